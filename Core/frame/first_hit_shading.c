/* SPDX-License-Identifier: BSD-3-Clause
 * The colour of a hit: the transfer function's colour of the voxel's value, lit with the normal of the face, the gradient or the cut. */
#include "first_hit_picture.h"

#include "matrix.h"
#include "ray_shading_table.h"
#include "vector.h"

#include <string.h>

/* ---- set-up */

void stratus_shader_set(stratus_shader* shader, const stratus_volume* volume, const stratus_voxel_borders* borders,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_ray_cast_options* options, const double index_to_world[16],
  const double world_to_index[16])
{
  memset(shader, 0, sizeof *shader);
  shader->volume = volume;
  shader->borders = borders;
  shader->transfer = transfer;
  shader->options = options;
  shader->bias = stratus_volume_bias(volume);
  memcpy(shader->index_to_world, index_to_world, sizeof shader->index_to_world);
  memcpy(shader->world_to_index, world_to_index, sizeof shader->world_to_index);
  for (int axis = 0; axis < 3; ++axis) { /* rows of the inverse matrix are face normals, even under shear */
    memcpy(shader->face[axis], world_to_index + 4 * axis, sizeof shader->face[axis]);
    (void)stratus_vector_normalize(shader->face[axis]);
  }
  for (int p = 0; p < options->clipping.clip_plane_count; ++p) {
    for (int axis = 0; axis < 3; ++axis) {
      shader->plane[p][axis] = -options->clipping.clip_planes[p][axis];
    }
    (void)stratus_vector_normalize(shader->plane[p]);
  }
  if (options->light.shading.on) {
    stratus_lamps_set(camera, &options->light.shading, &shader->lamps);
  }
}

void stratus_shader_set_colors(stratus_shader* shader, const stratus_volume* whole)
{
  shader->color_count = stratus_volume_components(whole) - 1;
  for (int c = 0; c < shader->color_count; ++c) {
    shader->colors[c] = stratus_volume_component(whole, c);
    shader->color_bias[c] = stratus_volume_bias(&shader->colors[c]);
  }
}

/* ---- values */

static size_t index_of(const stratus_shader* shader, const int64_t at[3])
{
  const int64_t* n = shader->volume->dimensions;
  return (size_t)((at[2] * n[1] + at[1]) * n[0] + at[0]);
}

static double value_at(const stratus_shader* shader, const int64_t at[3])
{
  return (double)stratus_volume_fetch(shader->volume, shader->bias, index_of(shader, at));
}

/* Returns the value of a dependent component. */
static double color_value(const stratus_shader* shader, int c, const int64_t at[3])
{
  return (double)stratus_volume_fetch(&shader->colors[c], shader->color_bias[c], index_of(shader, at)) + shader->color_bias[c];
}

/* Gives a voxel's colour, not lit. */
static void color_at(const stratus_shader* shader, const int64_t at[3], double rgba[4])
{
  const bool own = shader->color_count == 0;
  stratus_transfer_at(shader->transfer, own ? value_at(shader, at) + shader->bias : color_value(shader, 0, at), rgba);
  for (int c = 0; shader->color_count > 1 && c < shader->color_count; ++c) { /* red, green, blue */
    rgba[c] = fmin(fmax(color_value(shader, c, at) / 255.0, 0.0), 1.0);
  }
}

/* ---- normals: outward, in world coordinates, of length 1 */

/* Returns the distance from a value to the next one along an axis, in mean spacings. */
static double step_from(const stratus_volume* volume, int axis, int64_t at)
{
  const double* x = volume->coordinates[axis];
  const double step = !x ? 1.0 : volume->cell_centered ? 0.5 * (x[at + 2] - x[at]) : x[at + 1] - x[at];
  return x ? step / stratus_volume_spacing(volume, axis) : step;
}

/* Returns the slope along an axis at a value: of the line to the only neighbour, or of the parabola through both. NAN: no neighbour. */
static double slope_at(const stratus_volume* volume, int axis, int64_t at, double below, double value, double above)
{
  if (!volume->coordinates[axis]) {
    const int apart = isfinite(below) + isfinite(above);
    return apart ? ((isfinite(above) ? above : value) - (isfinite(below) ? below : value)) / apart : 0.0;
  }
  const double back = isfinite(below) ? step_from(volume, axis, at - 1) : 0.0, ahead = isfinite(above) ? step_from(volume, axis, at) : 0.0;
  const double left = back > 0.0 ? (value - below) / back : 0.0, right = ahead > 0.0 ? (above - value) / ahead : 0.0;
  return back > 0.0 && ahead > 0.0 ? (left * ahead + right * back) / (back + ahead) : left + right;
}

/* Computes the normal by differences, one-sided where a neighbour is missing or not finite. Returns false if the gradient is 0. */
static bool gradient_normal(const stratus_shader* shader, const int32_t voxel[3], const double direction[3], double normal[3])
{
  const stratus_volume* volume = shader->volume;
  const int64_t here[3] = { voxel[0], voxel[1], voxel[2] }, *n = volume->dimensions;
  const double value = value_at(shader, here);
  double world[3] = { 0.0, 0.0, 0.0 };
  for (int axis = 0; axis < 3; ++axis) {
    double side[2];
    for (int s = 0; s < 2; ++s) {
      int64_t at[3] = { here[0], here[1], here[2] };
      at[axis] += s ? 1 : -1;
      side[s] = at[axis] >= 0 && at[axis] < n[axis] ? value_at(shader, at) : NAN;
    }
    const double slope = volume->gradients
      ? (double)volume->gradients[((axis * n[2] + here[2]) * n[1] + here[1]) * n[0] + here[0]] * stratus_volume_spacing(volume, axis)
      : slope_at(volume, axis, here[axis], side[0], value, side[1]);
    for (int row = 0; row < 3; ++row) {
      world[row] += slope * shader->world_to_index[4 * axis + row];
    }
  }
  if (stratus_vector_normalize(world) == 0.0) {
    return false;
  }
  const double sign = stratus_vector_dot(world, direction) > 0.0 ? -1.0 : 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis] = sign * world[axis];
  }
  return true;
}

static void cut_normal(const stratus_shader* shader, uint32_t cut, const double direction[3], double normal[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis] = cut >= STRATUS_CUT_PLANE ? shader->plane[cut - STRATUS_CUT_PLANE][axis]
      : cut >= STRATUS_CUT_CROP             ? ((cut - STRATUS_CUT_CROP) % 2 ? 1.0 : -1.0) * shader->face[(cut - STRATUS_CUT_CROP) / 2][axis]
                                            : -direction[axis];
  }
}

/* Returns t where the ray enters the voxel. *face: 2*axis + upper, or -1 if the ray begins inside. */
static double entry(const stratus_voxel_borders* borders, const stratus_ray* ray, const int32_t voxel[3], int* face)
{
  double t = ray->t_min;
  *face = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray->direction[axis];
    if (d != 0.0) {
      const double at = (stratus_voxel_border(borders, axis, voxel[axis] + (d < 0.0)) - 0.5 - ray->origin[axis]) / d;
      if (at > t || (at == t && *face >= 0)) { /* ties go to the last axis, as in first_hit_exact.c */
        t = at;
        *face = 2 * axis + (d < 0.0);
      }
    }
  }
  return fmin(t, ray->t_max);
}

void stratus_shader_apply(
  const stratus_shader* shader, const stratus_ray* ray, uint32_t cut, const int32_t voxel[3], float rgba[4], float* depth)
{
  const int64_t at[3] = { voxel[0], voxel[1], voxel[2] };
  double direction[3], shown[4], index[3], point[3], normal[3];
  int face;
  const double t = entry(shader->borders, ray, voxel, &face);
  stratus_matrix_vector(shader->index_to_world, ray->direction, direction);
  const double length = sqrt(stratus_vector_dot(direction, direction));
  color_at(shader, at, shown);
  if (shader->options->light.shading.on) {
    for (int axis = 0; axis < 3; ++axis) {
      direction[axis] /= length;
      index[axis] = ray->origin[axis] + t * ray->direction[axis];
    }
    stratus_matrix_point(shader->index_to_world, index, point);
    if (face < 0) {
      cut_normal(shader, cut, direction, normal);
    } else if (shader->options->light.normals != STRATUS_NORMALS_GRADIENT || !gradient_normal(shader, voxel, direction, normal)) {
      for (int axis = 0; axis < 3; ++axis) {
        normal[axis] = (face & 1 ? 1.0 : -1.0) * shader->face[face / 2][axis];
      }
    }
    stratus_lamps_shine(&shader->lamps, point, normal, direction, shown);
  }
  for (int c = 0; c < 3; ++c) {
    rgba[c] = (float)fmin(fmax(shown[c], 0.0), 1.0);
  }
  rgba[3] = 1.0f;
  *depth = (float)(t * length);
}
