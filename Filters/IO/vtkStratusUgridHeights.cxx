// SPDX-License-Identifier: BSD-3-Clause
// Heights of a layered mesh that the file has at every node or face: of the layers' borders, of their middles, or their thicknesses.
#include "vtkStratusUgridLayers.h"

#include "vtkStratusReaderCore.h"

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

// Heights at each node, from the bottom up; missing ones below the lowest layer of a node are the core's task.
void vtkStratusUgridLayers::ReadHeights(size_t step, std::vector<double>& z, std::vector<uint8_t>& none) const
{
  const vtkStratusUgridValues values = this->Mesh.Read(*this->Source, step);
  const size_t nodes = this->Mesh.GetNodes(), given = this->OfBorders ? this->Count + 1 : this->Count;
  std::vector<double> at(nodes * given);
  for (size_t i = 0; i < given; ++i) {
    const std::vector<double> level = this->Mesh.ToNodes(values, this->Mesh.IsOnFaces(*this->Source), this->TopFirst ? given - 1 - i : i);
    std::transform(
      level.begin(), level.end(), at.begin() + static_cast<std::ptrdiff_t>(i * nodes), [this](double one) { return this->ToHeight(one); });
  }
  const vtkStratusReaderCore core;
  core.Check(stratus_layers_from_heights(core, static_cast<int64_t>(nodes), static_cast<int64_t>(this->Count), this->OfBorders ? 1 : 0,
               at.data(), z.data(), none.data()),
    this->File.GetPath() + ": '" + this->Source->Name + "': ");
}

void vtkStratusUgridLayers::ReadThicknesses(size_t step, std::vector<double>& z, std::vector<uint8_t>& none) const
{
  const vtkStratusUgridValues values = this->Mesh.Read(*this->Source, step);
  const size_t nodes = this->Mesh.GetNodes();
  std::vector<double> thicknesses(nodes * this->Count), bottom = this->ReadLength(*this->Bed, step);
  for (size_t i = 0; i < thicknesses.size(); ++i) {
    thicknesses[i] = values.At(i % nodes, this->FromBottom(i / nodes, this->Count));
  }
  std::transform(bottom.begin(), bottom.end(), bottom.begin(), [](double depth) { return -depth; });
  const std::vector<double> present = this->Lowest ? this->Mesh.ReadAtNodes(*this->Lowest, step) : std::vector<double>();
  const vtkStratusReaderCore core;
  core.Check(stratus_layers_from_thicknesses(core, static_cast<int64_t>(nodes), static_cast<int64_t>(this->Count), thicknesses.data(),
               bottom.data(), this->Lowest ? present.data() : nullptr, z.data(), none.data()),
    this->File.GetPath() + ": '" + this->Source->Name + "': ");
}
