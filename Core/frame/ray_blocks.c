/* SPDX-License-Identifier: BSD-3-Clause
 * Draws the blocks of a volume that was cut into grids of their own: from front to back, each by its own caster in the part of the picture
 * that it covers, and blends the parts as floats. */
#include "block_order.h"
#include "block_window.h"
#include "camera.h"
#include "picture.h"
#include "ray_caster.h"
#include "ray_kept.h"
#include "ray_light.h"
#include "ray_probe_blocks.h"
#include "ray_several_picture.h"
#include "vector.h"
#include "volume.h"

#include <stdio.h>
#include <string.h>

/* Blocks that reach into one another by less than this share of the shortest voxel edge lie side by side. */
#define SLACK 1e-3

typedef struct blocks {
  stratus_context* context;
  const stratus_ray_cast_input* inputs;
  int count;
  const stratus_camera* camera;
  const stratus_image* image;
  int overlap[2];     /* two blocks that overlap; -1: none does */
  stratus_image part; /* room for the part of the picture that a block covers */
  float* ends;        /* of its rays */
  stratus_kept* kept; /* modes whose rays keep a number, and surfaces of blocks that overlap; else NULL */
  bool more;          /* surfaces: farther ones may be seen */
} blocks;

/* The camera of a part of the picture, whose pixels have the rays that they have in the whole. */
static stratus_camera camera_of(const blocks* b, const int window[4])
{
  const int sides[2] = { b->image->width, b->image->height };
  stratus_camera part = *b->camera;
  double center[2], half[2];
  for (int side = 0; side < 2; ++side) {
    center[side] = (double)(window[2 * side] + window[2 * side + 1]) / sides[side] - 1.0;
    half[side] = (double)(window[2 * side + 1] - window[2 * side]) / sides[side];
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double sideways = center[0] * part.right[axis] + center[1] * part.up[axis];
    if (part.parallel) {
      part.eye[axis] += sideways;
    } else {
      part.forward[axis] += sideways;
    }
    part.right[axis] *= half[0];
    part.up[axis] *= half[1];
  }
  return part;
}

/* Blends the part behind what the picture has. inside: the pixels of the part that show something. */
static void blend_behind(const blocks* b, const int window[4], const int inside[4])
{
  const stratus_image* image = b->image;
  const int width = window[1] - window[0];
  for (int y = inside[2]; y < inside[3]; ++y) {
    const size_t to = (size_t)(window[2] + y) * (size_t)image->width + (size_t)window[0], from = (size_t)y * (size_t)width;
    for (int x = inside[0]; x < inside[1]; ++x) {
      float* sum = image->rgba + 4 * (to + (size_t)x);
      const float* add = b->part.rgba + 4 * (from + (size_t)x);
      const float clear = 1.0f - sum[3];
      for (int c = 0; c < 4; ++c) {
        sum[c] += clear * add[c];
      }
      if (image->depth && image->depth[to + (size_t)x] == INFINITY) {
        image->depth[to + (size_t)x] = b->part.depth[from + (size_t)x];
      }
      if (image->samples) {
        image->samples[to + (size_t)x] += b->part.samples[from + (size_t)x];
      }
    }
  }
}

/* Draw one block, and report on it in coordinates of the whole image. */
static stratus_status draw_block(blocks* b, int number, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_input* in = &b->inputs[number];
  stratus_ray_cast_options options = in->options ? *in->options : stratus_ray_cast_options_default();
  stratus_image part = b->part;
  int window[4];
  bool ends = false;
  stratus_block_window(in->volume, b->camera, b->image, window);
  if (window[0] >= window[1] || window[2] >= window[3] ||
    !stratus_kept_ends(b->kept, number, b->image, b->camera, window, stratus_kept_least(&options), b->ends, &ends)) {
    snprintf(report->why, sizeof report->why, "not drawn: nothing of the block can be seen");
    return STRATUS_OK;
  }
  part.width = window[1] - window[0];
  part.height = window[3] - window[2];
  part.opaque_depth = ends ? b->ends : NULL;
  options.sampling.tolerance = stratus_block_tolerance(options.sampling.tolerance, b->count);
  const stratus_camera camera = camera_of(b, window);
  if (b->kept) {
    TRY(stratus_kept_draw(b->kept, number, &camera, &options, &part, report));
    TRY(stratus_kept_join(b->kept, number, &part, window[0], window[2], report->window));
    b->more = b->more || !b->kept->pixels;
  } else {
    TRY(stratus_ray_caster_render(in->caster, in->volume, in->transfer, &camera, &options, &part, report));
    blend_behind(b, window, report->window);
  }
  for (int side = 0; side < 4; ++side) {
    report->window[side] += window[side / 2 * 2];
  }
  if (!b->kept && (number == b->overlap[0] || number == b->overlap[1])) {
    const size_t length = strlen(report->why);
    snprintf(report->why + length, sizeof report->why - length, "; overlaps block %d", b->overlap[number == b->overlap[0]]);
  }
  return STRATUS_OK;
}

/* ---- order */

/* Gives the ends, in mean index coordinates, of the cells that a block draws: its own, without layers of its neighbours'. */
static void find_ends(const stratus_ray_cast_input* in, double ends[2][3])
{
  const stratus_volume* volume = in->volume;
  const double half = volume->cell_centered ? 0.5 : 0.0;
  int64_t owned[2][3];
  if (in->caster->field.ranges && stratus_volume_same_data(&in->caster->field.volume, volume)) { /* else all flags are read */
    memcpy(owned, in->caster->field.owned, sizeof owned);
  } else {
    stratus_volume_owned(volume, owned[0], owned[1]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double* x = volume->coordinates[axis];
    for (int end = 0; end < 2; ++end) {
      const int64_t last = volume->dimensions[axis] - (volume->cell_centered ? 0 : 1); /* flat grids have a cell without an extent */
      const int64_t border = owned[end][axis] < last ? owned[end][axis] : last;
      ends[end][axis] = (x ? (x[border] - x[0]) / stratus_volume_spacing(volume, axis) : (double)border) - half;
    }
  }
}

/* Sets boxes and eye in the coordinates of the first block's axes, each of which has the world's unit. */
static stratus_status measure(const blocks* b, stratus_block_box* boxes, stratus_block_eye* eye, double* slack)
{
  double axes[16], to_axes[16];
  stratus_volume_index_to_world(b->inputs[0].volume, axes);
  for (int axis = 0; axis < 3; ++axis) {
    const double edge = sqrt(axes[axis] * axes[axis] + axes[4 + axis] * axes[4 + axis] + axes[8 + axis] * axes[8 + axis]);
    for (int row = 0; row < 3; ++row) {
      axes[4 * row + axis] /= edge;
    }
  }
  if (!stratus_matrix_invert_affine(axes, to_axes)) {
    return stratus_fail(b->context, STRATUS_INVALID_ARGUMENT, "the axes of block 0 are in one plane");
  }
  eye->parallel = b->camera->parallel != 0;
  (eye->parallel ? stratus_matrix_vector : stratus_matrix_point)(to_axes, eye->parallel ? b->camera->forward : b->camera->eye, eye->point);
  *slack = INFINITY;
  for (int n = 0; n < b->count; ++n) {
    const stratus_volume* volume = b->inputs[n].volume;
    double to_world[16], ends[2][3];
    stratus_volume_index_to_world(volume, to_world);
    find_ends(&b->inputs[n], ends);
    boxes[n] = (stratus_block_box){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for (int axis = 0; axis < 3; ++axis) {
      const double edge[3] = { to_world[axis], to_world[4 + axis], to_world[8 + axis] };
      *slack = fmin(*slack, SLACK * sqrt(stratus_vector_dot(edge, edge)));
    }
    for (int corner = 0; corner < 8; ++corner) {
      double index[3], world[3], point[3];
      for (int axis = 0; axis < 3; ++axis) {
        index[axis] = ends[corner >> axis & 1][axis];
      }
      stratus_matrix_point(to_world, index, world);
      stratus_matrix_point(to_axes, world, point);
      for (int axis = 0; axis < 3; ++axis) {
        boxes[n].lo[axis] = fmin(boxes[n].lo[axis], point[axis]);
        boxes[n].hi[axis] = fmax(boxes[n].hi[axis], point[axis]);
      }
    }
  }
  return STRATUS_OK;
}

static stratus_status check(const blocks* b)
{
  for (int n = 0; n < b->count; ++n) {
    const stratus_ray_cast_input* in = &b->inputs[n];
    if (!in->caster || in->tetra) {
      return stratus_fail(
        b->context, STRATUS_INVALID_ARGUMENT, "block %d has no ray caster: caster is NULL, or tetra is not; blocks are volumes", n);
    }
    if (in->caster->context != b->context) {
      return stratus_fail(
        b->context, STRATUS_INVALID_ARGUMENT, "the ray caster of block %d has another context than the one of block 0", n);
    }
    TRY(stratus_volume_check(b->context, in->volume));
    if (stratus_kept_mode(in) != stratus_kept_mode(b->inputs)) {
      return stratus_fail(b->context, STRATUS_INVALID_ARGUMENT, "block %d has mode %s, block 0 has %s: blocks are one picture of one mode",
        n, stratus_mode_name(stratus_kept_mode(in)), stratus_mode_name(stratus_kept_mode(b->inputs)));
    }
    if (b->kept) { /* else the picture of each block checks its input */
      const int components = stratus_ray_parts(in->volume, in->options),
                first = stratus_ray_parts(b->inputs[0].volume, b->inputs[0].options);
      if (components != first) {
        return stratus_fail(b->context, STRATUS_INVALID_ARGUMENT,
          "block %d has %d independent components, block 0 has %d: in mode %s all need the same", n, components, first,
          stratus_mode_name(stratus_kept_mode(in)));
      }
      TRY(stratus_ray_check_input(b->context, in->volume, in->transfer, in->options));
    }
  }
  return STRATUS_OK;
}

/* Draws the blocks in the order given, of one component if rays keep a number, of one surface of each ray if they keep surfaces. */
static stratus_status draw_all(blocks* b, const int* order, stratus_ray_cast_report* reports)
{
  for (int i = 0; i < b->count; ++i) {
    const int number = order[i];
    stratus_ray_cast_report report = { .expected_error = NAN, .tolerance_met = 1 };
    const stratus_status status = draw_block(b, number, &report);
    if (status != STRATUS_OK) {
      char message[sizeof b->context->message];
      memcpy(message, b->context->message, sizeof message);
      return stratus_fail(b->context, status, "block %d: %.900s", number, message);
    }
    if (reports && b->kept) {
      stratus_kept_report(b->kept, &reports[number], &report);
    } else if (reports) {
      reports[number] = report;
    }
  }
  return STRATUS_OK;
}

/* Draws one component after the other, and surfaces from the nearest on. */
static stratus_status draw_kept(blocks* b, const int* order, stratus_ray_cast_report* reports)
{
  stratus_status status = STRATUS_OK;
  TRY(stratus_kept_create(b->kept));
  const int components = stratus_ray_parts(b->inputs[0].volume, b->inputs[0].options);
  for (int c = 0; c < components && status == STRATUS_OK; ++c) {
    stratus_kept_begin(b->kept, c);
    b->more = true;
    for (b->kept->pass = 0; b->more && status == STRATUS_OK; ++b->kept->pass) {
      b->more = false;
      status = draw_all(b, order, reports);
    }
    stratus_kept_finish(b->kept);
  }
  stratus_kept_destroy(b->kept);
  return status;
}

stratus_status stratus_ray_caster_render_blocks(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports)
{
  if (!inputs || !inputs[0].caster) {
    return STRATUS_INVALID_ARGUMENT;
  }
  blocks b = { .context = inputs[0].caster->context, .inputs = inputs, .count = count, .camera = camera, .image = image };
  stratus_status status = STRATUS_OK;
  void *boxes = NULL, *order = NULL, *ends = NULL;
  stratus_block_eye eye;
  double slack = 0.0;
  if (count < 1) {
    return stratus_fail(b.context, STRATUS_INVALID_ARGUMENT, "%d blocks, must be 1 or more", count);
  }
  if (count == 1) {
    return stratus_ray_caster_render(inputs[0].caster, inputs[0].volume, inputs[0].transfer, camera, inputs[0].options, image, reports);
  }
  stratus_kept kept = { .context = b.context, .mode = stratus_kept_mode(inputs), .one_field = true, .inputs = inputs, .image = image };
  b.kept = stratus_kept_is(kept.mode) ? &kept : NULL;
  TRY(check(&b));
  TRY(stratus_image_check(b.context, image));
  TRY(stratus_camera_check(b.context, camera, image));
  stratus_image_clear(image);
  TRY_CLEANUP(stratus_allocate(b.context, (size_t)count, sizeof(stratus_block_box), &boxes));
  TRY_CLEANUP(stratus_allocate(b.context, (size_t)count, sizeof(int), &order));
  TRY_CLEANUP(measure(&b, boxes, &eye, &slack));
  TRY_CLEANUP(stratus_block_order(b.context, boxes, count, &eye, slack, order, b.overlap));
  if (kept.mode != STRATUS_MODE_COMPOSITE && b.overlap[0] >= 0) { /* surfaces of blocks side by side are behind one another, as light */
    if (!b.kept && stratus_ray_parts(inputs[0].volume, inputs[0].options) > 1) {
      status = stratus_several_kept(inputs, count, camera, image, reports);
      goto cleanup;
    }
    b.kept = &kept;
    kept.layers.least = stratus_kept_least(inputs[0].options);
    TRY_CLEANUP(check(&b));
  }
  /* as large as the largest part may be */
  TRY_CLEANUP(b.kept ? stratus_kept_part_create(b.kept, &b.part) : stratus_image_part_create(b.context, image, &b.part));
  TRY_CLEANUP(stratus_allocate(b.context, (size_t)image->width * (size_t)image->height, sizeof(float), &ends));
  b.ends = ends;
  stratus_ray_cast_report light = { .light_ms = 0.0 };
  if (kept.mode != STRATUS_MODE_QUANTITIES) { /* which leave a picture's maps as they are */
    status = stratus_ray_light_update_several(inputs, count, true, camera, stratus_ray_caster_render_blocks, &light);
  }
  if (status == STRATUS_OK && !b.kept) {
    const stratus_probe_blocks shared = { inputs, count, camera, image };
    stratus_probe_blocks_share(&shared, &shared);
    status = draw_all(&b, order, reports);
    stratus_probe_blocks_share(&shared, NULL);
  } else if (status == STRATUS_OK) {
    status = draw_kept(&b, order, reports);
  }
  stratus_ray_light_return(inputs, count);
  stratus_ray_light_report(&light, reports, count);
  if (status != STRATUS_OK) {
    goto cleanup;
  }
  stratus_image_fill_bytes(image);
cleanup:
  stratus_release(b.context, boxes);
  stratus_release(b.context, order);
  stratus_image_part_destroy(b.context, &b.part);
  stratus_release(b.context, ends);
  return status;
}
