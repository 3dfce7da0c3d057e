// SPDX-License-Identifier: BSD-3-Clause
// Views of VTK's images, rectilinear grids and transfer functions in the core's terms. Private to the modules, never installed.
#ifndef vtkStratusInput_h
#define vtkStratusInput_h

#include "stratus.h"

#include "vtkStratusFunction.h"
#include "vtkStratusPrivate.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkColorTransferFunction;
class vtkDataArray;
class vtkDataObject;
class vtkDataSet;
class vtkImageData;
class vtkInformationVector;
class vtkMatrix4x4;
class vtkPiecewiseFunction;
class vtkRectilinearGrid;
class vtkUnsignedCharArray;
class vtkVolumeProperty;

// A view of one array of an image or a rectilinear grid, both called image here. It copies the values where the array's memory is not one
// plain run, and copies again when they change.
class VTK_STRATUS_PRIVATE vtkStratusImageView
{
public:
  // Returns false, with the reason in `error`, where the core cannot take the array. `matrix` is the prop's, or nullptr for the identity.
  // `component`: the only one that is taken of an array of any number; -1: all, of which there may be `mostComponents`.
  bool Set(vtkDataSet* image, vtkDataArray* array, bool cells, vtkMatrix4x4* matrix, std::string& error, int mostComponents = 1,
    int component = -1);
  // Takes a filter's input and the array that the filter is to process. Either may be nullptr, which is reported as an error.
  bool SetInput(vtkDataSet* image, vtkDataArray* array, int association, std::string& error);
  void SetGradients(const float* gradients) { this->Volume.gradients = gradients; } // borrowed; until the next Set()
  const stratus_volume& GetVolume() const { return this->Volume; }
  // Where the parts that were read of an array of bricks are counted; null for another array.
  const uint64_t* GetReads() const { return this->Reads; }
  // The offset from VTK's cropping planes to the core's: crop_bounds = planes + offset. VTK's planes ignore the image's direction.
  const double* GetCropOffset() const { return this->CropOffset; }
  void Release();

private:
  bool SetValues(vtkDataSet* image, vtkDataArray* array, bool cells, int mostComponents, int component, std::string& error);
  void SetGeometry(vtkImageData* image);
  bool SetCoordinates(vtkRectilinearGrid* grid, std::string& error);
  bool SetGhosts(vtkDataSet* image, bool cells, std::string& error);
  void HideCellsAtPoints(vtkDataSet* image, vtkUnsignedCharArray* points, vtkUnsignedCharArray* cells);

  stratus_volume Volume;
  const uint64_t* Reads = nullptr;
  std::vector<double> Coordinates[3]; // of a rectilinear grid
  double CropOffset[3] = { 0, 0, 0 };
  std::vector<uint8_t> CellGhosts;      // where values are of cells and points are hidden
  uint64_t CellGhostsRevision = 0;      // 0: there are none
  vtkSmartPointer<vtkDataArray> Source; // kept alive, so that no new array can get the same address
  vtkSmartPointer<vtkDataArray> Plain;
  vtkMTimeType PlainTime = 0;
};

// A transfer function and the arrays it points to. A function is translated when it was modified or replaced, not with every picture.
class VTK_STRATUS_PRIVATE vtkStratusTransferView
{
public:
  // Reads the functions of the property's component `index`.
  bool Set(vtkVolumeProperty* property, int index, std::string& error);
  // Reads the functions of a label. If the property lacks one for the label, the function of `component0` replaces it; `component0` must
  // outlive this view. A label without a gradient opacity of its own has none here: the core then uses the gradient opacity of component 0.
  bool SetLabel(vtkVolumeProperty* property, int label, const vtkStratusTransferView& component0, std::string& error);
  // Returns the highest label that has functions of its own and fits in a byte, 0 if there is none.
  static int FindHighestLabel(vtkVolumeProperty* property);
  bool Set(vtkVolumeProperty* property, std::string& error) { return this->Set(property, 0, error); }
  const stratus_transfer& GetTransfer() const { return this->Transfer; }
  // Returns how many functions were translated since the view was made.
  uint64_t GetBuilds() const { return this->Opacity.GetBuilds() + this->Color.GetBuilds() + this->Gradient.GetBuilds(); }

private:
  void PointToOpacity();
  void PointToColor();
  bool SetGradient(vtkVolumeProperty* property, int index);

  stratus_transfer Transfer;
  vtkStratusFunction Opacity, Color, Gradient;
};

// Lists the image's arrays, for the message that the wanted one is missing.
VTK_STRATUS_PRIVATE std::string vtkStratusArrayNames(vtkDataSet* image);
// Returns the position along the grid's axis of an index, minus the origin. The index may be between two values. Index 0 of
// cell values is the centre of the first cell.
VTK_STRATUS_PRIVATE double vtkStratusPosition(const stratus_volume& volume, int axis, double index);
// Returns the data set where it is one that vtkStratusImageView takes, an image or a rectilinear grid, else nullptr.
VTK_STRATUS_PRIVATE vtkDataSet* vtkStratusAsImage(vtkDataObject* object);
// Makes a filter's first output, where it is not there yet, of its first input's class; an image where that is no such data set, which is
// refused later.
VTK_STRATUS_PRIVATE void vtkStratusMakeOutput(vtkInformationVector** inputs, vtkInformationVector* outputs);

#endif
