// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusUgridLayers.h"

#include "vtkStratusReaderCore.h"
#include "vtkStratusText.h"

#include "vtkStratusHeights.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace {
bool IsOneOf(const std::string& word, std::initializer_list<const char*> words)
{
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool EndsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}
} // namespace

vtkStratusUgridLayers::vtkStratusUgridLayers(const vtkStratusUgridMesh& mesh) : Mesh(mesh), File(mesh.GetFile())
{
  this->FindHeights();
  if (this->Kind == Flat && !this->FindThicknesses() && !this->FindSigma()) {
    this->FindLevels();
  }
  this->FindSurfaces();
  if ((this->Kind == Flat || this->Kind == Sigma) && (!this->Surface || !this->Bed)) {
    this->File.Fail(std::string("there is no ") + (this->Surface ? "bottom" : "free surface") +
      " to stand layers on: neither formula_terms nor standard_name nor the names of Delft3D FM, SCHISM or FVCOM name it, and no dimension "
      "of "
      "layers has a coordinate of a length, a pressure or a direction");
  }
  this->FindOrder();
  for (const Variable* one : { this->Source, this->Surface, this->Bed, this->Wet }) {
    const int time = one ? this->Mesh.FindTime(*one) : -1;
    this->Time = time >= 0 ? time : this->Time;
  }
}

// Layers are counted from the top where a node's first height is above its last.
void vtkStratusUgridLayers::FindOrder()
{
  if (!this->Source) {
    return;
  }
  if (this->Kind == Thicknesses) {
    this->TopFirst = true;
    return;
  }
  const vtkStratusUgridValues values = this->Mesh.Read(*this->Source, 0);
  const size_t last = this->OfBorders ? this->Count : this->Count - 1;
  const size_t places = this->Mesh.IsOnFaces(*this->Source) ? this->Mesh.GetFaces() : this->Mesh.GetNodes();
  for (size_t place = 0; place < (values.Across > 0 ? places : 1); ++place) {
    const double difference = this->ToHeight(values.At(place, 0)) - this->ToHeight(values.At(place, last));
    if (std::isfinite(difference) && difference != 0.0) {
      this->TopFirst = difference > 0.0;
      return;
    }
  }
}

// The height of a fixed level in metres; other values as they are.
double vtkStratusUgridLayers::ToHeight(double level) const
{
  if (this->Kind != Levels) {
    return this->Kind == Heights ? this->Unit.Convert(level) : level;
  }
  const double value = this->Unit.Convert(level);
  if (this->Unit.IsPressure()) {
    if (value < 0.0) {
      this->File.Fail("'" + this->Source->Name + "' has a pressure of " + vtkStratusNumberText(level) + ", it must not be negative");
    }
    return this->Unit.Scale == 10000.0 ? vtkStratusHeightInSea(value) : vtkStratusHeightOfPressure(value);
  }
  return this->Down ? -value : value;
}

void vtkStratusUgridLayers::TakeCount(const Variable& variable, int dimension, bool borders)
{
  const size_t length = this->File.LengthOf(dimension);
  if (length < (borders ? 2u : 1u)) {
    this->File.Fail("'" + variable.Name + "' has " + std::to_string(length) + (borders ? " borders of layers" : " layers") + ", at least " +
      (borders ? "2" : "1") + " are needed");
  }
  this->Count = borders ? length - 1 : length;
  (borders ? this->BorderDimension : this->LayerDimension) = dimension;
  this->OfBorders = borders;
}

// Sigma at borders if the file has it there, else at centres. The other dimension belongs to the same layers.
bool vtkStratusUgridLayers::FindSigma()
{
  const Variable* found[2] = { nullptr, nullptr }; // the shorter, the longer
  const auto length = [this](const Variable& one) { return this->File.LengthOf(one.Dimensions[0]); };
  for (const Variable& one : this->File.GetVariables()) {
    const bool named = this->File.Text(one, "standard_name") == "ocean_sigma_coordinate" ||
      IsOneOf(one.BaseName(), { "siglev", "siglay" }) || EndsWith(one.BaseName(), "_sigma");
    const bool shaped = (one.Dimensions.size() == 1 || (one.Dimensions.size() == 2 && this->Mesh.IsOnNodes(one))) &&
      this->Mesh.FindTime(one) < 0 && !(one.Dimensions.size() == 1 && (this->Mesh.IsOnNodes(one) || this->Mesh.IsOnFaces(one)));
    if (!named || !shaped) {
      continue;
    }
    if (!found[0] || length(one) < length(*found[0])) {
      found[1] = found[1] ? found[1] : found[0];
      found[0] = &one;
    } else {
      found[1] = &one;
    }
  }
  if (!found[0]) {
    return false;
  }
  this->Kind = Sigma;
  if (found[1] && length(*found[1]) == length(*found[0]) + 1) {
    this->TakeCount(*found[0], found[0]->Dimensions[0], false);
    this->TakeCount(*found[1], found[1]->Dimensions[0], true);
    this->Source = found[1];
    return true;
  }
  this->Source = found[0];
  const vtkStratusUgridValues values = this->Mesh.Read(*found[0], 0);
  const size_t count = length(*found[0]);
  const bool ends = count > 1 && std::fabs(values.At(0, 0) - values.At(0, count - 1)) > 1.0 - 1e-6; // from -1 to 0
  this->TakeCount(*found[0], found[0]->Dimensions[0], ends);
  return true;
}

// Returns whether a variable holds heights, depths or pressures along one dimension, which is neither time nor the mesh's.
bool vtkStratusUgridLayers::IsLevels(const Variable& one) const
{
  const std::string name = this->File.Text(one, "standard_name");
  const vtkStratusUnit unit = vtkStratusUnitOf(this->File.Text(one, "units"));
  const bool shaped = one.Dimensions.size() == 1 && one.HasNumbers() && this->Mesh.FindTime(one) < 0 && !this->Mesh.IsOnNodes(one) &&
    !this->Mesh.IsOnFaces(one);
  return shaped &&
    (unit.IsLength() || unit.IsPressure() || IsOneOf(name, { "altitude", "height", "depth" }) || EndsWith(one.BaseName(), "_layer_z") ||
      EndsWith(one.BaseName(), "_interface_z") || !this->File.Text(one, "positive").empty() ||
      vtkStratusLowerCase(vtkStratusTrimmed(this->File.Text(one, "axis"))) == "z");
}

// Fixed levels along the dimension of the first variable that has layers: at the layers' borders if the file has these, else in the middle
// of layers, with bounds or without.
bool vtkStratusUgridLayers::FindLevels()
{
  const auto along = [this](int dimension) {
    const Variable* own = this->File.CoordinateOf(dimension);
    const Variable* found = own && this->IsLevels(*own) ? own : nullptr;
    for (const Variable& one : this->File.GetVariables()) {
      const bool fits = this->IsLevels(one) && one.Dimensions[0] == dimension;
      found = fits && (!found || one.BaseName() == "refBottomDepth") ? &one : found;
    }
    return found;
  };
  const Variable* levels = nullptr;
  for (const Variable& one : this->File.GetVariables()) {
    const int dimension = this->Mesh.IsOnNodes(one) != this->Mesh.IsOnFaces(one) ? this->Mesh.FindLayers(one) : -1;
    levels = levels || dimension < 0 || !one.HasNumbers() ? levels : along(dimension);
  }
  if (!levels) {
    return false;
  }
  const Variable *middles = levels, *borders = nullptr;
  for (const Variable& one : this->File.GetVariables()) {
    const size_t length = this->File.LengthOf(levels->Dimensions[0]);
    if (this->IsLevels(one) && this->File.LengthOf(one.Dimensions[0]) == length + 1) {
      borders = &one;
    } else if (this->IsLevels(one) && this->File.LengthOf(one.Dimensions[0]) + 1 == length && length > 2) {
      middles = &one;
      borders = levels;
    }
  }
  this->Kind = Levels;
  this->TakeCount(*middles, middles->Dimensions[0], false);
  this->Source = borders ? borders : middles;
  if (borders) {
    this->TakeCount(*borders, borders->Dimensions[0], true);
  }
  const std::string units = this->File.Text(*this->Source, "units");
  this->Unit = vtkStratusUnitOf(units);
  this->Numbers = this->File.Text(*this->Source, "long_name") == "generalized_height" && !this->Unit.IsLength() && !this->Unit.IsPressure();
  if (!units.empty() && !this->Numbers && !this->Unit.IsLength() && !this->Unit.IsPressure()) {
    this->File.Fail(
      "the layers' coordinate '" + this->Source->Name + "' has the unit '" + units + "', it must be one of length or pressure");
  }
  const bool of_bottoms = this->Source->BaseName() == "refBottomDepth"; // MPAS' depths of the lower borders
  this->Down = this->Numbers || of_bottoms || (!this->Unit.IsPressure() && vtkStratusIsDown(this->File, *this->Source));
  this->Stretched = EndsWith(this->Source->BaseName(), "_layer_z") || EndsWith(this->Source->BaseName(), "_interface_z");
  const std::string bounds = this->File.Text(*this->Source, "bounds");
  if (of_bottoms) {
    this->Fixed = this->File.ReadComplete(*this->Source, "depths");
    std::transform(this->Fixed.begin(), this->Fixed.end(), this->Fixed.begin(), [this](double one) { return this->ToHeight(one); });
    std::reverse(this->Fixed.begin(), this->Fixed.end());
    this->Fixed.push_back(0.0);
  } else if (!borders && !bounds.empty()) {
    this->ReadBounds(bounds);
  }
  return true;
}

// Reads the borders of layers from the bounds of their coordinate, which must meet.
void vtkStratusUgridLayers::ReadBounds(const std::string& name)
{
  const Variable* bounds = this->File.Find(name, this->Source);
  if (!bounds || bounds->Dimensions.size() != 2 || bounds->Dimensions[0] != this->LayerDimension ||
    this->File.LengthOf(bounds->Dimensions[1]) != 2) {
    this->File.Fail("the bounds '" + name + "' of '" + this->Source->Name + "' " +
      (bounds ? "must have the dimension of layers, and one of 2" : "are not there"));
  }
  std::vector<double> at = this->File.ReadComplete(*bounds, "bounds of layers");
  std::transform(at.begin(), at.end(), at.begin(), [this](double one) { return this->ToHeight(one); });
  if (at[0] > at[1]) {
    for (size_t i = 0; i < at.size(); i += 2) {
      std::swap(at[i], at[i + 1]);
    }
  }
  const bool top_first = at.size() > 2 && at[2] < at[0];
  for (size_t i = 0; i < this->Count; ++i) {
    const size_t layer = top_first ? this->Count - 1 - i : i;
    const double low = at[2 * layer], high = at[2 * layer + 1];
    if (!(low < high) || (i > 0 && std::fabs(low - this->Fixed.back()) > 1e-5 * std::max(std::fabs(low), std::fabs(high)))) {
      this->File.Fail("the bounds '" + name + "' of layer " + std::to_string(layer) + " are " + vtkStratusNumberText(low) + " and " +
        vtkStratusNumberText(high) + " in metres, they must " +
        (low < high ? "begin at " + vtkStratusNumberText(this->Fixed.back()) + ", where the layer below ends" : "differ, in one order"));
    }
    if (i == 0) {
      this->Fixed.push_back(low);
    }
    this->Fixed.push_back(high);
  }
}

// Looks for a term of the heights' formula.
bool vtkStratusUgridLayers::FindTerm(const char* term, const Variable*& found) const
{
  for (const Variable& one : this->File.GetVariables()) {
    const std::vector<std::string> words = vtkStratusWords(this->File.Text(one, "formula_terms"));
    for (size_t i = 0; i + 1 < words.size() && !found; i += 2) {
      found = words[i] == std::string(term) + ":" ? this->File.Find(words[i + 1], &one) : nullptr;
    }
  }
  return found != nullptr;
}

void vtkStratusUgridLayers::FindSurfaces()
{
  const auto flat = [this](const Variable& one) {
    return this->Mesh.FindLayers(one) == -1 && (this->Mesh.IsOnNodes(one) || this->Mesh.IsOnFaces(one));
  };
  this->FindTerm("eta", this->Surface);
  bool found = this->FindTerm("bedlevel", this->Bed);
  found = found || this->FindTerm("depth", this->Bed);
  for (const Variable& one : this->File.GetVariables()) {
    const std::string name = this->File.Text(one, "standard_name");
    if (!flat(one)) {
      continue;
    }
    if (!this->Surface &&
      (name.compare(0, 18, "sea_surface_height") == 0 || name.compare(0, 20, "water_surface_height") == 0 ||
        IsOneOf(one.BaseName(), { "zeta", "elevation", "elev" }) || EndsWith(one.BaseName(), "_s1"))) {
      this->Surface = &one;
    }
    if (!this->Bed &&
      (name.compare(0, 15, "sea_floor_depth") == 0 || IsOneOf(one.BaseName(), { "h", "depth", "bathymetry", "dv", "bottomDepth" }) ||
        EndsWith(one.BaseName(), "_flowelem_bl") || EndsWith(one.BaseName(), "_node_z"))) {
      this->Bed = &one;
    }
    if (IsOneOf(one.BaseName(), { "wet_cells", "wetdry_elem" }) || EndsWith(one.BaseName(), "_wet_cells")) {
      this->Wet = &one;
      this->WetIsOne = one.BaseName() != "wetdry_elem";
    }
  }
  if (this->Bed) {
    const std::string name = this->File.Text(*this->Bed, "standard_name");
    const bool up = name == "altitude" || this->File.Text(*this->Bed, "positive") == "up" || EndsWith(this->Bed->Name, "_bl") ||
      EndsWith(this->Bed->Name, "_node_z");
    this->BedMeans = name == "sea_floor_depth_below_sea_surface" ? WaterDepth : up ? Altitude : Depth;
  }
}

bool vtkStratusUgridLayers::IsOnLayers(const Variable& variable) const
{
  const int layers = this->Mesh.FindLayers(variable);
  return layers >= 0 && this->Kind != Flat && layers != this->BorderDimension && this->File.LengthOf(layers) == this->Count;
}

bool vtkStratusUgridLayers::IsOnBorders(const Variable& variable) const
{
  const int layers = this->Mesh.FindLayers(variable);
  return layers >= 0 && this->Kind != Flat && layers != this->LayerDimension && this->File.LengthOf(layers) == this->Count + 1;
}

bool vtkStratusUgridLayers::Uses(const Variable& variable) const
{
  return &variable == this->Source || &variable == this->Wet || &variable == this->Lowest;
}

std::string vtkStratusUgridLayers::Describe() const
{
  std::string text = std::to_string(this->Count) + (this->Count == 1 ? " layer" : " layers");
  if (this->Source) {
    text += std::string(" by ") +
      (this->Kind == Heights          ? "heights"
          : this->Kind == Thicknesses ? "thicknesses"
          : this->Kind == Sigma       ? "sigma"
          : this->Numbers             ? "numbers"
                                      : "levels") +
      " '" + this->Source->Name + "'" + (!this->Fixed.empty() ? " and its bounds" : "") + (this->Down ? ", downwards" : "");
  }
  text += this->Surface ? ", free surface '" + this->Surface->Name + "'" : "";
  return text + (this->Bed ? ", bottom '" + this->Bed->Name + "'" : "");
}

// A length at nodes, in metres.
std::vector<double> vtkStratusUgridLayers::ReadLength(const Variable& variable, size_t step) const
{
  std::vector<double> values = this->Mesh.ReadAtNodes(variable, step);
  const vtkStratusUnit unit = vtkStratusUnitOf(this->File.Text(variable, "units"));
  const double scale = unit.IsLength() ? unit.Scale : 1.0;
  std::transform(values.begin(), values.end(), values.begin(), [scale](double one) { return one * scale; });
  return values;
}

// The bottom's heights at nodes.
std::vector<double> vtkStratusUgridLayers::Bottom(size_t step, const std::vector<double>& surface) const
{
  std::vector<double> bottom = this->ReadLength(*this->Bed, step);
  for (size_t node = 0; node < bottom.size(); ++node) {
    bottom[node] =
      this->BedMeans == Altitude ? bottom[node] : (this->BedMeans == WaterDepth && !surface.empty() ? surface[node] : 0.0) - bottom[node];
  }
  return bottom;
}

// The levels of the borders at a node, from the bottom up. The outermost borders of sigma are its ends.
std::vector<double> vtkStratusUgridLayers::BordersOf(const vtkStratusUgridValues& levels, size_t node) const
{
  if (!this->Fixed.empty()) {
    return this->Fixed;
  }
  const size_t given = this->OfBorders ? this->Count + 1 : this->Count;
  std::vector<double> at(given), borders(this->Count + 1);
  for (size_t i = 0; i < given; ++i) {
    at[i] = this->ToHeight(levels.At(node, i));
    if (!std::isfinite(at[i])) {
      this->File.Fail("'" + this->Source->Name + "' has no value (a fill value, or not finite) at layer " + std::to_string(i));
    }
  }
  if (given > 1 && at.front() > at.back()) {
    std::reverse(at.begin(), at.end());
  }
  for (size_t i = 1; i < given; ++i) {
    if (at[i] < at[i - 1]) {
      this->File.Fail("layers are upside down: '" + this->Source->Name + "' must increase or decrease all along, it has " +
        vtkStratusNumberText(at[i]) + " after " + vtkStratusNumberText(at[i - 1]));
    }
  }
  if (this->OfBorders) {
    return at;
  }
  const vtkStratusReaderCore core;
  core.Check(stratus_layers_between(core, static_cast<int64_t>(this->Count), at.data(), borders.data()));
  if (this->Kind == Sigma) {
    borders.front() = -1.0;
    borders.back() = 0.0;
  }
  return borders;
}

void vtkStratusUgridLayers::ReadLevels(size_t step, std::vector<double>& z, std::vector<uint8_t>& none) const
{
  const size_t nodes = this->Mesh.GetNodes();
  const std::vector<double> surface = this->Surface ? this->ReadLength(*this->Surface, step) : std::vector<double>();
  const std::vector<double> bottom = this->Bed ? this->Bottom(step, surface) : std::vector<double>();
  const vtkStratusUgridValues levels = this->Source ? this->Mesh.Read(*this->Source, step) : vtkStratusUgridValues();
  std::vector<double> borders = { -1.0, 0.0 };
  if (this->Source && levels.Across > 0) {
    borders.resize((this->Count + 1) * nodes);
    for (size_t node = 0; node < nodes; ++node) {
      const std::vector<double> own = this->BordersOf(levels, node);
      for (size_t b = 0; b <= this->Count; ++b) {
        borders[b * nodes + node] = own[b];
      }
    }
  } else if (this->Source) {
    borders = this->BordersOf(levels, 0);
  }
  stratus_layer_borders from = {};
  from.node_count = static_cast<int64_t>(nodes);
  from.layer_count = static_cast<int64_t>(this->Count);
  from.borders = borders.data();
  from.of_nodes = this->Source && levels.Across > 0 ? 1 : 0;
  from.sigma = this->Kind == Levels ? 0 : 1;
  from.stretched = this->Stretched ? 1 : 0; // Delft3D FM's lowest layer ends at the bottom
  from.bottom = this->Bed ? bottom.data() : nullptr;
  from.surface = this->Surface ? surface.data() : nullptr;
  const vtkStratusReaderCore core;
  core.Check(stratus_layers_from_borders(core, &from, z.data(), none.data()), this->File.GetPath() + ": ");
}

void vtkStratusUgridLayers::FindDry(size_t step, std::vector<uint8_t>& dry) const
{
  vtkStratusUgridValues wet, surface;
  const bool own = this->Surface && this->Mesh.IsOnFaces(*this->Surface);
  if (this->Wet && this->Mesh.IsOnFaces(*this->Wet)) {
    wet = this->Mesh.Read(*this->Wet, step);
  }
  if (own) {
    surface = this->Mesh.Read(*this->Surface, step);
  }
  for (size_t face = 0; face < this->Mesh.GetFaces(); ++face) {
    dry[face] = this->Mesh.IsAbsent(face) || (wet.Values && (wet.At(face, 0) == 1.0) != this->WetIsOne) ||
      (own && !std::isfinite(surface.At(face, 0)));
  }
}

void vtkStratusUgridLayers::Read(size_t step, std::vector<double>& z, std::vector<uint8_t>& none, std::vector<uint8_t>& dry) const
{
  const size_t nodes = this->Mesh.GetNodes();
  z.assign(nodes * (this->Count + 1), 0.0);
  none.assign(nodes, 0);
  dry.assign(this->Mesh.GetFaces(), 0);
  if (this->Kind == Thicknesses) {
    this->ReadThicknesses(step, z, none);
  } else if (this->Kind == Heights) {
    this->ReadHeights(step, z, none);
  } else {
    this->ReadLevels(step, z, none);
  }
  this->FindDry(step, dry);
}
