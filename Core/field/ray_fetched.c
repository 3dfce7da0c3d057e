/* SPDX-License-Identifier: BSD-3-Clause
 * Chooses the values that rays read: the volume's own or a float copy of them. A volume that is slow to read is copied once rays have taken
 * as many samples as it has values, or at once where this picture's rays may take as many, one a voxel along the longest side. A copy reads
 * each value once, as the value ranges do, and a sample eight. The copy does not change the picture. */
#include "ray_fetched.h"

/* The largest copy in bytes. */
#define FETCHED_BYTES_MOST ((size_t)1 << 31)

void stratus_ray_fetched_drop(stratus_ray_field* field)
{
  stratus_release(field->context, field->fetched);
  field->fetched = NULL;
  field->samples_since_data = 0;
  field->copy_failed = false;
}

/* Whether the shape suits the fast fetches: they use 32-bit indices and need a neighbour along each axis. */
static bool is_regular(const stratus_volume* volume)
{
  const double values = (double)volume->dimensions[0] * (double)volume->dimensions[1] * (double)volume->dimensions[2];
  return values < (double)INT32_MAX && volume->dimensions[0] > 1 && volume->dimensions[1] > 1 && volume->dimensions[2] > 1;
}

int stratus_ray_cast_type_is_fast(int type)
{
  return type == STRATUS_INT8 || type == STRATUS_UINT8 || type == STRATUS_INT16 || type == STRATUS_UINT16 || type == STRATUS_FLOAT32 ||
    type == STRATUS_FLOAT64;
}

int stratus_ray_fetch_type(const stratus_volume* volume)
{
  return !volume->tiles.values && is_regular(volume) && volume->value_stride == 1 && stratus_ray_cast_type_is_fast((int)volume->type)
    ? (int)volume->type
    : -1;
}

const void* stratus_ray_values_of(const stratus_ray_field* field)
{
  return field->traversed.tiles.values ? field->tiles : field->traversed.values;
}

size_t stratus_ray_component_bytes(const stratus_ray_field* field)
{
  const stratus_volume* volume = &field->traversed;
  const size_t planes = (size_t)stratus_volume_planes(volume) / (size_t)stratus_volume_components(volume);
  return volume->tiles.values          ? sizeof *field->tiles
    : volume->values == field->fetched ? stratus_volume_count(volume) * planes * sizeof(float)
                                       : stratus_type_size(volume->type);
}

/* Whether gradients are not where rays read them: behind the values of one component. */
static bool has_gradients_apart(const stratus_volume* volume)
{
  const bool plain = volume->type == STRATUS_FLOAT32 && volume->value_stride == 1 && stratus_volume_components(volume) == 1;
  return volume->gradients && !(plain && volume->gradients == (const float*)volume->values + stratus_volume_count(volume));
}

/* Copies the values of a component, and the planes of its gradients behind them. */
static void copy_component(const stratus_ray_field* field, int component, float* to)
{
  const stratus_volume view = stratus_volume_component(&field->volume, component);
  const double bias = stratus_volume_bias(&view);
  const size_t count = stratus_volume_count(&view), slice = count / (size_t)view.dimensions[2];
#pragma omp parallel for num_threads(field->context->threads)
  for (int64_t k = 0; k < view.dimensions[2]; ++k) {
    for (size_t i = (size_t)k * slice; i < ((size_t)k + 1) * slice; ++i) {
      to[i] = stratus_volume_fetch(&view, bias, i);
      for (size_t axis = 0; view.gradients && axis < 3; ++axis) {
        to[(axis + 1) * count + i] = view.gradients[axis * count + i];
      }
    }
  }
}

stratus_status stratus_ray_fetched_update(stratus_ray_field* field, size_t rays)
{
  const stratus_volume* volume = &field->volume;
  const int type = stratus_ray_fetch_type(volume);
  const int components = stratus_volume_components(volume);
  /* tiles are of an array that is larger than memory, so that a copy of it does not pay */
  const bool apart = has_gradients_apart(volume), slow = (type < 0 && !volume->tiles.values) || type == STRATUS_FLOAT64 || apart;
  /* traversal applies one bias, but each component has its own, and gradients have none */
  const bool must = apart || (components > 1 && stratus_type_is_wide(volume->type));
  field->traversed = *volume;
  for (int c = 0; c < components && volume->tiles.values; ++c) {
    field->tiles[c] = volume->tiles;
    field->tiles[c].values = (const char*)volume->tiles.values + (size_t)c * stratus_type_size(volume->type);
  }
  if ((!slow && !must) || (!is_regular(volume) && !must)) {
    return STRATUS_OK;
  }
  const size_t count = stratus_volume_count(volume), planes = (size_t)stratus_volume_planes(volume);
  const bool fits = count <= FETCHED_BYTES_MOST / sizeof(float) / planes;
  if (must && !fits) {
    return stratus_fail(field->context, STRATUS_UNSUPPORTED, "%d components of %zu values each %s: together at most %zu numbers",
      components, count, apart ? "with three derivatives" : "of 32 bits and more", FETCHED_BYTES_MOST / sizeof(float));
  }
  if (!field->fetched) {
    const int64_t* n = volume->dimensions;
    const double longest = fmax(fmax((double)n[0], (double)n[1]), (double)n[2]);
    const double samples = (double)field->samples_since_data + (field->copy_failed ? 0.0 : longest * (double)rays);
    if (!must && (samples < (double)count || !fits)) {
      return STRATUS_OK;
    }
    void* memory = NULL;
    const stratus_status status = stratus_allocate(field->context, count * planes, sizeof(float), &memory);
    if (status != STRATUS_OK && must) {
      return status;
    }
    if (status != STRATUS_OK) {
      stratus_log(field->context, STRATUS_LOG_WARNING, "no memory to keep the values as floats: drawing stays slower");
      field->samples_since_data = 0; /* try again after as many samples more */
      field->copy_failed = true;
      return STRATUS_OK;
    }
    field->fetched = memory;
    for (int c = 0; c < components; ++c) {
      copy_component(field, c, field->fetched + (size_t)c * (planes / (size_t)components) * count);
    }
    ++field->data_serial;
  }
  field->traversed.values = field->fetched;
  field->traversed.type = STRATUS_FLOAT32;
  field->traversed.value_stride = 1;
  field->traversed.tiles.values = NULL;
  return STRATUS_OK;
}
