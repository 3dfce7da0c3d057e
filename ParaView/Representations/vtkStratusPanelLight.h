// SPDX-License-Identifier: BSD-3-Clause
/**
 * Light that passes through matter, as the panel of a representation sets it, for mappers of volumes and of cells.
 */
#ifndef vtkStratusPanelLight_h
#define vtkStratusPanelLight_h

#include "vtkStratusRanks.h"

#include <algorithm>

namespace stratus {
struct PanelLight {
  bool Shadows = false, Multiple = false;
  double Scattering = 0.0, Anisotropy = 0.0;
  double Zenith[3] = { 0.0, 0.0, 0.0 }, Horizon[3] = { 0.0, 0.0, 0.0 }, Up[3] = { 0.0, 0.0, 1.0 };

  // Whether it is left out, because a rank does not have the matter of the others, whose shadows would end at its borders.
  bool IsLeftOut() const { return (this->Shadows || this->Scattering > 0.0) && count_ranks() > 1; }

  template <typename Mapper> void Apply(Mapper* mapper) const
  {
    const bool whole = count_ranks() == 1;
    mapper->SetShadows(whole && this->Shadows);
    mapper->SetVolumetricScatteringBlending(whole ? this->Scattering : 0.0);
    mapper->SetScatteringAnisotropy(this->Anisotropy);
    mapper->SetMultipleScattering(this->Multiple);
    mapper->SetSkyZenith(this->Zenith);
    mapper->SetSkyHorizon(this->Horizon);
    mapper->SetSkyUp(this->Up);
  }
};
} // namespace stratus

// Functions of a representation that set its member Light, and with it a mapper. SetScattering() has a name of its own, because a property
// of ParaView's superclass calls SetVolumetricScatteringBlending().
#define STRATUS_PANEL_LIGHT(representation, mapper)                                                                                        \
  STRATUS_PANEL_LIGHT_ONE(representation, SetShadows, bool, Shadows, mapper)                                                               \
  STRATUS_PANEL_LIGHT_ONE(representation, SetScattering, double, Scattering, mapper)                                                       \
  STRATUS_PANEL_LIGHT_ONE(representation, SetScatteringAnisotropy, double, Anisotropy, mapper)                                             \
  STRATUS_PANEL_LIGHT_ONE(representation, SetMultipleScattering, bool, Multiple, mapper)                                                   \
  STRATUS_PANEL_LIGHT_THREE(representation, SetSkyZenith, Zenith, mapper)                                                                  \
  STRATUS_PANEL_LIGHT_THREE(representation, SetSkyHorizon, Horizon, mapper)                                                                \
  STRATUS_PANEL_LIGHT_THREE(representation, SetSkyUp, Up, mapper)
#define STRATUS_PANEL_LIGHT_ONE(representation, setter, type, member, mapper)                                                              \
  void representation::setter(type value)                                                                                                  \
  {                                                                                                                                        \
    this->Light->member = value;                                                                                                           \
    this->Light->Apply(mapper);                                                                                                            \
  }
#define STRATUS_PANEL_LIGHT_THREE(representation, setter, member, mapper)                                                                  \
  void representation::setter(double x, double y, double z)                                                                                \
  {                                                                                                                                        \
    const double values[3] = { x, y, z };                                                                                                  \
    std::copy_n(values, 3, this->Light->member);                                                                                           \
    this->Light->Apply(mapper);                                                                                                            \
  }

#endif
