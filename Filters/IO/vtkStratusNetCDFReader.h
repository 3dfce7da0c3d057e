// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusNetCDFReader
 * @brief   base class of the readers of netCDF files and of Zarr: attributes, variables, dimensions
 *
 * Values are read as the netCDF users' guide says. All these attributes are about stored values, before scale_factor and add_offset:
 * - _Unsigned "true" or "false" gives integers the other sign; bytes with a valid limit above 127 have no sign.
 * - Values equal to _FillValue (its default for all types but bytes) or to any number of missing_value are NaN.
 * - Values outside of valid_range, or without it below valid_min or above valid_max, are NaN.
 * - Then scale_factor and add_offset are applied. Each must be one finite number; anything else is an error.
 *
 * Attributes are compared in the variable's type. GetDescription() lists attributes that are ignored: text, and limits that packed integers
 * cannot hold. Values are floats if floats can represent all of the variable's values exactly, otherwise doubles.
 *
 * Variables are listed in this order, and the first is read by default: fields of the cells; staggered fields; flags and masks; variables
 * that coordinates are computed from, such as pressure, geopotential, height, thickness and area. Within each group they are in the file's
 * order.
 *
 * @sa vtkStratusCFReader vtkStratusUgridReader vtkStratusZarrReader
 */
#ifndef vtkStratusNetCDFReader_h
#define vtkStratusNetCDFReader_h

#include "vtkStratusVariableReader.h"

#include "vtkSmartPointer.h"

#include <functional>
#include <memory>

class vtkPoints;
class vtkStratusNetCDFModel;
struct vtkStratusNetCDFVariable;

class STRATUSFILTERSIO_EXPORT vtkStratusNetCDFReader : public vtkStratusVariableReader
{
public:
  vtkTypeMacro(vtkStratusNetCDFReader, vtkStratusVariableReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the dimensions that are read at one index only: "NAME=INDEX,NAME=INDEX...", indices from 0. A selected dimension is neither an
   * axis nor the time, so that any three-dimensional part of a variable of more dimensions can be read. A name with the path of its group
   * ("run1/number") is this group's dimension; without a path it is each dimension of this name. A name that the file does not have, and an
   * index out of range, are errors. Default none: a dimension that is neither axis nor time is read at index 0.
   */
  vtkSetStringMacro(Selection);
  vtkGetStringMacro(Selection);
  //@}

  /**
   * How longitudes and latitudes become coordinates.
   */
  enum CoordinatesType { PLANE, SPHERE };

  //@{
  /**
   * Set/Get how longitudes and latitudes become coordinates. PLANE (default): metres on a plane, at the middle latitude. SPHERE: places on
   * a sphere of 6,371 km about 0, whose x axis goes through longitude 0 on the equator, and whose z axis goes through the north pole;
   * heights, times HeightFactor, are added to the radius. Images and rectilinear grids become a vtkStructuredGrid then. Lattices that go
   * all the way round are closed by one more column, and rows around a pole by points at the pole; columns and rows that a file repeats are
   * left out. Grids on a map projection or about another pole have the longitudes and latitudes of two dimensions that the file has, or
   * those of its grid mapping by PROJ. A grid without longitudes and latitudes of the Earth is an error.
   */
  vtkSetClampMacro(Coordinates, int, PLANE, SPHERE);
  vtkGetMacro(Coordinates, int);
  void SetCoordinatesToPlane() { this->SetCoordinates(PLANE); }
  void SetCoordinatesToSphere() { this->SetCoordinates(SPHERE); }
  //@}

  //@{
  /**
   * Set/Get whether heights on the plane are multiplied, if the file is of the Earth (all coordinates are in metres). The factor is
   * HeightFactor, or if that is 0 stratus_look_height_factor(): data lower than a tenth of their width become a fifth as high as wide. It
   * stays as it is at the first time step. The output then has the
   * field array HeightFactor. Default 0: heights are true. On the plane ChangeOfBasisMatrix, BoundingBoxInModelCoordinates and
   * AxisTitleForX, Y and Z are the file's own numbers and names, which axes follow where ParaView's plugin NonOrthogonalSource is loaded.
   */
  vtkSetMacro(ExaggerateHeights, vtkTypeBool);
  vtkGetMacro(ExaggerateHeights, vtkTypeBool);
  vtkBooleanMacro(ExaggerateHeights, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get the factor of heights on the sphere, and of exaggerated heights on the plane, at least 0. Default 0 on the sphere: as much as
   * makes them reach over a tenth of the radius.
   */
  vtkSetClampMacro(HeightFactor, double, 0.0, 1e30);
  vtkGetMacro(HeightFactor, double);
  //@}

  /**
   * Get the factor of heights of the last output on the sphere, or of exaggerated heights; 0: there was none.
   */
  vtkGetMacro(UsedHeightFactor, double);

  //@{
  /**
   * Find x and y of the output for a longitude and latitude in degrees, if its grid is on the plane of a map projection, or of longitudes
   * and latitudes about another pole. HasPlaces() returns whether it is, after UpdateInformation(). Returns false where the projection has
   * no such place. GetReasonWithoutPlaces() is why a grid with a grid mapping has no places, "" for one without: a mapping that is unknown
   * or incomplete, or a build without PROJ.
   */
  bool HasPlaces() const { return static_cast<bool>(this->PlaceOnPlane); }
  bool FindPlace(double longitude, double latitude, double at[2]) const;
  const char* GetReasonWithoutPlaces() const { return this->WhyNoPlaces.c_str(); }
  //@}

protected:
  vtkStratusNetCDFReader() = default;
  ~vtkStratusNetCDFReader() override;

#ifndef __VTK_WRAP__
  /// Opens FileName with the dimensions of Selection. Throws vtkStratusReadError.
  virtual std::unique_ptr<vtkStratusNetCDFModel> OpenFile();
#endif
  /// Inspect() and Build() of the superclass, with the file open.
  virtual std::string InspectFile(const vtkStratusNetCDFModel& file) = 0;
  virtual void BuildFile(const vtkStratusNetCDFModel& file, size_t step, vtkDataSet* output) = 0;

  /// Lists a variable, ordered by `place`. Within one place the order is: fields of the cells, staggered fields, flags and masks, variables
  /// that coordinates are computed from (pressure, geopotential, thickness, area).
  void AddVariable(const vtkStratusNetCDFModel& file, const vtkStratusNetCDFVariable& variable, int place = 0);

  std::string Inspect() override;
  void Build(size_t step, vtkDataObject* output) override;

#ifndef __VTK_WRAP__
  /// Sets how longitudes and latitudes become x and y of the output, none if it is null, and why not.
  void SetPlaceOnPlane(const std::function<bool(const double[2], double[2])>& place, const std::string& why_not);
#endif

  char* Selection = nullptr;
  int Coordinates = PLANE;
  double HeightFactor = 0.0, UsedHeightFactor = 0.0;
  vtkTypeBool ExaggerateHeights = 0;

private:
  void Exaggerate(vtkDataSet* output);
  void NameAxes(vtkDataSet* output);

  std::vector<int> Ranks; // of Variables
#ifndef __VTK_WRAP__
  std::function<bool(const double[2], double[2])> PlaceOnPlane;
#endif
  std::string WhyNoPlaces;
  vtkSmartPointer<vtkPoints> PlainPoints, HighPoints; // before and after heights are multiplied, of the last output
  vtkMTimeType FactorTime = 0;                        // when UsedHeightFactor was found

  vtkStratusNetCDFReader(const vtkStratusNetCDFReader&) = delete;
  void operator=(const vtkStratusNetCDFReader&) = delete;
};

#endif
