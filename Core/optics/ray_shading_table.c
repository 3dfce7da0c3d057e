/* SPDX-License-Identifier: BSD-3-Clause
 * Tables of shading, all in one allocation: the table of each component or label, and gradient opacities. This file also makes
 * their joint occupancy. */
#include "ray_optics.h"

#include "ray_mode.h"

#include <string.h>

/* Rays store entry numbers as floats, which are exact up to 2^24. The margin is for the tables before the labels' tables. */
#define LABEL_ENTRIES_MOST 16000000

int stratus_ray_shading_media(const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  return options->mask.label_count > 0                         ? 1 + options->mask.label_count
    : options->optics.dependent || options->optics.transfer_2d ? 1
                                                               : stratus_volume_components(volume);
}

/* ---- checks */

/* Sampling by cells uses only a value's colour and opacity, and light. */
static stratus_status check_cells(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options)
{
  const char* what = stratus_volume_components(volume) > 1             ? "of several components"
    : options->mask.bytes                                              ? "with a mask"
    : transfer->gradient_count > 0                                     ? "with a gradient opacity"
    : !options->light.shade                                            ? NULL
    : stratus_ray_clips_gradients(options)                             ? "with light by gradients that clip planes change"
    : options->sampling.interpolation == STRATUS_INTERPOLATION_NEAREST ? "with light and nearest interpolation"
                                                                       : NULL;
  if (options->sampling.rule == STRATUS_SAMPLING_CELLS && options->mode == STRATUS_MODE_COMPOSITE && what) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "sampling by cells of a volume %s is not supported", what);
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_shading_check_volume(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options)
{
  const int components = stratus_volume_components(volume);
  if (components > 1 && options->mode == STRATUS_MODE_QUANTITIES) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "mode quantities of a volume of %d components, must have 1", components);
  }
  if (options->mask.label_count < 0 || options->mask.label_count > 255 || (options->mask.label_count > 0 && !options->mask.bytes)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%d labels %s a mask, must be 0..255, and there must be one",
      options->mask.label_count, options->mask.bytes ? "with" : "without");
  }
  if (options->mask.label_count > 0 && (components > 1 || options->mode != STRATUS_MODE_COMPOSITE)) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "labels in mode %s of a volume of %d components: only composite of 1 takes them",
      stratus_mode_name(options->mode), components);
  }
  if (options->optics.dependent && components == 3) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "3 dependent components, must be 2 or 4");
  }
  if (options->optics.dependent && components == 4 && stratus_type_is_wide(volume->type)) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "4 dependent components of type %d, must be of up to 16 bits or floats", (int)volume->type);
  }
  for (int c = 0; c < stratus_ray_shading_media(volume, options); ++c) {
    TRY(stratus_transfer_check(context, transfer + c));
    const double weight = transfer[c].weight;
    if (components > 1 && !options->optics.dependent && !(weight >= 0.0 && weight <= 1.0)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "weight %g of component %d outside 0..1", weight, c);
    }
  }
  return check_cells(context, volume, transfer, options);
}

static void drop_label_tables(stratus_ray_optics* optics)
{
  stratus_ray_shading_tables* shading = &optics->shading_tables;
  for (int l = 0; l < shading->label_tables_count; ++l) {
    stratus_table_destroy(shading->label_tables[l]);
  }
  stratus_release(optics->context, shading->label_tables);
  shading->label_tables = NULL;
  shading->label_tables_count = 0;
}

void stratus_ray_shading_release(stratus_ray_optics* optics)
{
  stratus_ray_shading_tables* shading = &optics->shading_tables;
  for (int c = 0; c < 4; ++c) {
    stratus_table_destroy(shading->tables[c]);
  }
  drop_label_tables(optics);
  stratus_release(optics->context, shading->memory);
  memset(shading, 0, sizeof *shading);
}

static bool has_labels(const stratus_ray_optics* optics, const stratus_ray_field* field)
{
  return field->components == 1 && optics->transfer_count > 1;
}

bool stratus_ray_shading_several(const stratus_ray_optics* optics, const stratus_ray_field* field)
{
  return !optics->transfer_2d.on && !field->followed && (field->components > 1 || has_labels(optics, field));
}

/* ---- tables */

/* Converts entries (colour times alpha, alpha) to (colour times optical depth, optical depth). */
static void thicken(const stratus_table* table, float* out)
{
  for (size_t e = 0; e < (size_t)table->size; ++e) {
    const float* entry = table->rgba + 4 * e;
    const float alpha = entry[3], depth = table->rgba[4 * ((size_t)table->size + e)];
    for (size_t i = 0; i < 3; ++i) {
      out[4 * e + i] = alpha > 0.0f ? entry[i] / alpha * depth : 0.0f;
    }
    out[4 * e + 3] = alpha > 0.0f ? depth : 0.0f;
  }
}

/* entries: at least as many as the tolerance needs. */
static stratus_status create_table(
  stratus_ray_optics* optics, const stratus_ray_field* field, const stratus_transfer* transfer, int c, int entries, stratus_table** table)
{
  const stratus_table_values values =
    stratus_table_values_of(stratus_ray_range_of(field, c), field->interpolation == STRATUS_INTERPOLATION_NEAREST);
  const double distance = stratus_ray_modes_table_distance(optics->shading_tables.mode, transfer, optics->shading_tables.sample_distance);
  return stratus_table_create_fine(optics->context, transfer, &values, STRATUS_SAMPLING_MIDPOINT, distance, entries, table);
}

/* Return the number of entries of each label's table: as many as the caster's table, which follow the tolerance, unless there is no room
 * for them with this number of labels. Then half of the room is left for narrow features. */
static int entries_of_labels(const stratus_ray_optics* optics)
{
  const int least = stratus_table_entries_for(STRATUS_SAMPLING_MIDPOINT, stratus_ray_cast_options_default().sampling.tolerance);
  int entries = optics->made.entries;
  while (entries > least && 2.0 * entries * optics->transfer_count > 0.5 * LABEL_ENTRIES_MOST) {
    entries /= 2;
  }
  return entries;
}

static stratus_status create_label_tables(stratus_ray_optics* optics, const stratus_ray_field* field)
{
  stratus_ray_shading_tables* shading = &optics->shading_tables;
  void* memory = NULL;
  drop_label_tables(optics);
  if (!has_labels(optics, field)) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate_zero(optics->context, (size_t)optics->transfer_count, sizeof *shading->label_tables, &memory));
  shading->label_tables = memory;
  shading->label_tables_count = optics->transfer_count;
  const int least = entries_of_labels(optics);
  size_t entries = 0;
  for (int l = 0; l < optics->transfer_count; ++l) {
    TRY(create_table(optics, field, optics->transfers + l, 0, least, &shading->label_tables[l]));
    entries += 2 * (size_t)shading->label_tables[l]->size;
  }
  if (entries > LABEL_ENTRIES_MOST) {
    return stratus_fail(optics->context, STRATUS_UNSUPPORTED,
      "%d labels' functions need %zu table entries, must be at most %d: wider features need fewer", optics->transfer_count - 1, entries,
      LABEL_ENTRIES_MOST);
  }
  return STRATUS_OK;
}

/* Makes the tables of several components. Independent components have one each. Of dependent ones, the last has one for opacity, unless
 * rays follow it; of two, the first has another for colour. */
static stratus_status create_tables(stratus_ray_optics* optics, const stratus_ray_field* field)
{
  const bool dependent = optics->dependent;
  stratus_ray_shading_tables* shading = &optics->shading_tables;
  const int last = field->components - 1;
  for (int c = 0; c <= last; ++c) {
    stratus_table_destroy(shading->tables[c]);
    shading->tables[c] = NULL;
  }
  if (last == 0) {
    return create_label_tables(optics, field);
  }
  if (!dependent) {
    for (int c = 0; c <= last; ++c) {
      TRY(create_table(optics, field, optics->transfers + c, c, optics->made.entries, &shading->tables[c]));
    }
    return STRATUS_OK;
  }
  if (last == 1) {
    stratus_transfer color = optics->transfers[0];
    const double opaque[2] = { color.color[0], 1.0 };
    color.opacity = opaque;
    color.opacity_count = 1;
    color.clamp = 1;
    TRY(create_table(optics, field, &color, 0, optics->made.entries, &shading->tables[0]));
  }
  return field->followed ? STRATUS_OK : create_table(optics, field, optics->transfers, last, optics->made.entries, &shading->tables[last]);
}

/* Appends what finds an entry in a table of several entries a cell, unless out is NULL. Returns the end. */
static size_t lay_out_search(const stratus_table* table, size_t at, float* out, int* first_at, int* bound_at)
{
  if (table->search_steps == 0) {
    *first_at = *bound_at = 0;
    return at;
  }
  *first_at = (int)at;
  *bound_at = (int)(at + (size_t)table->cells + 1);
  if (out) {
    memcpy(out + *first_at, table->first, ((size_t)table->cells + 1) * sizeof *table->first);
    memcpy(out + *bound_at, table->bound, (size_t)table->size * sizeof *table->bound);
  }
  return at + (size_t)table->cells + 1 + (size_t)table->size;
}

static size_t rounded_to_four(size_t at)
{
  return (at + 3) / 4 * 4;
}

/* Append a gradient opacity, unless out is NULL, and set *first to its beginning, -1 if there is none. Returns the end. */
static size_t lay_out_factors(const stratus_transfer* transfer, bool has, size_t at, float* out, int* first, float* scale)
{
  *first = has ? (int)at : -1;
  *scale = has ? stratus_gradient_factors(transfer, out ? out + at : NULL) : 0.0f;
  return at + (has ? STRATUS_SHADING_FACTORS + 2 : 0);
}

/* Appends a record for each label, see stratus_ray_media, then the labels' tables and gradient opacities. Returns the end. */
static size_t lay_out_labels(stratus_ray_optics* optics, size_t at, float* out)
{
  enum { WORDS = 12 };
  stratus_ray_shading_tables* shading = &optics->shading_tables;
  const size_t labels = (size_t)shading->label_tables_count;
  shading->label_first = (int)at;
  shading->label_steps = 0;
  shading->label_factors = false;
  float* record = out ? out + at : NULL;
  at += WORDS * labels;
  for (size_t l = 0; l < labels; ++l) {
    const stratus_table* table = shading->label_tables[l];
    const size_t begin = at, words = 8 * (size_t)table->size;
    const bool own = l > 0 && optics->transfers[l].gradient_count > 0;
    int32_t numbers[4] = { (int32_t)(begin / 4), table->size }, factors[4] = { shading->factor_first[0] };
    float scale = shading->factor_scale[0];
    at = lay_out_search(table, begin + words, out, &numbers[2], &numbers[3]);
    if (own) {
      at = lay_out_factors(optics->transfers + l, true, at, out, &factors[0], &scale);
    }
    at = rounded_to_four(at);
    shading->label_factors |= factors[0] >= 0;
    shading->label_steps = table->search_steps > shading->label_steps ? table->search_steps : shading->label_steps;
    if (out) {
      const float place[4] = { table->scale, table->offset, (float)(table->cells - 1), scale };
      memcpy(record + WORDS * l, place, sizeof place);
      memcpy(record + WORDS * l + 4, numbers, sizeof numbers);
      memcpy(record + WORDS * l + 8, factors, sizeof factors);
      memcpy(out + begin, table->rgba, words * sizeof *out);
    }
  }
  return at;
}

/* Lays all tables out one after another, and writes them unless out is NULL. Returns their size in words of 4 bytes. */
static size_t lay_out(stratus_ray_optics* optics, const stratus_ray_field* field, float* out)
{
  const bool dependent = optics->dependent;
  stratus_ray_shading_tables* shading = &optics->shading_tables;
  size_t at = 0;
  if (field->components == 1 || field->followed) {
    const size_t words = stratus_table_words(optics->made.table);
    if (out) {
      memcpy(out, optics->made.table->rgba ? (const void*)optics->made.table->rgba : (const void*)optics->made.table->sums, 4 * words);
    }
    at = rounded_to_four(words);
  }
  for (int c = 0; c < field->components; ++c) {
    const stratus_table* table = shading->tables[c];
    shading->first[c] = (int)at;
    if (table && out && dependent && c == 0 && field->components == 2) {
      memcpy(out + at, table->rgba, 16 * (size_t)table->size);
    } else if (table && out) {
      thicken(table, out + at);
    }
    if (table) {
      at = lay_out_search(table, at + 4 * (size_t)table->size, out, &shading->first_at[c], &shading->bound_at[c]);
    }
  }
  for (int c = 0; c < field->components; ++c) {
    const stratus_transfer* transfer = dependent ? optics->transfers : optics->transfers + c;
    const bool has = transfer->gradient_count > 0 && (!dependent || c + 1 == field->components);
    at = lay_out_factors(transfer, has, at, out, &shading->factor_first[c], &shading->factor_scale[c]);
  }
  return lay_out_labels(optics, rounded_to_four(at), out);
}

stratus_status stratus_ray_shading_tables_update(
  stratus_ray_optics* optics, const stratus_ray_field* field, stratus_mode mode, double sample_distance)
{
  stratus_ray_shading_tables* shading = &optics->shading_tables;
  void* memory = NULL;
  if (shading->memory && shading->table_number == optics->made.number) {
    return STRATUS_OK;
  }
  stratus_release(optics->context, shading->memory);
  shading->memory = NULL;
  shading->mode = mode;
  shading->sample_distance = sample_distance;
  TRY(create_tables(optics, field));
  const size_t words = lay_out(optics, field, NULL);
  TRY(stratus_allocate(optics->context, words, sizeof(float), &memory));
  (void)lay_out(optics, field, memory);
  shading->memory = memory;
  shading->bytes = words * sizeof(float);
  shading->table_number = optics->made.number;
  ++optics->table_serial;
  return STRATUS_OK;
}

bool stratus_ray_shading_show(const stratus_ray_optics* optics, const stratus_ray_field* field, const stratus_shown* values)
{
  const stratus_ray_shading_tables* shading = &optics->shading_tables;
  for (int l = 0; optics->shades && l < shading->label_tables_count; ++l) {
    if (shading->label_tables[l]->shown > 0) {
      return true;
    }
  }
  if (field->components <= 1 || optics->transfer_2d.on || field->followed) {
    return stratus_shown_meets(values, field->ranges->whole_lo, field->ranges->whole_hi);
  }
  for (int c = 0; c < field->components; ++c) {
    if (shading->tables[c] && (!optics->dependent || c + 1 == field->components) && shading->tables[c]->shown > 0) {
      return true;
    }
  }
  return false;
}

/* ---- occupancy */

static stratus_status medium_occupancy(
  stratus_context* context, const stratus_value_range* ranges, const stratus_transfer* transfer, stratus_occupancy** occupancy)
{
  const stratus_fetching fetching = stratus_value_range_fetching(ranges);
  stratus_shown shown;
  TRY(stratus_shown_of_transfer(context, &fetching, transfer, &shown));
  const stratus_status status = stratus_occupancy_build(context, ranges, &shown, false, occupancy);
  stratus_release(context, shown.of);
  return status;
}

stratus_status stratus_ray_shading_occupancy(
  const stratus_ray_optics* optics, const stratus_ray_field* field, stratus_occupancy** occupancy)
{
  stratus_occupancy* whole = NULL;
  stratus_status status = STRATUS_OK;
  const bool labels = has_labels(optics, field);
  const int first = optics->dependent && !labels ? field->components - 1 : 0, count = labels ? optics->transfer_count : field->components;
  for (int c = first; c < count; ++c) {
    stratus_occupancy* part = NULL;
    TRY_CLEANUP(medium_occupancy(
      optics->context, stratus_ray_range_of(field, labels ? 0 : c), optics->transfers + (optics->dependent && !labels ? 0 : c), &part));
    if (whole) {
      stratus_occupancy_add(whole, part);
      stratus_occupancy_destroy(part);
    } else {
      whole = part;
    }
  }
  *occupancy = whole;
  return STRATUS_OK;
cleanup:
  stratus_occupancy_destroy(whole);
  return status;
}

/* ---- the table that rays read */

void stratus_ray_drop_tables(stratus_ray_optics* optics)
{
  stratus_table_destroy(optics->made.table);
  stratus_table_destroy(optics->spare_table.table);
  optics->made.table = NULL;
  optics->spare_table.table = NULL;
}

const void* stratus_ray_table_of(const stratus_ray_optics* optics, size_t* bytes)
{
  const stratus_table* table = optics->made.table;
  if (optics->transfer_2d.on) {
    *bytes = optics->transfer_2d.bytes;
    return optics->transfer_2d.table;
  }
  *bytes = optics->shades ? optics->shading_tables.bytes : stratus_table_words(table) * sizeof(float);
  return optics->shades ? optics->shading_tables.memory : table->sums ? (const void*)table->sums : (const void*)table->rgba;
}
