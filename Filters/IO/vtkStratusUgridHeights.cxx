// SPDX-License-Identifier: BSD-3-Clause
// Heights of a layered mesh that the file has at every node or face: of the layers' borders, of their middles, or their thicknesses.
#include "vtkStratusUgridLayers.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace {
bool IsOneOf(const std::string& word, std::initializer_list<const char*> words)
{
  return std::find(words.begin(), words.end(), word) != words.end();
}
} // namespace

// Heights of the layers' borders, or else of their middles.
void vtkStratusUgridLayers::FindHeights()
{
  for (const bool borders : { true, false }) {
    for (const Variable& one : this->File.GetVariables()) {
      const std::string name = this->File.Text(one, "standard_name"), base = one.BaseName();
      const int layers = this->Mesh.FindLayers(one);
      const bool middles = name == "geometric_height_at_full_level_center" || IsOneOf(base, { "z_mc", "zMid" });
      const bool named = middles || IsOneOf(base, { "zCoordinates", "zcor", "z_coordinates", "zgrid", "z_ifc", "zghalf", "HHL" }) ||
        IsOneOf(name, { "altitude", "height", "geometric_height_at_half_level_center" });
      if (named && borders != middles && this->Mesh.IsOnNodes(one) != this->Mesh.IsOnFaces(one) && layers >= 0) {
        this->Kind = Heights;
        this->Source = &one;
        this->Unit = vtkStratusUnitOf(this->File.Text(one, "units"));
        this->TakeCount(one, layers, borders);
        return;
      }
    }
  }
}

// The thicknesses of MPAS, from the top, above the bottom.
bool vtkStratusUgridLayers::FindThicknesses()
{
  const Variable *thickness = this->File.Find("layerThickness"), *bottom = this->File.Find("bottomDepth");
  if (!thickness || !bottom || this->Mesh.FindLayers(*thickness) < 0 || !this->Mesh.IsOnNodes(*thickness) ||
    !this->Mesh.IsOnNodes(*bottom)) {
    return false;
  }
  this->Kind = Thicknesses;
  this->Source = thickness;
  this->Bed = bottom;
  const Variable* const lowest = this->File.Find("maxLevelCell");
  this->Lowest = lowest && this->Mesh.IsOnNodes(*lowest) ? lowest : nullptr;
  this->TakeCount(*thickness, this->Mesh.FindLayers(*thickness), false);
  return true;
}

// Missing heights below the lowest layer of a node are set to the lowest border that has a height.
void vtkStratusUgridLayers::ReadHeights(size_t step, std::vector<double>& z) const
{
  const vtkStratusUgridValues values = this->Mesh.Read(*this->Source, step);
  const size_t nodes = this->Mesh.GetNodes(), given = this->OfBorders ? this->Count + 1 : this->Count;
  std::vector<double> at(nodes * given); // from the bottom up
  for (size_t i = 0; i < given; ++i) {
    const std::vector<double> level = this->Mesh.ToNodes(values, this->Mesh.IsOnFaces(*this->Source), this->TopFirst ? given - 1 - i : i);
    std::transform(
      level.begin(), level.end(), at.begin() + static_cast<std::ptrdiff_t>(i * nodes), [this](double one) { return this->ToHeight(one); });
  }
  for (size_t node = 0; node < nodes; ++node) {
    double last = NAN;
    for (size_t i = given; i-- > 0;) {
      double& height = at[i * nodes + node];
      height = std::isfinite(height) ? height : last;
      if (std::isfinite(last) && height > last) {
        this->File.Fail("layers are upside down: '" + this->Source->Name + "' has " + vtkStratusNumberText(height) + " under " +
          vtkStratusNumberText(last) + " at node " + std::to_string(node));
      }
      last = height;
    }
    const auto middle = [&](size_t i) { return at[i * nodes + node]; };
    for (size_t b = 0; b <= this->Count; ++b) {
      const bool end = b == 0 || b == this->Count;
      const size_t near = b == 0 ? 0 : this->Count - 1, next = b == 0 ? 1 : this->Count - 2; // of an end
      z[b * nodes + node] = this->OfBorders ? middle(b)
        : !end                              ? 0.5 * (middle(b - 1) + middle(b))
        : this->Count > 1                   ? 1.5 * middle(near) - 0.5 * middle(next)
                                            : middle(0) + (b == 0 ? -0.5 : 0.5);
    }
  }
}

void vtkStratusUgridLayers::ReadThicknesses(size_t step, std::vector<double>& z, std::vector<char>& none) const
{
  const vtkStratusUgridValues values = this->Mesh.Read(*this->Source, step);
  const std::vector<double> bottom = this->ReadLength(*this->Bed, step);
  const std::vector<double> lowest = this->Lowest ? this->Mesh.ReadAtNodes(*this->Lowest, step) : std::vector<double>();
  const size_t nodes = this->Mesh.GetNodes();
  for (size_t node = 0; node < nodes; ++node) {
    double height = std::isfinite(bottom[node]) ? -bottom[node] : 0.0;
    const double foot = height;
    z[node] = height;
    for (size_t b = 1; b <= this->Count; ++b) {
      const size_t layer = this->Count - b; // from the top
      const double thickness = values.At(node, layer);
      const bool there = std::isfinite(thickness) && thickness > 0.0 && (lowest.empty() || static_cast<double>(layer) < lowest[node]);
      height += there ? thickness : 0.0;
      z[b * nodes + node] = height;
    }
    none[node] = std::isfinite(bottom[node]) && height > foot ? 0 : 1;
  }
}
