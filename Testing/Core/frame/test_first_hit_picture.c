/* SPDX-License-Identifier: BSD-3-Clause
 * First-hit pictures compared with brute force over all voxels, of equal spacing and of coordinates. */
#define CASE_FULL_SIZE
#include "grid_case.h"

#include "volume.h"

static picture first;
static picture second;

/* ---- the oracle: the slabs of every effective voxel, one pixel after the other */

typedef struct oracle {
  const picture_case* c;
  double world_to_local[16]; /* local: along the grid's axes, from its origin, in the data's own lengths */
  uint8_t* effective;
} oracle;

/* Opacity of the transfer function by its definition: the last interval that begins at or below x decides. */
static double opacity_of(const stratus_transfer* transfer, double x)
{
  const double* p = transfer->opacity;
  const size_t n = transfer->opacity_count;
  if (x < p[0] || x > p[2 * n - 2]) {
    return transfer->clamp ? (x < p[0] ? p[1] : p[2 * n - 1]) : 0.0;
  }
  for (size_t i = n - 1; i > 0; --i) {
    if (p[2 * i - 2] <= x && p[2 * i - 2] < p[2 * i]) {
      return p[2 * i - 1] + (x - p[2 * i - 2]) / (p[2 * i] - p[2 * i - 2]) * (p[2 * i + 1] - p[2 * i - 1]);
    }
  }
  return p[1];
}

static void oracle_begin(const picture_case* c, oracle* o)
{
  double local_to_world[16];
  const int64_t* n = c->volume.dimensions;
  stratus_volume plain = c->volume;
  plain.cell_centered = 0;
  for (int a = 0; a < 3; ++a) {
    plain.spacing[a] = 1.0;
    plain.coordinates[a] = NULL;
  }
  stratus_volume_index_to_world(&plain, local_to_world);
  assert_true(stratus_matrix_invert_affine(local_to_world, o->world_to_local));
  o->c = c;
  o->effective = calloc((size_t)(n[0] * n[1] * n[2]), 1);
  for (size_t at = 0; at < (size_t)(n[0] * n[1] * n[2]); ++at) {
    const double value = reference_value_at(&c->volume, (int64_t)at);
    o->effective[at] = isfinite(value) && opacity_of(&c->transfer, value) > 0.0;
    o->effective[at] &= !c->options.mask.bytes || c->options.mask.bytes[at];
    if (c->cell_ghosts && c->volume.cell_centered) {
      o->effective[at] &= !(c->cell_ghosts[at] & (STRATUS_GHOST_HIDDEN_CELL | STRATUS_GHOST_DUPLICATE));
    }
  }
}

/* Ray of a pixel in world coordinates, and the interval of k in which it may hit. */
static void oracle_ray(const oracle* o, int x, int y, double from[3], double along[3], double* begin, double* end)
{
  const stratus_camera* camera = &o->c->camera;
  const double u = (2.0 * x + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * y + 1.0) / CASE_HEIGHT - 1.0;
  *begin = camera->near_k;
  *end = camera->far_k;
  for (int a = 0; a < 3; ++a) {
    const double sideways = u * camera->right[a] + v * camera->up[a];
    from[a] = camera->eye[a] + (camera->parallel ? sideways : 0.0);
    along[a] = camera->forward[a] + (camera->parallel ? 0.0 : sideways);
  }
  for (int p = 0; p < o->c->options.clipping.clip_plane_count; ++p) {
    const double* plane = o->c->options.clipping.clip_planes[p];
    const double height = plane[0] * from[0] + plane[1] * from[1] + plane[2] * from[2] + plane[3];
    const double slope = plane[0] * along[0] + plane[1] * along[1] + plane[2] * along[2];
    *begin = slope > 0.0 ? fmax(*begin, -height / slope) : *begin;
    *end = slope < 0.0 ? fmin(*end, -height / slope) : *end;
  }
}

/* Where voxel i ends along an axis: a value's halfway to its neighbours, a cell's at its coordinates. */
static void edges(const stratus_volume* v, int axis, int64_t i, double* lo, double* hi)
{
  const double* x = v->coordinates[axis];
  const int64_t last = v->dimensions[axis] - 1;
  if (!x) {
    *lo = v->spacing[axis] * ((double)i - (v->cell_centered ? 0.0 : 0.5));
    *hi = v->spacing[axis] * ((double)i + (v->cell_centered ? 1.0 : 0.5));
  } else if (v->cell_centered) {
    *lo = x[i];
    *hi = x[i + 1];
  } else {
    const double below = i > 0 ? x[i] - x[i - 1] : x[1] - x[0], above = i < last ? x[i + 1] - x[i] : x[last] - x[last - 1];
    *lo = x[i] - 0.5 * below;
    *hi = x[i] + 0.5 * above;
  }
}

/* Cuts begin..end to the box; returns false if nothing is left. */
static bool slabs(const double from[3], const double along[3], const double lo[3], const double hi[3], double* begin, double* end)
{
  for (int a = 0; a < 3; ++a) {
    const double t0 = (lo[a] - from[a]) / along[a], t1 = (hi[a] - from[a]) / along[a];
    *begin = fmax(*begin, fmin(t0, t1));
    *end = fmin(*end, fmax(t0, t1));
  }
  return *begin <= *end;
}

/* k of the first hit, or INFINITY if there is none; *voxel: its number. *doubtful: the ray enters another voxel at nearly the same place,
 * or hardly meets one. */
static double oracle_hit(const oracle* o, int x, int y, size_t* voxel, bool* doubtful)
{
  const int64_t* n = o->c->volume.dimensions;
  const double near = 1e-7;
  double world[3], toward[3], from[3], along[3], begin, end, best = INFINITY, next = INFINITY;
  oracle_ray(o, x, y, world, toward, &begin, &end);
  stratus_matrix_point(o->world_to_local, world, from);
  stratus_matrix_vector(o->world_to_local, toward, along);
  *doubtful = false;
  if (o->c->options.clipping.crop) {
    double lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      lo[a] = o->c->options.clipping.crop_bounds[2 * a] - o->c->volume.origin[a];
      hi[a] = o->c->options.clipping.crop_bounds[2 * a + 1] - o->c->volume.origin[a];
    }
    if (!slabs(from, along, lo, hi, &begin, &end)) {
      return INFINITY;
    }
  }
  for (size_t at = 0; at < (size_t)(n[0] * n[1] * n[2]); ++at) {
    if (o->effective[at]) {
      const int64_t i[3] = { (int64_t)at % n[0], (int64_t)at / n[0] % n[1], (int64_t)at / n[0] / n[1] };
      double lo[3], hi[3], t0 = begin, t1 = end;
      for (int a = 0; a < 3; ++a) {
        edges(&o->c->volume, a, i[a], &lo[a], &hi[a]);
      }
      const bool met = slabs(from, along, lo, hi, &t0, &t1);
      *doubtful |= fabs(t1 - t0) < near * (1.0 + fabs(t0)) && t0 < best;
      if (met && t0 < best) {
        next = best;
        best = t0;
        *voxel = at;
      } else if (met) {
        next = fmin(next, t0);
      }
    }
  }
  *doubtful |= next - best < near * (1.0 + fabs(best));
  return best;
}

static double length_of(const oracle* o, int x, int y)
{
  double from[3], along[3], begin, end;
  oracle_ray(o, x, y, from, along, &begin, &end);
  return sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
}

static void color_of(const picture_case* c, double x, double rgb[3])
{
  const double* p = c->transfer.color;
  const size_t n = c->transfer.color_count;
  size_t i = 0;
  while (i + 1 < n && p[4 * (i + 1)] <= x) {
    ++i;
  }
  const double t = i + 1 < n && x > p[4 * i] ? (x - p[4 * i]) / (p[4 * i + 4] - p[4 * i]) : 0.0;
  for (int channel = 1; channel < 4; ++channel) {
    rgb[channel - 1] = p[4 * i + (size_t)channel] + (t > 0.0 ? t * (p[4 * i + 4 + (size_t)channel] - p[4 * i + (size_t)channel]) : 0.0);
  }
}

/* A random case of few voxels, turned and sheared. */
static void create_case(stratus_context* context, uint32_t seed, picture_case* c)
{
  uint32_t s = seed;
  case_create_random(context, seed, c);
  for (int a = 0; a < 3; ++a) {
    c->volume.dimensions[a] = c->volume.dimensions[a] > 9 ? 3 + c->volume.dimensions[a] % 7 : c->volume.dimensions[a];
    c->volume.spacing[a] = case_uniform(&s, 0.5, 2.0);
    c->volume.origin[a] = case_uniform(&s, -5.0, 5.0);
    for (int b = 0; b < 3; ++b) {
      c->volume.matrix[4 * a + b] += case_uniform(&s, -0.3, 0.3) - (a == b && seed % 3 == 0 ? 1.9 : 0.0);
    }
  }
  case_camera(context, c, (int)(seed % 8), (int)(seed % 2));
  c->camera.near_k = seed % 5 == 0 ? 12.0 : c->camera.near_k;
  for (int a = 0; a < 6; ++a) {
    const int axis = a / 2;
    const double wide = c->volume.spacing[axis] * (double)c->volume.dimensions[axis];
    c->options.clipping.crop_bounds[a] = c->volume.origin[axis] + wide * (a % 2 ? case_uniform(&s, 0.5, 1.1) : case_uniform(&s, -0.1, 0.4));
  }
  if (c->options.clipping.clip_plane_count) { /* through the middle */
    double bounds[6];
    assert_int_equal(stratus_volume_bounds(context, &c->volume, bounds), STRATUS_OK);
    c->options.clipping.clip_planes[0][3] = 0.0;
    for (int a = 0; a < 3; ++a) {
      c->options.clipping.clip_planes[0][3] -= c->options.clipping.clip_planes[0][a] * 0.5 * (bounds[2 * a] + bounds[2 * a + 1]);
    }
  }
  c->options.mode = STRATUS_MODE_FIRST_HIT;
  c->options.light.shading.on = 0;
}

static void compare(const picture_case* c, const picture* p, uint32_t seed, int* hits, int* doubts)
{
  oracle o;
  oracle_begin(c, &o);
  for (int at = 0; at < CASE_PIXELS; ++at) {
    bool doubtful = false;
    size_t voxel = 0;
    double rgb[3];
    const double k = oracle_hit(&o, at % CASE_WIDTH, at / CASE_WIDTH, &voxel, &doubtful);
    if (doubtful) {
      ++*doubts;
      continue;
    }
    const double expected = k * length_of(&o, at % CASE_WIDTH, at / CASE_WIDTH);
    const float* rgba = p->rgba + 4 * at;
    if (!isfinite(k)) {
      assert_true(isinf(p->depth[at]) && rgba[0] == 0.0f && rgba[1] == 0.0f && rgba[2] == 0.0f && rgba[3] == 0.0f);
      continue;
    }
    ++*hits;
    if (!(fabs(p->depth[at] - expected) <= 1e-6 * fabs(expected))) { /* a float's digits */
      print_error("seed %u, pixel %d: depth %g instead of %g\n", seed, at, (double)p->depth[at], expected);
      fail();
    }
    color_of(c, reference_value_at(&c->volume, (int64_t)voxel), rgb);
    assert_true(rgba[3] == 1.0f && p->samples[at] == 1);
    for (int channel = 0; channel < 3; ++channel) {
      assert_true(fabs((double)rgba[channel] - rgb[channel]) < 1e-5);
    }
  }
  free(o.effective);
}

static void pixels_show_the_first_voxel_of_brute_force(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  int hits = 0, doubts = 0;
  for (uint32_t seed = 1; seed <= 80; ++seed) {
    picture_case c;
    create_case(context, seed, &c);
    c.options.skipping.structure = seed % 2 ? STRATUS_STRUCTURE_NONE : STRATUS_STRUCTURE_HYBRID;
    case_render(context, &c, &first);
    compare(&c, &first, seed, &hits, &doubts);
    case_destroy(&c);
  }
  print_message("             %d hits, %d doubtful\n", hits, doubts);
  assert_true(hits > 20000 && doubts < hits / 50);
  stratus_context_destroy(context);
}

/* A mask hides voxels, with ghosts or without, and a caster sees that it has changed, or that there is none any more. */
static void masks_hide_voxels(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  static uint8_t mask[64 * 64 * 64];
  int hits = 0, doubts = 0;
  for (uint32_t seed = 1; seed <= 40; ++seed) {
    uint32_t random = seed;
    stratus_ray_caster* caster = NULL;
    picture_case c;
    grid_case grid;
    create_case(context, seed, &c);
    if (seed % 3 == 0) {
      grid_case_set_random(context, seed, &c, &grid);
    }
    const size_t values = (size_t)(c.volume.dimensions[0] * c.volume.dimensions[1] * c.volume.dimensions[2]);
    assert_true(values <= sizeof mask);
    for (size_t i = 0; i < values; ++i) {
      mask[i] = case_random(&random) % 3 ? 255 : 0;
    }
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    c.options.skipping.structure = (stratus_structure)(seed % 6);
    case_render_with(context, caster, &c, &first);
    compare(&c, &first, seed, &hits, &doubts);
    c.options.mask.bytes = mask;
    case_render_with(context, caster, &c, &first);
    compare(&c, &first, seed, &hits, &doubts);
    memset(mask, 0, values / 2);
    ++c.options.mask.revision;
    c.options.skipping.audit = 1;
    case_render_with(context, caster, &c, &first);
    compare(&c, &first, seed, &hits, &doubts);
    assert_int_equal(first.report.differing_pixels, 0);
    c.options.mask.bytes = NULL;
    case_render_with(context, caster, &c, &first);
    compare(&c, &first, seed, &hits, &doubts);
    stratus_ray_caster_destroy(caster);
    case_destroy(&c);
  }
  print_message("             %d hits, %d doubtful\n", hits, doubts);
  assert_true(hits > 20000 && doubts < hits / 50);
  stratus_context_destroy(context);
}

/* Spacings up to 200:1, rising and falling, of values and cells, along one axis or all; in every structure, and the plain walk agrees. */
static void voxels_of_stretched_grids_are_met_where_they_are(void** state)
{
  (void)state;
  stratus_context* contexts[2] = { case_context("host", 2), case_context("host", 1) };
  int hits = 0, doubts = 0, falling = 0;
  for (uint32_t seed = 1; seed <= 80; ++seed) {
    picture_case c;
    grid_case grid;
    create_case(contexts[0], seed, &c);
    grid_case_set_random(contexts[0], seed, &c, &grid);
    for (int a = 0; a < 3; ++a) {
      falling += c.volume.coordinates[a] && c.volume.coordinates[a][0] > c.volume.coordinates[a][1];
    }
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(contexts[0], &c, &first);
    compare(&c, &first, seed, &hits, &doubts);
    c.options.skipping.audit = 1;
    for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      c.options.skipping.structure = (stratus_structure)structure;
      case_render(contexts[structure % 2], &c, &second);
      assert_int_equal(second.report.differing_pixels, 0);
      assert_memory_equal(first.rgba, second.rgba, sizeof first.rgba);
      assert_memory_equal(first.depth, second.depth, sizeof first.depth);
    }
    case_destroy(&c);
  }
  print_message("             %d hits, %d doubtful, %d axes fall\n", hits, doubts, falling);
  assert_true(hits > 20000 && doubts < hits / 50 && falling > 10);
  stratus_context_destroy(contexts[0]);
  stratus_context_destroy(contexts[1]);
}

/* Coordinates that halve are exact in doubles, so that not a bit of unlit pictures may differ; of lit ones, roundings. */
static void equal_coordinates_draw_the_picture_of_the_image(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (int kind = 0; kind < 8; ++kind) {
    uint32_t none = 0;
    picture_case c;
    grid_case grid;
    case_create(context, &c, STRATUS_INT16, 12, 11, 10, 5);
    c.options.mode = STRATUS_MODE_FIRST_HIT;
    c.volume.cell_centered = kind & 1;
    c.options.light.shading.on = kind >> 1 & 1;
    c.options.light.normals = kind >> 2 ? STRATUS_NORMALS_GRADIENT : STRATUS_NORMALS_FACES;
    for (int a = 0; a < 3; ++a) {
      c.volume.spacing[a] = 0.5;
    }
    case_camera(context, &c, kind, kind & 1);
    case_render(context, &c, &first);
    grid_case_set(&c, &grid, GRID_EQUAL, kind & 1 ? 7 : 5, 0.0, 0.5, 1.0, &none);
    case_render(context, &c, &second);
    assert_true(case_lit(&first) > case_share(300));
    assert_memory_equal(first.depth, second.depth, sizeof first.depth);
    for (int at = 0; at < 4 * CASE_PIXELS; ++at) {
      assert_true(fabsf(first.rgba[at] - second.rgba[at]) <= (c.options.light.shading.on ? 1e-5f : 0.0f));
    }
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

/* Differences of a square polynomial are exact on any spacing, so that light shows the field's own gradient. */
static void gradients_are_those_of_the_field(void** state)
{
  (void)state;
  enum { N = 12 };
  static double values[N * N * N];
  static const double opacity[] = { 6.0, 1.0, 6.0, 0.0 }, color[] = { 0.0, 1.0, 1.0, 1.0 };
  stratus_context* context = case_context("host", 2);
  for (int cells = 0; cells < 2; ++cells) {
    uint32_t none = 0;
    picture_case c;
    grid_case grid;
    oracle o;
    double at[3][N];
    int judged = 0;
    case_create(context, &c, STRATUS_FLOAT64, N, N, N, 5);
    c.volume.cell_centered = cells;
    c.volume.values = values;
    c.options.mode = STRATUS_MODE_FIRST_HIT;
    c.options.light.normals = STRATUS_NORMALS_GRADIENT;
    c.options.light.shading = (stratus_shading){ .on = 1, .diffuse = 1.0, .specular_power = 1.0, .light_count = 1 };
    c.options.light.shading.lights[0] = (stratus_light){ .vector = { 0.48, 0.64, 0.6 }, .color = { 1.0, 1.0, 1.0 } };
    c.transfer.opacity = opacity;
    c.transfer.opacity_count = 2;
    c.transfer.color = color;
    c.transfer.color_count = 1;
    grid_case_set(&c, &grid, GRID_GEOMETRIC, 7, -4.0, 1.0, 30.0, &none);
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < N; ++i) {
        at[a][i] = cells ? 0.5 * (grid.of[a][i] + grid.of[a][i + 1]) : grid.of[a][i];
      }
    }
    for (int i = 0; i < N * N * N; ++i) {
      const double x = at[0][i % N], y = at[1][i / N % N], z = at[2][i / N / N];
      values[i] = x * x + 0.5 * y * y + 2.0 * z * z - x; /* an ellipsoid shows */
    }
    case_camera(context, &c, 3, 0);
    case_render(context, &c, &first);
    oracle_begin(&c, &o);
    for (int pixel = 0; pixel < CASE_PIXELS; ++pixel) {
      bool doubtful = false;
      size_t voxel = 0;
      const double k = oracle_hit(&o, pixel % CASE_WIDTH, pixel / CASE_WIDTH, &voxel, &doubtful);
      const size_t i[3] = { voxel % N, voxel / N % N, voxel / N / N };
      const bool inner = i[0] % (N - 1) && i[1] % (N - 1) && i[2] % (N - 1);
      if (!isfinite(k) || doubtful || !inner) {
        continue;
      }
      double world[3], toward[3], begin, end, length = 0.0, facing = 0.0, cosine = 0.0;
      oracle_ray(&o, pixel % CASE_WIDTH, pixel / CASE_WIDTH, world, toward, &begin, &end);
      const double slope[3] = { 2.0 * at[0][i[0]] - 1.0, at[1][i[1]], 4.0 * at[2][i[2]] };
      for (int a = 0; a < 3; ++a) {
        length += slope[a] * slope[a];
        facing += slope[a] * toward[a];
        cosine += slope[a] * c.options.light.shading.lights[0].vector[a];
      }
      const double expected = fmax(0.0, (facing > 0.0 ? -cosine : cosine) / sqrt(length));
      assert_true(fabs((double)first.rgba[4 * pixel] - expected) < 2e-6); /* values are read as floats */
      judged += expected > 0.1;
    }
    print_message("             %s: %d pixels\n", cells ? "cells" : "values", judged);
    assert_true(judged > 50);
    free(o.effective);
    c.volume.values = c.values;
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

static void opaque_depth_ends_rays(void** state)
{
  (void)state;
  static float depth[CASE_PIXELS_MOST];
  stratus_context* context = case_context("host", 2);
  for (int parallel = 0; parallel < 2; ++parallel) {
    picture_case c;
    int before = 0, behind = 0;
    case_create(context, &c, STRATUS_FLOAT32, 9, 8, 7, 3);
    case_camera(context, &c, 2, parallel);
    c.options.mode = STRATUS_MODE_FIRST_HIT;
    c.camera.near_k = 5.0;
    c.camera.far_k = 80.0;
    case_render(context, &c, &first);
    for (int at = 0; at < CASE_PIXELS; ++at) { /* one half of the hits just behind, the other just before the opaque thing */
      const double u = (2.0 * (at % CASE_WIDTH) + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * (at / CASE_WIDTH) + 1.0) / CASE_HEIGHT - 1.0;
      double square = 0.0;
      for (int a = 0; a < 3; ++a) {
        const double d = c.camera.forward[a] + (parallel ? 0.0 : u * c.camera.right[a] + v * c.camera.up[a]);
        square += d * d;
      }
      const double k = (double)first.depth[at] / sqrt(square) + (at % 2 ? 0.01 : -0.01);
      depth[at] = isfinite(k) ? (float)(parallel ? (k - 5.0) / 75.0 : (80.0 - 80.0 * 5.0 / k) / 75.0) : 1.0f;
    }
    c.opaque_depth = depth;
    case_render(context, &c, &second);
    for (int at = 0; at < CASE_PIXELS; ++at) {
      const bool hit = isfinite(first.depth[at]);
      before += hit && at % 2;
      behind += hit && at % 2 == 0;
      assert_true(at % 2 || !hit ? memcmp(first.rgba + 4 * at, second.rgba + 4 * at, 16) == 0 : second.rgba[4 * at + 3] == 0.0f);
    }
    assert_true(before > 100 && behind > 100);
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

int test_first_hit_picture(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(pixels_show_the_first_voxel_of_brute_force),
    cmocka_unit_test(masks_hide_voxels),
    cmocka_unit_test(voxels_of_stretched_grids_are_met_where_they_are),
    cmocka_unit_test(equal_coordinates_draw_the_picture_of_the_image),
    cmocka_unit_test(gradients_are_those_of_the_field),
    cmocka_unit_test(opaque_depth_ends_rays),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
