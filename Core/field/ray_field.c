/* SPDX-License-Identifier: BSD-3-Clause
 * Keeps the field of a volume up to date: value ranges, hidden bytes, tables of the grid, a float copy. */
#include "ray_field.h"

#include "ray_fetched.h"
#include "ray_mask.h"

#include <string.h>

static bool same_data(const stratus_ray_field* field, const stratus_volume* volume, int block_size)
{
  const stratus_volume* old = &field->volume;
  return field->ranges && field->ranges->block_size == block_size && stratus_volume_same_data(old, volume) &&
    stratus_volume_components(old) == stratus_volume_components(volume);
}

/* Makes value ranges, unless `same`, and hidden bytes. */
static stratus_status make_ranges(stratus_ray_field* field, const stratus_volume* volume, const stratus_ray_cast_options* options,
  int block_size, int followed, bool by_value, bool same)
{
  stratus_value_range* ranges = NULL;
  uint8_t* hidden = NULL;
  int hides = 0;
  stratus_status status = stratus_ray_hidden_make(field->context, volume, by_value, &hidden);
  if (status == STRATUS_OK) {
    status = stratus_ray_mask_join(field->context, volume, options->mask.bytes, options->mask.label_count > 0, by_value, &hidden, &hides);
  }
  const stratus_volume view = stratus_volume_component(volume, followed);
  if (status == STRATUS_OK && !same) {
    status = stratus_value_range_create(field->context, &view, block_size, &ranges);
  }
  if (status == STRATUS_OK && ranges && ranges->whole_lo == ranges->whole_hi) {
    status = stratus_volume_check_floats(field->context, &view, ranges->bias);
  }
  if (status != STRATUS_OK) {
    stratus_value_range_destroy(ranges);
    stratus_release(field->context, hidden);
    return status;
  }
  stratus_release(field->context, field->hidden);
  field->hidden = hidden;
  field->hidden_by_value = by_value;
  field->hides = hides;
  field->mask = options->mask.bytes;
  field->mask_revision = options->mask.revision;
  ++field->data_serial;
  if (!same) {
    stratus_value_range_destroy(field->ranges);
    field->ranges = ranges;
    field->followed = followed;
    stratus_ray_fetched_drop(field);
    ++field->range_builds;
    field->owns_all = stratus_volume_owned(volume, field->owned[0], field->owned[1]);
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_field_update(stratus_ray_field* field, const stratus_volume* volume, const stratus_ray_cast_options* options,
  size_t rays, stratus_ray_field_change* change, double* ms)
{
  const int block_size = stratus_value_range_block_size(volume, options->skipping.block_size);
  const bool by_value = options->sampling.interpolation == STRATUS_INTERPOLATION_NEAREST && volume->cell_centered;
  const int followed = stratus_ray_followed(volume, options);
  const bool same = same_data(field, volume, block_size) && field->followed == followed;
  if (!same || field->hidden_by_value != by_value || !stratus_ray_mask_same(field, options)) {
    const double start = stratus_now_ms();
    TRY(make_ranges(field, volume, options, block_size, followed, by_value, same));
    change->values = !same;
    change->hidden = true;
    *ms = stratus_now_ms() - start;
    field->scan_ms = same ? field->scan_ms : *ms;
  }
  TRY(stratus_ray_grid_update(field->context, volume, &field->grid, &change->grid));
  field->volume = *volume;
  memcpy(field->volume.coordinates, field->grid.coordinates, sizeof field->grid.coordinates);
  const float* before = field->fetched;
  const double start = stratus_now_ms();
  TRY(stratus_ray_fetched_update(field, rays));
  *ms += field->fetched != before ? stratus_now_ms() - start : 0.0;
  return STRATUS_OK;
}

static void drop_components(stratus_ray_field* field)
{
  for (int c = 0; c < 4; ++c) {
    stratus_value_range_destroy(field->others[c]);
    field->others[c] = NULL;
  }
  field->components = 0;
}

void stratus_ray_field_release(stratus_ray_field* field)
{
  drop_components(field);
  stratus_value_range_destroy(field->ranges);
  stratus_release(field->context, field->hidden);
  field->ranges = NULL;
  field->hidden = NULL;
  stratus_ray_fetched_drop(field);
  stratus_ray_grid_release(field->context, &field->grid);
}

bool stratus_ray_field_has_components(const stratus_ray_field* field)
{
  return field->others_of == field->range_builds && field->components == stratus_volume_components(&field->volume);
}

stratus_status stratus_ray_field_components(stratus_ray_field* field)
{
  const int components = stratus_volume_components(&field->volume);
  drop_components(field);
  for (int c = 0; c < components; ++c) {
    const stratus_volume view = stratus_volume_component(&field->volume, c);
    if (c != field->followed) {
      TRY(stratus_value_range_create(field->context, &view, field->ranges->block_size, &field->others[c]));
    }
  }
  field->components = components;
  field->others_of = field->range_builds;
  return STRATUS_OK;
}

const stratus_value_range* stratus_ray_range_of(const stratus_ray_field* field, int component)
{
  return component == field->followed ? field->ranges : field->others[component];
}
