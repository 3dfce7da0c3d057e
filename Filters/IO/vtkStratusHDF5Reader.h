// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusHDF5Reader
 * @brief   reads an image from a VTKHDF file (.vtkhdf, .hdf), or a data set of three dimensions from any HDF5 file (.h5)
 *
 * Of a VTKHDF file of the type ImageData, versions 1 and 2, the variables are the arrays of points, then the arrays of cells, each in the
 * order of names; the array that the attribute Scalars of PointData names comes first. The image has the file's WholeExtent, Origin,
 * Spacing and Direction (default: the axes), and its arrays vtkGhostType. The group Steps has the times of steps; an array may have a first
 * dimension of time, whose index at a step PointDataOffsets or CellDataOffsets say (default: the step's number). An array may have a last
 * dimension of components. Arrays of other sizes than the grid's are left out, and GetDescription() names them. Another type than ImageData
 * is an error: VTK's vtkHDFReader reads the others.
 *
 * Of another HDF5 file the variables are its data sets of numbers of three dimensions, by their paths ("/run1/rho"). The slowest dimension
 * is z. The image has the origin 0 and the spacing 1, and values are points.
 *
 * Numbers of either order of bytes are read, and floats of 16 bits become floats of 32 bits. If MapFile is on (default off), values of at
 * least MappedBytesLeast bytes stay in the file: values in one piece are mapped, or in bricks if they are larger than a memory limit that
 * is set. Chunks are read when something looks at them. Several threads undo the filters deflate, shuffle and fletcher32 of chunks. Values
 * with other filters, and values of the other order of bytes, are read by one thread at a time.
 *
 * @sa vtkStratusCFReader vtkStratusImageReader
 */
#ifndef vtkStratusHDF5Reader_h
#define vtkStratusHDF5Reader_h

#include "vtkSmartPointer.h" // For vtkSmartPointer
#include "vtkStratusVariableReader.h"

class vtkDataArray;
class vtkStratusHDF5File;

class STRATUSFILTERSIO_EXPORT vtkStratusHDF5Reader : public vtkStratusVariableReader
{
public:
  static vtkStratusHDF5Reader* New();
  vtkTypeMacro(vtkStratusHDF5Reader, vtkStratusVariableReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Returns whether a file is HDF5, and no VTKHDF file of another type than ImageData.
   */
  static int CanReadFile(const char* path);

protected:
  vtkStratusHDF5Reader();
  ~vtkStratusHDF5Reader() override;

  std::string Inspect() override;
  void Build(size_t step, vtkDataObject* output) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkStratusHDF5Reader(const vtkStratusHDF5Reader&) = delete;
  void operator=(const vtkStratusHDF5Reader&) = delete;

#ifndef __VTK_WRAP__
  // A data set that is an array of the image.
  struct Array {
    std::string Name, Path;
    bool Cells = false, Timed = false; // Timed: its first dimension is the time
    int Axes = 3;                      // its dimensions in space: x, y and, except where a flat image leaves it out, z
    int Components = 1;
    std::vector<size_t> Sizes; // of the data set
  };
  struct Box;

  void InspectImage(const vtkStratusHDF5File& file);
  void InspectDataSets(const vtkStratusHDF5File& file);
  void FindFrame(const vtkStratusHDF5File& file);
  void FindSteps(const vtkStratusHDF5File& file);
  void FindArrays(const vtkStratusHDF5File& file, bool cells, std::string& left_out);
  void AddArray(const vtkStratusHDF5File& file, const Array& array, bool first);
  const Array& FindChosen() const;
  bool Fits(Array& array) const;
  std::vector<size_t> GridOf(bool cells) const;
  size_t IndexOf(const vtkStratusHDF5File& file, const Array& array, size_t step) const;
  Box OpenBox(const vtkStratusHDF5File& file, const Array& array, size_t step) const;
  vtkSmartPointer<vtkDataArray> ReadValues(const vtkStratusHDF5File& file, const Array& array, const Box& box);
  vtkSmartPointer<vtkDataArray> LeaveValues(const Array& array, const Box& box) const;

  std::vector<Array> Arrays, Ghosts;
#endif
  double Origin[3], Spacing[3], Direction[9];
};

#endif
