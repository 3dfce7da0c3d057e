/* SPDX-License-Identifier: BSD-3-Clause
 * First-hit pictures: batches of camera rays find their first effective voxel, which is then shaded.
 *
 * Rays are in index coordinates, of the mean spacing where it changes; the camera's k is the ray parameter t. The tree or the walk yields
 * only the voxel. Entry point and colour are computed from ray and voxel, so that every structure gives the same picture. */
#include "first_hit_picture.h"

#include "camera.h"
#include "first_hit_stretched_rays.h"
#include "lights.h"
#include "matrix.h"
#include "picture.h"
#include "ray_caster.h"

#include <string.h>

/* Side of a tile in pixels. Rays are ordered by tile, so that the 64 of a tile go through the tree as one beam. */
#define TILE 8
/* x of a pixel that a ray only fills its tile's place for. */
#define NO_PIXEL UINT32_MAX
/* Of places and planes in index coordinates, relative to the numbers from which they are computed. */
#define ROUNDING 1e-13
/* Enough rays to keep all threads or the device busy, few enough for their caches. */
#define BATCH_RAYS 32768

typedef struct first_hit_frame {
  const stratus_ray_cast_options* options;
  const stratus_image* image;
  const stratus_camera* camera;
  stratus_first_hit_scene scene;
  stratus_shader shader;
  double eye[3], forward[3], right[3], up[3]; /* index coordinates */
  double crop[6];                             /* index coordinates */
  double planes[STRATUS_CLIP_PLANES_MAX][4];  /* index coordinates */
  int window[4];
  stratus_ray* rays;
  stratus_first_hit_pixel* pixels;
  stratus_hit *hits, *plain_hits;
  int rows; /* rows of tiles in a batch */
} first_hit_frame;

/* ---- rays */

/* Clips the ray to slope*t + height >= 0. A ray whose start moves records `number` in *cut_by. size: the sum of the magnitudes that
 * `height` adds up, whose rounding must not show voxels beyond a plane that is on their faces. */
static void cut(double height, double size, double slope, uint32_t number, stratus_ray* ray, uint32_t* cut_by)
{
  const double slack = ROUNDING * size;
  if (slope > 0.0) {
    const double t = (slack - height) / slope;
    if (t > ray->t_min) {
      ray->t_min = t;
      *cut_by = number;
    }
  } else if (slope < 0.0) {
    ray->t_max = fmin(ray->t_max, (slack - height) / slope);
  } else if (height < 0.0) {
    ray->t_max = -INFINITY;
  }
}

/* Whether the clipped ray can meet the bounds of all voxels. */
static bool meets(const first_hit_frame* frame, const stratus_ray* ray)
{
  double begin = ray->t_min, end = ray->t_max;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray->direction[axis], lo = frame->scene.lo[axis] - ray->origin[axis], hi = frame->scene.hi[axis] - ray->origin[axis];
    if (d != 0.0) {
      /* widened, so that rounding cannot lose a voxel's edge */
      const double a = lo / d, b = hi / d, slack = 1e-9 * (fabs(a) + fabs(b));
      begin = fmax(begin, fmin(a, b) - slack);
      end = fmin(end, fmax(a, b) + slack);
    } else if (lo > 0.0 || hi < 0.0) {
      return false;
    }
  }
  return begin <= end;
}

/* Returns false if the ray cannot meet a voxel. */
static bool make_ray(const first_hit_frame* frame, uint32_t x, uint32_t y, stratus_ray* ray, stratus_first_hit_pixel* pixel)
{
  const double u = (2.0 * x + 1.0) / frame->image->width - 1.0, v = (2.0 * y + 1.0) / frame->image->height - 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double offset = u * frame->right[axis] + v * frame->up[axis];
    ray->origin[axis] = frame->eye[axis] + (frame->camera->parallel ? offset : 0.0);
    ray->direction[axis] = frame->forward[axis] + (frame->camera->parallel ? 0.0 : offset);
  }
  ray->t_min = frame->camera->near_k;
  ray->t_max = frame->camera->far_k;
  *pixel = (stratus_first_hit_pixel){ .x = x, .y = y, .cut = STRATUS_CUT_NEAR };
  if (frame->image->opaque_depth) {
    const float depth = frame->image->opaque_depth[(size_t)y * (size_t)frame->image->width + x];
    ray->t_max = fmin(ray->t_max, stratus_camera_place(frame->camera, (double)depth));
  }
  for (uint32_t side = 0; frame->options->clipping.crop && side < 6; ++side) {
    const uint32_t axis = side / 2;
    const double sign = side % 2 ? -1.0 : 1.0;
    cut(sign * (ray->origin[axis] - frame->crop[side]), fabs(ray->origin[axis]) + fabs(frame->crop[side]), sign * ray->direction[axis],
      STRATUS_CUT_CROP + side, ray, &pixel->cut);
  }
  for (int p = 0; p < frame->options->clipping.clip_plane_count; ++p) {
    const double* plane = frame->planes[p];
    const double terms[4] = { plane[0] * ray->origin[0], plane[1] * ray->origin[1], plane[2] * ray->origin[2], plane[3] };
    const double height = terms[0] + terms[1] + terms[2] + terms[3];
    const double size = fabs(terms[0]) + fabs(terms[1]) + fabs(terms[2]) + fabs(terms[3]);
    const double slope = plane[0] * ray->direction[0] + plane[1] * ray->direction[1] + plane[2] * ray->direction[2];
    cut(height, size, slope, STRATUS_CUT_PLANE + (uint32_t)p, ray, &pixel->cut);
  }
  return ray->t_min <= ray->t_max && meets(frame, ray);
}

/* Store the rays of one row of tiles from index `at` on: all rays of a tile if one of them can meet a voxel. Returns their count. */
static size_t make_row(first_hit_frame* frame, int tile_row, size_t at)
{
  size_t count = 0;
  for (int x0 = frame->window[0]; x0 < frame->window[1]; x0 += TILE) {
    bool any = false;
    for (int i = 0; i < TILE * TILE; ++i) {
      const int x = x0 + i % TILE, y = tile_row * TILE + i / TILE;
      const bool inside = x < frame->window[1] && y >= frame->window[2] && y < frame->window[3];
      stratus_ray* const ray = &frame->rays[at + count + (size_t)i];
      stratus_first_hit_pixel* const pixel = &frame->pixels[at + count + (size_t)i];
      if (inside && make_ray(frame, (uint32_t)x, (uint32_t)y, ray, pixel)) {
        any = true;
      } else {
        *ray = (stratus_ray){ .direction = { 1.0 }, .t_max = -1.0 };
        pixel->x = NO_PIXEL;
      }
    }
    count += any ? TILE * TILE : 0;
  }
  return count;
}

/* Most rays of a row of tiles. */
static size_t row_rays(const first_hit_frame* frame)
{
  return (size_t)((frame->window[1] - frame->window[0] + TILE - 1) / TILE) * TILE * TILE;
}

/* Stores the rays of a batch without gaps; returns their count. counts: scratch, one for each row. */
static size_t make_batch(const stratus_context* context, first_hit_frame* frame, int first, int rows, size_t* counts)
{
  const size_t pitch = row_rays(frame);
#pragma omp parallel for schedule(dynamic) num_threads(context->threads)
  for (int row = 0; row < rows; ++row) {
    counts[row] = make_row(frame, first + row, (size_t)row * pitch);
  }
  size_t count = 0;
  for (int row = 0; row < rows; ++row) {
    memmove(frame->rays + count, frame->rays + (size_t)row * pitch, counts[row] * sizeof *frame->rays);
    memmove(frame->pixels + count, frame->pixels + (size_t)row * pitch, counts[row] * sizeof *frame->pixels);
    count += counts[row];
  }
  return count;
}

/* ---- pixels */

static void shade(const first_hit_frame* frame, size_t ray, const stratus_hit* hit, float rgba[4], float* depth)
{
  memset(rgba, 0, 4 * sizeof *rgba);
  *depth = INFINITY;
  if (hit->voxel[0] >= 0) {
    stratus_shader_apply(&frame->shader, &frame->rays[ray], frame->pixels[ray].cut, hit->voxel, rgba, depth);
  }
}

static void shade_batch(const stratus_context* context, const first_hit_frame* frame, size_t count, stratus_ray_cast_report* report)
{
  const stratus_image* image = frame->image;
  uint64_t rays = 0, samples = 0, lookups = 0, differing = 0;
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(+ : rays, samples, lookups, differing)
  for (size_t ray = 0; ray < count; ++ray) {
    const stratus_hit* hit = &frame->hits[ray];
    if (frame->pixels[ray].x == NO_PIXEL) {
      continue;
    }
    ++rays;
    const size_t at = (size_t)frame->pixels[ray].y * (size_t)image->width + frame->pixels[ray].x;
    float depth, plain_depth, plain_rgba[4];
    shade(frame, ray, hit, image->rgba + 4 * at, &depth);
    samples += hit->voxel[0] >= 0;
    lookups += hit->visited;
    if (image->depth) {
      image->depth[at] = depth;
    }
    for (int c = 0; image->rgba8 && c < 4; ++c) {
      image->rgba8[4 * at + (size_t)c] = stratus_image_byte(image->rgba[4 * at + (size_t)c]);
    }
    if (image->samples) {
      image->samples[at] = hit->voxel[0] >= 0;
    }
    if (frame->plain_hits) {
      shade(frame, ray, &frame->plain_hits[ray], plain_rgba, &plain_depth);
      differing += memcmp(plain_rgba, image->rgba + 4 * at, sizeof plain_rgba) != 0 || memcmp(&plain_depth, &depth, sizeof depth) != 0;
    }
  }
  report->rays += rays;
  report->samples += samples;
  report->lookups += lookups;
  report->differing_pixels += differing;
}

static stratus_status draw_batch(
  stratus_context* context, first_hit_frame* frame, int first, int rows, size_t* counts, stratus_ray_cast_report* report)
{
  const size_t count = make_batch(context, frame, first, rows, counts);
  if (count == 0) {
    return STRATUS_OK;
  }
  if (frame->scene.tree && frame->scene.borders) {
    TRY(stratus_tree_first_voxels_between(context, frame->scene.tree, frame->scene.borders, frame->rays, count, frame->hits));
  } else if (frame->scene.tree) {
    TRY(stratus_tree_first_hit(context, frame->scene.tree, frame->rays, count, frame->hits));
  } else {
    TRY(stratus_voxels_first_hit_between(context, frame->scene.voxels, frame->scene.borders, frame->rays, count, frame->hits));
  }
  if (frame->plain_hits) {
    TRY(stratus_voxels_first_hit_between(context, frame->scene.voxels, frame->scene.borders, frame->rays, count, frame->plain_hits));
  }
  shade_batch(context, frame, count, report);
  return STRATUS_OK;
}

static stratus_status draw(stratus_context* context, first_hit_frame* frame, stratus_ray_cast_report* report)
{
  const int first = frame->window[2] / TILE, last = (frame->window[3] + TILE - 1) / TILE;
  const int width = frame->window[1] - frame->window[0];
  void *rays = NULL, *pixels = NULL, *hits = NULL, *plain_hits = NULL, *counts = NULL;
  stratus_status status = STRATUS_OK;
  if (width <= 0 || last <= first) {
    return STRATUS_OK;
  }
  const size_t row = row_rays(frame);
  const int fitting = (int)(BATCH_RAYS / row), rows = fitting < 1 ? 1 : fitting < last - first ? fitting : last - first;
  const size_t most = row * (size_t)rows;
  TRY_CLEANUP(stratus_allocate(context, most, sizeof *frame->rays, &rays));
  TRY_CLEANUP(stratus_allocate(context, most, sizeof *frame->pixels, &pixels));
  TRY_CLEANUP(stratus_allocate(context, most, sizeof *frame->hits, &hits));
  TRY_CLEANUP(stratus_allocate(context, (size_t)rows, sizeof(size_t), &counts));
  if (frame->options->skipping.audit) {
    TRY_CLEANUP(stratus_allocate(context, most, sizeof *frame->plain_hits, &plain_hits));
  }
  frame->rays = rays;
  frame->pixels = pixels;
  frame->hits = hits;
  frame->plain_hits = plain_hits;
  for (int r = first; r < last; r += rows) {
    const int left = last - r;
    TRY_CLEANUP(stratus_progress(context, "first hits", (double)(r - first) / (last - first)));
    TRY_CLEANUP(draw_batch(context, frame, r, left < rows ? left : rows, counts, report));
  }
  status = stratus_progress(context, "first hits", 1.0);
cleanup:
  stratus_release(context, rays);
  stratus_release(context, pixels);
  stratus_release(context, hits);
  stratus_release(context, plain_hits);
  stratus_release(context, counts);
  return status;
}

/* ---- set-up */

static void set_limits(const stratus_volume* volume, const double index_to_world[16], first_hit_frame* frame)
{
  const double half = volume->cell_centered ? 0.5 : 0.0;
  for (int side = 0; side < 6; ++side) {
    const double spacing = stratus_volume_spacing(volume, side / 2);
    const double begin = volume->origin[side / 2] + stratus_volume_begin(volume, side / 2);
    const int from = spacing < 0.0 ? side ^ 1 : side; /* falling coordinates turn the sides round */
    frame->crop[side] = (frame->options->clipping.crop_bounds[from] - begin) / spacing - half;
  }
  for (int p = 0; p < frame->options->clipping.clip_plane_count; ++p) {
    const double* plane = frame->options->clipping.clip_planes[p];
    for (int column = 0; column < 4; ++column) {
      frame->planes[p][column] = column == 3 ? plane[3] : 0.0;
      for (int row = 0; row < 3; ++row) {
        frame->planes[p][column] += plane[row] * index_to_world[4 * row + column];
      }
    }
  }
}

static void set_window(first_hit_frame* frame)
{
  const int sides[2] = { frame->image->width, frame->image->height };
  memset(frame->window, 0, sizeof frame->window);
  if (frame->scene.lo[0] < frame->scene.hi[0]) {
    stratus_camera_window(frame->eye, frame->right, frame->up, frame->forward, frame->camera->parallel != 0, frame->scene.lo,
      frame->scene.hi, sides, frame->window);
  }
}

/* Draws the followed component, in the colours of the others. */
static stratus_status render(stratus_ray_caster* caster, const stratus_volume* whole, const stratus_transfer* transfer,
  const stratus_voxel_borders* borders, first_hit_frame* frame, stratus_ray_cast_report* report)
{
  const int followed = stratus_ray_followed(whole, frame->options);
  const stratus_volume view = stratus_volume_component(whole, followed), *volume = &view;
  stratus_context* context = caster->context;
  const stratus_camera* camera = frame->camera;
  const stratus_ray_cast_options* options = frame->options;
  double index_to_world[16], world_to_index[16];
  stratus_volume_index_to_world(volume, index_to_world);
  if (!stratus_matrix_invert_affine(index_to_world, world_to_index)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the volume's matrix has no inverse");
  }
  TRY(stratus_first_hit_update(caster, volume, transfer, borders, options, &frame->scene, report));
  const double start = stratus_now_ms();
  stratus_matrix_point(world_to_index, camera->eye, frame->eye);
  stratus_matrix_vector(world_to_index, camera->forward, frame->forward);
  stratus_matrix_vector(world_to_index, camera->right, frame->right);
  stratus_matrix_vector(world_to_index, camera->up, frame->up);
  set_limits(volume, index_to_world, frame);
  set_window(frame);
  stratus_shader_set(&frame->shader, volume, borders, transfer, camera, options, index_to_world, world_to_index);
  if (followed) {
    stratus_shader_set_colors(&frame->shader, whole);
  }
  stratus_image_clear(frame->image);
  TRY(draw(context, frame, report));
  const int64_t* n = volume->dimensions;
  report->blocks = (uint64_t)((n[0] + 3) / 4) * (uint64_t)((n[1] + 3) / 4) * (uint64_t)((n[2] + 3) / 4);
  memcpy(report->window, frame->window, sizeof report->window);
  report->occupancy_builds = caster->structure.occupancy_builds;
  report->structure_builds = caster->structure.structure_builds;
  report->range_builds = caster->field.range_builds;
  report->table_builds = caster->optics.table_builds;
  report->uploads = caster->uploads;
  report->cast_ms = stratus_now_ms() - start;
  return STRATUS_OK;
}

stratus_status stratus_first_hit_render(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report)
{
  stratus_context* context = caster->context;
  first_hit_frame frame = { .options = options, .image = image, .camera = camera };
  stratus_voxel_borders borders;
  void* memory = NULL;
  const bool stretched = stratus_volume_is_stretched(volume);
  TRY(stratus_camera_check(context, camera, image));
  if (options->light.shading.on) {
    TRY(stratus_shading_check(context, &options->light.shading));
  }
  if (stretched) {
    TRY(stratus_first_hit_borders(context, volume, &borders, &memory));
  }
  const stratus_status status = render(caster, volume, transfer, stretched ? &borders : NULL, &frame, report);
  stratus_release(context, memory);
  return status;
}
