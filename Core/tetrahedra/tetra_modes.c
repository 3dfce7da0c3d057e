/* SPDX-License-Identifier: BSD-3-Clause
 * Modes that gather no light along the whole ray, and the planes that cut rays: checks of their options, their tables and arguments. */
#include "tetra_caster.h"

#include "matrix.h"
#include "mesh.h"
#include "slices.h"
#include "vector.h"

#include <string.h>

#define SUM_MOST INT32_MAX

_Static_assert(STRATUS_TETRA_CONTOURS_MAX == TETRA_CONTOURS, "as many as the arguments hold");
_Static_assert(STRATUS_TETRA_CLIP_PLANES_MAX + 6 == TETRA_PLANES, "as many as the arguments hold");

static stratus_status check_planes(stratus_context* context, const stratus_tetra_options* options)
{
  if (options->clip_plane_count < 0 || options->clip_plane_count > STRATUS_TETRA_CLIP_PLANES_MAX) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "clip_plane_count %d outside 0..%d", options->clip_plane_count, STRATUS_TETRA_CLIP_PLANES_MAX);
  }
  for (int p = 0; p < options->clip_plane_count; ++p) {
    for (int i = 0; i < 4; ++i) {
      if (!isfinite(options->clip_planes[p][i])) {
        return stratus_fail(
          context, STRATUS_INVALID_ARGUMENT, "clip_planes[%d][%d] is %g, must be finite", p, i, options->clip_planes[p][i]);
      }
    }
  }
  if (options->crop_regions > STRATUS_CROP_ALL) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "crop regions 0x%x, must be 0..0x%x", (unsigned)options->crop_regions, (unsigned)STRATUS_CROP_ALL);
  }
  for (int axis = 0; options->crop && axis < 3; ++axis) {
    const double* bounds = options->crop_bounds + 2 * axis;
    if (!(bounds[0] <= bounds[1])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "crop_bounds %g .. %g along axis %d, must rise", bounds[0], bounds[1], axis);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_contours(stratus_context* context, const stratus_tetra_options* options, const stratus_mesh* mesh)
{
  if (options->contour_count < 1 || options->contour_count > STRATUS_TETRA_CONTOURS_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%d contour values, an isosurface needs 1..%d", options->contour_count,
      STRATUS_TETRA_CONTOURS_MAX);
  }
  for (int n = 0; n < options->contour_count; ++n) {
    if (!isfinite(options->contours[n])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "contour %d has value %g, must be finite", n, options->contours[n]);
    }
  }
  return mesh->cell_values ? stratus_fail(context, STRATUS_UNSUPPORTED,
                               "isosurfaces of values of cells are not supported: constant in each cell, they cross no value")
                           : STRATUS_OK;
}

bool stratus_tetra_modes_regions(const stratus_tetra_options* options)
{
  return options->crop && options->crop_regions != STRATUS_CROP_INSIDE && options->crop_regions != STRATUS_CROP_ALL;
}

bool stratus_tetra_modes_march(const stratus_tetra_options* options)
{
  return options->mode != STRATUS_TETRA_COMPOSITE && options->mode != STRATUS_TETRA_MAXIMUM;
}

stratus_status stratus_tetra_modes_check(stratus_context* context, const stratus_tetra_options* options, const stratus_mesh* mesh)
{
  const double* range = options->average_range;
  TRY(check_planes(context, options));
  if (options->mode == STRATUS_TETRA_AVERAGE && !(range[0] <= range[1])) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "average_range %g .. %g, must rise", range[0], range[1]);
  }
  if (options->method == STRATUS_TETRA_METHOD_PROJECT && stratus_tetra_modes_march(options)) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "mode %s cannot be projected, only marched: take the method march or auto",
      stratus_tetra_mode_name(options->mode));
  }
  if (options->method == STRATUS_TETRA_METHOD_PROJECT && stratus_tetra_modes_regions(options)) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "crop regions 0x%x cannot be projected, only marched: take the method march or auto, or the inside (0x%x)",
      (unsigned)options->crop_regions, (unsigned)STRATUS_CROP_INSIDE);
  }
  if (options->mode == STRATUS_TETRA_SLICE) {
    return stratus_slice_check(context, &options->slice);
  }
  return options->mode == STRATUS_TETRA_ISOSURFACE ? check_contours(context, options, mesh) : STRATUS_OK;
}

/* ---- tables */

stratus_status stratus_tetra_value_sums(
  stratus_context* context, const stratus_table* table, const stratus_table_values* values, const double range[2], int32_t** sums)
{
  const size_t size = (size_t)table->size;
  const double lo = (double)values->lo, width = (double)values->hi - lo, one = SUM_MOST / ((double)size + 1.0);
  int64_t below[4] = { 0, 0, 0, 0 }, moment = 0;
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, STRATUS_TETRA_SUMS * size, sizeof(int32_t), &memory));
  *sums = memory;
  for (size_t entry = 0; entry < size; ++entry) {
    const double value = table->scale > 0.0f ? ((double)entry + 0.5 - (double)table->offset) / (double)table->scale : lo;
    const double half = table->scale > 0.0f ? 0.5 / (double)table->scale : 0.0, alpha = (double)table->rgba[4 * entry + 3];
    const double real = value + values->fetching.bias, part = width > 0.0 ? fmin(fmax((value - lo) / width, 0.0), 1.0) : 0.0;
    const bool counts = real + half >= range[0] && real - half <= range[1];
    const double own[4] = { counts ? alpha * part : 0.0, counts ? alpha : 0.0, 0.0, counts ? 1.0 : 0.0 };
    for (size_t c = 0; c < 4; ++c) {
      const int64_t here = (int64_t)(own[c] * one);
      (*sums)[4 * entry + c] = (int32_t)(below[c] + (here + 1) / 2);
      (*sums)[4 * (size + entry) + c] = (int32_t)here;
      below[c] += here;
    }
    const int64_t turn = (int64_t)(*sums)[4 * (size + entry) + 1] * (int64_t)entry, middle = moment + turn / 2;
    (*sums)[10 * size + 2 * entry] = (int32_t)(middle >> 16);
    (*sums)[10 * size + 2 * entry + 1] = (int32_t)(middle & 0xffff);
    moment += turn;
  }
  return STRATUS_OK;
}

stratus_status stratus_tetra_shown_sums(stratus_context* context, const stratus_table* table, int32_t** sums)
{
  const size_t size = (size_t)table->size;
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, STRATUS_TETRA_SUMS * size, sizeof(int32_t), &memory));
  *sums = memory;
  int32_t *up = *sums + 8 * size, *down = up + size, last = -1;
  for (int32_t entry = 0; entry < table->size; ++entry) {
    up[entry] = table->next_shown[entry];
    last = up[entry] == entry ? entry : last;
    down[entry] = last;
  }
  return STRATUS_OK;
}

/* ---- arguments */

void stratus_tetra_frame_mode(stratus_tetra_frame* frame, const stratus_tetra_options* options)
{
  stratus_tetra_arguments* a = &frame->arguments;
  static const int modes[] = { TETRA_LIGHT, TETRA_EXTREMES, TETRA_EXTREMES, TETRA_ADD, TETRA_ADD, TETRA_SURFACES, TETRA_SLICE, TETRA_HITS,
    TETRA_QUANTITIES };
  a->mode = modes[options->mode];
  a->sign = options->mode == STRATUS_TETRA_MINIMUM ? -1.0f : 1.0f;
}

void stratus_tetra_frame_slice(stratus_tetra_frame* frame, const stratus_tetra_options* options)
{
  double to_world[16] = { [15] = 1.0 };
  for (int axis = 0; axis < 3 && options->mode == STRATUS_TETRA_SLICE; ++axis) {
    for (int column = 0; column < 3; ++column) {
      to_world[4 * axis + column] = frame->basis[column][axis];
    }
    to_world[4 * axis + 3] = frame->camera.eye[axis] + frame->middle * frame->camera.forward[axis];
  }
  if (options->mode == STRATUS_TETRA_SLICE) {
    stratus_slice_set(&options->slice, to_world, &frame->arguments.slice);
  }
}

/* Sets the surfaces of component c, whose fetched values are relative to `bias`: an insertion sort without duplicates. */
static void set_surfaces(
  stratus_tetra_arguments* a, int c, double bias, double weight, const stratus_transfer* transfer, const stratus_tetra_options* options)
{
  float(*surface)[5] = a->contour[c];
  int count = 0;
  for (int n = 0; n < options->contour_count; ++n) {
    const float value = (float)(options->contours[n] - bias);
    double rgba[4];
    int at = count;
    while (at > 0 && surface[at - 1][0] >= value) {
      --at;
    }
    if (at < count && !(value < surface[at][0])) {
      continue;
    }
    memmove(surface + at + 1, surface + at, (size_t)(count - at) * sizeof *surface);
    stratus_transfer_at(transfer, options->contours[n], rgba);
    surface[at][0] = value;
    for (int i = 0; i < 4; ++i) {
      surface[at][1 + i] = (float)(i < 3 ? rgba[i] * rgba[3] * weight : rgba[3] * weight);
    }
    ++count;
  }
  a->contour_count[c] = count;
}

void stratus_tetra_frame_contours(
  stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  stratus_tetra_arguments* a = &frame->arguments;
  const stratus_tetra_components* m = &caster->components;
  const stratus_transfer* transfer = caster->look.transfer;
  const double per_sum = ((double)frame->table->size + 1.0) / SUM_MOST;
  const bool surfaces = a->mode == TETRA_SURFACES || a->mode == TETRA_SLICE;
  a->grey = options->mode == STRATUS_TETRA_ADDITIVE ? (float)(per_sum / transfer->unit_distance) : 0.0f;
  a->kept = surfaces ? (float)caster->keeps : caster->keeps ? (float)per_sum : 0.0f;
  if (options->mode == STRATUS_TETRA_ISOSURFACE && !stratus_tetra_meets_components(mesh, options)) {
    set_surfaces(a, 0, caster->mesh->bias, 1.0, transfer, options);
  } else if (options->mode == STRATUS_TETRA_ISOSURFACE) {
    for (int c = 0; c < m->count; ++c) {
      set_surfaces(a, c, m->bias[c], m->transfers[c].weight, m->transfers + c, options);
    }
  }
}

/* Sets the numbers of the plane of points p with n p + d >= 0, scaled so that the largest is 1. */
static void set_plane(const stratus_tetra_frame* frame, const double n[3], double d, float numbers[6])
{
  const stratus_camera* c = &frame->camera;
  const double eye = stratus_vector_dot(n, c->eye) + d, f = stratus_vector_dot(n, c->forward), r = stratus_vector_dot(n, c->right),
               u = stratus_vector_dot(n, c->up);
  const double perspective[6] = { eye + frame->middle * f, frame->middle * r, frame->middle * u, frame->per_z * f, frame->per_z * r,
    frame->per_z * u };
  const double parallel[6] = { eye + frame->middle * f, r - frame->lean[0] * f, u - frame->lean[1] * f, frame->per_z * f, 0.0, 0.0 };
  const double* plane = c->parallel ? parallel : perspective;
  double largest = 0.0;
  for (int i = 0; i < 6; ++i) {
    largest = fmax(largest, fabs(plane[i]));
  }
  for (int i = 0; i < 6; ++i) {
    numbers[i] = largest > 0.0 ? (float)(plane[i] / largest) : 0.0f;
  }
}

/* The plane of points at or above a bound of the crop, in the world. inverse: of the mesh's matrix. */
static void side_plane(const stratus_tetra_options* options, const double inverse[16], int side, double plane[4])
{
  const double* row = inverse + 4 * (side / 2);
  memcpy(plane, row, 3 * sizeof *plane);
  plane[3] = row[3] - options->crop_bounds[side];
}

int stratus_tetra_planes(const stratus_mesh* mesh, const stratus_tetra_options* options, double planes[TETRA_PLANES][4])
{
  int count = options->clip_plane_count;
  double inverse[16];
  memcpy(planes, options->clip_planes, (size_t)count * sizeof *planes);
  if (!options->crop || options->crop_regions != STRATUS_CROP_INSIDE || !stratus_matrix_invert_affine(mesh->matrix, inverse)) {
    return count; /* stratus_mesh_check() refuses such a matrix */
  }
  for (int side = 0; side < 6; ++side) {
    if (isfinite(options->crop_bounds[side])) {
      side_plane(options, inverse, side, planes[count]);
      for (int i = 0; i < 4 && side % 2; ++i) {
        planes[count][i] = -planes[count][i];
      }
      ++count;
    }
  }
  return count;
}

int stratus_tetra_crop_planes(const stratus_mesh* mesh, const stratus_tetra_options* options, double planes[6][4])
{
  double inverse[16];
  if (!stratus_tetra_modes_regions(options) || !stratus_matrix_invert_affine(mesh->matrix, inverse)) {
    return 0;
  }
  for (int side = 0; side < 6; ++side) {
    side_plane(options, inverse, side, planes[side]);
  }
  return 6;
}

void stratus_tetra_frame_clip(stratus_tetra_frame* frame, const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  double planes[TETRA_PLANES][4];
  stratus_tetra_arguments* a = &frame->arguments;
  a->plane_count = stratus_tetra_planes(mesh, options, planes);
  for (int p = 0; p < a->plane_count; ++p) {
    set_plane(frame, planes[p], planes[p][3], a->plane[p]);
  }
  a->regions = stratus_tetra_crop_planes(mesh, options, planes) > 0 ? (int)options->crop_regions : 0;
  for (int side = 0; a->regions && side < 6; ++side) {
    float* numbers = a->crop[side / 2][side % 2];
    if (isfinite(planes[side][3])) {
      set_plane(frame, planes[side], planes[side][3], numbers);
    } else { /* all points are on one side */
      memset(numbers, 0, sizeof a->crop[0][0]);
      numbers[0] = planes[side][3] > 0.0 ? 1.0f : -1.0f;
    }
  }
}
