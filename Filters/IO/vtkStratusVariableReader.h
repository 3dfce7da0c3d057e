// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVariableReader
 * @brief   base class of readers of one of a file's variables: the file name, the variable and the time
 *
 * A reader outputs one variable on its grid, at the time step that the pipeline requests (the nearest step at or before it, otherwise the
 * first). An error names the file and the fault, and empties the output.
 *
 * Readers of images and of grids with an extent output the piece of a rank, with as many layers of ghost cells as are requested, or the
 * extent that a filter requests. Of values that stay in the file (SetMapFile()), only the piece's
 * are read, and the chunks that contain them. Other values are read as a whole first.
 *
 * The information of the output's array has the variable's unit as vtkDataArray::UNITS_LABEL(). If the unit of the coordinates is a length,
 * the output's field data have an array "MetresPerUnit" of one number. By both, numbers of rays (vtkStratusVolumeMapper::SetQuantities())
 * have units, and their lengths are in metres.
 *
 * @sa vtkStratusCFReader vtkStratusHDF5Reader vtkStratusImageReader vtkStratusUgridReader vtkStratusVDBReader vtkStratusXMLImageReader
 *     vtkStratusZarrReader
 */
#ifndef vtkStratusVariableReader_h
#define vtkStratusVariableReader_h

#include "StratusFiltersIOModule.h" // For export macro
#include "vtkDataSetAlgorithm.h"
#include "vtkNew.h"          // For vtkNew
#include "vtkSmartPointer.h" // For vtkSmartPointer

#include <cstdint>    // For uint64_t
#include <functional> // For std::function
#include <map>        // For std::map
#include <string>     // For std::string
#include <vector>     // For std::vector

class vtkDataArray;
class vtkStringArray;

#ifndef __VTK_WRAP__
// The file's numbers along an axis: number = coordinate * Scale, or pairs of both.
struct vtkStratusFileAxis {
  int Kind = 0;
  std::string Title, Units;
  double Scale = 1.0;
  std::vector<double> Levels;
};
#endif

class STRATUSFILTERSIO_EXPORT vtkStratusVariableReader : public vtkDataSetAlgorithm
{
public:
  vtkTypeMacro(vtkStratusVariableReader, vtkDataSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the file's name. Default none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  //@}

  //@{
  /**
   * Set/Get the variable to read. One that the file does not have is an error that lists those that it has. Default none: the first.
   */
  vtkSetStringMacro(VariableName);
  vtkGetStringMacro(VariableName);
  //@}

  //@{
  /**
   * Values stay in the file where the reader can leave them there, and are read when something looks at them. Values of fewer bytes than
   * MappedBytesLeast (default 16 MiB) are read at once, which is as quick. The array then has the file's values as long as nothing writes
   * to the file; after that, its values are undefined. Where a file is cut short, the values that are missing become 0 or NaN, and the
   * mappers report an error. Readers of images leave uncompressed values in the file by default. Those of netCDF, Zarr, HDF5, .vti and
   * .nvdb do so if MapFile is on (default off), and read a row of the file's chunks at a time; these arrays, and all of more bytes than a
   * memory limit that is set, are *bricks*. Nothing may write into bricks; and system calls that read them (such as a file's write or a
   * message of MPI) fail where values are not in memory, so that such arrays are for mappers, not for writers.
   */
  vtkSetMacro(MapFile, vtkTypeBool);
  vtkGetMacro(MapFile, vtkTypeBool);
  vtkBooleanMacro(MapFile, vtkTypeBool);
  vtkSetMacro(MappedBytesLeast, vtkTypeInt64);
  vtkGetMacro(MappedBytesLeast, vtkTypeInt64);
  vtkGetMacro(Mapped, vtkTypeBool); // whether the last output's values are in the file
  //@}

  //@{
  /**
   * Set/Get how many bytes of memory all bricks of the process take together, at least 16 MiB. Other memory that the process takes from the
   * first file on counts, too, such as structures and pictures, until half of the limit is left to bricks. Bricks that were not looked at
   * for longest are dropped, and read again when something looks at them. 0 (default): half of the memory that is free when the first file
   * is read.
   */
  static void SetMemoryLimit(vtkTypeInt64 bytes);
  static vtkTypeInt64 GetMemoryLimit();
  //@}

  /**
   * Set the same limit in MiB for user interfaces, where every reader has a value: 0 leaves it as it is.
   */
  void SetMemoryLimitInMiB(vtkTypeInt64 size);

  /**
   * Get how many bytes of memory all bricks of the process take now.
   */
  static vtkTypeInt64 GetMemoryUsed();

  /**
   * Get how many bytes were read into bricks since the process began, those that were read again, too.
   */
  static vtkTypeInt64 GetBytesRead();

  //@{
  /**
   * Get the variables that can be read, after UpdateInformation(): their number, all names, and the name, units, long name and standard
   * name (of the CF conventions) of each. A text that the file does not contain is "". An index out of range gives "".
   */
  int GetNumberOfVariables();
  vtkStringArray* GetNamesOfVariables();
  const char* GetNameOfVariable(int index);
  const char* GetUnitsOfVariable(int index);
  const char* GetLongNameOfVariable(int index);
  const char* GetStandardNameOfVariable(int index);
  //@}

  /**
   * Get the unit of the time steps as the file has it ("hours since 2001-01-01 00:00"), "" if it has none. After UpdateInformation().
   */
  const char* GetTimeUnits();

  /**
   * Get the calendar of the time steps as the file names it ("noleap", "360_day"), "" if it does not: the Gregorian one. After
   * UpdateInformation().
   */
  const char* GetTimeCalendar();

  /**
   * Get the unit of all three of the output's coordinates, such as "m" or "mm", after UpdateInformation(). It is "" if the file has no
   * units or they differ.
   */
  const char* GetLengthUnits();

  //@{
  /**
   * Get the name of an axis of the output's coordinates, 0 to 2, and the unit of its numbers: "east" (from the meridian of longitude 0, on
   * the sphere) and "m", "height" and "m", or the name and unit of the file's coordinate or dimension. The text is "" if the file has none,
   * and for another axis. After UpdateInformation().
   */
  const char* GetNameOfAxis(int axis);
  const char* GetUnitsOfAxis(int axis);
  //@}

  /**
   * What the file's own numbers of an axis are: numbers, degrees of longitude or latitude, or levels, such as pressures.
   */
  enum AxisKind { AXIS_OF_NUMBERS, AXIS_OF_LONGITUDES, AXIS_OF_LATITUDES, AXIS_OF_LEVELS };

  //@{
  /**
   * Get the numbers that the file has along an axis, 0 to 2, of the output's coordinates, for labels of axes: their kind, what they are
   * (the long_name or standard_name of the file's coordinate, such as "air pressure"), and their unit ("hPa"). A number is the output's
   * coordinate times the scale, which is below 0 for depths. Only levels are pairs of an output's coordinate and a number instead. After
   * UpdateInformation(). For another axis, numbers are the output's coordinates.
   */
  int GetKindOfAxis(int axis);
  const char* GetTitleOfAxis(int axis);
  const char* GetFileUnitsOfAxis(int axis);
  double GetScaleOfAxis(int axis);
  int GetNumberOfLevelsOfAxis(int axis);
  double GetCoordinateOfLevel(int axis, int level);
  double GetNumberOfLevel(int axis, int level);
  //@}

  /**
   * Get a sentence on how coordinates became a grid, "" before the first update: which variables they are, and how their
   * units were converted.
   */
  const char* GetDescription();

protected:
  vtkStratusVariableReader();
  ~vtkStratusVariableReader() override;

  struct VariableEntry {
    std::string Name, Units, LongName, StandardName = {};
  };

  /// Looks up Variables, Times, TimeUnits, Description and WholeExtent. Returns the class of the output for the chosen variable.
  /// Throws vtkStratusReadError, as Build() and ChosenName() do.
  virtual std::string Inspect() = 0;
  /// Fills the output, whose class Inspect() reported, with the data of a time step. The step is 0 in a file without time.
  virtual void Build(size_t step, vtkDataObject* output) = 0;
  /// Returns VariableName, or the first variable if there is none. Fails with the list of variables for another name.
  std::string ChosenName() const;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

#ifndef __VTK_WRAP__
  /// Returns the bricks of a time step, which `make` makes unless they are there from before; null if it can't. Bricks of some steps stay,
  /// so that values in memory are not read again. Once the time changes, bricks of the step that comes next are read ahead.
  vtkSmartPointer<vtkDataArray> BricksOf(size_t step, const std::function<vtkSmartPointer<vtkDataArray>(size_t)>& make);
#endif

  vtkTypeBool MapFile = 0, Mapped = 0;
  vtkTypeInt64 MappedBytesLeast = vtkTypeInt64(1) << 24;
  char* FileName = nullptr;
  char* VariableName = nullptr;
  std::vector<VariableEntry> Variables;
  std::vector<double> Times;
  std::string TimeUnits, TimeCalendar;
  std::string Description;
  std::string LengthUnits;
  std::string AxisNames[3], AxisUnits[3]; // units: "" as LengthUnits
#ifndef __VTK_WRAP__
  vtkStratusFileAxis FileAxes[3];
#endif
  int WholeExtent[6]; // of an output with an extent
  /// Whether the reader gives parts of such an output, for ranks and for filters that request one. Build() makes all of it, or all but
  /// arrays that have the values of Part only; the rest is cut out. Blocks of WholeExtent it cuts itself.
  bool GivesParts = false;
  int Part[6];      // what is requested of WholeExtent, with ghost cells
  int OwnedPart[6]; // Part without ghost cells

  /// Says that the output's coordinates are places on a sphere, in metres.
  void SetAxesOnSphere();

private:
  vtkStratusVariableReader(const vtkStratusVariableReader&) = delete;
  void operator=(const vtkStratusVariableReader&) = delete;

  bool Look();
  void SetUnits(vtkDataObject* output);

  vtkMTimeType LookTime = 0;
#ifndef __VTK_WRAP__
  void Retire(size_t step);
  bool FindPart(vtkInformation* request, vtkDataObject* output);

  std::map<size_t, vtkSmartPointer<vtkDataArray>> Bricks; // of time steps
  std::vector<vtkSmartPointer<vtkDataArray>> Retired;     // were among them
  vtkSmartPointer<vtkDataArray> Ahead;                    // of the step that is read ahead
  uint64_t BricksFile = 0;                                // the identity of their file
  int BricksPart[6];                                      // the extent that they have
#endif
  size_t LastStep = 0; // of these
  std::string OutputClass;
  vtkNew<vtkStringArray> Names;
};

#endif
