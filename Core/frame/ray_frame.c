/* SPDX-License-Identifier: BSD-3-Clause
 * Computes the arguments that all rays of a frame share, from camera, volume and options. */
#include "ray_frame.h"

#include "camera.h"
#include "matrix.h"
#include "ray_caster.h"
#include "ray_fetched.h"
#include "ray_mode.h"
#include "ray_sampling.h"
#include "table_fill.h"
#include "vector.h"

#include <string.h>

/* Floats cannot distinguish more samples than this on one ray. */
#define SAMPLES_MOST 4e6
/* Bounds shrink by FLOAT_COARSENESS times the sum of the dimension and the length of a sample in voxels, so that no rounding takes a sample
 * outside: a ray's position is a float, and segment 0 begins up to one sample before the bounds. */
#define FLOAT_COARSENESS 0x1p-21
#define VOXELS_A_SAMPLE_MOST 4096.0
#define SMALLEST_SAMPLE_DISTANCE 1e-30
#define LARGEST_SAMPLE_DISTANCE 1e30
#define UNBOUNDED 1e30f
/* Steeper gradients than to a value so large have the same direction, and fall beyond any function of magnitudes. */
#define CLIPPED_MOST 1e30
/* The error for which stratus_table.color_slope cuts segments: a twelfth of the change of colour that it allows in a piece, 1/48. */
#define TABLE_COLOR_ERROR (1.0 / 576.0)
/* A ray ends when its transparency is this share of the tolerance: matter behind it changes no channel by more. Below TERMINATION_LEAST a
 * transparency does not change a float. */
#define TERMINATION_SHARE 0.5
#define TERMINATION_MOST 0.5
#define TERMINATION_LEAST 0x1p-24

/* Returns an upper bound of the world distance from the eye (parallel: from any point of the window) to a point of the volume. */
static double farthest_point(const stratus_volume* volume, const stratus_camera* camera, const double m[16])
{
  double farthest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double index[3], point[3], square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      index[axis] = corner >> axis & 1 ? (double)volume->dimensions[axis] : -1.0;
    }
    stratus_matrix_point(m, index, point);
    for (int axis = 0; axis < 3; ++axis) {
      square += (point[axis] - camera->eye[axis]) * (point[axis] - camera->eye[axis]);
    }
    farthest = fmax(farthest, sqrt(square));
  }
  return farthest + sqrt(stratus_vector_dot(camera->right, camera->right)) + sqrt(stratus_vector_dot(camera->up, camera->up));
}

static void set_camera(const stratus_camera* camera, const double world_to_index[16], stratus_ray_cast_arguments* a)
{
  const double* vectors[3] = { camera->forward, camera->right, camera->up };
  stratus_pair* targets[3] = { a->camera.forward, a->camera.right, a->camera.up };
  double point[3];
  stratus_matrix_point(world_to_index, camera->eye, point);
  for (int axis = 0; axis < 3; ++axis) {
    a->camera.eye[axis] = stratus_pair_of(point[axis]);
  }
  for (int v = 0; v < 3; ++v) {
    double vector[3];
    stratus_matrix_vector(world_to_index, vectors[v], vector);
    for (int axis = 0; axis < 3; ++axis) {
      targets[v][axis] = stratus_pair_of(vector[axis]);
    }
  }
  a->camera.near_k = stratus_pair_of(camera->near_k);
  a->camera.has_far = isfinite(camera->far_k);
  a->camera.far_k = stratus_pair_of(a->camera.has_far ? camera->far_k : 0.0);
}

void stratus_ray_frame_lattice(
  const stratus_camera* camera, const stratus_image* image, double sample_distance, stratus_ray_cast_arguments* a)
{
  a->camera.metric[0] = stratus_pair_of(stratus_vector_dot(camera->forward, camera->forward));
  a->camera.metric[1] = stratus_pair_of(2.0 * stratus_vector_dot(camera->forward, camera->right));
  a->camera.metric[2] = stratus_pair_of(2.0 * stratus_vector_dot(camera->forward, camera->up));
  a->camera.metric[3] = stratus_pair_of(stratus_vector_dot(camera->right, camera->right));
  a->camera.metric[4] = stratus_pair_of(2.0 * stratus_vector_dot(camera->right, camera->up));
  a->camera.metric[5] = stratus_pair_of(stratus_vector_dot(camera->up, camera->up));
  a->camera.parallel = camera->parallel != 0;
  a->camera.pixel[0] = stratus_pair_of(1.0 / image->width);
  a->camera.pixel[1] = stratus_pair_of(1.0 / image->height);
  a->lattice.per_step = stratus_pair_of(1.0 / sample_distance);
  a->lattice.step = (float)sample_distance;
}

/* Returns the length of a sample in voxels, along the axis where it is longest. */
static double voxels_a_sample(const stratus_volume* volume, const double world_to_index[16], double sample_distance, bool follows)
{
  double voxels = 0.0, samples[3];
  stratus_ray_samples_a_voxel(volume, sample_distance, samples);
  for (int axis = 0; axis < 3; ++axis) {
    const double* row = world_to_index + 4 * axis;
    voxels = fmax(voxels, follows ? 1.0 / samples[axis] : sample_distance * sqrt(stratus_vector_dot(row, row)));
  }
  return voxels;
}

double stratus_ray_voxels_within(const stratus_volume* volume, double length)
{
  double index_to_world[16], world_to_index[16];
  stratus_volume_index_to_world(volume, index_to_world);
  return stratus_matrix_invert_affine(index_to_world, world_to_index) ? voxels_a_sample(volume, world_to_index, length, false)
                                                                      : VOXELS_A_SAMPLE_MOST;
}

double stratus_ray_voxels_a_sample(const stratus_ray_caster* caster)
{
  double index_to_world[16], world_to_index[16];
  stratus_volume_index_to_world(&caster->field.traversed, index_to_world);
  const bool has_inverse = stratus_matrix_invert_affine(index_to_world, world_to_index);
  return has_inverse ? voxels_a_sample(&caster->field.traversed, world_to_index, caster->integrator.choice.sample_distance,
                         caster->integrator.choice.follows)
                     : VOXELS_A_SAMPLE_MOST;
}

/* Gives where crop bounds number lo and hi of an axis are in index coordinates, the lower first. */
static void crop_at(const stratus_volume* volume, const stratus_ray_cast_options* options, int axis, double at[2])
{
  const double spacing = stratus_volume_spacing(volume, axis), begin = volume->origin[axis] + stratus_volume_begin(volume, axis);
  const double half = volume->cell_centered ? 0.5 : 0.0;
  for (int side = 0; side < 2; ++side) { /* falling coordinates turn the sides round */
    at[spacing < 0.0 ? 1 - side : side] = (options->clipping.crop_bounds[2 * axis + side] - begin) / spacing - half;
  }
}

/* Sets the bounds, cropped, in index coordinates. voxels: the length of a sample. Returns false if they are empty. */
static bool set_box(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, double voxels, stratus_ray_cast_arguments* a)
{
  const stratus_volume* volume = &caster->field.traversed;
  for (int axis = 0; axis < 3; ++axis) {
    const double last = (double)(volume->dimensions[axis] - 1), margin = (last + 1.0 + voxels) * FLOAT_COARSENESS;
    double lo = volume->cell_centered ? -0.5 : margin, hi = volume->cell_centered ? last + 0.5 : last - margin;
    if (options->clipping.crop && options->clipping.crop_regions == STRATUS_CROP_INSIDE) {
      double bounds[2];
      crop_at(volume, options, axis, bounds);
      lo = fmax(lo, bounds[0]);
      hi = fmin(hi, bounds[1]);
    }
    if (!(lo < hi)) {
      return false;
    }
    a->crop.box[0][axis] = stratus_pair_of(lo);
    a->crop.box[1][axis] = stratus_pair_of(hi);
    a->values.last[axis] = (float)(last > 0.0 ? last - margin : last); /* below `last`, so that the position's cell and block exist */
    if (caster->field.grid.table && last > 0.0) {
      const double end = stratus_ray_grid_at(&caster->field.grid, axis, last),
                   before = stratus_ray_grid_at(&caster->field.grid, axis, last - 1.0);
      a->values.last[axis] = (float)(end - margin * (end - before));
    }
  }
  return true;
}

/* Turns crop regions round along the axes whose coordinates fall: bit x + 3 y + 9 z. */
static uint32_t regions_by_index(const stratus_volume* volume, uint32_t regions)
{
  uint32_t turned = 0;
  for (int region = 0; region < 27; ++region) {
    const int at[3] = { region % 3, region / 3 % 3, region / 9 };
    int to = 0;
    for (int axis = 2; axis >= 0; --axis) {
      to = 3 * to + (stratus_volume_spacing(volume, axis) < 0.0 ? 2 - at[axis] : at[axis]);
    }
    turned |= (regions >> region & 1u) << to;
  }
  return turned;
}

/* Sets crop regions other than just the inside. Returns false if none is shown. */
static bool set_regions(const stratus_volume* volume, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* a)
{
  if (!options->clipping.crop || options->clipping.crop_regions == STRATUS_CROP_INSIDE ||
    options->clipping.crop_regions == STRATUS_CROP_ALL) {
    return true;
  }
  a->crop.regions = (int)regions_by_index(volume, options->clipping.crop_regions);
  for (int axis = 0; axis < 3; ++axis) {
    double bounds[2];
    crop_at(volume, options, axis, bounds);
    a->crop.plane[axis][0] = stratus_pair_of(bounds[0]);
    a->crop.plane[axis][1] = stratus_pair_of(bounds[1]);
  }
  return a->crop.regions != 0;
}

/* Returns where the border below a cell is in the coordinates of rays. */
static double border_of(const stratus_ray_caster* caster, int axis, int64_t cell)
{
  return caster->field.grid.table ? stratus_ray_grid_border(&caster->field.grid, axis, cell)
                                  : (double)cell - (caster->field.traversed.cell_centered ? 0.5 : 0.0);
}

/* Returns where gradients begin to lack neighbours beside a border that another piece is behind, in the coordinates of rays. owned: the
 * border of the piece's own part, on all of which places stay where they are. side: 0: below, 1: above. */
static double lit_border(const stratus_ray_caster* caster, int axis, int side, int64_t cells, double owned)
{
  const int64_t outer = side ? cells - 1 : 1; /* the border between the outermost cell and the next */
  double border = border_of(caster, axis, outer);
  if (caster->field.traversed.cell_centered) { /* the next cell's centre */
    border = 0.5 * (border + border_of(caster, axis, outer + (side ? -1 : 1)));
  }
  return side ? fmax(border, owned) : fmin(border, owned);
}

/* Sets the part that this piece of a larger volume draws. Returns false if it owns nothing. */
static bool set_piece(const stratus_ray_caster* caster, stratus_ray_cast_arguments* a)
{
  const stratus_volume* volume = &caster->field.traversed;
  const int64_t *lo = caster->field.owned[0], *hi = caster->field.owned[1];
  a->crop.has_piece = !caster->field.owns_all;
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t cells = volume->dimensions[axis] - (volume->cell_centered ? 0 : 1);
    const bool others[2] = { lo[axis] > 0, hi[axis] < cells };
    for (int side = 0; side < 2; ++side) {
      const double owned = others[side] ? border_of(caster, axis, side ? hi[axis] : lo[axis]) : (side ? 1.0 : -1.0) * (double)UNBOUNDED;
      a->crop.piece[side][axis] = stratus_pair_of(owned);
      a->crop.lit[side][axis] = (float)(others[side] && cells > 2 ? lit_border(caster, axis, side, cells, owned) : owned);
    }
    if (lo[axis] >= hi[axis]) {
      return false;
    }
  }
  return true;
}

/* Transforms the world planes to index coordinates: n . (M x + t) + d. */
static void set_clip_planes(const stratus_ray_cast_options* options, const double m[16], stratus_ray_cast_arguments* a)
{
  a->crop.clip_count = options->clipping.clip_plane_count;
  for (int p = 0; p < options->clipping.clip_plane_count; ++p) {
    const double* plane = options->clipping.clip_planes[p];
    double result[4] = { 0.0, 0.0, 0.0, plane[3] };
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        result[column] += plane[row] * m[4 * row + column];
      }
    }
    /* Only the sign counts. Normalize, so that tiny or huge spacings stay within the range of floats. */
    const double length = sqrt(stratus_vector_dot(result, result));
    for (int i = 0; i < 4; ++i) {
      a->crop.clip[p][i] = stratus_pair_of(length > 0.0 ? result[i] / length : result[i]);
    }
  }
}

static void set_addressing(const stratus_volume* volume, stratus_ray_cast_arguments* a)
{
  a->values.gradient_at = volume->gradients ? (int)(uint32_t)stratus_volume_count(volume) : 0;
  const uint64_t stride = (uint64_t)volume->value_stride, row = (uint64_t)volume->dimensions[0] * stride;
  const uint64_t slice = row * (uint64_t)volume->dimensions[1], values = slice * (uint64_t)volume->dimensions[2];
  for (int axis = 0; axis < 3; ++axis) {
    a->values.dimensions[axis] = (int)volume->dimensions[axis];
    a->values.gradient_scale[axis] = (float)stratus_volume_spacing(volume, axis);
  }
  a->values.row = (int)(uint32_t)row;
  a->values.row_high = (int)(uint32_t)(row >> 32);
  a->values.slice = (int)(uint32_t)slice;
  a->values.slice_high = (int)(uint32_t)(slice >> 32);
  a->values.tail = values > 4 && values < INT32_MAX ? (int)(values - 4) : 0;
  a->values.reading = volume->tiles.values ? RAY_READING_TILES : 1 + stratus_ray_fetch_type(volume);
  a->values.type = (int)volume->type;
  a->values.stride = (int)stride;
}

double stratus_ray_termination(double tolerance)
{
  return fmax(fmin(TERMINATION_SHARE * tolerance, TERMINATION_MOST), TERMINATION_LEAST);
}

/* The sum of a volume's edges in the world: no ray through it is longer. */
static double longest_way(const double m[16], const stratus_volume* volume)
{
  double diagonal = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    double edge = 0.0;
    for (int row = 0; row < 3; ++row) {
      edge += m[4 * row + axis] * m[4 * row + axis];
    }
    diagonal += stratus_volume_extends(volume, axis) ? sqrt(edge) * (double)volume->dimensions[axis] : 0.0;
  }
  return diagonal;
}

/* Returns how many samples no ray through a volume exceeds. */
static double most_samples(const stratus_volume* volume, const double m[16], double sample_distance, bool follows)
{
  double samples[3], most = 0.0;
  if (!follows) {
    return longest_way(m, volume) / sample_distance;
  }
  stratus_ray_samples_a_voxel(volume, sample_distance, samples);
  for (int axis = 0; axis < 3; ++axis) {
    most += samples[axis] * (double)volume->dimensions[axis];
  }
  return most;
}

bool stratus_ray_step_fits(const stratus_volume* volume, double sample_distance, bool follows)
{
  double index_to_world[16];
  stratus_volume_index_to_world(volume, index_to_world);
  return most_samples(volume, index_to_world, sample_distance, follows) <= SAMPLES_MOST;
}

static stratus_status check_samples(stratus_context* context, const double m[16], const double inverse[16], const stratus_volume* volume,
  double sample_distance, bool follows)
{
  if (most_samples(volume, m, sample_distance, follows) > SAMPLES_MOST) {
    const double diagonal = longest_way(m, volume);
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "sample distance %g is too short: a ray through a volume %g wide would take more than %g samples; at least %g", sample_distance,
      diagonal, SAMPLES_MOST, diagonal / SAMPLES_MOST);
  }
  const double voxels = voxels_a_sample(volume, inverse, sample_distance, follows);
  if (!(voxels <= VOXELS_A_SAMPLE_MOST) || !(sample_distance >= SMALLEST_SAMPLE_DISTANCE && sample_distance <= LARGEST_SAMPLE_DISTANCE)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "sample distance %g is too long or out of range: %g voxels a sample, at most %g; distances %g..%g", sample_distance, voxels,
      VOXELS_A_SAMPLE_MOST, SMALLEST_SAMPLE_DISTANCE, LARGEST_SAMPLE_DISTANCE);
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_frame_arguments(const stratus_ray_caster* caster, const stratus_camera* camera,
  const stratus_ray_cast_options* options, const stratus_image* image, double sample_distance, bool follows, stratus_ray_cast_arguments* a,
  bool* empty)
{
  stratus_context* context = caster->context;
  const stratus_volume* volume = &caster->field.traversed;
  double index_to_world[16], world_to_index[16], per_voxel[3];
  memset(a, 0, sizeof *a);
  TRY(stratus_camera_check(context, camera, image));
  stratus_volume_index_to_world(volume, index_to_world);
  if (!stratus_matrix_invert_affine(index_to_world, world_to_index)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the volume's matrix has no inverse");
  }
  TRY(check_samples(context, index_to_world, world_to_index, volume, sample_distance, follows));
  set_camera(camera, world_to_index, a);
  stratus_ray_frame_lattice(camera, image, sample_distance, a);
  a->lattice.reach = stratus_pair_of(farthest_point(volume, camera, index_to_world) / sample_distance + 2.0);
  a->lattice.follows = follows;
  stratus_ray_samples_a_voxel(volume, sample_distance, per_voxel);
  for (int axis = 0; axis < 3; ++axis) {
    a->lattice.per_voxel[axis] = stratus_pair_of(per_voxel[axis]);
  }
  a->picture.width = image->width;
  a->picture.height = image->height;
  a->camera.has_opaque_depth = image->opaque_depth != NULL;
  a->picture.want_depth = image->depth != NULL;
  a->picture.want_samples = image->samples != NULL;
  a->picture.want_bytes = image->rgba8 != NULL;
  a->values.nearest = options->sampling.interpolation == STRATUS_INTERPOLATION_NEAREST;
  a->values.clamp = volume->cell_centered != 0;
  a->termination = (float)(options->sampling.termination > 0.0 ? 1.0 - options->sampling.termination
                                                               : stratus_ray_termination(stratus_ray_tolerance(options)));
  set_clip_planes(options, index_to_world, a);
  a->crop.clipped = stratus_ray_clips_gradients(options);
  a->crop.clipped_value = (float)fmax(fmin(options->clipping.clipped_value - caster->field.ranges->bias, CLIPPED_MOST), -CLIPPED_MOST);
  set_addressing(volume, a);
  a->grid = caster->field.grid.arguments;
  const double bias = stratus_type_is_wide(volume->type) ? caster->field.ranges->bias : 0.0;
  uint64_t bits;
  memcpy(&bits, &bias, sizeof bits);
  a->values.bias_low = (int)(uint32_t)bits;
  a->values.bias_high = (int)(uint32_t)(bits >> 32);
  a->lattice.jitter = options->sampling.jitter != 0;
  a->lattice.seed = (int)options->sampling.jitter_seed;
  *empty = !set_box(caster, options, voxels_a_sample(volume, world_to_index, sample_distance, follows), a) || !set_piece(caster, a) ||
    !set_regions(volume, options, a);
  return STRATUS_OK;
}

/* Returns where a block begins in the coordinates of rays. */
static float block_at(const stratus_ray_grid* grid, const stratus_occupancy* occupancy, int axis, int64_t block)
{
  const int64_t index = block * occupancy->block_size;
  return grid->table ? (float)stratus_ray_grid_at(grid, axis, (double)index) : (float)index;
}

static void set_map(
  const stratus_ray_grid* grid, const stratus_occupancy* occupancy, const stratus_distance_map* map, stratus_ray_cast_arguments* a)
{
  a->map.pitch = (int)map->pitch;
  a->map.rows = (int)map->blocks[1];
  a->map.octant_stride = map->kind == STRATUS_DISTANCE_OCTANT ? (int)map->map_bytes : 0;
  a->map.tree = map->tree_nodes;
  a->map.bounds_at = (int)(map->bounds_at / 64);
  a->map.bounds_across = (int)occupancy->blocks[0];
  a->map.bounds_rows = (int)occupancy->blocks[1];
  a->map.block_log2 = stratus_distance_map_block_log2(map);
  for (int axis = 0; axis < 3; ++axis) {
    a->map.occupied[0][axis] = occupancy->lo[axis] > 0 ? block_at(grid, occupancy, axis, occupancy->lo[axis]) : -UNBOUNDED;
    a->map.occupied[1][axis] =
      occupancy->hi[axis] < occupancy->blocks[axis] ? block_at(grid, occupancy, axis, occupancy->hi[axis]) : UNBOUNDED;
  }
}

static double pair_value(stratus_pair pair)
{
  return (double)pair.hi + (double)pair.lo;
}

static void pair_values(const stratus_pair pairs[3], double values[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    values[axis] = pair_value(pairs[axis]);
  }
}

void stratus_ray_frame_table(const stratus_table* table, double tolerance, stratus_ray_cast_arguments* a)
{
  a->table = stratus_table_arguments_of(table);
  const float stricter = (float)(TABLE_COLOR_ERROR / fmax(tolerance, TERMINATION_LEAST));
  a->table.color_slope *= stricter;
  a->table.color_most *= stricter;
}

void stratus_ray_frame_structures(const stratus_ray_grid* grid, const stratus_table* table, double tolerance,
  const stratus_occupancy* occupancy, const stratus_distance_map* map, stratus_ray_cast_arguments* a)
{
  if (table) {
    stratus_ray_frame_table(table, tolerance, a);
  }
  a->map.structure = map != NULL;
  double lo[3], hi[3];
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = pair_value(a->crop.box[0][axis]);
    hi[axis] = pair_value(a->crop.box[1][axis]);
  }
  if (map) {
    set_map(grid, occupancy, map, a);
    for (int axis = 0; axis < 3 && !a->mode.sum; ++axis) {
      lo[axis] = fmax(lo[axis], (double)a->map.occupied[0][axis]);
      hi[axis] = fmin(hi[axis], (double)a->map.occupied[1][axis]);
    }
  }
  double eye[3], right[3], up[3], forward[3];
  const int sides[2] = { a->picture.width, a->picture.height };
  pair_values(a->camera.eye, eye);
  pair_values(a->camera.right, right);
  pair_values(a->camera.up, up);
  pair_values(a->camera.forward, forward);
  stratus_camera_window(eye, right, up, forward, a->camera.parallel, lo, hi, sides, a->camera.window);
}

stratus_ray_cast_frame stratus_ray_frame_of(
  const stratus_ray_caster* caster, const stratus_ray_cast_arguments* arguments, const stratus_image* image, bool with_map)
{
  size_t bytes = 0;
  return (stratus_ray_cast_frame){ .arguments = arguments,
    .values = stratus_ray_values_of(&caster->field),
    .hidden = caster->field.hidden,
    .map = with_map ? caster->structure.map->bytes : NULL,
    .grid = caster->field.grid.table,
    .lights = stratus_light_maps_words(caster->optics.lights),
    .rough = caster->integrator.choice.sampling == STRATUS_SAMPLING_LOCAL ? caster->structure.rough->bytes : NULL,
    .table = stratus_ray_table_of(&caster->optics, &bytes),
    .opaque_depth = image->opaque_depth,
    .rgba = image->rgba,
    .depth = image->depth,
    .samples = image->samples,
    .rgba8 = image->rgba8 };
}
