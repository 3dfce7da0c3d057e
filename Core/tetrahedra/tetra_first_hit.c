/* SPDX-License-Identifier: BSD-3-Clause
 * First hits of tetrahedra. Rays march to the first cell of which a seen part shows, and store its points (tetra_hit() in
 * kernels/tetrahedra/tetra_march.h). From these the place in the cell, its colour and its light are found here, in double. */
#include "tetra_caster.h"

#include "camera.h"
#include "lights.h"
#include "matrix.h"
#include "picture.h"
#include "vector.h"

#include <string.h>

/* A cell whose volume is this part of its extent's cube is flat: its field has no slope. */
#define FLATTEST 1e-14

typedef struct hits {
  const stratus_tetra_frame* frame;
  const stratus_tetra_caster* caster;
  const stratus_transfer* transfer;
  const stratus_tetra_options* options;
  double planes[TETRA_PLANES + 6][4]; /* that cut rays, in the world, relative to the eye; then those between crop regions */
  int plane_count, crop_count;        /* of the first, and of the second */
  double to_normal[9];                /* takes gradients in local coordinates to the world */
  const float* gradients;             /* of points */
  bool smooth;                        /* normals are the gradients of points */
  bool dependent;                     /* values are of dependent components */
  stratus_lamps lamps;
} hits;

/* Where a part begins or a place is: a plane's number, or one of these. */
#define CUT_NEAR (-1)
#define CUT_NONE (-2)
#define PARTS 4 /* as many as six planes leave of a ray, see crop_pieces() in kernels/base/crop.h */

/* A seen part of a ray. */
typedef struct hit_part {
  double begin, end;
  int cut; /* where it begins */
} hit_part;

/* Places are relative to the eye; the ray is at from + k along. */
typedef struct hit_ray {
  double from[3], along[3], length;
  hit_part parts[PARTS];
  int count;
} hit_ray;

typedef struct hit_cell {
  int32_t name[4];
  double p[4][3], value[4]; /* the first three points are those of the face by which the ray enters */
  double slope[4][3];       /* the gradients of the points' weights, of values of points */
  bool flat;
} hit_cell;

/* ---- the ray and its cell */

/* Whether a place of a ray is in a crop region that shows. */
static bool in_region(const hits* h, const hit_ray* ray, double k)
{
  int region = 0;
  for (int axis = 2; axis >= 0; --axis) {
    int above = 0; /* how many of the axis's planes the place is above */
    for (int side = 0; side < 2; ++side) {
      const double* plane = h->planes[TETRA_PLANES + 2 * axis + side];
      above += stratus_vector_dot(plane, ray->from) + plane[3] + k * stratus_vector_dot(plane, ray->along) >= 0.0;
    }
    region = 3 * region + above;
  }
  return h->options->crop_regions >> region & 1;
}

/* Cuts the seen part of a ray at the planes between crop regions. */
static void take_parts(const hits* h, hit_part whole, hit_ray* ray)
{
  hit_part cuts[7] = { whole };
  int count = 1;
  for (int side = 0; side < h->crop_count; ++side) {
    const double* plane = h->planes[TETRA_PLANES + side];
    const double start = stratus_vector_dot(plane, ray->from) + plane[3], rise = stratus_vector_dot(plane, ray->along);
    const double k = rise != 0.0 ? -start / rise : INFINITY;
    int at = count;
    if (!(k > whole.begin && k < whole.end)) {
      continue;
    }
    for (; at > 1 && cuts[at - 1].begin > k; --at) {
      cuts[at] = cuts[at - 1];
    }
    cuts[at] = (hit_part){ k, INFINITY, TETRA_PLANES + side };
    ++count;
  }
  ray->count = h->crop_count > 0 ? 0 : 1;
  ray->parts[0] = whole;
  bool before = false;
  for (int i = 0; h->crop_count > 0 && i < count; ++i) {
    const double end = i + 1 < count ? cuts[i + 1].begin : whole.end, begin = cuts[i].begin;
    const bool shows = begin < end && in_region(h, ray, end < INFINITY ? 0.5 * (begin + end) : begin + 1.0);
    if (shows && !before && ray->count < PARTS) {
      ray->parts[ray->count++] = cuts[i];
    }
    if (shows) {
      ray->parts[ray->count - 1].end = end;
    }
    before = begin < end ? shows : before;
  }
}

static void take_ray(const hits* h, int x, int y, hit_ray* ray)
{
  const stratus_camera* camera = &h->frame->camera;
  const int sides[2] = { h->frame->image.width, h->frame->image.height };
  stratus_camera_ray(camera, sides, x, y, ray->from, ray->along);
  ray->length = sqrt(stratus_vector_dot(ray->along, ray->along));
  hit_part whole = { camera->near_k, INFINITY, CUT_NEAR };
  for (int p = 0; p < h->plane_count; ++p) {
    const double start = stratus_vector_dot(h->planes[p], ray->from) + h->planes[p][3], rise = stratus_vector_dot(h->planes[p], ray->along);
    if (rise > 0.0 && -start / rise > whole.begin) {
      whole.begin = -start / rise;
      whole.cut = p;
    }
  }
  take_parts(h, whole, ray);
}

static void take_cell(const hits* h, const float stored[4], hit_cell* cell)
{
  const stratus_tetra_frame* frame = h->frame;
  const int points = frame->cell_values ? 3 : 4; /* of cells, the fourth number is the cell's own */
  double edge[3][3], size = 0.0;
  memcpy(cell->name, stored, sizeof cell->name);
  for (int i = 0; i < 4; ++i) {
    cell->name[i] -= TETRA_HIT_NAME;
  }
  for (int i = 0; i < points; ++i) {
    const float* place = frame->places + 4 * (size_t)cell->name[i];
    cell->value[i] = (double)(frame->cell_values ? frame->cell_values[cell->name[3]] : place[3]);
    for (int axis = 0; axis < 3; ++axis) {
      cell->p[i][axis] = frame->middle * frame->camera.forward[axis];
      for (int row = 0; row < 3; ++row) {
        cell->p[i][axis] += (double)place[row] * frame->basis[row][axis];
      }
    }
  }
  for (int i = 1; i < points; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      edge[i - 1][axis] = cell->p[i][axis] - cell->p[0][axis];
      size = fmax(size, fabs(edge[i - 1][axis]));
    }
  }
  stratus_vector_cross(edge[0], edge[1], cell->slope[3]);
  cell->flat = true;
  if (points == 4) {
    const double volume = stratus_vector_dot(cell->slope[3], edge[2]);
    stratus_vector_cross(edge[1], edge[2], cell->slope[1]);
    stratus_vector_cross(edge[2], edge[0], cell->slope[2]);
    cell->flat = !(fabs(volume) > FLATTEST * size * size * size);
    for (int axis = 0; axis < 3 && !cell->flat; ++axis) {
      for (int i = 1; i < 4; ++i) {
        cell->slope[i][axis] /= volume;
      }
      cell->slope[0][axis] = -cell->slope[1][axis] - cell->slope[2][axis] - cell->slope[3][axis];
    }
  }
}

/* Returns k where the ray passes the plane of the face by which it enters. */
static double entry(const hit_ray* ray, const hit_cell* cell)
{
  const double to[3] = { cell->p[0][0] - ray->from[0], cell->p[0][1] - ray->from[1], cell->p[0][2] - ray->from[2] };
  const double slope = stratus_vector_dot(cell->slope[3], ray->along);
  return slope != 0.0 ? stratus_vector_dot(cell->slope[3], to) / slope : stratus_vector_dot(ray->along, to) / (ray->length * ray->length);
}

/* The weights of the cell's points at k; of those of its face only, if it has no volume or the values are of cells. */
static void weigh(const hit_ray* ray, const hit_cell* cell, double k, double weight[4])
{
  double to[4][3], area[3], sum = 0.0;
  for (int i = 0; i < (cell->flat ? 3 : 1); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      to[i][axis] = cell->p[i][axis] - ray->from[axis] - k * ray->along[axis];
    }
  }
  weight[3] = 0.0;
  for (int i = 0; i < 3 && cell->flat; ++i) {
    stratus_vector_cross(to[(i + 1) % 3], to[(i + 2) % 3], area);
    weight[i] = fmax(stratus_vector_dot(area, cell->slope[3]), 0.0) + 1e-300;
    sum += weight[i];
  }
  for (int i = 0; i < 4; ++i) {
    weight[i] = cell->flat ? weight[i] / sum : (double)(i == 0) - stratus_vector_dot(cell->slope[i], to[0]);
  }
}

static double value_at(const hit_ray* ray, const hit_cell* cell, double k)
{
  double weight[4], value = 0.0;
  weigh(ray, cell, k, weight);
  for (int i = 0; i < (cell->flat ? 3 : 4); ++i) {
    value += weight[i] * cell->value[i];
  }
  return value;
}

/* ---- the place */

typedef struct hit_place {
  double k, value;
  int cut;     /* where the ray's part begins, if that is within the cell, and so is the place; or CUT_NONE */
  bool inside; /* the field begins to show within the cell */
} hit_place;

static int entry_of(const stratus_table* table, double value)
{
  return (int)fmin(fmax(floor(value * (double)table->scale + (double)table->offset), 0.0), (double)(table->size - 1));
}

/* Finds the first place of a cell that shows on a part of the ray. Returns false if there is none. */
static bool find_on_part(const hits* h, const hit_ray* ray, const hit_cell* cell, const hit_part* part, hit_place* place)
{
  const stratus_table* table = h->caster->look.table;
  const double enters = entry(ray, cell);
  double end = part->end;
  *place = (hit_place){ .k = fmax(enters, part->begin), .cut = part->begin > enters ? part->cut : CUT_NONE };
  place->value = value_at(ray, cell, place->k);
  for (int i = 0; i < 4 && !cell->flat; ++i) {
    double weight[4];
    const double fall = stratus_vector_dot(cell->slope[i], ray->along);
    weigh(ray, cell, enters, weight);
    end = fall < 0.0 ? fmin(end, enters - fmax(weight[i], 0.0) / fall) : end;
  }
  if (cell->flat || !(end > place->k) || !(end < INFINITY)) {
    return end > place->k;
  }
  const double last = value_at(ray, cell, end);
  const bool rises = last > place->value;
  const int first_entry = entry_of(table, place->value), last_entry = entry_of(table, last);
  const int32_t* shown = h->caster->look.sums + (rises ? 8 : 9) * (size_t)table->size;
  const int met = shown[first_entry]; /* the nearest entry that shows in this direction, see stratus_tetra_shown_sums() */
  if (met != first_entry) {
    const int into = rises ? (met < last_entry ? met : last_entry) : (met > last_entry ? met : last_entry);
    const double border = ((double)(rises ? into : into + 1) - (double)table->offset) / (double)table->scale;
    const double share = last != place->value ? (border - place->value) / (last - place->value) : 0.0;
    place->k += fmin(fmax(share, 0.0), 1.0) * (end - place->k);
    place->value = ((double)into + 0.5 - (double)table->offset) / (double)table->scale; /* at its border a function may jump */
    place->cut = CUT_NONE;
    place->inside = true;
    return into == met;
  }
  return true;
}

/* Finds the hit. Where no part shows by these numbers, the march's floats have found another: then the first that meets the cell counts. */
static hit_place find_place(const hits* h, const hit_ray* ray, const hit_cell* cell)
{
  hit_place found, place;
  bool any = find_on_part(h, ray, cell, ray->parts, &found);
  for (int part = 1; part < ray->count && !any; ++part) {
    any = find_on_part(h, ray, cell, ray->parts + part, &place);
    found = any ? place : found;
  }
  return found;
}

/* ---- its normal and colour */

/* The field's gradient at a place, in the world, by those of points. Returns false if it is 0. */
static bool smooth_normal(const hits* h, const hit_ray* ray, const hit_cell* cell, double k, double normal[3])
{
  double weight[4], gradient[3] = { 0.0, 0.0, 0.0 };
  weigh(ray, cell, k, weight);
  for (int i = 0; i < (cell->flat ? 3 : 4); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      gradient[axis] += weight[i] * (double)h->gradients[4 * (size_t)cell->name[i] + (size_t)axis];
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis] = stratus_vector_dot(h->to_normal + 3 * axis, gradient);
  }
  return stratus_vector_normalize(normal) > 0.0;
}

static bool facet_normal(const hit_cell* cell, double normal[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis] = 0.0;
    for (int i = 0; i < 4; ++i) {
      normal[axis] += cell->value[i] * cell->slope[i][axis];
    }
  }
  return stratus_vector_normalize(normal) > 0.0;
}

static void find_normal(const hits* h, const hit_ray* ray, const hit_cell* cell, const hit_place* place, double normal[3])
{
  const bool cut = place->cut != CUT_NONE;
  if (cut) {
    memcpy(normal, place->cut == CUT_NEAR ? ray->along : h->planes[place->cut], 3 * sizeof *normal);
  }
  if (cut || !((h->smooth && smooth_normal(h, ray, cell, place->k, normal)) || (place->inside && facet_normal(cell, normal)))) {
    memcpy(normal, cut ? normal : cell->slope[3], 3 * sizeof *normal);
    (void)stratus_vector_normalize(normal);
  }
  const double sign = stratus_vector_dot(normal, ray->along) > 0.0 ? -1.0 : 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis] *= sign;
  }
}

/* Finds the colour of a place. Of dependent components the last one's function is not asked: the others have the colour. */
static void find_color(const hits* h, const hit_ray* ray, const hit_cell* cell, const hit_place* place, double shown[4])
{
  const stratus_tetra_components* m = &h->caster->components;
  double value = place->value + h->caster->mesh->bias;
  if (h->dependent) {
    double weight[4], at[4] = { 0.0, 0.0, 0.0, 0.0 };
    const bool own = h->frame->cell_values != NULL;
    weigh(ray, cell, place->k, weight);
    for (int i = 0; i < (own ? 1 : cell->flat ? 3 : 4); ++i) {
      const float* places = m->places + 4 * (size_t)cell->name[own ? 3 : i];
      for (int c = 0; c < m->count; ++c) {
        at[c] += (own ? 1.0 : weight[i]) * (double)places[c];
      }
    }
    memcpy(shown, at, 3 * sizeof *shown);
    value = m->scale[0] > 0.0f ? (at[0] - (double)m->offset[0]) / (double)m->scale[0] + m->bias[0] : m->bias[0] + (double)m->low;
  }
  if (!h->dependent || m->count == 2) {
    stratus_transfer_at(h->transfer, value, shown);
  }
}

/* Replaces a pixel's stored cell by the colour of the hit. Returns its depth. */
static float shade(const hits* h, int x, int y, float rgba[4])
{
  hit_ray ray;
  hit_cell cell;
  double shown[4], normal[3], direction[3], point[3];
  if (!(rgba[3] > 0.0f)) {
    return INFINITY;
  }
  take_ray(h, x, y, &ray);
  take_cell(h, rgba, &cell);
  const hit_place place = find_place(h, &ray, &cell);
  find_color(h, &ray, &cell, &place, shown);
  if (h->options->shade) {
    find_normal(h, &ray, &cell, &place, normal);
    for (int axis = 0; axis < 3; ++axis) {
      direction[axis] = ray.along[axis] / ray.length;
      point[axis] = h->frame->camera.eye[axis] + ray.from[axis] + place.k * ray.along[axis];
    }
    stratus_lamps_shine(&h->lamps, point, normal, direction, shown);
  }
  for (int c = 0; c < 3; ++c) {
    rgba[c] = (float)fmin(fmax(shown[c], 0.0), 1.0);
  }
  rgba[3] = 1.0f;
  return (float)(place.k * ray.length);
}

void stratus_tetra_hits_shade(const stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_tetra_options* options, const stratus_image* image)
{
  hits h = { .frame = frame, .caster = caster, .transfer = transfer, .options = options, .dependent = stratus_tetra_mixes(mesh, options) };
  double inverse[16];
  h.plane_count = stratus_tetra_planes(mesh, options, h.planes);
  h.crop_count = stratus_tetra_crop_planes(mesh, options, h.planes + TETRA_PLANES);
  for (int p = 0; p < TETRA_PLANES + h.crop_count; ++p) {
    h.planes[p][3] += stratus_vector_dot(h.planes[p], frame->camera.eye);
  }
  const int of = h.dependent ? caster->components.count - 1 : 0, set = caster->gradients.set[of] > 0 ? caster->gradients.set[of] : 0;
  h.gradients = caster->gradients.vectors ? caster->gradients.vectors + 4 * (size_t)caster->mesh->point_count * (size_t)set : NULL;
  h.smooth = options->normals == STRATUS_NORMALS_GRADIENT && h.gradients && stratus_matrix_invert_affine(mesh->matrix, inverse);
  for (int i = 0; i < 9 && h.smooth; ++i) { /* normals transform by the inverse's transpose */
    h.to_normal[i] = inverse[4 * (i % 3) + i / 3];
  }
  if (options->shade) {
    stratus_lamps_set(&frame->camera, &options->shading, &h.lamps);
  }
#pragma omp parallel for num_threads(caster->context->threads)
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
      const float depth = shade(&h, x, y, image->rgba + 4 * at);
      if (image->depth) {
        image->depth[at] = depth;
      }
    }
  }
  stratus_image_fill_bytes(image);
}
