/* SPDX-License-Identifier: BSD-3-Clause
 * First hits of tetrahedra, compared with a double reference that tries every cell: on random meshes with hollows, values of points and of
 * cells, cut by planes and boxes, stretched and mirrored, from outside and inside, lit by faces and by gradients.
 *
 * Only rounding is left: of a place, and of a value to the table's entries. A ray that grazes a cell's edge or the border of what shows may
 * hit another cell in one of the pictures. */
#include "tetra_light_case.h"

#include "tetra_caster.h"

#define CHANGED 0.02            /* of a channel: the hit is another one */
#define GRAZING_SHARE 0.01      /* of the pixels that show */
#define ERROR_MOST (0.02 / 255) /* root mean square of all others, in which normals turn by the rounding of points to floats */

static tetra_picture picture;
static double reference[4 * TETRA_PIXELS_MOST], depth[TETRA_PIXELS_MOST];

/* Where a stretch first shows, 0..1 being all of it; above 1: it does not. Between the points of its function an opacity is linear. */
static double first_shown(const tetra_case* c, const tetra_stretch* s)
{
  double begin = 0.0;
  if (linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, s->first) > 0.0) {
    return 0.0;
  }
  while (begin < 1.0) {
    double end = 1.0;
    for (size_t i = 0; i < c->transfer.opacity_count; ++i) {
      const double t = (c->transfer.opacity[2 * i] - s->first) / (s->last - s->first);
      end = t > begin + 1e-12 && t < end ? t : end;
    }
    const double x = s->first + 0.5 * (begin + end) * (s->last - s->first);
    if (linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, x) > 0.0) {
      return begin;
    }
    begin = end;
  }
  return 2.0;
}

static void world_of(const tetra_case* c, int64_t cell, double p[4][3])
{
  const double* m = c->mesh.matrix;
  for (int i = 0; i < 4; ++i) {
    const double* q = c->mesh.points + 3 * (int64_t)c->mesh.vertices[4 * cell + i];
    for (int a = 0; a < 3; ++a) {
      p[i][a] = m[4 * a] * q[0] + m[4 * a + 1] * q[1] + m[4 * a + 2] * q[2] + m[4 * a + 3];
    }
  }
}

static void cross(const double a[3], const double b[3], double out[3])
{
  for (int i = 0; i < 3; ++i) {
    out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  }
}

/* The normal of the cell's face that is nearest to the place. */
static void face_normal(const tetra_case* c, int64_t cell, const double x[3], double normal[3])
{
  double p[4][3], least = INFINITY;
  world_of(c, cell, p);
  for (int f = 0; f < 4; ++f) {
    double u[3], v[3], n[3], far = 0.0;
    for (int a = 0; a < 3; ++a) {
      u[a] = p[(f + 2) & 3][a] - p[(f + 1) & 3][a];
      v[a] = p[(f + 3) & 3][a] - p[(f + 1) & 3][a];
    }
    cross(u, v, n);
    tetra_unit(n);
    for (int a = 0; a < 3; ++a) {
      far += n[a] * (x[a] - p[(f + 1) & 3][a]);
    }
    if (fabs(far) < least) {
      least = fabs(far);
      memcpy(normal, n, sizeof n);
    }
  }
}

/* The gradient of the field within the cell. */
static void slope_of(const tetra_case* c, int64_t cell, double normal[3])
{
  double p[4][3], edge[3][3], rise[3];
  const int32_t* v = c->mesh.vertices + 4 * cell;
  world_of(c, cell, p);
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < 3; ++a) {
      edge[i][a] = p[i + 1][a] - p[0][a];
    }
    rise[i] = (double)c->values[v[i + 1]] - (double)c->values[v[0]];
  }
  tetra_solve((const double(*)[3])edge, rise, normal);
}

/* The normal of the clip plane, or of the box's side, at the place; against the ray if neither is there. */
static void cut_normal(const tetra_case* c, const double x[3], const double along[3], double normal[3])
{
  const double* m = c->mesh.matrix;
  double least = 1e-6, local[3], offset[3], rows[3][3];
  memcpy(normal, along, 3 * sizeof *normal);
  for (int p = 0; p < c->options.clip_plane_count; ++p) {
    const double* n = c->options.clip_planes[p];
    if (fabs(tetra_dot(n, x) + n[3]) < least) {
      least = fabs(tetra_dot(n, x) + n[3]);
      memcpy(normal, n, 3 * sizeof *normal);
    }
  }
  for (int a = 0; a < 3; ++a) {
    offset[a] = x[a] - m[4 * a + 3];
    memcpy(rows[a], m + 4 * a, sizeof rows[a]);
  }
  tetra_solve((const double(*)[3])rows, offset, local);
  for (int side = 0; c->options.crop && side < 6; ++side) {
    const double* u = (const double[3]){ m[(side / 2 + 1) % 3], m[4 + (side / 2 + 1) % 3], m[8 + (side / 2 + 1) % 3] };
    const double* v = (const double[3]){ m[(side / 2 + 2) % 3], m[4 + (side / 2 + 2) % 3], m[8 + (side / 2 + 2) % 3] };
    if (fabs(local[side / 2] - c->options.crop_bounds[side]) < least) {
      least = fabs(local[side / 2] - c->options.crop_bounds[side]);
      cross(u, v, normal);
    }
  }
}

/* Phong's light of one lamp at the eye. */
static void lit(const tetra_case* c, const double x[3], const double along[3], double normal[3], double rgb[3])
{
  const stratus_shading* s = &c->options.shading;
  double ray[3], to[3], mirrored[3];
  memcpy(ray, along, sizeof ray);
  tetra_unit(ray);
  tetra_unit(normal);
  const double turn = tetra_dot(normal, ray) > 0.0 ? -1.0 : 1.0;
  for (int a = 0; a < 3; ++a) {
    normal[a] *= turn;
    to[a] = c->camera.parallel ? -c->camera.forward[a] : c->camera.eye[a] - x[a];
  }
  tetra_unit(to);
  const double cosine = fmax(tetra_dot(normal, to), 0.0);
  for (int a = 0; a < 3; ++a) {
    mirrored[a] = 2.0 * cosine * normal[a] - to[a];
  }
  const double shine = cosine > 0.0 ? s->specular * pow(fmax(-tetra_dot(mirrored, ray), 0.0), s->specular_power) : 0.0;
  for (int a = 0; a < 3; ++a) {
    rgb[a] = rgb[a] * (s->ambient + s->diffuse * cosine) + shine;
  }
}

static void draw_reference(const tetra_case* c)
{
  tetra_space world = tetra_space_create(c, 1);
  for (int pixel = 0; pixel < TETRA_PIXELS; ++pixel) {
    const double u = (2.0 * (pixel % TETRA_WIDTH) + 1.0) / TETRA_WIDTH - 1.0, v = (2.0 * (pixel / TETRA_WIDTH) + 1.0) / TETRA_HEIGHT - 1.0;
    const stratus_camera* k = &c->camera;
    double origin[3], along[3], from = k->near_k, to = k->far_k, *out = reference + 4 * pixel, nearest = INFINITY, part = 0.0;
    int64_t of = -1;
    tetra_stretch hit = { 0 };
    bool cut = false;
    for (int a = 0; a < 3; ++a) {
      const double side = u * k->right[a] + v * k->up[a];
      origin[a] = k->eye[a] + (k->parallel ? side : 0.0);
      along[a] = k->forward[a] + (k->parallel ? 0.0 : side);
    }
    tetra_cut_ray(c, origin, along, &from, &to);
    for (int64_t cell = 0; cell < c->mesh.cell_count; ++cell) {
      tetra_stretch s, parts[7];
      const size_t count = tetra_meet(c, cell, origin, along, from, to, &s) ? tetra_crop(c, origin, along, &s, parts) : 0;
      for (size_t n = 0; n < count; ++n) {
        const double at = first_shown(c, parts + n), place = parts[n].from + at * (parts[n].to - parts[n].from);
        if (at <= 1.0 && place < nearest) {
          nearest = place;
          of = cell;
          hit = parts[n];
          part = at;
          cut = hit.from > s.from || fabs(s.from - from) < 1e-9 * (1.0 + fabs(from));
        }
      }
    }
    memset(out, 0, 4 * sizeof *out);
    depth[pixel] = nearest * sqrt(tetra_dot(along, along));
    if (of < 0) {
      continue;
    }
    const double value = hit.first + part * (hit.last - hit.first);
    for (size_t a = 0; a < 3; ++a) {
      out[a] = linear_between(c->transfer.color, c->transfer.color_count, 4, a + 1, value);
    }
    out[3] = 1.0;
    const double x[3] = { origin[0] + nearest * along[0], origin[1] + nearest * along[1], origin[2] + nearest * along[2] };
    double normal[3];
    if (part == 0.0 && cut) {
      cut_normal(c, x, along, normal);
    } else if (c->options.normals == STRATUS_NORMALS_GRADIENT) {
      tetra_gradient_at(c, &world, &world, of, x, normal);
    } else if (part > 0.0) {
      slope_of(c, of, normal);
    } else {
      face_normal(c, of, x, normal);
    }
    if (c->options.shade) {
      lit(c, x, along, normal, out);
    }
    for (int a = 0; a < 3; ++a) {
      out[a] = fmin(out[a], 1.0);
    }
  }
  tetra_space_destroy(&world);
}

static void is_right(stratus_context* context, const tetra_case* c, const char* what)
{
  int shown = 0, grazing = 0, far = 0;
  double squares = 0.0;
  draw_reference(c);
  tetra_draw(context, c, &picture);
  for (int i = 0; i < TETRA_PIXELS; ++i) {
    double most = 0.0, sum = 0.0;
    for (int a = 0; a < 4; ++a) {
      const double d = (double)picture.rgba[4 * i + a] - reference[4 * i + a];
      most = fmax(most, fabs(d));
      sum += d * d;
      assert_true(abs((int)picture.rgba8[4 * i + a] - (int)(255.0f * picture.rgba[4 * i + a] + 0.5f)) <= 0);
    }
    const bool either = reference[4 * i + 3] > 0.0 || picture.rgba[4 * i + 3] > 0.0f;
    shown += either;
    grazing += most > CHANGED;
    squares += most > CHANGED ? 0.0 : sum;
    far += most <= CHANGED && either && fabs((double)picture.depth[i] - depth[i]) > 1e-3 * depth[i];
    assert_true(either || isinf((double)picture.depth[i]));
  }
  const double error = sqrt(squares / fmax(4.0 * shown, 1.0));
  print_message("             %s: %d pixels, %d of another hit, %d at another depth, others within %.3f of 255\n", what, shown, grazing,
    far, 255.0 * error);
  assert_true(shown > TETRA_PIXELS / 40);
  assert_true(grazing + far <= (int)(GRAZING_SHARE * shown) + 1);
  assert_true(error < ERROR_MOST);
}

static void make_case(stratus_context* context, tetra_case* c, uint32_t seed)
{
  static const double planes[2][4] = { { 0.3, -0.5, 0.8, -0.9 }, { -1.0, 0.1, -0.2, 3.1 } };
  static const double bounds[6] = { 0.4, 3.3, -INFINITY, 2.9, 0.6, 3.6 };
  static const double matrix[16] = { 0.9, -0.3, 0.1, 0.2, 0.4, 0.8, 0.0, -0.3, 0.1, 0.2, -1.1, 4.2, 0, 0, 0, 1 };
  static const double opacity[8] = { 0.0, 0.0, 0.35, 0.0, 0.6, 0.7, 0.8, 0.0 };
  tetra_create(c, 4, 0.2, seed % 3 == 0 ? 0.25 : 0.0, seed);
  memcpy(c->opacity, opacity, sizeof opacity); /* values below .35 do not show, nor above .8 */
  c->options.mode = STRATUS_TETRA_FIRST_HIT;
  c->options.normals = seed % 2 ? STRATUS_NORMALS_GRADIENT : STRATUS_NORMALS_FACES;
  c->options.shade = seed != 4;
  c->options.shading.specular = 0.3;
  c->mesh.cell_values = seed % 4 >= 2;
  c->options.clip_plane_count = (int)(seed % 3);
  memcpy(c->options.clip_planes, planes, sizeof planes);
  memcpy(c->options.crop_bounds, bounds, sizeof bounds);
  c->options.crop = seed % 5 == 1 || seed == 2 || seed == 9;
  c->options.crop_regions = seed % 5 == 1 ? STRATUS_CROP_INSIDE : 0x5a3e9d6;
  if (seed % 4 == 1) { /* sheared and mirrored */
    memcpy(c->mesh.matrix, matrix, sizeof matrix);
  }
  tetra_camera(context, c, 4, (int)(seed % 8), seed % 7 == 3);
  if (seed == 8 || seed == 10) { /* from inside */
    for (int a = 0; a < 3; ++a) {
      c->camera.eye[a] = 1.9 + 0.1 * a;
    }
    c->camera.near_k = 0.2;
  }
}

static void hits_are_right(void** state)
{
  for (uint32_t seed = 0; seed < 16; ++seed) {
    tetra_case c;
    char what[60];
    make_case(*state, &c, seed);
    (void)snprintf(what, sizeof what, "mesh %u, values of %s, %s", seed, c.mesh.cell_values ? "cells" : "points",
      c.options.normals == STRATUS_NORMALS_GRADIENT ? "gradients" : "faces");
    is_right(*state, &c, what);
    tetra_destroy(&c);
  }
}

/* Lattices, whose cells are not listed, and rays that end at opaque geometry. */
static void lattices_and_opaque_geometry(void** state)
{
  static tetra_picture whole;
  static float opaque[TETRA_PIXELS_MOST];
  for (uint32_t seed = 0; seed < 4; ++seed) {
    tetra_case c;
    make_case(*state, &c, 2 * seed + 1);
    c.options.crop = c.options.clip_plane_count = 0;
    c.mesh.cell_values = 0;
    c.camera.near_k = 2.0;
    c.camera.far_k = 30.0;
    tetra_draw(*state, &c, &whole);
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      const double k = 0.5 * (c.camera.near_k + c.camera.far_k), n = c.camera.near_k, f = c.camera.far_k;
      opaque[i] = (float)(c.camera.parallel ? (k - n) / (f - n) : f * (k - n) / (k * (f - n)));
    }
    c.opaque_depth = opaque;
    tetra_draw(*state, &c, &picture);
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      const bool hidden = !(picture.rgba[4 * i + 3] > 0.0f);
      assert_true(hidden || memcmp(picture.rgba + 4 * i, whole.rgba + 4 * i, 4 * sizeof(float)) == 0);
      assert_true(!hidden || isinf((double)picture.depth[i]));
    }
    c.opaque_depth = NULL;
    if ((2 * seed + 1) % 3 != 0) { /* no cell is missing */
      tetra_as_lattice(&c, 4);
      tetra_draw(*state, &c, &picture);
      int differ = 0;
      for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
        differ += fabsf(picture.rgba[i] - whole.rgba[i]) > 1e-4f;
      }
      assert_true(differ < TETRA_PIXELS / 50);
    }
    tetra_destroy(&c);
  }
}

static void wrong_requests_are_refused(void** state)
{
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  tetra_case c;
  make_case(*state, &c, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  c.options.method = STRATUS_TETRA_METHOD_PROJECT;
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_UNSUPPORTED);
  assert_non_null(strstr(stratus_context_message(*state), "mode first-hit cannot be projected"));
  c.options.method = STRATUS_TETRA_METHOD_AUTO;
  c.options.normals = (stratus_normals)2;
  assert_int_equal(
    stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "normals 2 outside 0..1"));
  c.options.normals = STRATUS_NORMALS_FACES;
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
  assert_string_equal(report.why, "march: mode first-hit cannot be projected");
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

int test_tetra_first_hit(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(hits_are_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(lattices_and_opaque_geometry, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(wrong_requests_are_refused, tetra_start, tetra_stop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
