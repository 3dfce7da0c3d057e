// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumeMixer.h"

#include "stratus.h"
#include "vtkStratusDepthOrder.h"
#include "vtkStratusMultiBlockVolumeMapper.h"
#include "vtkStratusMultiVolume.h"
#include "vtkStratusTetrahedraMapper.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkVolume.h"

#include <cstring>
#include <set>

namespace {
class Mixer : public vtkStratusDepthOrder::Mixer
{
public:
  vtkStratusDepthOrder::Kind GetKind(vtkVolume* volume) const override;
  std::string Mix(vtkRenderer* renderer, const std::vector<vtkVolume*>& volumes) const override;

private:
  static std::vector<vtkVolume*> FindVolumes(vtkVolume* prop);
  static std::string FindHindrance(const std::vector<vtkVolume*>& volumes);
};

// Finds the visible volumes of a vtkStratusMultiVolume. Another volume is one itself.
std::vector<vtkVolume*> Mixer::FindVolumes(vtkVolume* prop)
{
  auto* several = vtkStratusMultiVolume::SafeDownCast(prop);
  if (!several) {
    return { prop };
  }
  std::vector<vtkVolume*> volumes;
  for (int port = 0; port < STRATUS_SEVERAL_MAX; ++port) {
    vtkVolume* volume = several->GetVolume(port);
    if (volume && volume->GetVisibility()) {
      volumes.push_back(volume);
    }
  }
  return volumes;
}

vtkStratusDepthOrder::Kind Mixer::GetKind(vtkVolume* volume) const
{
  if (vtkStratusMultiVolume::SafeDownCast(volume)) {
    return FindVolumes(volume).empty() ? vtkStratusDepthOrder::NOTHING : vtkStratusDepthOrder::MEDIUM;
  }
  auto* mapper = vtkStratusVolumeMapper::SafeDownCast(volume->GetMapper());
  auto* blocks = vtkStratusMultiBlockVolumeMapper::SafeDownCast(volume->GetMapper());
  if (!mapper && !blocks) {
    return vtkStratusDepthOrder::OTHER;
  }
  if (mapper && mapper->GetRenderToImage()) {
    return vtkStratusDepthOrder::NOTHING;
  }
  const int mode = blocks ? blocks->GetSettings()->GetRenderMode() : mapper->GetRenderMode();
  return mode == vtkStratusVolumeMapper::FIRST_HIT_MODE ? vtkStratusDepthOrder::SOLID : vtkStratusDepthOrder::MEDIUM;
}

std::string Mixer::FindHindrance(const std::vector<vtkVolume*>& volumes)
{
  if (volumes.size() > STRATUS_SEVERAL_MAX) {
    return std::to_string(volumes.size()) + " volumes overlap, at most " + std::to_string(STRATUS_SEVERAL_MAX) + " are mixed";
  }
  std::set<vtkAbstractVolumeMapper*> mappers;
  bool any = false;
  int first = vtkVolumeMapper::COMPOSITE_BLEND;
  for (vtkVolume* volume : volumes) {
    auto* images = vtkStratusVolumeMapper::SafeDownCast(volume->GetMapper());
    auto* meshes = vtkStratusTetrahedraMapper::SafeDownCast(volume->GetMapper());
    const bool plain = std::strcmp(volume->GetClassName(), "vtkVolume") == 0;
    if (!plain || (!images && !meshes)) {
      const vtkObject* object = plain && volume->GetMapper() ? static_cast<vtkObject*>(volume->GetMapper()) : volume;
      return std::string("a ") + object->GetClassName() + " is not mixed, only a vtkVolume of a vtkStratusVolumeMapper or " +
        "vtkStratusTetrahedraMapper is";
    }
    const int mode = images ? images->GetBlendMode() : meshes->GetBlendMode();
    if (!mappers.empty() && mode != first) {
      return "blend modes " + std::to_string(first) + " and " + std::to_string(mode) + " are not mixed, all volumes need the same";
    }
    first = mode;
    if (!mappers.insert(volume->GetMapper()).second) {
      return "two volumes share a mapper, each needs one of its own";
    }
    any = any || images;
  }
  return any ? "" : "no volume has a vtkStratusVolumeMapper, at least one of them must";
}

std::string Mixer::Mix(vtkRenderer* renderer, const std::vector<vtkVolume*>& props) const
{
  std::vector<vtkVolume*> volumes;
  for (vtkVolume* prop : props) {
    const std::vector<vtkVolume*> of = FindVolumes(prop);
    volumes.insert(volumes.end(), of.begin(), of.end());
  }
  const std::string hindrance = FindHindrance(volumes);
  return hindrance.empty() ? vtkStratusMultiVolume::Mix(renderer, props.front(), volumes) : hindrance;
}
} // namespace

void vtkStratusRegisterMixer()
{
  static const Mixer mixer;
  vtkStratusDepthOrder::SetMixer(&mixer);
}
