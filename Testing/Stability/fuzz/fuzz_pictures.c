/* SPDX-License-Identifier: BSD-3-Clause
 * Ray casts of volumes: every mode, structure, sampling and interpolation. One caster draws them in sequence, and each picture must equal
 * the one that a new caster draws. */
#include "fuzz.h"

#include "volume.h"
#include "ray_cast_host.h"

#include <stdlib.h>

typedef struct picture_case {
  fuzz_field field;
  int components;
  stratus_ray_cast_options options;
  stratus_camera camera;
  const stratus_transfer* transfers;
} picture_case;

/* ---- options */

void fuzz_clipping(fuzz* f, stratus_ray_clipping_options* o, const fuzz_field* field)
{
  const stratus_volume* v = &field->view;
  o->crop = fuzz_chance(f, 0.2) ? 1 : 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double width = v->spacing[axis] * (double)v->dimensions[axis], at = v->origin[axis] + width * fuzz_between(f, -0.3, 0.7);
    o->crop_bounds[2 * axis] = fuzz_odd(f) ? fuzz_odd_real(f) : at;
    o->crop_bounds[2 * axis + 1] = fuzz_odd(f) ? fuzz_odd_real(f) : at + width * fuzz_between(f, 0.0, 0.8);
  }
  o->crop_regions = fuzz_chance(f, 0.5) ? STRATUS_CROP_INSIDE : (uint32_t)fuzz_next(f) & (fuzz_odd(f) ? 0xffffffffu : STRATUS_CROP_ALL);
  o->clip_plane_count = fuzz_chance(f, 0.7) ? 0 : fuzz_integer(f, 0, STRATUS_CLIP_PLANES_MAX);
  for (int p = 0; p < STRATUS_CLIP_PLANES_MAX; ++p) {
    double* plane = o->clip_planes[p];
    fuzz_vector(f, -1.0, 1.0, plane);
    plane[3] = 0.0;
    for (int axis = 0; axis < 3; ++axis) { /* through the volume, somewhere */
      plane[3] -= plane[axis] * fuzz_between(f, field->bounds[2 * axis], field->bounds[2 * axis + 1]);
    }
    plane[3] = fuzz_odd(f) ? fuzz_odd_real(f) : plane[3];
  }
}

/* A mask of one byte for each value, at times of labels. */
static void choose_mask(fuzz* f, stratus_ray_cast_options* o, const picture_case* c)
{
  uint8_t* mask = malloc(c->field.values + 1);
  const bool labels = o->mode == STRATUS_MODE_COMPOSITE && c->components == 1 && fuzz_chance(f, 0.5);
  for (size_t i = 0; mask && i < c->field.values; ++i) {
    mask[i] = labels ? (uint8_t)fuzz_below(f, 6) : (uint8_t)(fuzz_chance(f, 0.7) ? 255 : 0);
  }
  o->mask.bytes = fuzz_input(f, mask, c->field.values);
  o->mask.revision = fuzz_below(f, 2);
  o->mask.label_count = labels ? (fuzz_chance(f, 0.05) ? 255 : 1 + (int)fuzz_below(f, 6)) : 0;
  free(mask);
}

/* Chooses a surface through the volume, and a function of two variables of columns x rows entries. */
static void choose_surface_and_function(fuzz* f, stratus_ray_cast_options* o, const picture_case* c)
{
  const fuzz_field* field = &c->field;
  const bool coordinates = field->view.coordinates[0] || field->view.coordinates[1] || field->view.coordinates[2];
  for (int axis = 0; axis < 3; ++axis) {
    o->slice.center[axis] = fuzz_real(f, field->bounds[2 * axis], field->bounds[2 * axis + 1]);
    o->slice.linear[axis] = fuzz_real(f, -1.0, 1.0);
    o->slice.square[axis] = fuzz_chance(f, 0.5) ? 0.0 : fuzz_real(f, -1.0, 1.0);
    o->slice.square[3 + axis] = fuzz_chance(f, 0.5) ? 0.0 : fuzz_real(f, -1.0, 1.0);
  }
  o->slice.constant = fuzz_chance(f, 0.5) ? 0.0 : fuzz_real(f, -field->shortest, field->shortest);
  if (fuzz_odd(f) || (c->components <= 1 && !coordinates && fuzz_chance(f, 0.2))) {
    o->clipping.clip_gradients = fuzz_flag(f);
    o->clipping.clipped_value = fuzz_real(f, field->low, field->high);
  }
  if (fuzz_odd(f) || (o->mode == STRATUS_MODE_COMPOSITE && c->components <= 2 && o->mask.label_count == 0 && fuzz_chance(f, 0.2))) {
    float rgba[4 * 9 * 9];
    stratus_transfer_2d of = { .columns = 1 + (int)fuzz_below(f, 9), .rows = 1 + (int)fuzz_below(f, 9), .revision = fuzz_next(f) };
    for (int i = 0; i < 4 * of.columns * of.rows; ++i) {
      rgba[i] = fuzz_chance(f, 0.3) ? 0.0f : (float)fuzz_real(f, 0.0, 1.0);
    }
    of.rgba = fuzz_input(f, rgba, 4 * (size_t)(of.columns * of.rows) * sizeof *rgba);
    of.value_range[0] = of.second_range[0] = field->low;
    of.value_range[1] = of.second_range[1] = field->high > field->low ? field->high : field->low + fmax(1.0, fabs(field->low));
    of.second_range[0] = fuzz_odd(f) ? fuzz_odd_real(f) : of.second_range[0];
    of.unit_distance = fuzz_real(f, 0.1 * field->shortest, 10.0 * field->shortest);
    o->optics.transfer_2d = FUZZ_INPUT(f, of);
    o->sampling.rule = fuzz_odd(f) ? o->sampling.rule : fuzz_chance(f, 0.5) ? STRATUS_SAMPLING_AUTO : STRATUS_SAMPLING_MIDPOINT;
  }
}

static stratus_ray_cast_options choose_options(fuzz* f, const picture_case* c)
{
  stratus_ray_cast_options o = stratus_ray_cast_options_default();
  static const int sizes[] = { 0, 2, 4, 8, 16, 32 };
  const fuzz_field* field = &c->field;
  o.mode = (stratus_mode)(fuzz_chance(f, 0.4) ? 0 : fuzz_choice(f, STRATUS_MODE_SLICE + 1));
  o.optics.dependent = (c->components == 2 || (c->components == 4 && !stratus_type_is_wide(field->view.type))) && fuzz_chance(f, 0.5);
  if (c->components > 1 && !o.optics.dependent && o.mode != STRATUS_MODE_COMPOSITE) { /* other modes draw a picture of each */
    o.mode = STRATUS_MODE_SLICE;
  }
  o.skipping.structure = (stratus_structure)fuzz_choice(f, STRATUS_STRUCTURE_HYBRID + 1);
  o.sampling.rule = (stratus_sampling)fuzz_choice(f, STRATUS_SAMPLING_CELLS + 1);
  o.sampling.interpolation = (stratus_interpolation)(o.mode == STRATUS_MODE_ISOSURFACE && !fuzz_odd(f) ? 0 : fuzz_choice(f, 2));
  o.sampling.distance = fuzz_chance(f, 0.4) ? 0.0 : fuzz_real(f, 0.1 * field->shortest, 10.0 * field->shortest);
  o.sampling.termination = fuzz_chance(f, 0.5) ? o.sampling.termination : fuzz_real(f, 0.0, 1.0);
  o.skipping.block_size = fuzz_odd(f) ? fuzz_integer(f, -1, 64) : sizes[fuzz_below(f, 6)];
  fuzz_clipping(f, &o.clipping, field);
  o.skipping.audit = fuzz_chance(f, 0.3);
  o.light.normals = (stratus_normals)fuzz_choice(f, 2);
  fuzz_shading(f, field->bounds, field->edge, &o.light.shading);
  o.light.shade = fuzz_chance(f, 0.25) ? fuzz_flag(f) : 0;
  if (fuzz_chance(f, 0.5)) {
    o.optics.average_range[0] = fuzz_real(f, field->low, 0.5 * (field->low + field->high));
    o.optics.average_range[1] = fuzz_real(f, 0.5 * (field->low + field->high), field->high);
  }
  o.optics.contour_count = fuzz_integer(f, 1, STRATUS_CONTOURS_MAX);
  for (int i = 0; i < STRATUS_CONTOURS_MAX; ++i) {
    o.optics.contours[i] = fuzz_real(f, field->low, field->high);
  }
  if (o.mode == STRATUS_MODE_FIRST_HIT) {
    o.clipping.crop_regions = STRATUS_CROP_INSIDE;
  }
  if (fuzz_chance(f, 0.2)) {
    choose_mask(f, &o, c);
  }
  o.mask.label_count = fuzz_odd(f) ? (fuzz_chance(f, 0.5) ? -1 : 256) : o.mask.label_count;
  choose_surface_and_function(f, &o, c);
  o.sampling.jitter = fuzz_chance(f, 0.2) ? fuzz_flag(f) : 0;
  o.sampling.jitter_seed = (uint32_t)fuzz_next(f);
  return o;
}

/* ---- draws */

static stratus_status draw(fuzz* f, stratus_context* context, stratus_ray_caster* caster, const picture_case* c,
  const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report)
{
  const stratus_volume* volume = fuzz_pointer(f, FUZZ_INPUT(f, c->field.view));
  const stratus_camera* camera = fuzz_pointer(f, FUZZ_INPUT(f, c->camera));
  const stratus_ray_cast_options* given = FUZZ_INPUT(f, *options);
  const stratus_image* into = fuzz_pointer(f, FUZZ_INPUT(f, *image));
  const stratus_transfer* transfers = fuzz_pointer(f, c->transfers);
  const stratus_volume* v = &c->field.view;
  fuzz_about(f,
    "%s %s %s, interpolation %d, shade %d, labels %d, mask %d, crop %d, clips %d, audit %d, opaque %d, %s camera; %lld x %lld x %lld of "
    "type "
    "%d, %d components, stride %lld, cells %d, ghosts %d %d",
    stratus_mode_name(options->mode), stratus_structure_name(options->skipping.structure), stratus_sampling_name(options->sampling.rule),
    (int)options->sampling.interpolation, options->light.shade, options->mask.label_count, options->mask.bytes != NULL,
    options->clipping.crop, options->clipping.clip_plane_count, options->skipping.audit, image->opaque_depth != NULL,
    c->camera.parallel ? "parallel" : "perspective", (long long)v->dimensions[0], (long long)v->dimensions[1], (long long)v->dimensions[2],
    (int)v->type, v->components, (long long)v->value_stride, v->cell_centered, v->point_ghosts != NULL, v->cell_ghosts != NULL);
  ++f->tally->pictures;
  return STATUS_OF(context, stratus_ray_caster_render(caster, volume, transfers, camera, given, into, report));
}

static void check_report(fuzz* f, const picture_case* c, const stratus_image* image, const stratus_ray_cast_report* r)
{
  const int* w = r->window;
  EXPECT(r->differing_pixels == 0, "audit: %llu pixels differ from the plain march", (unsigned long long)r->differing_pixels);
  EXPECT(r->rays <= (uint64_t)image->width * (uint64_t)image->height, "%llu rays", (unsigned long long)r->rays);
  EXPECT(r->occupied_blocks <= r->blocks, "%llu of %llu blocks", (unsigned long long)r->occupied_blocks, (unsigned long long)r->blocks);
  EXPECT(w[0] >= 0 && w[0] <= w[1] && w[1] <= image->width && w[2] >= 0 && w[2] <= w[3] && w[3] <= image->height, "window %d %d %d %d",
    w[0], w[1], w[2], w[3]);
  EXPECT(memchr(r->why, '\0', sizeof r->why), "why does not end");
  EXPECT((unsigned)r->structure <= STRATUS_STRUCTURE_HYBRID && (unsigned)r->sampling <= STRATUS_SAMPLING_LOCAL, "structure %d",
    (int)r->structure);
  EXPECT(c->options.mode == STRATUS_MODE_FIRST_HIT || (r->sample_distance > 0.0 && isfinite(r->sample_distance)), "sample distance %g",
    r->sample_distance);
  for (int i = 0; i < image->width * image->height; ++i) {
    const int x = i % image->width, y = i / image->width;
    const bool inside = x >= w[0] && x < w[1] && y >= w[2] && y < w[3];
    EXPECT(inside || image->rgba[4 * i + 3] == 0.0f, "pixel %d, %d shows %g outside the window", x, y, (double)image->rgba[4 * i + 3]);
  }
}

/* Compares with a caster on a context of its own, with other threads, memory and instruction set, and at times another structure: the bits
 * must be the same. */
static void compare(fuzz* f, const picture_case* c, const stratus_image* image, const stratus_ray_cast_report* report)
{
  fuzz_memory memory;
  stratus_context* context = fuzz_context(f, &memory);
  stratus_ray_caster* caster = NULL;
  stratus_ray_cast_options options = c->options;
  stratus_ray_cast_report other;
  /* Neither rule local nor a distance that follows the voxels can be set by hand. */
  const bool structures = fuzz_chance(f, 0.5) && !report->follows_voxels && report->sampling != STRATUS_SAMPLING_LOCAL;
  if (!stratus_context_on_device(context)) {
    context->isa = (int)fuzz_below(f, (uint64_t)stratus_isa_highest() + 1);
  }
  if (structures) {
    options.skipping.structure = (stratus_structure)fuzz_below(f, STRATUS_STRUCTURE_HYBRID + 1);
    options.sampling.rule = report->sampling;
    options.sampling.distance = options.mode == STRATUS_MODE_FIRST_HIT ? options.sampling.distance : report->sample_distance;
    options.sampling.cell_error = report->cell_error;
    options.sampling.light_spread = report->light_spread;
  }
  EXPECT(STATUS_OF(context, stratus_ray_caster_create(context, &caster)) == STRATUS_OK, "no caster");
  ++f->tally->objects;
  const stratus_image picture = fuzz_image_like(f, image);
  const stratus_status status = draw(f, context, caster, c, &options, &picture, &other);
  EXPECT(status == STRATUS_OK, "a new caster draws it otherwise: %s: %s", stratus_status_name(status), stratus_context_message(context));
  /* A packet may query a structure for all of its rays at once, so that its width decides how many samples are skipped. An automatic
   * structure follows from times, and the skipped segments follow from it. */
  const bool chosen = options.skipping.structure == STRATUS_STRUCTURE_AUTO && options.mode != STRATUS_MODE_FIRST_HIT;
  const bool counted = !structures && !chosen && !report->offered_tree && context->isa == f->context->isa;
  fuzz_check_same(f, image, &picture, counted, structures ? "with another structure" : "on a new caster");
  CALL(stratus_ray_caster_destroy(caster));
  fuzz_context_close(f, context, &memory);
}

static fuzz_limits limits_of(const picture_case* c)
{
  const stratus_ray_cast_options* o = &c->options;
  const bool can_be_lit = o->mode == STRATUS_MODE_COMPOSITE || o->mode == STRATUS_MODE_ISOSURFACE;
  return (fuzz_limits){ .behind = c->camera.parallel,
    .lit = (can_be_lit && o->light.shade) || o->mode == STRATUS_MODE_FIRST_HIT,
    .surfaces = o->mode != STRATUS_MODE_ADDITIVE && o->mode != STRATUS_MODE_AVERAGE };
}

static void step(fuzz* f, stratus_ray_caster* caster, const picture_case* c)
{
  const int width = fuzz_integer(f, 1, fuzz_chance(f, 0.2) ? 24 : 10), height = fuzz_integer(f, 1, fuzz_chance(f, 0.2) ? 24 : 10);
  const bool right = width >= 1 && width <= 24 && height >= 1 && height <= 24;
  stratus_image image = fuzz_image(f, right ? width : 5, right ? height : 4, &c->camera);
  stratus_ray_cast_report* report = fuzz_output(f, sizeof *report);
  if (!right && (width < 1 || width > 65536)) {
    image.width = width;
  }
  image.rgba = fuzz_odd(f) ? NULL : image.rgba;
  if (fuzz_chance(f, 0.15)) {
    fuzz_trouble(f);
  }
  stratus_status status = draw(f, f->context, caster, c, &c->options, &image, report);
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  const bool refused = status == STRATUS_UNSUPPORTED && c->options.sampling.rule == STRATUS_SAMPLING_CELLS; /* with light, masks and more */
  EXPECT(status == STRATUS_OK || troubled || refused || !fuzz_is_tame(f), "%s: %s", stratus_status_name(status),
    stratus_context_message(f->context));
  if (troubled && fuzz_is_tame(f)) {
    status = draw(f, f->context, caster, c, &c->options, &image, report);
    EXPECT(status == STRATUS_OK || refused || c->options.sampling.rule == STRATUS_SAMPLING_CELLS, "after trouble: %s: %s",
      stratus_status_name(status), stratus_context_message(f->context));
  }
  if (status != STRATUS_OK) {
    return;
  }
  fuzz_check_image(f, &image, limits_of(c));
  check_report(f, c, &image, report);
  if (fuzz_is_tame(f) && fuzz_chance(f, 0.5)) {
    const stratus_image again = fuzz_image_like(f, &image);
    EXPECT(draw(f, f->context, caster, c, &c->options, &again, NULL) == STRATUS_OK, "drawn once, but not twice");
    fuzz_check_same(f, &image, &again, true, "drawn twice");
  }
  if (fuzz_is_tame(f)) {
    compare(f, c, &image, report);
  }
}

static const stratus_transfer* choose_transfers(fuzz* f, const picture_case* c)
{
  const stratus_ray_cast_options* o = &c->options;
  const int labels = o->mask.label_count >= 1 && o->mask.label_count <= 255 && o->mask.bytes ? o->mask.label_count + 1 : 1;
  const stratus_transfer* transfers =
    fuzz_transfers(f, c->components > 1 && !o->optics.dependent ? c->components : labels, c->field.low, c->field.high, c->field.edge);
  return transfers;
}

static void change_mask(fuzz* f, picture_case* c)
{
  if (c->options.mask.bytes) {
    uint8_t* mask = malloc(c->field.values + 1);
    for (size_t i = 0; mask && i < c->field.values; ++i) {
      mask[i] = (uint8_t)fuzz_below(f, 3);
    }
    fuzz_change(f, c->options.mask.bytes, mask);
    ++c->options.mask.revision;
    free(mask);
  }
}

/* Changes one of the things that a caller may change between two pictures. */
static void change(fuzz* f, stratus_ray_caster* caster, picture_case* c)
{
  switch (fuzz_below(f, 7)) {
    case 0:
      c->camera = fuzz_camera(f, c->field.bounds);
      break;
    case 1:
      fuzz_volume_changes(f, &c->field);
      break;
    case 2:
      c->field = fuzz_volume(f, 9, c->components);
      c->options = choose_options(f, c);
      c->camera = fuzz_camera(f, c->field.bounds);
      break;
    case 3:
      c->options = choose_options(f, c);
      break;
    case 4:
      CALL(stratus_ray_caster_release(caster));
      (void)STATUS(stratus_ray_caster_offer_tree(caster, NULL, 0));
      break;
    case 5:
      change_mask(f, c);
      break;
    default:
      break;
  }
  c->transfers = choose_transfers(f, c);
}

/* Offers a tree that comes with the data: of this volume, of another, or invalid. */
static void offer(fuzz* f, stratus_ray_caster* caster, const picture_case* c)
{
  stratus_voxels* voxels = NULL;
  stratus_tree* tree = NULL;
  stratus_criterion criterion = stratus_criterion_default();
  criterion.transfer = fuzz_chance(f, 0.7) ? c->transfers : NULL;
  criterion.lower = criterion.transfer ? criterion.lower : c->field.low;
  const bool cells = fuzz_chance(f, 0.5);
  const stratus_status status = cells ? CREATE(&voxels, stratus_voxels_create_cells(f->context, &c->field.view, &criterion, &voxels))
                                      : CREATE(&voxels, stratus_voxels_create(f->context, &c->field.view, &criterion, &voxels));
  if (status == STRATUS_OK && CREATE(&tree, stratus_tree_create(f->context, voxels, NULL, &tree)) == STRATUS_OK) {
    const size_t size = CALL(stratus_tree_bytes(tree));
    unsigned char* bytes = fuzz_output(f, size);
    CALL(stratus_tree_save(tree, bytes));
    if (fuzz_chance(f, 0.2)) {
      bytes[fuzz_below(f, size)] ^= (unsigned char)(1u << fuzz_below(f, 8));
      ++f->tally->byte_strings;
    }
    (void)STATUS(stratus_ray_caster_offer_tree(caster, bytes, size));
  }
  CALL(stratus_tree_destroy(tree));
  CALL(stratus_voxels_destroy(voxels));
}

void fuzz_pictures(fuzz* f)
{
  picture_case c = { .components = fuzz_chance(f, 0.8) ? 1 : 2 + (int)fuzz_below(f, 3) };
  stratus_ray_caster* caster = NULL;
  c.field = fuzz_volume(f, 12, c.components);
  c.options = choose_options(f, &c);
  c.camera = fuzz_camera(f, c.field.bounds);
  c.transfers = choose_transfers(f, &c);
  if (CREATE(&caster, stratus_ray_caster_create(f->context, &caster)) != STRATUS_OK) {
    return;
  }
  if (fuzz_chance(f, 0.15)) {
    offer(f, caster, &c);
  }
  const uint64_t steps = 1 + fuzz_below(f, 4);
  for (uint64_t s = 0; s < steps; ++s) {
    step(f, caster, &c);
    change(f, caster, &c);
  }
  CALL(stratus_ray_caster_destroy(caster));
}
