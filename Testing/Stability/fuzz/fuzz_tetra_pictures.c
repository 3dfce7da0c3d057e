/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of tetrahedra by march and by projection, compared with each other and with a new caster's pictures. */
#include "fuzz.h"

#include <stdlib.h>

/* Largest root mean square difference of the methods by the contract, where no cells overlap: a hundredth of a step of 8 bits. */
#define METHODS_DIFFER_MOST (0.01 / 255.0)
#define STEEPEST 20.0

typedef struct tetra_case {
  fuzz_tetrahedra mesh;
  stratus_tetra_options options;
  bool no_options; /* the call gets NULL instead */
  stratus_camera camera;
  const stratus_transfer* transfer;
  stratus_partition* partition;
  stratus_leaves leaves;
} tetra_case;

/* Returns whether only the march draws the picture: of a slice, or one that the gradient affects. */
static bool is_marched(const tetra_case* c)
{
  return c->options.mode == STRATUS_TETRA_SLICE || c->options.shade ||
    (c->transfer->gradient_count > 0 && c->options.mode == STRATUS_TETRA_COMPOSITE);
}

static void choose_view(fuzz* f, tetra_case* c)
{
  stratus_tetra_options o = CALL(stratus_tetra_options_default());
  o.mode = (stratus_tetra_mode)(fuzz_chance(f, 0.7) ? 0 : fuzz_chance(f, 0.3) ? STRATUS_TETRA_SLICE : fuzz_choice(f, 2));
  o.method = (stratus_tetra_method)fuzz_choice(f, STRATUS_TETRA_METHOD_PROJECT + 1);
  o.termination = fuzz_chance(f, 0.6) ? o.termination : fuzz_real(f, 0.0, 1.0);
  o.tolerance = fuzz_chance(f, 0.6) ? o.tolerance : fuzz_real(f, 0.0, 0.1);
  o.leaves = c->partition ? &c->leaves : NULL;
  o.clip_plane_count = fuzz_chance(f, 0.8) ? 0 : fuzz_choice(f, STRATUS_TETRA_CLIP_PLANES_MAX + 1);
  for (int i = 0; i < 4 * STRATUS_TETRA_CLIP_PLANES_MAX; ++i) {
    o.clip_planes[i / 4][i % 4] = fuzz_chance(f, 0.1) ? 0.0 : fuzz_real(f, -1.0, 1.0);
  }
  o.crop = fuzz_chance(f, 0.1);
  for (int side = 0; side < 6; ++side) {
    o.crop_bounds[side] = c->mesh.bounds[side] + (side & 1 ? -0.2 : 0.2) * fuzz_real(f, 0.0, 1.0) * c->mesh.edge;
  }
  o.crop = o.crop && o.crop_bounds[0] <= o.crop_bounds[1] && o.crop_bounds[2] <= o.crop_bounds[3] && o.crop_bounds[4] <= o.crop_bounds[5];
  for (int i = 0; i < 6; ++i) {
    o.slice.square[i] = fuzz_chance(f, 0.5) ? 0.0 : fuzz_real(f, -1.0, 1.0);
    o.slice.linear[i % 3] = fuzz_real(f, 0.1, 1.0);
    o.slice.center[i % 3] = c->mesh.bounds[i % 3 * 2] + fuzz_real(f, 0.0, 1.0) * c->mesh.edge;
  }
  o.shade = o.mode == STRATUS_TETRA_COMPOSITE && fuzz_chance(f, 0.2);
  fuzz_shading(f, c->mesh.bounds, c->mesh.edge, &o.shading);
  o.gradient_distance = fuzz_chance(f, 0.6) ? 0.0 : fuzz_real(f, -1.0, 1.0);
  c->no_options = fuzz_chance(f, 0.02);
  c->options = c->no_options ? stratus_tetra_options_default() : o;
  c->camera = fuzz_camera(f, c->mesh.bounds);
  c->transfer = fuzz_transfers(f, 1, c->mesh.low, c->mesh.high, c->mesh.edge);
  if (fuzz_is_tame(f) && c->options.method == STRATUS_TETRA_METHOD_PROJECT && is_marched(c)) {
    c->options.method = STRATUS_TETRA_METHOD_AUTO;
  }
}

static stratus_status draw(fuzz* f, stratus_context* context, stratus_tetra_caster* caster, const tetra_case* c, const stratus_image* image,
  stratus_tetra_report* report)
{
  const stratus_tetra_options* options = &c->options;
  const stratus_mesh* m = &c->mesh.view;
  const stratus_mesh* mesh = fuzz_pointer(f, FUZZ_INPUT(f, *m));
  const stratus_camera* camera = fuzz_pointer(f, FUZZ_INPUT(f, c->camera));
  const stratus_tetra_options* given = c->no_options ? NULL : FUZZ_INPUT(f, *options);
  ++f->tally->pictures;
  fuzz_about(f, "%s, mode %d, leaves %d, opaque %d, %s camera; %lld points, %lld cells, sound %d, type %d, of cells %d, hidden %d",
    stratus_tetra_method_name(options->method), (int)options->mode, options->leaves ? options->leaves->leaf_count : 0,
    image->opaque_depth != NULL, c->camera.parallel ? "parallel" : "perspective", (long long)m->point_count, (long long)m->cell_count,
    c->mesh.sound, (int)m->type, m->cell_values, m->hidden != NULL);
  return STATUS_OF(context,
    stratus_tetra_caster_render(caster, mesh, fuzz_pointer(f, c->transfer), camera, given, fuzz_pointer(f, FUZZ_INPUT(f, *image)), report));
}

static void check_report(fuzz* f, const tetra_case* c, const stratus_image* image, const stratus_tetra_report* r)
{
  EXPECT(r->method == STRATUS_TETRA_METHOD_MARCH || r->method == STRATUS_TETRA_METHOD_PROJECT, "method %d", (int)r->method);
  EXPECT(r->rays <= (uint64_t)image->width * (uint64_t)image->height, "%llu rays", (unsigned long long)r->rays);
  EXPECT(r->cells == c->mesh.view.cell_count && r->shown_cells >= 0 && r->shown_cells <= r->cells, "%lld of %lld cells",
    (long long)r->shown_cells, (long long)r->cells);
  EXPECT(memchr(r->why, '\0', sizeof r->why), "why does not end");
}

static fuzz_limits limits_of(const tetra_case* c)
{
  return (fuzz_limits){ .surfaces = true, .behind = c->camera.parallel, .lit = c->options.shade };
}

/* True if points of `components` numbers rise and fall by no more than STEEPEST over the values' range. */
static bool is_even(const double* points, size_t count, size_t components, double range)
{
  bool even = true;
  for (size_t i = 1; i < count; ++i) {
    const double *a = points + (i - 1) * (components + 1), *b = a + components + 1;
    for (size_t c = 1; c <= components; ++c) {
      even = even && fabs(b[c] - a[c]) <= STEEPEST * (b[0] - a[0]) / range;
    }
  }
  return even;
}

/* True if the rounding of a value to a float hardly shows: no function is steep, and no value is out of proportion to their range. */
static bool is_gentle(const tetra_case* c)
{
  const stratus_mesh* m = &c->mesh.view;
  const stratus_transfer* t = c->transfer;
  const double range = c->mesh.high - c->mesh.low;
  const stratus_volume row = { .values = m->values, .type = m->type, .value_stride = m->value_stride };
  bool gentle = range > 1e-3 * fmax(fabs(c->mesh.low), fabs(c->mesh.high)) && t->clamp && t->unit_distance > 0.3 * c->mesh.edge;
  for (int64_t i = 0; gentle && i < (m->cell_values ? m->cell_count : m->point_count); ++i) {
    const double value = fuzz_value_of(&row, (size_t)i);
    gentle = value >= c->mesh.low - range && value <= c->mesh.high + range;
  }
  return gentle && is_even(t->opacity, t->opacity_count, 1, range) && is_even(t->color, t->color_count, 3, range);
}

/* Compares with the other method, which must be close where no cells overlap. */
static void compare_methods(
  fuzz* f, stratus_context* context, stratus_tetra_caster* caster, const tetra_case* c, const stratus_image* image)
{
  tetra_case otherwise = *c;
  otherwise.options.method = c->options.method == STRATUS_TETRA_METHOD_MARCH ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH;
  const stratus_image other = fuzz_image_like(f, image);
  const stratus_status status = draw(f, context, caster, &otherwise, &other, NULL);
  EXPECT(status == STRATUS_OK, "the other method: %s", stratus_context_message(context));
  fuzz_check_image(f, &other, limits_of(c));
  const int numbers = 4 * image->width * image->height;
  double square = 0.0, largest = 0.0;
  for (int i = 0; i < numbers; ++i) {
    const double d = (double)image->rgba[i] - (double)other.rgba[i];
    square += d * d;
    largest = fmax(largest, fabs(d));
  }
  EXPECT(!c->mesh.sound || !is_gentle(c) || sqrt(square / numbers) < METHODS_DIFFER_MOST,
    "march and projection differ by %g, and %g at most", sqrt(square / numbers), largest);
  f->tally->compared += c->mesh.sound && is_gentle(c);
}

static void compare(fuzz* f, const tetra_case* c, const stratus_image* image, stratus_tetra_method drawn)
{
  fuzz_memory memory;
  stratus_context* context = fuzz_context(f, &memory);
  stratus_tetra_caster* caster = NULL;
  tetra_case other = *c;
  other.options.method = drawn;
  other.no_options = false;
  EXPECT(STATUS_OF(context, stratus_tetra_caster_create(context, &caster)) == STRATUS_OK, "no caster");
  ++f->tally->objects;
  if (fuzz_chance(f, 0.7)) {
    const stratus_image picture = fuzz_image_like(f, image);
    const stratus_status status = draw(f, context, caster, &other, &picture, NULL);
    EXPECT(status == STRATUS_OK, "a new caster draws it otherwise: %s", stratus_context_message(context));
    fuzz_check_same(f, image, &picture, true, "on a new caster");
  }
  if (!is_marched(c)) {
    compare_methods(f, context, caster, &other, image);
  }
  CALL(stratus_tetra_caster_destroy(caster));
  fuzz_context_close(f, context, &memory);
}

static void step(fuzz* f, stratus_tetra_caster* caster, const tetra_case* c)
{
  const int width = fuzz_integer(f, 1, fuzz_chance(f, 0.3) ? 24 : 10), height = fuzz_integer(f, 1, fuzz_chance(f, 0.3) ? 24 : 10);
  const bool right = width >= 1 && width <= 24 && height >= 1 && height <= 24;
  stratus_image image = fuzz_image(f, right ? width : 5, right ? height : 4, &c->camera);
  stratus_tetra_report* report = fuzz_output(f, sizeof *report);
  if (!right && (height < 1 || height > 65536)) {
    image.height = height;
  }
  image.rgba = fuzz_odd(f) ? NULL : image.rgba;
  if (fuzz_chance(f, 0.15)) {
    fuzz_trouble(f);
  }
  stratus_status status = draw(f, f->context, caster, c, &image, report);
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || troubled || !fuzz_is_tame(f) || !c->mesh.view.values, "%s", stratus_context_message(f->context));
  if (troubled && fuzz_is_tame(f)) {
    status = draw(f, f->context, caster, c, &image, report);
  }
  if (status != STRATUS_OK) {
    return;
  }
  fuzz_check_image(f, &image, limits_of(c));
  check_report(f, c, &image, report);
  if (fuzz_is_tame(f)) {
    compare(f, c, &image, report->method);
  }
}

void fuzz_tetra_pictures(fuzz* f)
{
  tetra_case c = { .mesh = fuzz_mesh(f, fuzz_chance(f, 0.2) ? 6 : 3) };
  stratus_tetra_caster* caster = NULL;
  stratus_mesh* m = &c.mesh.view;
  stratus_partition_result r;
  if (fuzz_is_tame(f) && fuzz_chance(f, 0.2)) {
    stratus_mesh shape = *m;
    c.partition = fuzz_partition(f, FUZZ_INPUT(f, shape), &r);
    if (c.partition && r.cell_count > 0) { /* values of the cut mesh: any will do */
      const fuzz_field field = c.mesh.row = fuzz_row(f, r.point_count);
      c.leaves = r.leaves;
      *m = (stratus_mesh){ .points = r.points,
        .point_count = r.point_count,
        .vertices = r.vertices,
        .cell_count = r.cell_count,
        .values = field.view.values,
        .type = field.view.type,
        .value_stride = field.view.value_stride };
      memcpy(m->matrix, shape.matrix, sizeof m->matrix);
      c.mesh.low = field.low;
      c.mesh.high = field.high;
    } else {
      CALL(stratus_partition_destroy(c.partition));
      c.partition = NULL;
    }
  }
  if (CREATE(&caster, stratus_tetra_caster_create(f->context, &caster)) == STRATUS_OK) {
    const uint64_t steps = 1 + fuzz_below(f, 3);
    choose_view(f, &c);
    for (uint64_t s = 0; s < steps; ++s) {
      step(f, caster, &c);
      choose_view(f, &c);
      if (fuzz_chance(f, 0.1)) {
        CALL(stratus_tetra_caster_release(caster));
      } else if (fuzz_chance(f, 0.2)) {
        fuzz_mesh_changes(f, &c.mesh);
      }
    }
  }
  CALL(stratus_tetra_caster_destroy(caster));
  CALL(stratus_partition_destroy(c.partition));
}
