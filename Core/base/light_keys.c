/* SPDX-License-Identifier: BSD-3-Clause
 * Keys of what maps of light are built of: if two are equal, so are the maps. */
#include "light_maps.h"

uint64_t stratus_light_key(uint64_t key, const void* bytes, size_t count)
{
  key = key ? key : UINT64_C(0xcbf29ce484222325); /* FNV-1a (Fowler, Noll & Vo) */
  for (size_t i = 0; i < count; ++i) {
    key = (key ^ ((const unsigned char*)bytes)[i]) * UINT64_C(0x100000001b3);
  }
  return key;
}

uint64_t stratus_light_key_of_surfaces(const stratus_surfaces* surfaces)
{
  if (!surfaces || surfaces->triangle_count == 0) {
    return 0;
  }
  const uint64_t numbers[3] = { (uint64_t)(uintptr_t)surfaces->points, surfaces->triangle_count, surfaces->revision };
  return stratus_light_key(0, numbers, sizeof numbers);
}

uint64_t stratus_light_key_of_transfers(uint64_t key, const stratus_transfer* transfers, int count)
{
  for (int i = 0; i < count; ++i) {
    const stratus_transfer* t = transfers + i;
    const double numbers[3] = { t->unit_distance, t->weight, t->clamp };
    key = stratus_light_key(key, numbers, sizeof numbers);
    key = stratus_light_key(key, t->opacity, 2 * t->opacity_count * sizeof *t->opacity);
    key = stratus_light_key(key, t->gradient, 2 * t->gradient_count * sizeof *t->gradient);
  }
  return key;
}

uint64_t stratus_light_key_of_scattering(uint64_t key, const stratus_shading* shading, const stratus_light* lights, int count)
{
  key = shading->shadow_length > 0.0 ? stratus_light_key(key, &shading->shadow_length, sizeof shading->shadow_length) : key;
  if (!shading->multiple) {
    return key;
  }
  const uint64_t surfaces = stratus_light_key_of_surfaces(shading->surfaces);
  key = surfaces ? stratus_light_key(key, &surfaces, sizeof surfaces) : key;
  key = stratus_light_key(key, &shading->diffuse, sizeof shading->diffuse);
  key = stratus_light_key(key, &shading->anisotropy, sizeof shading->anisotropy);
  key = stratus_light_key(key, shading->sky_zenith, sizeof shading->sky_zenith);
  key = stratus_light_key(key, shading->sky_horizon, sizeof shading->sky_horizon);
  key = stratus_light_key(key, shading->up, sizeof shading->up);
  for (int i = 0; i < count; ++i) {
    const double numbers[2] = { lights[i].cone_angle, lights[i].cone_exponent };
    key = stratus_light_key(key, lights[i].color, sizeof lights[i].color);
    key = stratus_light_key(key, lights[i].attenuation, sizeof lights[i].attenuation);
    key = stratus_light_key(key, lights[i].axis, sizeof lights[i].axis);
    key = stratus_light_key(key, numbers, sizeof numbers);
  }
  return key;
}

uint64_t stratus_light_key_of_albedo(
  uint64_t key, const stratus_transfer* transfers, int count, const stratus_material* materials, int components)
{
  for (int i = 0; i < count; ++i) {
    key = stratus_light_key(key, transfers[i].color, 4 * transfers[i].color_count * sizeof *transfers[i].color);
  }
  for (int c = 0; materials && c < components; ++c) {
    const double numbers[2] = { materials[c].shade, materials[c].diffuse };
    key = stratus_light_key(key, numbers, sizeof numbers);
  }
  return key;
}
