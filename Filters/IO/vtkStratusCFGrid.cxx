// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusCFGrid.h"

#include "vtkStratusNetCDFBricks.h"
#include "vtkStratusText.h"

#include "vtkStratusLongitudes.h"
#include "vtkStratusSphere.h"

#include "vtkDoubleArray.h"

#include <algorithm>
#include <climits>
#include <cmath>

namespace {
bool IsOneOf(const std::string& word, std::initializer_list<const char*> words)
{
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool EndsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

int AxisOfName(const std::string& name)
{
  const std::string word = vtkStratusLowerCase(vtkStratusTrimmed(name));
  if (IsOneOf(word, { "x", "xc", "xt", "xm", "xh", "lon", "longitude", "rlon", "west_east", "xi_rho", "ni", "i", "nx" })) {
    return 0;
  }
  if (IsOneOf(word, { "y", "yc", "yt", "ym", "yh", "lat", "latitude", "rlat", "south_north", "eta_rho", "nj", "j", "ny" })) {
    return 1;
  }
  const bool height = IsOneOf(word,
    { "z", "zc", "zt", "zm", "zh", "lev", "level", "levels", "height", "altitude", "depth", "plev", "pressure", "bottom_top", "s_rho",
      "s_w", "sigma", "layer", "k", "nz" });
  return height ? 2 : -1;
}
} // namespace

bool vtkStratusCFGrid::IsVolume(const vtkStratusNetCDFModel& file, const Variable& variable)
{
  return variable.HasNumbers() && vtkStratusNetCDFLayout(file, variable, [](int) { return -1; }).IsVolume();
}

vtkStratusCFGrid::vtkStratusCFGrid(const vtkStratusNetCDFModel& file, const Variable& variable, bool on_earth)
    : File(file), Of(variable), OnEarth(on_earth), Mapping(vtkStratusProjection::FindMapping(file, variable)),
      Layout(file, variable, [this](int dimension) { return this->AxisOfDimension(dimension); }), Dimensions(Layout.GetAxes())
{
  if (!this->Layout.IsVolume()) {
    file.Fail("variable '" + variable.Name + "' has " + std::to_string(this->Layout.GetCount()) +
      " dimensions in space that are longer than 1, a volume has 3; its dimensions are " + file.DescribeDimensions(variable));
  }
  this->CheckSize();
  this->FindCoordinates();
  this->ConvertUnits();
  this->Description += this->Layout.Describe();
}

// Checks the variable before memory is allocated for axes of its lengths, which a file can say without having as many values.
void vtkStratusCFGrid::CheckSize() const
{
  constexpr double most = 1LL << 46; // values that a process can address
  double count = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (this->GetLength(axis) > static_cast<size_t>(INT_MAX)) {
      this->File.Fail("a dimension of " + std::to_string(this->GetLength(axis)) + " values is longer than VTK's grids, 2147483647");
    }
    count *= static_cast<double>(this->GetLength(axis));
  }
  if (count > most) {
    this->File.Fail("'" + this->Of.Name + "' has " + vtkStratusNumberText(count) + " values, at most " + vtkStratusNumberText(most) +
      " can be addressed");
  }
  this->File.CheckValues(this->Of);
}

int vtkStratusCFGrid::AxisOfDimension(int dimension) const
{
  const std::string& name = this->File.NameOf(dimension);
  const Variable* own = this->File.CoordinateOf(dimension);
  const int axis = own ? this->AxisOf(*own) : -1;
  return axis >= 0 ? axis : AxisOfName(name);
}

int vtkStratusCFGrid::AxisOf(const Variable& coordinate) const
{
  const std::string axis = vtkStratusLowerCase(vtkStratusTrimmed(this->File.Text(coordinate, "axis"))),
                    name = this->File.Text(coordinate, "standard_name"), units = this->File.Text(coordinate, "units");
  if (axis == "x" || axis == "y" || axis == "z") {
    return axis[0] - 'x';
  }
  if (IsOneOf(name, { "longitude", "projection_x_coordinate", "projection_x_angular_coordinate", "grid_longitude" }) ||
    vtkStratusIsEast(units)) {
    return 0;
  }
  if (IsOneOf(name, { "latitude", "projection_y_coordinate", "projection_y_angular_coordinate", "grid_latitude" }) ||
    vtkStratusIsNorth(units)) {
    return 1;
  }
  const bool vertical = IsOneOf(name, { "altitude", "height", "depth", "air_pressure", "height_above_reference_ellipsoid" }) ||
    name.compare(0, 6, "ocean_") == 0 || name.compare(0, 11, "atmosphere_") == 0;
  return vertical || vtkStratusUnitOf(units).IsPressure() || !this->File.Text(coordinate, "positive").empty() ? 2 : -1;
}

bool vtkStratusCFGrid::Fits(const Variable& variable) const
{
  return variable.HasNumbers() && std::all_of(variable.Dimensions.begin(), variable.Dimensions.end(), [this](int one) {
    return one == this->Layout.GetTime() || this->Layout.IsFixed(one) || this->File.LengthOf(one) == 1 ||
      std::find(this->Dimensions.begin(), this->Dimensions.end(), one) != this->Dimensions.end();
  });
}

bool vtkStratusCFGrid::Has(const Variable& variable, int axis) const
{
  return std::find(variable.Dimensions.begin(), variable.Dimensions.end(), this->GetDimension(axis)) != variable.Dimensions.end();
}

// A longitude or latitude that has no unit is in degrees. An angle of an instrument is a length on the plane that it sees, or a number.
vtkStratusUnit vtkStratusCFGrid::UnitOf(const Variable& coordinate) const
{
  vtkStratusUnit unit = vtkStratusUnitOf(this->File.Text(coordinate, "units"));
  const std::string name = this->File.Text(coordinate, "standard_name");
  const bool angle = IsOneOf(name, { "longitude", "latitude", "grid_longitude", "grid_latitude" });
  unit.Quantity = angle && unit.Quantity == vtkStratusQuantity::None ? vtkStratusQuantity::Angle : unit.Quantity;
  if (unit.IsAngle() && name.compare(0, 11, "projection_") == 0) {
    const double metres = this->Mapping ? vtkStratusProjection::MetresPerRadian(this->File, *this->Mapping) : 0.0;
    unit.Quantity = metres > 0.0 ? vtkStratusQuantity::Length : vtkStratusQuantity::None;
    unit.Scale = metres > 0.0 ? unit.Scale * std::acos(-1.0) / 180.0 * metres : 1.0;
  }
  return unit;
}

// Whether a coordinate is a longitude or latitude of the Earth, instead of one about another pole or on a plane.
bool vtkStratusCFGrid::IsOfEarth(const Variable& coordinate) const
{
  return this->UnitOf(coordinate).IsAngle() && this->File.Text(coordinate, "standard_name").compare(0, 5, "grid_") != 0;
}

bool vtkStratusCFGrid::IsOfPlane(const Variable& coordinate) const
{
  return this->UnitOf(coordinate).IsLength() || (this->UnitOf(coordinate).IsAngle() && !this->IsOfEarth(coordinate));
}

void vtkStratusCFGrid::FindCoordinates()
{
  std::vector<const Variable*> others;
  for (const std::string& name : vtkStratusWords(this->File.Text(this->Of, "coordinates"))) {
    const Variable* one = this->File.Find(name, &this->Of);
    if (one && this->Fits(*one)) {
      others.push_back(one);
    }
  }
  for (size_t a = 0; a < 3; ++a) {
    const int dimension = this->Dimensions[a];
    const auto along = [dimension](const Variable* one) {
      return one && one->Dimensions.size() == 1 && one->Dimensions[0] == dimension && one->HasNumbers();
    };
    const Variable* own = this->File.CoordinateOf(dimension);
    const auto other = std::find_if(others.begin(), others.end(), along);
    this->Along[a] = along(own) ? own : other == others.end() ? nullptr : *other;
  }
  this->Vertical = std::make_unique<vtkStratusCFVertical>(*this, this->Along[2], others);
  this->FindHorizontal(others);
  for (int a = 0; a < 3; ++a) {
    this->ReadAxis(a);
  }
  if (this->OnEarth && !this->Horizontal[0]) {
    this->FindPlaces();
  }
}

// The projection of x and y, null if they are no coordinates of a plane that the file describes.
std::shared_ptr<vtkStratusProjection> vtkStratusCFGrid::MakeProjection() const
{
  const bool on_plane = this->Mapping && !this->Horizontal[0] && this->Along[0] && this->Along[1] && this->IsOfPlane(*this->Along[0]) &&
    this->IsOfPlane(*this->Along[1]);
  if (!on_plane) {
    return nullptr;
  }
  const bool is_angle = this->UnitOf(*this->Along[0]).IsAngle();
  const double metres = vtkStratusUnitOf(this->File.Text(*this->Along[0], "units")).Scale;
  auto projection = std::make_shared<vtkStratusProjection>(this->File, *this->Mapping, is_angle ? 1.0 : metres);
  if (projection->IsRotated() != is_angle || is_angle != this->UnitOf(*this->Along[1]).IsAngle()) {
    this->File.Fail("'" + this->Along[0]->Name + "' and '" + this->Along[1]->Name + "' are in '" +
      this->File.Text(*this->Along[0], "units") + "' and '" + this->File.Text(*this->Along[1], "units") + "', the grid mapping " +
      projection->Describe() + " needs " + (projection->IsRotated() ? "degrees" : "lengths"));
  }
  return projection;
}

// Finds longitudes and latitudes of all columns and rows by the projection. Those of places off the Earth are NaN.
void vtkStratusCFGrid::FindPlaces()
{
  const std::shared_ptr<vtkStratusProjection> projection = this->MakeProjection();
  if (!projection) {
    return;
  }
  const size_t columns = this->GetLength(0), rows = this->GetLength(1);
  for (std::vector<double>& each : this->Places) {
    each.resize(columns * rows, std::nan(""));
  }
  for (size_t j = 0; j < rows; ++j) {
    for (size_t i = 0; i < columns; ++i) {
      const double at[2] = { this->Axes[0][i], this->Axes[1][j] };
      double degrees[2];
      if (projection->ToEarth(at, degrees)) {
        this->Places[0][j * columns + i] = degrees[0];
        this->Places[1][j * columns + i] = degrees[1];
      }
    }
  }
  this->Description += "longitudes and latitudes by the grid mapping " + projection->Describe() + "; ";
}

vtkStratusCFGrid::Place vtkStratusCFGrid::GetPlaceOnPlane() const
{
  const std::shared_ptr<vtkStratusProjection> projection = this->MakeProjection();
  if (!projection) {
    return nullptr;
  }
  const std::array<double, 2> factors = this->Factors;
  const double middle = 0.5 * (this->Axes[0].front() + this->Axes[0].back()) / factors[0];
  return [projection, factors, middle](const double degrees[2], double at[2]) {
    const bool found = projection->ToPlane(degrees, at);
    if (projection->IsRotated()) { // in the turn of the file's longitudes
      at[0] -= 360.0 * std::round((at[0] - middle) / 360.0);
    }
    at[0] *= factors[0];
    at[1] *= factors[1];
    return found;
  };
}

// Two-dimensional coordinates are used if one-dimensional ones are missing or plain numbers, or not of the Earth, which is wanted. WRF's
// are also known by their names.
void vtkStratusCFGrid::FindHorizontal(const std::vector<const Variable*>& others)
{
  const auto is_number = [this](const Variable* one) {
    return !one || (this->File.Text(*one, "units").empty() && this->File.Text(*one, "standard_name").empty());
  };
  const bool of_earth = this->Along[0] && this->Along[1] && this->IsOfEarth(*this->Along[0]) && this->IsOfEarth(*this->Along[1]);
  if (!is_number(this->Along[0]) && !is_number(this->Along[1]) && (of_earth || !this->OnEarth)) {
    return;
  }
  std::vector<const Variable*> candidates = others;
  for (const Variable& one : this->File.GetVariables()) {
    const bool named = one.BaseName().compare(0, 5, "XLONG") == 0 || one.BaseName().compare(0, 4, "XLAT") == 0;
    if (this->Vertical->IsWrf() && named && this->Fits(one)) {
      candidates.push_back(&one);
    }
  }
  std::array<const Variable*, 2> found = { { nullptr, nullptr } };
  for (const Variable* one : candidates) {
    const int given = this->AxisOf(*one), axis = given < 0 ? AxisOfName(one->BaseName()) : given;
    if (this->Has(*one, 0) && this->Has(*one, 1) && (axis == 0 || axis == 1) && !found[static_cast<size_t>(axis)] &&
      (this->IsOfEarth(*one) || !this->OnEarth)) {
      found[static_cast<size_t>(axis)] = one;
    }
  }
  if (found[0] && found[1] && !(this->Vertical->IsWrf() && this->FindWrfSpacing(*found[0], *found[1]))) {
    this->Horizontal = found;
  }
}

// WRF's ideal cases have longitudes and latitudes of 0 all over, and the distance of points as attributes of the file.
bool vtkStratusCFGrid::FindWrfSpacing(const Variable& x, const Variable& y)
{
  Variable global = x; // in the same group
  global.Id = vtkStratusNetCDFModel::Global;
  for (const Variable* one : { &x, &y }) {
    const vtkSmartPointer<vtkDataArray> values = this->File.Read(*one);
    double range[2];
    values->GetRange(range);
    if (range[0] < range[1]) {
      return false;
    }
  }
  std::array<double, 2> spacing = { { 0.0, 0.0 } };
  if (!this->File.Number(global, "DX", spacing[0]) || !this->File.Number(global, "DY", spacing[1]) || !(spacing[0] > 0.0) ||
    !(spacing[1] > 0.0)) {
    this->File.Fail("'" + x.Name + "' or '" + y.Name + "' is the same all over, and the file has no attributes DX and DY above 0");
  }
  this->Spacing = spacing;
  return true;
}

// Reads an axis, which must increase or decrease all along. Angles become degrees, and longitudes continuous. Without a coordinate the axis
// counts from 0.
void vtkStratusCFGrid::ReadAxis(int axis)
{
  const size_t a = static_cast<size_t>(axis);
  const Variable* coordinate = this->Along[a];
  std::vector<double>& at = this->Axes[a];
  at.resize(this->GetLength(axis));
  for (size_t i = 0; i < at.size(); ++i) {
    at[i] = static_cast<double>(i);
  }
  const bool used = axis < 2 ? !this->Horizontal[a] && this->Spacing[a] == 0.0 : !this->Vertical->IsCurved();
  if (!coordinate || !used) {
    if (axis < 2 && this->Spacing[a] > 0.0) {
      const double offset = EndsWith(this->File.NameOf(this->Dimensions[a]), "_stag") ? 0.5 : 0.0; // half a cell before the others
      std::transform(at.begin(), at.end(), at.begin(), [=](double value) { return (value - offset) * this->Spacing[a]; });
    }
    return;
  }
  at = this->File.ReadComplete(*coordinate, "coordinate");
  const vtkStratusUnit unit = this->UnitOf(*coordinate);
  if (axis < 2) {
    std::transform(at.begin(), at.end(), at.begin(), [&unit](double value) { return unit.Convert(value); });
  }
  if (axis == 0 && unit.IsAngle()) {
    this->Continuous = vtkStratusLongitudes::UnwrapAxis(at);
  }
  for (size_t i = 1; i < at.size(); ++i) {
    if (!((at[i] - at[i - 1]) * (at[1] - at[0]) > 0.0)) {
      this->File.Fail("coordinate '" + coordinate->Name + "' must increase or decrease all along: number " + std::to_string(i) + " is " +
        vtkStratusNumberText(at[i]) + ", after " + vtkStratusNumberText(at[i - 1]));
    }
  }
}

double vtkStratusCFGrid::MiddleLatitude() const
{
  std::vector<double> latitudes = this->Places[1].empty() ? this->Axes[1] : this->Places[1];
  if (this->Horizontal[1]) {
    const vtkStratusUnit unit = this->UnitOf(*this->Horizontal[1]);
    const vtkSmartPointer<vtkDataArray> all = this->File.Read(*this->Horizontal[1]);
    latitudes.clear();
    for (vtkIdType i = 0; i < all->GetNumberOfTuples(); ++i) {
      latitudes.push_back(unit.Convert(all->GetComponent(i, 0)));
    }
  }
  double low = INFINITY, high = -INFINITY;
  for (double latitude : latitudes) {
    low = std::isfinite(latitude) ? std::min(low, latitude) : low;
    high = std::isfinite(latitude) ? std::max(high, latitude) : high;
  }
  if (low > high) {
    this->File.Fail(this->Horizontal[1] ? "coordinate '" + this->Horizontal[1]->Name + "' has no value that is finite"
                                        : "no point of '" + this->Of.Name + "' is on the Earth by its projection");
  }
  return 0.5 * (low + high);
}

void vtkStratusCFGrid::ConvertUnits()
{
  std::array<const Variable*, 2> from = { { nullptr, nullptr } };
  std::array<vtkStratusUnit, 2> units;
  for (size_t a = 0; a < 2; ++a) {
    from[a] = this->Horizontal[a] ? this->Horizontal[a] : this->Spacing[a] > 0.0 ? nullptr : this->Along[a];
    units[a] = from[a] ? this->UnitOf(*from[a]) : vtkStratusUnitOf(this->Spacing[a] > 0.0 ? "m" : "");
    units[a] = this->Places[a].empty() ? units[a] : vtkStratusUnitOf("degree");
  }
  const bool degrees = units[0].IsAngle() && units[1].IsAngle();
  this->Flat = degrees || (units[0].IsLength() && units[1].IsLength());
  this->Metres = this->Flat && this->Vertical->IsLength();
  if (degrees) {
    const double degree = std::acos(-1.0) / 180.0, middle = this->MiddleLatitude();
    this->Factors = { { vtkStratusSphere::EarthRadius * degree * std::cos(middle * degree), vtkStratusSphere::EarthRadius * degree } };
    this->Description += this->OnEarth ? "" : "degrees as metres at latitude " + vtkStratusNumberText(middle) + "; ";
  }
  for (size_t a = 0; a < 2; ++a) {
    const std::string text = from[a] ? this->File.Text(*from[a], "units") : "";
    this->Description += std::string(1, "xy"[a]) + " by " +
      (from[a] ? "'" + from[a]->Name + "'" + (text.empty() ? "" : " (" + text + ")")
               : "number" + (this->Spacing[a] > 0.0 ? " times " + vtkStratusNumberText(this->Spacing[a]) + " m" : std::string())) +
      (a == 0 && this->Continuous ? ", made continuous where it jumps, " : ", ");
  }
  this->Description += this->Vertical->Describe();
  this->NameAxes(from, units, degrees);
  this->DescribeHorizontal(from, degrees);
  this->DescribeVertical(); // before levels are converted
  for (int a = 0; a < 3; ++a) {
    this->ConvertAxis(a);
  }
}

std::string vtkStratusCFGrid::TitleOr(const Variable* coordinate, const std::string& usual) const
{
  const std::string title = coordinate ? this->File.Title(*coordinate) : "";
  return title.empty() ? usual : title;
}

void vtkStratusCFGrid::DescribeHorizontal(const std::array<const Variable*, 2>& from, bool degrees)
{
  for (size_t a = 0; a < 2; ++a) {
    vtkStratusFileAxis& axis = this->FileAxes[a];
    const bool turned = this->Places[a].empty() && from[a] && !this->IsOfEarth(*from[a]); // about another pole
    axis.Title = this->TitleOr(from[a], degrees ? (a == 0 ? "longitude" : "latitude") : this->Names[a]);
    if (degrees) {
      axis.Kind = turned ? vtkStratusVariableReader::AXIS_OF_NUMBERS
        : a == 0         ? vtkStratusVariableReader::AXIS_OF_LONGITUDES
                         : vtkStratusVariableReader::AXIS_OF_LATITUDES;
      axis.Units = "degrees";
      axis.Scale = 1.0 / this->Factors[a];
      this->Degrees = !turned;
    }
  }
}

// Heights stay heights, depths count downwards, and levels of pressure are the file's own.
void vtkStratusCFGrid::DescribeVertical()
{
  vtkStratusFileAxis& axis = this->FileAxes[2];
  const bool down = this->Vertical->IsDepth();
  const bool of_levels = !this->Vertical->IsCurved() || this->Vertical->IsField(); // else the formula's heights have no name in the file
  axis.Title = this->TitleOr(of_levels ? this->Vertical->GetSource() : nullptr, down ? "depth" : this->Names[2]);
  axis.Scale = down ? -1.0 : 1.0;
  if (this->Vertical->IsCurved() || !this->Along[2] || !this->Vertical->GetUnit().IsPressure()) {
    return;
  }
  const double unit = this->Vertical->IsSea() ? 1e4 : 100.0; // Pa
  axis.Kind = vtkStratusVariableReader::AXIS_OF_LEVELS;
  axis.Title = this->TitleOr(this->Along[2], "pressure");
  axis.Units = this->Vertical->IsSea() ? "dbar" : "hPa";
  axis.Scale = 1.0;
  for (double level : this->Axes[2]) {
    axis.Levels.push_back(this->Vertical->Convert(level));
    axis.Levels.push_back(this->Vertical->GetUnit().Convert(level) / unit);
  }
}

// Names axes by the meaning of their converted numbers: distances on the sphere, heights, or the file's own coordinates.
void vtkStratusCFGrid::NameAxes(const std::array<const Variable*, 2>& from, const std::array<vtkStratusUnit, 2>& units, bool degrees)
{
  for (size_t a = 0; a < 3; ++a) {
    const Variable* coordinate = a < 2 ? from[a] : this->Along[a];
    const bool length = a < 2 ? degrees || units[a].IsLength() : this->Vertical->IsLength();
    const std::string text = coordinate ? this->File.Text(*coordinate, "units") : "";
    this->Names[a] = coordinate ? coordinate->BaseName() : this->File.NameOf(this->Dimensions[a]);
    this->Units[a] = length ? "m" : a < 2 && units[a].IsAngle() ? "degrees" : text == "1" ? "" : text;
    if (a < 2 ? degrees : length) {
      this->Names[a] = a == 0 ? "east" : a == 1 ? "north" : "height";
    }
  }
}

void vtkStratusCFGrid::ConvertAxis(int axis)
{
  std::vector<double>& at = this->Axes[static_cast<size_t>(axis)];
  for (double& value : at) {
    value = axis < 2 ? value * this->Factors[static_cast<size_t>(axis)] : this->Along[2] ? this->Vertical->Convert(value) : value;
  }
  if (at.size() > 1 && at[1] < at[0]) {
    this->Flipped[static_cast<size_t>(axis)] = !this->IsCurved();
    if (!this->IsCurved()) {
      std::reverse(at.begin(), at.end());
    }
  }
}

// Evenly spaced up to the digits of floats, in which most files store coordinates.
bool vtkStratusCFGrid::IsUniform() const
{
  for (const std::vector<double>& at : this->Axes) {
    const double first = at.front(), step = (at.back() - first) / static_cast<double>(at.size() - 1);
    const double rounding = 2.4e-7 * std::max(std::fabs(first), std::fabs(at.back()));
    for (size_t i = 0; i < at.size(); ++i) {
      if (std::fabs(at[i] - (first + step * static_cast<double>(i))) > std::min(std::max(rounding, 1e-9 * step), 0.01 * step)) {
        return false;
      }
    }
  }
  return true;
}

vtkStratusCFField vtkStratusCFGrid::ReadField(const Variable& variable, size_t step, const std::array<int, 3>* dimensions) const
{
  const std::array<int, 3>& axes = dimensions ? *dimensions : this->Dimensions;
  vtkStratusCFField field;
  std::vector<size_t> start, count;
  for (int dimension : variable.Dimensions) {
    const bool space = std::find(axes.begin(), axes.end(), dimension) != axes.end();
    start.push_back(space ? 0 : this->Layout.IndexOf(dimension, step));
    count.push_back(space ? this->File.LengthOf(dimension) : 1);
    this->ReadsTime = this->ReadsTime || (dimension == this->GetTime() && &variable != &this->Of);
  }
  size_t stride = 1;
  for (size_t i = count.size(); i-- > 0;) {
    for (size_t a = 0; a < 3; ++a) {
      if (axes[a] == variable.Dimensions[i]) {
        field.Strides[a] = stride;
      }
    }
    stride *= count[i];
  }
  field.Values = this->File.Read(variable, start, count);
  return field;
}

vtkSmartPointer<vtkDataArray> vtkStratusCFGrid::ReadValues(size_t step) const
{
  const vtkStratusCFField field = this->ReadField(this->Of, step);
  const size_t nx = this->GetLength(0), ny = this->GetLength(1), nz = this->GetLength(2);
  const bool plain = field.Strides[0] == 1 && field.Strides[1] == nx && field.Strides[2] == nx * ny && !this->Flipped[0] &&
    !this->Flipped[1] && !this->Flipped[2];
  if (plain) {
    return field.Values;
  }
  vtkSmartPointer<vtkDataArray> sorted;
  sorted.TakeReference(field.Values->NewInstance());
  sorted->SetName(field.Values->GetName());
  sorted->SetNumberOfTuples(static_cast<vtkIdType>(nx * ny * nz));
  size_t to = 0;
  for (size_t k = 0; k < nz; ++k) {
    for (size_t j = 0; j < ny; ++j) {
      for (size_t i = 0; i < nx; ++i, ++to) {
        const size_t from =
          field.Index(this->Flipped[0] ? nx - 1 - i : i, this->Flipped[1] ? ny - 1 - j : j, this->Flipped[2] ? nz - 1 - k : k);
        sorted->SetTuple(static_cast<vtkIdType>(to), static_cast<vtkIdType>(from), field.Values);
      }
    }
  }
  return sorted;
}

vtkSmartPointer<vtkDataArray> vtkStratusCFGrid::MakeBricks(size_t step, const vtkStratusBox& box) const
{
  vtkStratusNetCDFPart part;
  part.Box = box;
  for (const int dimension : this->Of.Dimensions) {
    const auto axis = std::find(this->Dimensions.begin(), this->Dimensions.end(), dimension);
    const bool space = axis != this->Dimensions.end();
    part.Axes.push_back(space ? static_cast<int>(axis - this->Dimensions.begin()) : -1);
    part.Indices.push_back(space ? 0 : this->Layout.IndexOf(dimension, step));
  }
  for (size_t a = 0; a < 3; ++a) {
    part.Lengths[a] = this->GetLength(static_cast<int>(a));
  }
  part.Flipped = this->Flipped;
  return this->File.MakeBricks(this->Of, part);
}

// Reads x or y of two or more dimensions in degrees or metres. Longitudes are made continuous. Values that are missing are NaN.
std::vector<double> vtkStratusCFGrid::ReadHorizontal(int axis, size_t step, std::array<size_t, 3>& strides) const
{
  if (!this->Places[0].empty()) {
    strides = { { 1, this->GetLength(0), 0 } };
    std::vector<double> at = this->Places[static_cast<size_t>(axis)];
    if (axis == 0) {
      vtkStratusLongitudes::Unwrap(at, { { this->GetLength(0), this->GetLength(1), 1 } }, strides);
    }
    return at;
  }
  const Variable& variable = *this->Horizontal[static_cast<size_t>(axis)];
  const vtkStratusUnit unit = this->UnitOf(variable);
  const vtkStratusCFField field = this->ReadField(variable, step);
  strides = field.Strides;
  std::vector<double> at(static_cast<size_t>(field.Values->GetNumberOfTuples()));
  for (size_t i = 0; i < at.size(); ++i) {
    at[i] = unit.Convert(field.Values->GetComponent(static_cast<vtkIdType>(i), 0));
    if (std::isinf(at[i])) {
      this->File.Fail("coordinate '" + variable.Name + "' is not finite at number " + std::to_string(i));
    }
  }
  if (axis == 0 && unit.IsAngle()) {
    vtkStratusLongitudes::Unwrap(at, { { this->GetLength(0), this->GetLength(1), this->GetLength(2) } }, strides);
  }
  return at;
}

// Marks the columns of cells across which longitudes differ by more than half a turn.
void vtkStratusCFGrid::HideTorn(
  const std::vector<double>& longitudes, const std::array<size_t, 3>& strides, std::vector<char>& hidden) const
{
  const size_t n[3] = { this->GetLength(0) - 1, this->GetLength(1) - 1, this->GetLength(2) - 1 };
  for (size_t k = 0; k < n[2]; ++k) {
    for (size_t j = 0; j < n[1]; ++j) {
      for (size_t i = 0; i < n[0]; ++i) {
        double low = INFINITY, high = -INFINITY;
        for (size_t corner = 0; corner < 8; ++corner) {
          const double one =
            longitudes[(i + (corner & 1)) * strides[0] + (j + (corner >> 1 & 1)) * strides[1] + (k + (corner >> 2)) * strides[2]];
          low = std::min(low, one);
          high = std::max(high, one);
        }
        if (high - low > 180.0) {
          hidden.resize(n[0] * n[1] * n[2], 0);
          hidden[i + n[0] * (j + n[1] * k)] = 1;
        }
      }
    }
  }
}

vtkSmartPointer<vtkDataArray> vtkStratusCFGrid::ReadPoints(
  size_t step, std::vector<char>& hidden_points, std::vector<char>& hidden_cells) const
{
  const size_t n[3] = { this->GetLength(0), this->GetLength(1), this->GetLength(2) };
  vtkSmartPointer<vtkDoubleArray> points = vtkSmartPointer<vtkDoubleArray>::New();
  points->SetNumberOfComponents(3);
  points->SetNumberOfTuples(static_cast<vtkIdType>(n[0] * n[1] * n[2]));
  double* const first = points->GetPointer(0);
  for (int axis = 0; axis < 3; ++axis) {
    const size_t a = static_cast<size_t>(axis);
    std::array<size_t, 3> strides = { { 0, 0, 0 } };
    std::vector<double> at;
    if (axis < 2 && (this->Horizontal[a] || !this->Places[a].empty())) {
      at = this->ReadHorizontal(axis, step, strides);
      if (axis == 0 && !this->OnEarth && this->UnitOf(*this->Horizontal[0]).IsAngle()) {
        this->HideTorn(at, strides, hidden_cells);
      }
      std::transform(at.begin(), at.end(), at.begin(), [this, a](double value) { return value * this->Factors[a]; });
    } else if (axis == 2 && this->Vertical->IsCurved()) {
      this->Vertical->Read(step, first + 2, 3);
      continue;
    } else {
      at = this->Axes[a];
      strides[a] = 1;
    }
    double* to = first + axis;
    for (size_t k = 0; k < n[2]; ++k) {
      for (size_t j = 0; j < n[1]; ++j) {
        for (size_t i = 0; i < n[0]; ++i, to += 3) {
          *to = at[i * strides[0] + j * strides[1] + k * strides[2]];
        }
      }
    }
  }
  this->HideMissing(points, hidden_points);
  return points;
}

std::vector<double> vtkStratusCFGrid::ReadDegrees(size_t step) const
{
  const size_t columns = this->GetLength(0), rows = this->GetLength(1);
  std::array<std::vector<double>, 2> at;
  std::array<std::array<size_t, 3>, 2> strides = { { { { 1, 0, 0 } }, { { 0, 1, 0 } } } };
  for (size_t a = 0; a < 2; ++a) {
    if (this->Horizontal[a] || !this->Places[a].empty()) {
      at[a] = this->ReadHorizontal(static_cast<int>(a), step, strides[a]);
      continue;
    }
    at[a] = this->Axes[a];
    std::transform(at[a].begin(), at[a].end(), at[a].begin(), [this, a](double value) { return value / this->Factors[a]; });
  }
  const size_t levels = strides[0][2] > 0 || strides[1][2] > 0 ? this->GetLength(2) : 1;
  std::vector<double> degrees;
  degrees.reserve(2 * columns * rows * levels);
  for (size_t k = 0; k < levels; ++k) {
    for (size_t j = 0; j < rows; ++j) {
      for (size_t i = 0; i < columns; ++i) {
        for (size_t a = 0; a < 2; ++a) {
          degrees.push_back(at[a][i * strides[a][0] + j * strides[a][1] + k * strides[a][2]]);
        }
      }
    }
  }
  return degrees;
}

// Marks points that have no place, and puts them where the last one is that has one.
void vtkStratusCFGrid::HideMissing(vtkDoubleArray* points, std::vector<char>& hidden) const
{
  const size_t count = static_cast<size_t>(points->GetNumberOfTuples());
  double* const at = points->GetPointer(0);
  const auto missing = [at](size_t i) { return std::isnan(at[3 * i]) || std::isnan(at[3 * i + 1]) || std::isnan(at[3 * i + 2]); };
  size_t there = 0;
  while (there < count && missing(there)) {
    ++there;
  }
  if (there == count) {
    this->File.Fail("no point of '" + this->Of.Name + "' has a place: everywhere one of its coordinates, or a term of them, is missing");
  }
  for (size_t i = 0; i < count; ++i) {
    if (missing(i)) {
      hidden.resize(count, 0);
      hidden[i] = 1;
      std::copy(at + 3 * there, at + 3 * there + 3, at + 3 * i);
    } else {
      there = i;
    }
  }
}
