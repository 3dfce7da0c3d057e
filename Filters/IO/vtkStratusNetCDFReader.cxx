// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFReader.h"
#include "vtkStratusText.h"

#ifdef STRATUS_NETCDF
#include "vtkStratusHDF5Lock.h"
#include "vtkStratusNetCDFFile.h"
#endif
#include "vtkStratusNetCDFModel.h"

#include "stratus/look.h"

#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <array>

namespace {
using Variable = vtkStratusNetCDFVariable;

enum RankType { Field, Staggered, Flag, Ingredient, RankCount };

template <size_t N> bool IsOneOf(const std::string& word, const std::array<const char*, N>& words)
{
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool EndsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Returns whether an attribute of another variable names this one: "area: cells volume: boxes".
bool IsNamedBy(const vtkStratusNetCDFModel& file, const Variable& variable, const char* attribute)
{
  return std::any_of(file.GetVariables().begin(), file.GetVariables().end(), [&](const Variable& one) {
    const std::string text = file.Text(one, attribute);
    const std::vector<std::string> words = text.empty() ? std::vector<std::string>() : vtkStratusWords(text);
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return file.Find(word, &one) == &variable; });
  });
}

// Whether coordinates are computed from the variable, by standard_name, by models' names, and by its description.
bool IsIngredient(const vtkStratusNetCDFModel& file, const Variable& variable)
{
  static constexpr std::array<const char*, 18> standard = { "altitude", "height", "depth", "air_pressure", "sea_water_pressure",
    "geopotential", "geopotential_height", "height_above_geopotential_datum", "height_above_mean_sea_level",
    "height_above_reference_ellipsoid", "cell_thickness", "cell_area", "cell_volume", "ocean_volume", "longitude", "latitude",
    "projection_x_coordinate", "projection_y_coordinate" };
  static constexpr std::array<const char*, 35> names = { "x", "y", "z", "lon", "lat", "longitude", "latitude", "xlong", "xlat", "height",
    "altitude", "depth", "pressure", "pres", "p", "pb", "p_hyd", "ph", "phb", "geopotential", "z_mc", "z_ifc", "zg", "zcor", "zcoordinates",
    "dz", "e3t", "e3u", "e3v", "e3w", "thkcello", "volcello", "areacello", "hgt", "zhalf" };
  static constexpr std::array<const char*, 7> words = { "geopotential", "base state", "base-state", "cell thickness", "layer thickness",
    "cell area", "cell volume" };
  const std::string said = vtkStratusLowerCase(file.Text(variable, "long_name") + " " + file.Text(variable, "description"));
  const bool axis = !file.Text(variable, "axis").empty() || !file.Text(variable, "positive").empty();
  return axis || IsOneOf(file.Text(variable, "standard_name"), standard) || IsOneOf(vtkStratusLowerCase(variable.BaseName()), names) ||
    std::any_of(words.begin(), words.end(), [&said](const char* word) { return said.find(word) != std::string::npos; }) ||
    IsNamedBy(file, variable, "cell_measures");
}

// On the faces, edges or corners of cells: WRF and ROMS name their dimensions by it.
bool IsStaggered(const vtkStratusNetCDFModel& file, const Variable& variable)
{
  const auto staggered = [&file](int dimension) {
    const std::string& name = file.NameOf(dimension);
    return EndsWith(name, "_stag") || EndsWith(name, "_u") || EndsWith(name, "_v") || EndsWith(name, "_w") || EndsWith(name, "_psi");
  };
  return std::any_of(variable.Dimensions.begin(), variable.Dimensions.end(), staggered);
}

int RankOf(const vtkStratusNetCDFModel& file, const Variable& variable)
{
  if (IsIngredient(file, variable)) {
    return Ingredient;
  }
  for (const char* attribute : { "flag_values", "flag_masks", "flag_meanings" }) {
    if (file.Has(variable, attribute)) {
      return Flag;
    }
  }
  const bool mask =
    vtkStratusLowerCase(variable.BaseName()).find("mask") != std::string::npos || IsNamedBy(file, variable, "ancillary_variables");
  return mask ? Flag : IsStaggered(file, variable) ? Staggered : Field;
}

#ifdef STRATUS_NETCDF
// A file with libnetcdf's lock, which is held before the file is opened and until it is closed.
class LockedFile : private vtkStratusHDF5Call, public vtkStratusNetCDFFile
{
public:
  using vtkStratusNetCDFFile::vtkStratusNetCDFFile;
};
#endif
} // namespace

void vtkStratusNetCDFReader::AddVariable(const vtkStratusNetCDFModel& file, const Variable& variable, int place)
{
  this->Ranks.resize(this->Variables.size());
  const int rank = place * RankCount + RankOf(file, variable);
  const auto at = std::upper_bound(this->Ranks.begin(), this->Ranks.end(), rank) - this->Ranks.begin();
  const std::string name = file.Text(variable, "long_name");
  this->Ranks.insert(this->Ranks.begin() + at, rank);
  this->Variables.insert(this->Variables.begin() + at,
    { variable.Name, file.Text(variable, "units"), name.empty() ? file.Text(variable, "description") : name,
      file.Text(variable, "standard_name") });
}

vtkStratusNetCDFReader::~vtkStratusNetCDFReader()
{
  this->SetSelection(nullptr);
}

void vtkStratusNetCDFReader::SetPlaceOnPlane(const std::function<bool(const double[2], double[2])>& place, const std::string& why_not)
{
  this->PlaceOnPlane = place;
  this->WhyNoPlaces = why_not;
}

bool vtkStratusNetCDFReader::FindPlace(double longitude, double latitude, double at[2]) const
{
  const double degrees[2] = { longitude, latitude };
  return this->PlaceOnPlane && this->PlaceOnPlane(degrees, at);
}

std::unique_ptr<vtkStratusNetCDFModel> vtkStratusNetCDFReader::OpenFile()
{
#ifdef STRATUS_NETCDF
  return std::make_unique<LockedFile>(this->FileName, this->Selection ? this->Selection : "");
#else
  throw vtkStratusReadError{ std::string(this->FileName) +
    ": the module was built without libnetcdf (Debian: libnetcdf-dev), which reads netCDF files" };
#endif
}

std::string vtkStratusNetCDFReader::Inspect()
{
  const std::unique_ptr<vtkStratusNetCDFModel> file = this->OpenFile();
  this->SetPlaceOnPlane(nullptr, "");
  return this->InspectFile(*file);
}

void vtkStratusNetCDFReader::Build(size_t step, vtkDataObject* output)
{
  const std::unique_ptr<vtkStratusNetCDFModel> file = this->OpenFile();
  this->BuildFile(*file, step, vtkDataSet::SafeDownCast(output));
  if (this->ExaggerateHeights && this->Coordinates == PLANE && this->LengthUnits == "m") {
    this->Exaggerate(vtkDataSet::SafeDownCast(output));
  } else if (this->Coordinates == PLANE) {
    this->UsedHeightFactor = 0.0;
  }
  if (this->Coordinates == PLANE) {
    this->NameAxes(vtkDataSet::SafeDownCast(output));
  }
}

// Field data that ParaView's axes follow: titles, and how the file's own numbers become coordinates. They stay as they are where these are
// not proportional.
void vtkStratusNetCDFReader::NameAxes(vtkDataSet* output)
{
  double bounds[6];
  output->GetBounds(bounds);
  vtkNew<vtkDoubleArray> matrix, box;
  matrix->SetName("ChangeOfBasisMatrix");
  matrix->SetNumberOfComponents(16);
  matrix->SetNumberOfTuples(1);
  matrix->Fill(0.0);
  matrix->SetComponent(0, 15, 1.0);
  box->SetName("BoundingBoxInModelCoordinates");
  box->SetNumberOfComponents(6);
  box->SetNumberOfTuples(1);
  for (int axis = 0; axis < 3; ++axis) {
    const double factor = axis == 2 && this->UsedHeightFactor > 0.0 ? this->UsedHeightFactor : 1.0;
    const double scale = this->GetScaleOfAxis(axis) / factor;
    const std::string letter(1, "XYZ"[axis]);
    const int kind = this->GetKindOfAxis(axis);
    const bool levels = kind == AXIS_OF_LEVELS, degrees = kind == AXIS_OF_LONGITUDES || kind == AXIS_OF_LATITUDES;
    const std::string name = levels ? this->GetNameOfAxis(axis) : this->GetTitleOfAxis(axis);
    const std::string units = degrees ? "\u00b0" : levels ? this->GetUnitsOfAxis(axis) : this->GetFileUnitsOfAxis(axis);
    const std::string title = (name.empty() ? letter : name) + (units.empty() || units == "1" ? "" : " (" + units + ")");
    matrix->SetComponent(0, 5 * axis, 1.0 / scale);
    box->SetComponent(0, 2 * axis, std::min(scale * bounds[2 * axis], scale * bounds[2 * axis + 1]));
    box->SetComponent(0, 2 * axis + 1, std::max(scale * bounds[2 * axis], scale * bounds[2 * axis + 1]));
    vtkNew<vtkStringArray> text; // its component is called as the title, which is what a client gets
    text->SetName(("AxisTitleFor" + letter).c_str());
    text->SetNumberOfComponents(1);
    text->SetComponentName(0, title.c_str());
    text->InsertNextValue(title);
    output->GetFieldData()->AddArray(text);
  }
  output->GetFieldData()->AddArray(matrix);
  output->GetFieldData()->AddArray(box);
}

void vtkStratusNetCDFReader::Exaggerate(vtkDataSet* output)
{
  double bounds[6];
  output->GetBounds(bounds);
  if (this->FactorTime != this->GetMTime()) {
    this->UsedHeightFactor = this->HeightFactor > 0.0 ? this->HeightFactor : stratus_look_height_factor(bounds, 2);
    this->FactorTime = this->GetMTime();
    this->PlainPoints = this->HighPoints = nullptr;
  }
  const double factor = this->UsedHeightFactor;
  if (factor == 1.0) {
    return;
  }
  if (vtkImageData* image = vtkImageData::SafeDownCast(output)) {
    const double *spacing = image->GetSpacing(), *origin = image->GetOrigin();
    image->SetSpacing(spacing[0], spacing[1], factor * spacing[2]);
    image->SetOrigin(origin[0], origin[1], factor * origin[2]);
  } else if (vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(output)) {
    vtkDataArray* const from = grid->GetZCoordinates();
    vtkNew<vtkDoubleArray> heights;
    for (vtkIdType i = 0; i < from->GetNumberOfTuples(); ++i) {
      heights->InsertNextValue(factor * from->GetComponent(i, 0));
    }
    grid->SetZCoordinates(heights);
  } else if (vtkPointSet* set = vtkPointSet::SafeDownCast(output)) {
    if (set->GetPoints() != this->PlainPoints) { // which steps share if places do not move
      this->PlainPoints = set->GetPoints();
      this->HighPoints = vtkSmartPointer<vtkPoints>::New();
      this->HighPoints->SetDataType(this->PlainPoints->GetDataType());
      this->HighPoints->DeepCopy(this->PlainPoints);
      vtkDataArray* const places = this->HighPoints->GetData();
      for (vtkIdType i = 0; i < places->GetNumberOfTuples(); ++i) {
        places->SetComponent(i, 2, factor * places->GetComponent(i, 2));
      }
    }
    set->SetPoints(this->HighPoints);
  }
  vtkNew<vtkDoubleArray> used;
  used->SetName("HeightFactor");
  used->InsertNextValue(factor);
  output->GetFieldData()->AddArray(used);
}

void vtkStratusNetCDFReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Coordinates: " << (this->Coordinates == SPHERE ? "sphere" : "plane") << "\n";
  os << indent << "ExaggerateHeights: " << this->ExaggerateHeights << "\n";
  os << indent << "HeightFactor: " << this->HeightFactor << "\n";
  os << indent << "Selection: " << (this->Selection ? this->Selection : "(none)") << "\n";
}
