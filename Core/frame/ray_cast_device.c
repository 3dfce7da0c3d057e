/* SPDX-License-Identifier: BSD-3-Clause
 * The traversal on the OpenCL device: keeps copies of volume, table and map until they are rebuilt, and launches the kernel. */
#include "ray_cast_device.h"

#include "device_frame.h"
#include "ray_cast_host.h"
#include "ray_caster.h"
#include "ray_device_buffers.h"
#include "ray_frame.h"
#include "ray_mask.h"
#include "ray_shading_table.h"

#include <stdio.h>
#include <string.h>

/* All members are 4-byte scalars, so no padding separates them. The kernel gets the size by a define and asserts it, too. */
_Static_assert(sizeof(stratus_ray_cast_arguments) ==
    sizeof(stratus_picture_arguments) + sizeof(stratus_ray_camera) + sizeof(stratus_ray_lattice) + sizeof(float) +
      sizeof(stratus_ray_crop) + sizeof(stratus_ray_values) + sizeof(stratus_ray_grid_arguments) + sizeof(stratus_ray_map) +
      sizeof(stratus_ray_rough) + sizeof(stratus_table_arguments) + sizeof(stratus_ray_mode) + sizeof(stratus_light_arguments) +
      sizeof(stratus_ray_media) + sizeof(stratus_ray_function_2d) + sizeof(stratus_slice_arguments),
  "arguments must have no padding");

void stratus_ray_device_destroy(stratus_ray_caster* caster)
{
  if (caster->device) {
    for (int b = 0; b < BUFFERS; ++b) {
      stratus_slot_drop(&caster->device->slots[b]);
    }
    stratus_ray_pages_drop(caster->context, &caster->device->pages);
    stratus_release(caster->context, caster->device);
    caster->device = NULL;
  }
}

/* Replaces a buffer by a copy of the host's bytes, or by the bytes themselves if the device shares the host's memory. */
static stratus_status replace(stratus_ray_caster* caster, buffer_name name, const void* host, size_t bytes)
{
  TRY(stratus_slot_keep(caster->context, &caster->device->slots[name], host, bytes));
  ++caster->uploads;
  return STRATUS_OK;
}

static size_t value_bytes(const stratus_ray_caster* caster)
{
  const stratus_volume* volume = &caster->field.traversed;
  const size_t values = stratus_volume_count(volume);
  if (volume->values == caster->field.fetched || volume->gradients) { /* one plane after the other */
    return values * (size_t)stratus_volume_planes(volume) * sizeof(float);
  }
  return ((values - 1) * (size_t)volume->value_stride + (size_t)stratus_volume_components(volume)) * stratus_type_size(volume->type);
}

/* Whether the device gets pages: of values in tiles, or that one allocation does not hold. */
static bool comes_in_pages(const stratus_ray_caster* caster)
{
  return caster->field.traversed.tiles.values || value_bytes(caster) > stratus_device_largest_allocation(caster->context->device);
}

static size_t hidden_bytes(const stratus_ray_caster* caster)
{
  const int64_t* n = caster->field.volume.dimensions;
  const size_t values = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
  return (caster->field.hides & (HIDDEN_BY_MASK | HIDDEN_LABELS) ? values : 0) +
    (caster->field.hides & HIDDEN_CELLS ? stratus_ray_hidden_cells(&caster->field.volume, caster->field.hidden_by_value) : 0);
}

/* Send the hidden bytes, and the whole volume unless its values come in pages; then free the device's whole copy. */
static stratus_status upload_data(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, bool in_pages)
{
  stratus_ray_device* d = caster->device;
  if (d->data_serial != caster->field.data_serial || d->in_pages != in_pages) {
    d->data_serial = 0; /* until all is there */
    if (in_pages) {
      stratus_slot_drop(&d->slots[VALUES]);
    } else {
      stratus_ray_pages_drop(caster->context, &d->pages);
      TRY(replace(caster, VALUES, frame->values, value_bytes(caster)));
    }
    d->in_pages = in_pages;
    TRY(replace(caster, HIDDEN, frame->hidden, frame->hidden ? hidden_bytes(caster) : 0));
    d->data_serial = caster->field.data_serial;
  }
  return STRATUS_OK;
}

static stratus_status upload(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame)
{
  stratus_ray_device* d = caster->device;
  /* shading has a table of its own, and so have functions of two variables */
  const uint64_t table_serial = 3 * caster->optics.table_serial + (caster->optics.transfer_2d.on ? 2 : caster->optics.shades);
  if (d->table_serial != table_serial) {
    size_t bytes = 0;
    const void* table = stratus_ray_table_of(&caster->optics, &bytes);
    TRY(replace(caster, TABLE, table, bytes));
    d->table_serial = table_serial;
  }
  const uint64_t map_serial = frame->map ? caster->structure.map_serial : 0; /* 0 without a map, so that the device keeps none borrowed */
  if (!d->slots[MAP].memory || d->map_serial != map_serial) {
    TRY(replace(caster, MAP, frame->map, frame->map ? caster->structure.map->bytes_size : 0));
    d->map_serial = map_serial;
  }
  const uint64_t rough_serial = frame->rough ? caster->structure.rough_serial : 0;
  if (!d->slots[ROUGH].memory || d->rough_serial != rough_serial) {
    TRY(replace(caster, ROUGH, frame->rough, frame->rough ? caster->structure.rough->bytes_size : 0));
    d->rough_serial = rough_serial;
  }
  const uint64_t grid_serial = frame->grid ? caster->field.grid.serial : 0;
  if (!d->slots[GRID].memory || d->grid_serial != grid_serial) {
    TRY(replace(caster, GRID, frame->grid, frame->grid ? caster->field.grid.bytes : 0));
    d->grid_serial = grid_serial;
  }
  d->lights = NULL;
  if (caster->optics.lights) {
    bool sent = false;
    TRY(stratus_light_maps_on_device(caster->optics.lights, &d->lights, &sent));
    caster->uploads += sent;
  }
  return STRATUS_OK;
}

/* Returns the reason why the device cannot draw this volume, or NULL. */
static const char* obstacle(const stratus_ray_caster* caster)
{
  const stratus_device* device = caster->context->device;
  const size_t largest = stratus_device_largest_allocation(device);
  if (caster->field.hides && hidden_bytes(caster) > largest) {
    return "the mask and the hidden cells are larger than the device's largest allocation";
  }
  if (caster->structure.map && caster->structure.map->bytes_size > largest) {
    return "the distance map is larger than the device's largest allocation";
  }
  if (stratus_light_maps_bytes(caster->optics.lights) > largest) {
    return "the maps of light are larger than the device's largest allocation";
  }
  if (caster->integrator.choice.sampling == STRATUS_SAMPLING_LOCAL && caster->structure.rough->bytes_size > largest) {
    return "the map of rough blocks is larger than the device's largest allocation";
  }
  if (stratus_type_is_wide(caster->field.traversed.type) && !stratus_device_has_double(device)) {
    return "the device has no double for this type of values";
  }
  return NULL;
}

int stratus_ray_rarities(const stratus_ray_cast_arguments* a)
{
  return (a->crop.regions ? RAY_REGIONS : 0) | (a->crop.clip_count ? RAY_CLIP : 0) | (a->crop.has_piece ? RAY_PIECE : 0) |
    (a->lattice.jitter ? RAY_JITTER : 0) | (a->values.has_hidden ? RAY_HIDDEN : 0) | (a->values.nearest ? RAY_NEAREST : 0) |
    (a->map.tree ? RAY_TREE : 0) | (a->media.components > 1 ? RAY_COMPONENTS : 0) | (a->media.label_count > 0 ? RAY_LABELS : 0) |
    (a->values.page_components ? RAY_PAGES : 0) | (a->table.has_opaque ? RAY_OPAQUE : 0) | (a->table.cut ? RAY_CUT : 0) |
    (a->table.jumps ? RAY_JUMPS : 0) | (a->grid.on ? RAY_GRID : 0) | (a->lattice.follows ? RAY_FOLLOWS : 0) |
    (a->values.gradient_at ? RAY_GRADIENTS : 0);
}

static stratus_status find_kernel(stratus_ray_caster* caster, const stratus_ray_cast_arguments* arguments, int type,
  stratus_ray_variant variant, bool packets, cl_kernel* kernel)
{
  stratus_context* context = caster->context;
  static const int modes[] = { [STRATUS_VARIANT_EXTREMES] = STRATUS_RAY_EXTREMES,
    [STRATUS_VARIANT_SUMS] = STRATUS_RAY_SUMS,
    [STRATUS_VARIANT_ISOSURFACE] = STRATUS_RAY_ISOSURFACE,
    [STRATUS_VARIANT_CELLS] = STRATUS_RAY_CELLS,
    [STRATUS_VARIANT_LOCAL] = STRATUS_RAY_LOCAL,
    [STRATUS_VARIANT_LIT] = STRATUS_RAY_LOCAL,
    [STRATUS_VARIANT_TRANSFER_2D] = STRATUS_RAY_TRANSFER_2D,
    [STRATUS_VARIANT_SLICE] = STRATUS_RAY_SLICE,
    [STRATUS_VARIANT_QUANTITIES] = STRATUS_RAY_QUANTITIES,
    [STRATUS_VARIANT_SHADING_MIDPOINT] = STRATUS_RAY_SHADING,
    [STRATUS_VARIANT_SHADING_PREINTEGRATED] = STRATUS_RAY_SHADING };
  char defines[256];
  int used = snprintf(defines, sizeof defines,
    "-DSTRATUS_DEVICE=1 -DSTRATUS_TYPE=%d -DSTRATUS_PREINTEGRATED=%d -DSTRATUS_WIDTH=%d -DRAY_TILE=%d "
    "-DSTRATUS_ARGUMENTS_BYTES=%zu -DRAY_HAS=%d%s%s",
    type, variant == STRATUS_VARIANT_PREINTEGRATED || variant == STRATUS_VARIANT_SHADING_PREINTEGRATED, packets ? 16 : 1,
    STRATUS_RAY_DEVICE_TILE, sizeof(stratus_ray_cast_arguments), stratus_ray_rarities(arguments),
    variant == STRATUS_VARIANT_LIT ? " -DRAY_LIT=1" : "", stratus_device_has_double(context->device) ? "" : " -DSTRATUS_REAL_PAIR=1");
  if (modes[variant]) {
    snprintf(defines + used, sizeof defines - (size_t)used, " -DSTRATUS_RAY_MODE=%d", modes[variant]);
  }
  return stratus_device_kernel(context, "ray_cast", defines, "ray_cast", kernel);
}

/* counts: 4 zeros for each tile of packets or row of rays, to which the kernel adds. */
static stratus_status draw(
  stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, cl_kernel kernel, bool packets, void* counts, size_t counts_bytes)
{
  static const buffer_name others[] = { HIDDEN, MAP, ROUGH, GRID, ARGUMENTS, TABLE, OPAQUE, RGBA, RGBA8, DEPTH, SAMPLES, COUNTS };
  enum { OF_LIGHTS = 4 }; /* the maps of light; without maps some buffer, because an argument must be one */
  stratus_context* context = caster->context;
  stratus_ray_device* d = caster->device;
  stratus_device_slot* slots = caster->device->slots;
  const stratus_ray_cast_arguments* a = frame->arguments;
  const size_t width = (size_t)a->picture.width, height = (size_t)a->picture.height, pixels = width * height;
  TRY(stratus_slot_send(context, slots + ARGUMENTS, CL_MEM_READ_ONLY, a, sizeof *a));
  TRY(stratus_slot_send(context, slots + OPAQUE, CL_MEM_READ_ONLY, frame->opaque_depth, pixels * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + RGBA, CL_MEM_WRITE_ONLY, frame->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + RGBA8, CL_MEM_WRITE_ONLY, frame->rgba8, pixels * 4));
  TRY(stratus_slot_lend(context, slots + DEPTH, CL_MEM_WRITE_ONLY, frame->depth, pixels * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + SAMPLES, CL_MEM_WRITE_ONLY, frame->samples, pixels * sizeof(uint32_t)));
  TRY(stratus_slot_send(context, slots + COUNTS, CL_MEM_READ_WRITE, counts, counts_bytes));
  unsigned n = 0;
  TRY(stratus_device_argument(context, kernel, n++, sizeof(cl_mem), &slots[ARGUMENTS].memory));
  if (!d->in_pages) {
    TRY(stratus_device_argument(context, kernel, n++, sizeof(cl_mem), &slots[VALUES].memory));
  }
  for (int s = 0; d->in_pages && s <= PAGE_SLABS; ++s) { /* the slabs, and the page table behind them */
    TRY(stratus_device_argument(context, kernel, n++, sizeof(cl_mem), s < PAGE_SLABS ? &d->pages.slabs[s].memory : &d->pages.table.memory));
  }
  for (size_t i = 0; i < COUNT_OF(others); ++i) {
    const cl_mem* memory = i == OF_LIGHTS && d->lights ? &d->lights : &slots[others[i]].memory;
    TRY(stratus_device_argument(context, kernel, n++, sizeof(cl_mem), memory));
  }
  const size_t side = packets ? STRATUS_RAY_DEVICE_TILE : 1, group = packets ? 1 : STRATUS_RAY_DEVICE_GROUP;
  const size_t global[2] = { (width + side - 1) / side, (height + side - 1) / side }, local[2] = { group, group };
  TRY(stratus_device_run(context, kernel, 2, global, local));
  TRY(stratus_slot_receive(context, slots + RGBA, frame->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_receive(context, slots + RGBA8, frame->rgba8, pixels * 4));
  TRY(stratus_slot_receive(context, slots + DEPTH, frame->depth, pixels * sizeof(float)));
  TRY(stratus_slot_receive(context, slots + SAMPLES, frame->samples, pixels * sizeof(uint32_t)));
  return stratus_slot_receive(context, slots + COUNTS, counts, counts_bytes);
}

size_t stratus_ray_device_parts(size_t width, size_t height, bool packets)
{
  const size_t side = STRATUS_RAY_DEVICE_TILE;
  return packets ? ((width + side - 1) / side) * ((height + side - 1) / side) : height;
}

void stratus_ray_device_count(const cl_uint* part, size_t parts, stratus_ray_counts* counts)
{
  *counts = (stratus_ray_counts){ 0 };
  for (size_t i = 0; i < parts; ++i) {
    counts->rays += part[4 * i];
    counts->samples += part[4 * i + 1];
    counts->skipped += part[4 * i + 2];
    counts->lookups += part[4 * i + 3];
  }
}

static stratus_status draw_and_count(
  stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, int type, stratus_ray_variant variant, stratus_ray_counts* counts)
{
  stratus_context* context = caster->context;
  const bool packets = stratus_device_is_cpu(context->device) && stratus_device_has_double(context->device);
  const size_t width = (size_t)frame->arguments->picture.width, height = (size_t)frame->arguments->picture.height;
  const size_t parts = stratus_ray_device_parts(width, height, packets);
  cl_kernel kernel;
  void* memory = NULL;
  TRY(find_kernel(caster, frame->arguments, type, variant, packets, &kernel));
  TRY(stratus_allocate_zero(context, parts, 4 * sizeof(cl_uint), &memory));
  const stratus_status status = draw(caster, frame, kernel, packets, memory, parts * 4 * sizeof(cl_uint));
  stratus_slots_return(caster->context, caster->device->slots, BUFFERS);
  if (status == STRATUS_OK) {
    stratus_ray_device_count(memory, parts, counts);
  }
  stratus_release(context, memory);
  return status;
}

/* Logs why the host draws, and keeps it for the report. */
static void draw_on_host(stratus_ray_caster* caster, const char* why)
{
  stratus_log(caster->context, STRATUS_LOG_WARNING, "drawing on the host: %s", why);
  snprintf(caster->where, sizeof caster->where, "drawn on the host: %s", why);
}

static void report_pages(stratus_ray_caster* caster, const stratus_ray_pages* pages)
{
  snprintf(caster->where, sizeof caster->where,
    "the device has %lld of the volume's %lld pages, %.4g MB, as all of it, %.4g MB, exceeds its largest allocation",
    (long long)pages->count, (long long)(pages->pages[0] * pages->pages[1] * pages->pages[2]), (double)pages->bytes / 1e6,
    (double)value_bytes(caster) / 1e6);
}

/* Gives how many voxels beyond an occupied block's cells rays may read, below and above it. The nearest value to a sample may lie beyond
 * them, too: where it shows, the block about it is occupied. */
static void find_margin(const stratus_ray_caster* caster, stratus_ray_variant variant, int margin[2])
{
  const bool lit = variant >= STRATUS_VARIANT_SHADING_MIDPOINT || variant == STRATUS_VARIANT_LIT || variant == STRATUS_VARIANT_ISOSURFACE ||
    variant == STRATUS_VARIANT_TRANSFER_2D;
  const bool segments = variant == STRATUS_VARIANT_PREINTEGRATED || variant == STRATUS_VARIANT_SHADING_PREINTEGRATED;
  margin[0] = lit ? 2 : 0; /* central differences, at a place that may be rounded into the next cell */
  margin[1] = lit ? 3 : 0;
  /* towards the light, along whichever axis of the grid that is */
  const int near =
    (int)ceil(fmin(stratus_ray_voxels_within(&caster->field.traversed, stratus_light_maps_near(caster->optics.lights)), 1e9));
  margin[0] += near;
  margin[1] += near;
  if (segments) { /* a segment that shows anything may end in a transparent block, whose value there counts */
    const int segment = (int)ceil(stratus_ray_voxels_a_sample(caster)) + 1;
    margin[0] += segment;
    margin[1] += segment;
  }
}

/* Sends the pages of the values that rays may need. */
static stratus_status upload_pages(
  stratus_ray_caster* caster, stratus_ray_variant variant, char* text, size_t capacity, const char** why_not)
{
  stratus_ray_pages* pages = &caster->device->pages;
  int margin[2];
  find_margin(caster, variant, margin);
  if (!caster->structure.occupancy) { /* no structure was requested, but pages follow from the occupied blocks */
    TRY(stratus_ray_make_occupancy(caster));
    ++caster->structure.occupancy_builds;
  }
  const uint64_t before = pages->uploads;
  const stratus_status status = stratus_ray_pages_update(&caster->field, &caster->structure, margin, pages, text, capacity, why_not);
  caster->uploads += pages->uploads - before;
  return status;
}

/* Sends what is stale of the frame's data. *why_not: the reason why the device cannot have it; NULL where it has. */
static stratus_status upload_all(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, stratus_ray_variant variant,
  bool in_pages, char* text, size_t capacity, const char** why_not)
{
  *why_not = NULL;
  TRY(upload_data(caster, frame, in_pages));
  if (in_pages) {
    const uint64_t uploads = caster->uploads;
    TRY(upload_pages(caster, variant, text, capacity, why_not));
    if (*why_not) {
      return STRATUS_OK;
    }
    report_pages(caster, &caster->device->pages);
    if (caster->uploads != uploads) {
      stratus_log(caster->context, STRATUS_LOG_INFO, "%s", caster->where);
    }
  }
  return upload(caster, frame);
}

/* Makes the caster's state on the device, unless it has one. */
static stratus_status make_device(stratus_ray_caster* caster)
{
  void* memory = NULL;
  if (!caster->device) {
    TRY(stratus_allocate_zero(caster->context, 1, sizeof *caster->device, &memory));
    caster->device = memory;
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_device_send(
  stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, const float* layers, const char** why_not)
{
  *why_not = obstacle(caster);
  if (!*why_not && comes_in_pages(caster)) {
    *why_not = "a volume is larger than memory or the device's largest allocation, and several are not drawn from pages";
  }
  if (*why_not) {
    return STRATUS_OK;
  }
  TRY(make_device(caster));
  stratus_ray_device* d = caster->device;
  TRY(upload_data(caster, frame, false));
  TRY(upload(caster, frame));
  if (layers &&
    (!d->slots[LAYERS].memory || d->layers != layers || d->layers_of != caster->optics.layers_of ||
      d->layers_step != caster->optics.layers_step)) {
    d->layers_of = 0; /* until they are there: tables count from 1 */
    TRY(replace(caster, LAYERS, layers, 4 * (size_t)caster->optics.made.table->size * sizeof(float)));
    d->layers = layers;
    d->layers_of = caster->optics.layers_of;
    d->layers_step = caster->optics.layers_step;
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_cast_device(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, int type,
  stratus_ray_variant variant, stratus_ray_counts* counts, double* upload_ms, bool* drawn)
{
  stratus_context* context = caster->context;
  const bool in_pages = comes_in_pages(caster);
  _Alignas(64) stratus_ray_cast_arguments arguments = *frame->arguments; /* aligned so that a device can borrow them */
  stratus_ray_cast_frame mine = *frame;
  char text[128];
  const char* why_not = obstacle(caster);
  if (why_not) {
    draw_on_host(caster, why_not);
    return STRATUS_OK;
  }
  TRY(make_device(caster));
  const double start = stratus_now_ms();
  TRY(upload_all(caster, frame, variant, in_pages, text, sizeof text, &why_not));
  *upload_ms += stratus_now_ms() - start;
  if (why_not) {
    draw_on_host(caster, why_not);
    return STRATUS_OK;
  }
  if (in_pages) {
    stratus_ray_pages_arguments(&caster->device->pages, stratus_volume_planes(&caster->field.traversed), &arguments);
    type = (int)caster->field.traversed.type; /* pages have the type's own fetch, whatever the volume's shape */
  }
  mine.arguments = &arguments;
  TRY(stratus_progress(context, "ray cast", 0.0));
  TRY(draw_and_count(caster, &mine, type, variant, counts));
  *drawn = true;
  return stratus_progress(context, "ray cast", 1.0);
}
