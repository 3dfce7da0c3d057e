/* SPDX-License-Identifier: BSD-3-Clause
 * The reference's ray through several volumes. It knows no lattice, no table and no structure: between the places where the ray enters or
 * leaves a volume, or a cell of a mesh, it takes even steps, and at the middle of each asks every volume and cell. Steps whose halves show
 * otherwise are halved. */
#include "reference_several.h"

#include "reference_field.h"
#include "reference_shading.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Optical depth per unit length for opacity 1. */
#define WALL 1e9
/* Largest difference, of 1, between a part of a ray and its halves, and the largest number of halvings: edges of functions are sharp. */
#define PARTS_AGREE 1e-6
#define HALVINGS_MOST 24

typedef struct medium {
  const reference_scene* scene;
  reference_field field;
  reference_field parts[REFERENCE_COMPONENTS_MAX]; /* of each component, the field of its view */
  stratus_volume views[REFERENCE_COMPONENTS_MAX];
  reference_cell cell[REFERENCE_COMPONENTS_MAX];
  reference_gradients gradients[REFERENCE_COMPONENTS_MAX];
  double origin[3], direction[3]; /* of the ray, in index coordinates */
  double begin, end;
} medium;

typedef struct line {
  double origin[3], direction[3], begin, end;
} line;

static void keep_positive(double f0, double slope, double* begin, double* end)
{
  if (slope > 0.0) {
    *begin = fmax(*begin, -f0 / slope);
  } else if (slope < 0.0) {
    *end = fmin(*end, -f0 / slope);
  } else if (f0 < 0.0) {
    *end = -(double)INFINITY;
  }
}

/* A cell that a line passes: from begin to end, where the field is value + slope times the place. */
typedef struct passed_cell {
  const reference_mesh* of;
  int64_t cell;
  double begin, end, value, slope;
} passed_cell;

static line line_of(const stratus_camera* camera, double u, double v, const float* opaque)
{
  const double n = camera->near_k, f = camera->far_k;
  line r;
  double length = 0.0, far_k = f;
  for (int a = 0; a < 3; ++a) {
    const double side = u * camera->right[a] + v * camera->up[a];
    r.origin[a] = camera->eye[a] + (camera->parallel ? side : 0.0);
    r.direction[a] = camera->forward[a] + (camera->parallel ? 0.0 : side);
    length += r.direction[a] * r.direction[a];
  }
  length = sqrt(length);
  if (opaque) {
    const double depth = (double)*opaque;
    far_k = fmin(f, camera->parallel ? n + depth * (f - n) : n * f / (f - depth * (f - n)));
  }
  r.begin = n * length;
  r.end = far_k * length;
  for (int a = 0; a < 3; ++a) {
    r.direction[a] /= length;
  }
  return r;
}

/* Finds where the line is in a volume that is drawn. */
static void meet(medium* m, const line* r)
{
  const reference_field* f = &m->field;
  m->begin = r->begin;
  m->end = r->end;
  for (int i = 0; i < REFERENCE_COMPONENTS_MAX; ++i) {
    m->cell[i] = (reference_cell){ .at = { -1, -1, -1 } };
    memcpy(m->gradients[i].at, m->cell[i].at, sizeof m->gradients[i].at);
  }
  for (int a = 0; a < 3; ++a) {
    m->origin[a] = f->shift[a];
    m->direction[a] = 0.0;
    for (int b = 0; b < 3; ++b) {
      m->origin[a] += f->to_index[a][b] * (r->origin[b] - f->corner[b]);
      m->direction[a] += f->to_index[a][b] * r->direction[b];
    }
    keep_positive(m->origin[a] - f->lo[a], m->direction[a], &m->begin, &m->end);
    keep_positive(f->hi[a] - m->origin[a], -m->direction[a], &m->begin, &m->end);
  }
  for (int i = 0; i < m->scene->clip_plane_count; ++i) {
    const double* p = m->scene->clip_planes[i];
    keep_positive(p[0] * r->origin[0] + p[1] * r->origin[1] + p[2] * r->origin[2] + p[3],
      p[0] * r->direction[0] + p[1] * r->direction[1] + p[2] * r->direction[2], &m->begin, &m->end);
  }
}

/* Whether crop regions show position p, in index coordinates. */
static bool shows_region(const reference_scene* scene, const double p[3])
{
  int region = 0;
  for (int a = 2; a >= 0; --a) {
    const double low = reference_axis_crop(scene->volume, a, scene->crop_bounds[2 * a]),
                 high = reference_axis_crop(scene->volume, a, scene->crop_bounds[2 * a + 1]);
    region = 3 * region + (p[a] < low ? 0 : p[a] > high ? 2 : 1);
  }
  return !scene->crop || scene->crop_regions == 0 || (scene->crop_regions >> region & 1u);
}

/* Adds what one volume has at s: optical depth and light per length. */
static void add_medium(medium* m, const line* r, double s, double* tau, double glow[3])
{
  reference_place place = { .gradients = m->gradients };
  double p[3], values[REFERENCE_COMPONENTS_MAX], own_tau, own_glow[3];
  memcpy(place.to_index, m->field.to_index, sizeof place.to_index);
  memcpy(place.direction, r->direction, sizeof place.direction);
  for (int a = 0; a < 3; ++a) {
    p[a] = m->origin[a] + s * m->direction[a];
    place.spot[a] = reference_axis_find(m->field.volume, a, p[a]);
    place.world[a] = r->origin[a] + s * r->direction[a];
    place.at[a] = p[a];
  }
  if (!shows_region(m->scene, p)) {
    return;
  }
  for (int i = 0; i < reference_components(m->scene->volume); ++i) {
    values[i] = reference_field_sample(&m->parts[i], p, &m->cell[i]);
  }
  reference_shade(m->scene, &place, values, &own_tau, own_glow);
  *tau += own_tau;
  for (int a = 0; a < 3; ++a) {
    glow[a] += own_glow[a];
  }
}

/* Six times the signed volume of the tetrahedron of a and three vectors from it. */
static double determinant(const double a[3], const double b[3], const double c[3])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Where the line is in a cell: at weights, which are linear along it, of at least 0. Returns 0 if nowhere. */
static int meet_cell(const reference_mesh* of, int64_t cell, const line* r, passed_cell* passed)
{
  const stratus_mesh* mesh = of->mesh;
  const float* values = mesh->values;
  double p[4][3], edge[3][3], from[3], weight[4] = { 1.0, 0.0, 0.0, 0.0 }, slope[4] = { 0.0 };
  for (int i = 0; i < 4; ++i) {
    const double* at = mesh->points + 3 * (int64_t)mesh->vertices[4 * cell + i];
    for (int a = 0; a < 3; ++a) {
      const double* m = mesh->matrix + 4 * a;
      p[i][a] = m[0] * at[0] + m[1] * at[1] + m[2] * at[2] + m[3];
    }
  }
  for (int a = 0; a < 3; ++a) {
    from[a] = r->origin[a] - p[0][a];
    for (int i = 0; i < 3; ++i) {
      edge[i][a] = p[i + 1][a] - p[0][a];
    }
  }
  const double whole = determinant(edge[0], edge[1], edge[2]);
  if (whole == 0.0 || (mesh->hidden && mesh->hidden[cell])) {
    return 0;
  }
  for (int i = 0; i < 3; ++i) {
    const double *next = edge[(i + 1) % 3], *last = edge[(i + 2) % 3];
    weight[i + 1] = determinant(from, next, last) / whole;
    slope[i + 1] = determinant(r->direction, next, last) / whole;
    weight[0] -= weight[i + 1];
    slope[0] -= slope[i + 1];
  }
  *passed = (passed_cell){ of, cell, r->begin, r->end, 0.0, 0.0 };
  for (int i = 0; i < 4; ++i) {
    keep_positive(weight[i], slope[i], &passed->begin, &passed->end);
    const double value = mesh->cell_values ? (double)values[cell] / 4.0 : (double)values[mesh->vertices[4 * cell + i]];
    passed->value += mesh->cell_values ? value : weight[i] * value;
    passed->slope += mesh->cell_values ? 0.0 : slope[i] * value;
  }
  for (int i = 0; i < of->clip_plane_count; ++i) {
    const double* c = of->clip_planes[i];
    keep_positive(c[0] * r->origin[0] + c[1] * r->origin[1] + c[2] * r->origin[2] + c[3],
      c[0] * r->direction[0] + c[1] * r->direction[1] + c[2] * r->direction[2], &passed->begin, &passed->end);
  }
  return passed->begin < passed->end;
}

static void add_cell(const passed_cell* cell, const line* r, double s, double* tau, double glow[3])
{
  const stratus_transfer* transfer = cell->of->transfer;
  const double value = cell->value + s * cell->slope, opacity = reference_opacity(transfer, value);
  double own = fmin(-log1p(-opacity) / transfer->unit_distance, WALL), rgb[3];
  reference_color(transfer, value, rgb);
  if (cell->of->light && own > 0.0) {
    const double place[3] = { r->origin[0] + s * r->direction[0], r->origin[1] + s * r->direction[1], r->origin[2] + s * r->direction[2] };
    cell->of->light(cell->of->data, cell->cell, place, r->direction, rgb, &own);
  }
  *tau += own;
  for (int a = 0; a < 3; ++a) {
    glow[a] += own * rgb[a];
  }
}

static int ascending(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

/* A ray's media and cells, and where each begins and ends. */
typedef struct passage {
  medium* media;
  int count;
  passed_cell* cells;
  size_t cell_count;
  double* cuts;
} passage;

/* A part of a ray, taken as even: values per length at its middle. */
typedef struct part {
  double middle, length, tau, glow[3];
} part;

static part part_about(const passage* p, const line* r, double middle, double length)
{
  part at = { .middle = middle, .length = length };
  for (int m = 0; m < p->count; ++m) {
    if (middle > p->media[m].begin && middle < p->media[m].end) {
      add_medium(&p->media[m], r, middle, &at.tau, at.glow);
    }
  }
  for (size_t m = 0; m < p->cell_count; ++m) {
    if (middle > p->cells[m].begin && middle < p->cells[m].end) {
      add_cell(&p->cells[m], r, middle, &at.tau, at.glow);
    }
  }
  return at;
}

/* The composited light so far. */
typedef struct composited {
  double color[3], left, first;
} composited;

static void composite_part(const part* at, composited* so_far)
{
  if (at->tau > 0.0) {
    const double kept = -expm1(-at->tau * at->length);
    for (int a = 0; a < 3; ++a) {
      so_far->color[a] += so_far->left * kept * at->glow[a] / at->tau;
    }
    so_far->left *= 1.0 - kept;
    so_far->first = fmin(at->middle, so_far->first);
  }
}

/* Composites a part as two halves, or, where these show otherwise than it does, the halves in turn as theirs. */
static void composite_halves(const passage* p, const line* r, const part* whole, int deeper, composited* so_far)
{
  const double half = 0.5 * whole->length;
  const part near_half = part_about(p, r, whole->middle - 0.5 * half, half), far_half = part_about(p, r, whole->middle + 0.5 * half, half);
  composited as_one = *so_far, as_two = *so_far;
  composite_part(whole, &as_one);
  composite_part(&near_half, &as_two);
  composite_part(&far_half, &as_two);
  double apart = fabs(as_two.left - as_one.left);
  for (int a = 0; a < 3; ++a) {
    apart = fmax(apart, fabs(as_two.color[a] - as_one.color[a]));
  }
  if (apart <= PARTS_AGREE || deeper == 0) {
    *so_far = as_two;
    return;
  }
  composite_halves(p, r, &near_half, deeper - 1, so_far);
  composite_halves(p, r, &far_half, deeper - 1, so_far);
}

static double trace_several(const passage* p, const line* r, double longest, float pixel[4])
{
  composited so_far = { .left = 1.0, .first = (double)INFINITY };
  double* cuts = p->cuts;
  size_t n = 0;
  for (int i = 0; i < p->count; ++i) {
    meet(&p->media[i], r);
    if (p->media[i].begin < p->media[i].end) {
      cuts[n++] = p->media[i].begin;
      cuts[n++] = p->media[i].end;
    }
  }
  for (size_t i = 0; i < p->cell_count; ++i) {
    cuts[n++] = p->cells[i].begin;
    cuts[n++] = p->cells[i].end;
  }
  qsort(cuts, n, sizeof *cuts, ascending);
  for (size_t c = 1; c < n; ++c) {
    const double length = cuts[c] - cuts[c - 1];
    const int64_t steps = (int64_t)ceil(length / longest);
    for (int64_t i = 0; i < steps && so_far.left > 1e-12; ++i) {
      const part step = part_about(p, r, cuts[c - 1] + ((double)i + 0.5) * length / (double)steps, length / (double)steps);
      composite_halves(p, r, &step, HALVINGS_MOST, &so_far);
    }
  }
  for (int a = 0; a < 3; ++a) {
    pixel[a] = (float)so_far.color[a];
  }
  pixel[3] = (float)(1.0 - so_far.left);
  return so_far.first;
}

/* Draws a row of pixels. Returns 0, or -1 without memory. */
static int draw_row(
  const reference_mixture* mixture, const medium* media, int width, int height, int y, double step, float* rgba, float* depth)
{
  medium mine[REFERENCE_SEVERAL_MAX];
  size_t cells = 0;
  for (int m = 0; m < mixture->mesh_count; ++m) {
    cells += (size_t)mixture->meshes[m].mesh->cell_count;
  }
  memcpy(mine, media, sizeof mine);
  passage p = { .media = mine, .count = mixture->count };
  p.cells = calloc(cells + 1, sizeof *p.cells);
  p.cuts = calloc(2 * cells + 2 * REFERENCE_SEVERAL_MAX, sizeof *p.cuts);
  for (int x = 0; p.cells && p.cuts && x < width; ++x) {
    const size_t at = (size_t)y * (size_t)width + (size_t)x;
    const line r = line_of(mixture->camera, (2.0 * x + 1.0) / width - 1.0, (2.0 * y + 1.0) / height - 1.0,
      mixture->opaque_depth ? mixture->opaque_depth + at : NULL);
    p.cell_count = 0;
    for (int m = 0; m < mixture->mesh_count; ++m) {
      for (int64_t cell = 0; cell < mixture->meshes[m].mesh->cell_count; ++cell) {
        p.cell_count += (size_t)meet_cell(&mixture->meshes[m], cell, &r, &p.cells[p.cell_count]);
      }
    }
    const double first = trace_several(&p, &r, step, rgba + 4 * at);
    if (depth) {
      depth[at] = (float)first;
    }
  }
  const int result = p.cells && p.cuts ? 0 : -1;
  free(p.cells);
  free(p.cuts);
  return result;
}

int reference_render_mixture(const reference_mixture* mixture, int width, int height, double step, float* rgba, float* depth)
{
  medium media[REFERENCE_SEVERAL_MAX];
  int made = 0, failed = 0;
  while (made < mixture->count && reference_field_create(&mixture->scenes[made], &media[made].field) == 0) {
    media[made].scene = &mixture->scenes[made];
    for (int i = 0; i < reference_components(mixture->scenes[made].volume); ++i) {
      media[made].views[i] = reference_component(mixture->scenes[made].volume, i);
      media[made].parts[i] = media[made].field;
      media[made].parts[i].volume = &media[made].views[i];
    }
    ++made;
  }
  if (made == mixture->count) {
#pragma omp parallel for schedule(dynamic, 1) reduction(| : failed)
    for (int y = 0; y < height; ++y) {
      failed |= draw_row(mixture, media, width, height, y, step, rgba, depth);
    }
  }
  for (int i = 0; i < made; ++i) {
    reference_field_release(&media[i].field);
  }
  return made == mixture->count && !failed ? 0 : -1;
}

int reference_render_several(const reference_scene* scenes, int count, int width, int height, double step, float* rgba, float* depth)
{
  const reference_mixture mixture = {
    .scenes = scenes, .count = count, .camera = scenes[0].camera, .opaque_depth = scenes[0].opaque_depth
  };
  double edge = (double)INFINITY;
  for (int i = 0; i < count; ++i) {
    reference_field field;
    if (reference_field_create(&scenes[i], &field) != 0) {
      return -1;
    }
    edge = fmin(edge, field.edge);
    reference_field_release(&field);
  }
  return reference_render_mixture(&mixture, width, height, step * edge, rgba, depth);
}

int reference_converged_several(
  const reference_scene* scenes, int count, int width, int height, double wanted_db, float* rgba, float* depth, double* reference_db)
{
  const size_t pixels = (size_t)width * (size_t)height;
  float* coarse = malloc(4 * pixels * sizeof *coarse);
  int result = coarse ? reference_render_several(scenes, count, width, height, 0.25, rgba, depth) : -1;
  double agreement = -(double)INFINITY;
  for (double step = 0.125; result == 0 && step >= 1.0 / 512.0 && agreement < wanted_db + 10.0; step *= 0.5) {
    memcpy(coarse, rgba, 4 * pixels * sizeof *coarse);
    result = reference_render_several(scenes, count, width, height, step, rgba, depth);
    agreement = reference_psnr(coarse, rgba, pixels);
  }
  *reference_db = agreement;
  free(coarse);
  return result;
}
