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

/* A field whose hits are looked for: the mesh's own values, or an independent component's values. */
typedef struct hit_field {
  const stratus_transfer* transfer;
  const float* places;  /* of a component's values in its table, four floats apart; NULL: the mesh's own values */
  const int32_t* shown; /* two rows of stratus_tetra_shown_sums() */
  int size;             /* of the table, to whose entries scale and offset take values; where the scale is 0, all are the least */
  double scale, offset, least;
  double bias;
  const float* gradients; /* of points */
  bool smooth;            /* normals are the gradients of points */
  bool lit;
  stratus_shading shading;
  stratus_lamps lamps;
} hit_field;

typedef struct hits {
  const stratus_tetra_frame* frame;
  const stratus_tetra_caster* caster;
  const stratus_tetra_options* options;
  hit_field fields[STRATUS_COMPONENTS_MAX];
  int field_count;                    /* several: the nearest of their hits counts */
  double planes[TETRA_PLANES + 6][4]; /* that cut rays, in the world, relative to the eye; then those between crop regions */
  int plane_count, crop_count;        /* of the first, and of the second */
  double to_normal[9];                /* takes gradients in local coordinates to the world */
  bool dependent;                     /* values are of dependent components */
} hits;

/* Where a part begins or a place is: a plane's number, or one of these. */
#define CUT_NEAR (-1)
#define CUT_NONE (-2)

/* A seen part of a ray. */
typedef struct hit_part {
  double begin, end;
  int cut; /* where it begins */
} hit_part;

/* Places are relative to the eye; the ray is at from + k along. */
typedef struct hit_ray {
  double from[3], along[3], length;
  hit_part parts[CROP_PIECES];
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
    if (shows && !before && ray->count < CROP_PIECES) {
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

static void take_values(const hits* h, const hit_field* field, hit_cell* cell)
{
  const float* own = h->frame->cell_values;
  for (int i = 0; i < (own ? 3 : 4); ++i) {
    const size_t at = (size_t)cell->name[own ? 3 : i];
    if (field->places) {
      cell->value[i] = field->scale > 0.0 ? ((double)field->places[4 * at] - field->offset) / field->scale : field->least;
    } else {
      cell->value[i] = (double)(own ? own[at] : h->frame->places[4 * at + 3]);
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

static int entry_of(const hit_field* field, double value)
{
  return (int)fmin(fmax(floor(value * field->scale + field->offset), 0.0), (double)(field->size - 1));
}

/* Finds the first place of a cell that shows on a part of the ray. Returns false if there is none. only: the march has found that this
 * field shows. */
static bool find_on_part(
  const hit_field* field, const hit_ray* ray, const hit_cell* cell, const hit_part* part, bool only, hit_place* place)
{
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
  const int first_entry = entry_of(field, place->value);
  if (cell->flat || !(end > place->k) || !(end < INFINITY)) {
    return end > place->k && (only || field->shown[first_entry] == first_entry);
  }
  const double last = value_at(ray, cell, end);
  const bool rises = last > place->value;
  const int last_entry = entry_of(field, last);
  const int met =
    field
      ->shown[first_entry + (rises ? 0 : field->size)]; /* the nearest entry that shows in this direction, see stratus_tetra_shown_sums() */
  if (met != first_entry) {
    const int into = rises ? (met < last_entry ? met : last_entry) : (met > last_entry ? met : last_entry);
    const double border = ((double)(rises ? into : into + 1) - field->offset) / field->scale;
    const double share = last != place->value ? (border - place->value) / (last - place->value) : 0.0;
    place->k += fmin(fmax(share, 0.0), 1.0) * (end - place->k);
    place->value = ((double)into + 0.5 - field->offset) / field->scale; /* at its border a function may jump */
    place->cut = CUT_NONE;
    place->inside = true;
    return into == met;
  }
  return true;
}

/* Finds a field's hit in a cell that has its values. Returns false where no part shows by these numbers: then the first counts, if the
 * march's floats have found one. */
static bool find_in_cell(const hits* h, const hit_field* field, const hit_ray* ray, const hit_cell* cell, hit_place* found)
{
  const bool only = h->field_count == 1;
  hit_place place;
  bool any = find_on_part(field, ray, cell, ray->parts, only, found);
  for (int part = 1; part < ray->count && !any; ++part) {
    any = find_on_part(field, ray, cell, ray->parts + part, only, &place);
    *found = any ? place : *found;
  }
  return any;
}

/* Finds the nearest hit. Returns its field, whose values the cell then has. */
static const hit_field* find_place(const hits* h, const hit_ray* ray, hit_cell* cell, hit_place* found)
{
  const hit_field* of = h->fields;
  bool any = false;
  for (int f = 0; f < h->field_count; ++f) {
    hit_place place;
    take_values(h, h->fields + f, cell);
    const bool shows = find_in_cell(h, h->fields + f, ray, cell, &place);
    if (f == 0 || (shows && (!any || place.k < found->k))) {
      *found = place;
      of = h->fields + f;
    }
    any = any || shows;
  }
  take_values(h, of, cell);
  return of;
}

/* ---- its normal and colour */

/* The field's gradient at a place, in the world, by those of points. Returns false if it is 0. */
static bool smooth_normal(const hits* h, const hit_field* field, const hit_ray* ray, const hit_cell* cell, double k, double normal[3])
{
  double weight[4], gradient[3] = { 0.0, 0.0, 0.0 };
  weigh(ray, cell, k, weight);
  for (int i = 0; i < (cell->flat ? 3 : 4); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      gradient[axis] += weight[i] * (double)field->gradients[4 * (size_t)cell->name[i] + (size_t)axis];
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

static void find_normal(
  const hits* h, const hit_field* field, const hit_ray* ray, const hit_cell* cell, const hit_place* place, double normal[3])
{
  const bool cut = place->cut != CUT_NONE;
  if (cut) {
    memcpy(normal, place->cut == CUT_NEAR ? ray->along : h->planes[place->cut], 3 * sizeof *normal);
  }
  if (cut || !((field->smooth && smooth_normal(h, field, ray, cell, place->k, normal)) || (place->inside && facet_normal(cell, normal)))) {
    memcpy(normal, cut ? normal : cell->slope[3], 3 * sizeof *normal);
    (void)stratus_vector_normalize(normal);
  }
  const double sign = stratus_vector_dot(normal, ray->along) > 0.0 ? -1.0 : 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis] *= sign;
  }
}

/* Finds the colour of a place. Of dependent components the last one's function is not asked: the others have the colour. */
static void find_color(
  const hits* h, const hit_field* field, const hit_ray* ray, const hit_cell* cell, const hit_place* place, double shown[4])
{
  const stratus_tetra_components* m = &h->caster->components;
  double value = place->value + field->bias;
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
    value = m->scale[0] > 0.0f ? (at[0] - (double)m->offset[0]) / (double)m->scale[0] + m->bias[0] : m->bias[0] + (double)m->least[0];
  }
  if (!h->dependent || m->count == 2) {
    stratus_transfer_at(field->transfer, value, shown);
  }
}

/* Replaces a pixel's stored cell by the colour of the hit. Returns its depth. */
static float shade(const hits* h, int x, int y, float rgba[4])
{
  hit_ray ray;
  hit_cell cell;
  hit_place place = { .cut = CUT_NONE };
  double shown[4], normal[3], direction[3], point[3];
  if (!(rgba[3] > 0.0f)) {
    return INFINITY;
  }
  take_ray(h, x, y, &ray);
  take_cell(h, rgba, &cell);
  const hit_field* field = find_place(h, &ray, &cell, &place);
  find_color(h, field, &ray, &cell, &place, shown);
  if (field->lit) {
    find_normal(h, field, &ray, &cell, &place, normal);
    for (int axis = 0; axis < 3; ++axis) {
      direction[axis] = ray.along[axis] / ray.length;
      point[axis] = h->frame->camera.eye[axis] + ray.from[axis] + place.k * ray.along[axis];
    }
    stratus_lamps_shine(&field->lamps, point, normal, direction, shown);
  }
  for (int c = 0; c < 3; ++c) {
    rgba[c] = (float)fmin(fmax(shown[c], 0.0), 1.0);
  }
  rgba[3] = 1.0f;
  return (float)(place.k * ray.length);
}

/* Adds a field. of: the component whose gradients and material it has. */
static void add_field(hits* h, hit_field field, int of, const stratus_mesh* mesh)
{
  const stratus_tetra_gradients* g = &h->caster->gradients;
  const stratus_material material = stratus_tetra_material(mesh, h->options, of);
  hit_field* to = &h->fields[h->field_count++];
  const size_t set = g->set[of] > 0 ? (size_t)g->set[of] : 0;
  *to = field;
  to->gradients = g->vectors ? g->vectors + 4 * (size_t)h->caster->mesh->point_count * set : NULL;
  to->smooth = h->options->normals == STRATUS_NORMALS_GRADIENT && to->gradients && g->set[of] >= 0;
  to->lit = material.shade != 0;
  to->shading = h->options->shading;
  to->shading.ambient = material.ambient;
  to->shading.diffuse = material.diffuse;
  to->shading.specular = material.specular;
  to->shading.specular_power = material.specular_power;
  if (to->lit) {
    stratus_lamps_set(&h->frame->camera, &to->shading, &to->lamps);
  }
}

static void add_fields(hits* h, const stratus_mesh* mesh, const stratus_transfer* transfers)
{
  const stratus_tetra_components* m = &h->caster->components;
  const stratus_table* table = h->caster->look.table;
  if (!stratus_tetra_meets_components(mesh, h->options)) {
    const hit_field own = { .transfer = transfers,
      .shown = h->caster->look.sums + 8 * (size_t)table->size,
      .size = table->size,
      .scale = (double)table->scale,
      .offset = (double)table->offset,
      .bias = h->caster->mesh->bias };
    add_field(h, own, h->dependent ? m->count - 1 : 0, mesh);
    return;
  }
  for (int c = 0; c < m->count; ++c) {
    const int size = (int)m->last[c] + 1;
    const hit_field component = { .transfer = transfers + c,
      .places = m->places + c,
      .shown = m->sums + m->sums_at[c] + 8 * (size_t)size,
      .size = size,
      .scale = (double)m->scale[c],
      .offset = (double)m->offset[c],
      .least = (double)m->least[c],
      .bias = m->bias[c] };
    if (transfers[c].weight > 0.0) {
      add_field(h, component, c, mesh);
    }
  }
}

void stratus_tetra_hits_shade(const stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_tetra_options* options, const stratus_image* image)
{
  hits h = { .frame = frame, .caster = caster, .options = options, .dependent = options->dependent && stratus_tetra_mixes(mesh, options) };
  double inverse[16];
  h.plane_count = stratus_tetra_planes(mesh, options, h.planes);
  h.crop_count = stratus_tetra_crop_planes(mesh, options, h.planes + TETRA_PLANES);
  for (int p = 0; p < TETRA_PLANES + h.crop_count; ++p) {
    h.planes[p][3] += stratus_vector_dot(h.planes[p], frame->camera.eye);
  }
  const bool inverts = stratus_matrix_invert_affine(mesh->matrix, inverse); /* stratus_mesh_check() refuses other matrices */
  for (int i = 0; i < 9 && inverts; ++i) {                                  /* normals transform by the inverse's transpose */
    h.to_normal[i] = inverse[4 * (i % 3) + i / 3];
  }
  add_fields(&h, mesh, transfer);
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
