/* SPDX-License-Identifier: BSD-3-Clause
 * Rays that stand for all pictures of a volume: where they go, and how much each counts. */
#include "ray_probe_rays.h"

#include "matrix.h"
#include "vector.h"

#include <string.h>

/* Parts of the value range at whose borders the functions' variation is known. */
#define BINS 512
#define CLASSES STRATUS_PROBE_CLASSES
/* Distance between neighbouring rays of a patch, in voxels: far enough that their errors differ, near enough that they share memory. */
#define PITCH 1.3
/* A ray counts as crossing at least this much of a block, so that no weight grows without bound where rays graze a block's corner. */
#define CHORD_LEAST 0.25

/* ---- numbers without order: the same on every machine */

static double uniform_of(uint32_t number, uint32_t stream)
{
  uint32_t h = number * 0x9e3779b1u ^ stream * 0x85ebca77u;
  h = (h ^ h >> 16) * 0x85ebca6bu; /* Murmur3's finalizer (Appleby) */
  h = (h ^ h >> 13) * 0xc2b2ae35u;
  h ^= h >> 16;
  return (h + 0.5) * 0x1p-32;
}

/* ---- variation of the transfer functions */

/* Colour times opacity, and opacity, of a voxel's length at one value. */
static void appearance(const stratus_transfer* transfer, double voxel, double value, double out[4])
{
  stratus_transfer_at(transfer, value, out);
  out[3] = out[3] > 0.0 ? -expm1(log1p(-out[3]) * voxel / transfer->unit_distance) : 0.0;
  for (int c = 0; c < 3; ++c) {
    out[c] *= out[3];
  }
}

static double change_between(const double a[4], const double b[4])
{
  double largest = 0.0;
  for (int c = 0; c < 4; ++c) {
    largest = fmax(largest, fabs(a[c] - b[c]));
  }
  return largest;
}

/* Sum of all changes of a function's appearance below each bin's border, the optical depth of a voxel's length there, and the greatest. */
typedef struct variation {
  double from, per_bin; /* bin of value v: (v - from) * per_bin */
  double deepest;
  float below[BINS + 1], depth[BINS + 1];
} variation;

/* Optical depth of the opacity of an appearance. */
static double depth_of(const double seen[4])
{
  return -log1p(-seen[3]);
}

/* Add the variation between the last place and x, and the step at x, to `sum`. last: the appearance at the last place; receives the
 * appearance at x. */
static void pass(const stratus_transfer* transfer, double voxel, double x, double last[4], variation* v, double* sum)
{
  double before[4], at[4];
  appearance(transfer, voxel, nextafter(x, -INFINITY), before);
  appearance(transfer, voxel, x, at);
  *sum += change_between(last, before) + change_between(before, at);
  v->deepest = fmax(v->deepest, fmax(depth_of(before), depth_of(at)));
  memcpy(last, at, sizeof at);
}

static void measure_variation(const stratus_transfer* transfer, double voxel, double lo, double hi, variation* v)
{
  const double width = (hi - lo) / BINS;
  double last[4], sum = 0.0, passed = lo;
  size_t opacity = 0, color = 0;
  v->from = lo;
  v->per_bin = width > 0.0 ? 1.0 / width : 0.0;
  appearance(transfer, voxel, lo, last);
  v->deepest = depth_of(last);
  for (int bin = 0; bin <= BINS; ++bin) {
    const double border = lo + bin * width;
    for (;;) { /* the function's points below the border, in ascending order */
      const double next_opacity = opacity < transfer->opacity_count ? transfer->opacity[2 * opacity] : INFINITY;
      const double next_color = color < transfer->color_count ? transfer->color[4 * color] : INFINITY;
      const double next = fmin(next_opacity, next_color);
      if (!(next <= border)) {
        break;
      }
      if (next > lo) {
        pass(transfer, voxel, next, last, v, &sum);
        passed = next;
      }
      while (opacity < transfer->opacity_count && transfer->opacity[2 * opacity] <= next) {
        ++opacity; /* a step's points are one place */
      }
      while (color < transfer->color_count && transfer->color[4 * color] <= next) {
        ++color;
      }
    }
    if (border > passed) { /* a point may be at the very border */
      pass(transfer, voxel, border, last, v, &sum);
      passed = border;
    }
    v->below[bin] = (float)sum;
    v->depth[bin] = (float)depth_of(last);
  }
}

static int bin_of(const variation* v, double value)
{
  const double bin = (value - v->from) * v->per_bin;
  return bin > 0.0 ? bin < BINS ? (int)bin : BINS - 1 : 0;
}

static double variation_between(const variation* v, double lo, double hi)
{
  return (double)v->below[bin_of(v, hi) + 1] - (double)v->below[bin_of(v, lo)];
}

/* ---- classes of blocks */

static int class_of(double changes)
{
  int exponent = 0;
  (void)frexp(changes, &exponent);
  const int c = -exponent / 2;
  return !(changes > 0.0) ? CLASSES - 1 : c < 0 ? 0 : c < CLASSES ? c : CLASSES - 1;
}

/* Whether medium m reads component c of the volume. */
static int component_of(const stratus_ray_caster* caster, int m)
{
  const int components = caster->field.components;
  return components <= 1 || caster->optics.transfer_2d.on ? 0 : caster->optics.transfer_count == 1 ? components - 1 : m;
}

/* Returns the first index from `at` on whose byte is another than `value`, or `end`. */
static int64_t pass_bytes(const uint8_t* bytes, uint8_t value, int64_t at, int64_t end)
{
  const uint64_t eight = value * UINT64_C(0x0101010101010101);
  for (uint64_t word = eight; at + 8 <= end; at += 8) {
    memcpy(&word, bytes + at, sizeof word);
    if (word != eight) {
      break;
    }
  }
  while (at < end && bytes[at] == value) {
    ++at;
  }
  return at;
}

/* Where rows of blocks begin and end along x within the box of the occupied blocks, by their number. */
static void row_of(const stratus_occupancy* occupancy, int64_t row, int64_t* begin, int64_t* end)
{
  const int64_t *lo = occupancy->lo, *hi = occupancy->hi, ny = hi[1] - lo[1];
  *begin = ((lo[2] + row / ny) * occupancy->blocks[1] + lo[1] + row % ny) * occupancy->blocks[0] + lo[0];
  *end = *begin + hi[0] - lo[0];
}

static int64_t rows_of(const stratus_occupancy* occupancy)
{
  return (occupancy->hi[1] - occupancy->lo[1]) * (occupancy->hi[2] - occupancy->lo[2]);
}

/* Add a medium's share of a block's possible contribution: changes of the function, and the optical depth at its least value. */
static void add_medium(const variation* v, const stratus_value_range* r, int64_t b, double* changes, double* depth)
{
  if (r->lo[b] <= r->hi[b]) {
    const double lo = (double)r->lo[b] + r->bias;
    *changes += variation_between(v, lo, (double)r->hi[b] + r->bias);
    *depth += (double)v->depth[bin_of(v, lo)];
  }
}

static stratus_status classify(const stratus_ray_caster* caster, double voxel, stratus_probe_classes* k)
{
  const stratus_occupancy* occupancy = caster->structure.occupancy;
  const int64_t blocks = occupancy->blocks[0] * occupancy->blocks[1] * occupancy->blocks[2];
  const int media = caster->optics.transfer_count;
  void *memory = NULL, *variations = NULL;
  stratus_status status = STRATUS_OK;
  memcpy(k->blocks, occupancy->blocks, sizeof k->blocks);
  k->block_size = occupancy->block_size;
  TRY(stratus_allocate(caster->context, (size_t)blocks, 1, &memory));
  k->of = memory;
  TRY_CLEANUP(stratus_allocate(caster->context, (size_t)media, sizeof(variation), &variations));
  variation* v = variations;
  for (int m = 0; m < media; ++m) {
    const stratus_value_range* ranges = stratus_ray_range_of(&caster->field, component_of(caster, m));
    const bool any = ranges->whole_lo <= ranges->whole_hi;
    measure_variation(caster->optics.transfers + m, voxel, any ? (double)ranges->whole_lo + ranges->bias : 0.0,
      any ? (double)ranges->whole_hi + ranges->bias : 0.0, v + m);
  }
  k->deepest = 0.0;
  const bool labels = media > 1 && caster->field.components <= 1; /* of which one holds at a place */
  for (int m = 0; m < media; ++m) {
    k->deepest = labels ? fmax(k->deepest, v[m].deepest) : k->deepest + v[m].deepest;
  }
  memset(k->count, 0, sizeof k->count);
  memset(k->depth, 0, sizeof k->depth);
  memset(k->of, CLASSES, (size_t)blocks);
#pragma omp parallel num_threads(caster->context->threads)
  {
    int64_t mine[CLASSES] = { 0 };
    double deepest[CLASSES] = { 0.0 };
#pragma omp for schedule(static) nowait
    for (int64_t row = 0; row < rows_of(occupancy); ++row) {
      int64_t b, end;
      row_of(occupancy, row, &b, &end);
      for (b = pass_bytes(occupancy->occupied, 0, b, end); b < end; b = pass_bytes(occupancy->occupied, 0, b + 1, end)) {
        double changes = 0.0, depth = 0.0;
        for (int m = 0; m < media; ++m) {
          add_medium(v + m, stratus_ray_range_of(&caster->field, component_of(caster, m)), b, &changes, &depth);
        }
        const int c = class_of(changes);
        k->of[b] = (uint8_t)c;
        deepest[c] = fmax(deepest[c], depth);
        ++mine[c];
      }
    }
#pragma omp critical(stratus_probe_classes)
    for (int c = 0; c < CLASSES; ++c) {
      k->count[c] += mine[c];
      k->depth[c] = fmax(k->depth[c], deepest[c]);
    }
  }
cleanup:
  stratus_release(caster->context, variations);
  if (status != STRATUS_OK) {
    stratus_release(caster->context, k->of);
    k->of = NULL;
  }
  return status;
}

/* Deals the patches to the classes: half of them by the number of blocks, half of them evenly. */
static void deal(const stratus_probe_classes* k, int dealt[CLASSES])
{
  int64_t whole = 0;
  int used = 0, rest = STRATUS_PROBE_PATCHES, most = 0;
  for (int c = 0; c < CLASSES; ++c) {
    whole += k->count[c];
    used += k->count[c] > 0;
    most = k->count[c] > k->count[most] ? c : most;
  }
  for (int c = 0; c < CLASSES; ++c) {
    const double share = k->count[c] > 0 ? 0.5 / used + 0.5 * (double)k->count[c] / (double)whole : 0.0;
    dealt[c] = (int)(share * STRATUS_PROBE_PATCHES);
    rest -= dealt[c];
  }
  dealt[most] += rest;
}

/* ---- patches */

/* Returns where a block begins on an axis, in blocks of equal size. */
static double block_begin(const stratus_ray_grid* grid, const stratus_probe_classes* k, int axis, int64_t block)
{
  const double last = grid->table ? (double)(grid->dimensions[axis] - 1) : 0.0, index = (double)(block * k->block_size);
  return !grid->table || index > last ? (double)block : stratus_ray_grid_at(grid, axis, index) / k->block_size;
}

/* Adds up the length, in blocks, that the line through p along d crosses of each class. Positions are in blocks; on grids whose spacing
 * changes, in blocks of the mean size. */
static void measure_chords(const stratus_ray_grid* grid, const stratus_probe_classes* k, const int64_t home[3], const double p[3],
  const double d[3], double chords[CLASSES])
{
  double begin = -INFINITY, end = INFINITY, next[3], step[3];
  int64_t cell[3];
  memset(chords, 0, CLASSES * sizeof *chords);
  for (int axis = 0; axis < 3; ++axis) {
    const double a = -p[axis] / d[axis], b = ((double)k->blocks[axis] - p[axis]) / d[axis];
    begin = fmax(begin, fmin(a, b));
    end = fmin(end, fmax(a, b));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double at = p[axis] + begin * d[axis];
    cell[axis] = at > 0.0 ? (int64_t)at : 0;
    cell[axis] = cell[axis] < k->blocks[axis] ? cell[axis] : k->blocks[axis] - 1;
    if (grid->table) { /* the block that the ray begins in is between the border and the block that it goes through, or is that block */
      for (cell[axis] = home[axis]; cell[axis] > 0 && block_begin(grid, k, axis, cell[axis]) > at;) {
        --cell[axis];
      }
      while (cell[axis] < k->blocks[axis] - 1 && block_begin(grid, k, axis, cell[axis] + 1) <= at) {
        ++cell[axis];
      }
    }
    next[axis] = (block_begin(grid, k, axis, cell[axis] + (d[axis] > 0.0)) - p[axis]) / d[axis];
    step[axis] = fabs(1.0 / d[axis]);
  }
  double s = begin;
  while (s < end) {
    const int axis = next[0] < next[1] ? next[0] < next[2] ? 0 : 2 : next[1] < next[2] ? 1 : 2;
    const double to = fmin(next[axis], end);
    const int c = k->of[(cell[2] * k->blocks[1] + cell[1]) * k->blocks[0] + cell[0]];
    if (c < CLASSES && to > s) {
      chords[c] += to - s;
    }
    s = fmax(s, next[axis]);
    next[axis] += step[axis];
    cell[axis] += d[axis] > 0.0 ? 1 : -1;
    if (cell[axis] < 0 || cell[axis] >= k->blocks[axis]) {
      break;
    }
    if (grid->table) {
      next[axis] = (block_begin(grid, k, axis, cell[axis] + (d[axis] > 0.0)) - p[axis]) / d[axis];
    }
  }
}

/* Make the camera of patch `number`, which looks at a point of the world. Its plane is before the volume at a distance of its own, so that
 * different patches have different sample places. */
static void aim(const double point[3], double reach, double voxel, int number, stratus_camera* camera)
{
  const double golden = 2.399963229728653; /* directions on a spiral over the sphere, an equal area for each */
  const double z = 1.0 - (2.0 * number + 1.0) / STRATUS_PROBE_PATCHES, radius = sqrt(1.0 - z * z), turn = golden * number;
  const double forward[3] = { radius * cos(turn), radius * sin(turn), z };
  const double roll = 6.283185307179586 * uniform_of((uint32_t)number, 1);
  int least = 0;
  for (int axis = 1; axis < 3; ++axis) {
    least = fabs(forward[axis]) < fabs(forward[least]) ? axis : least;
  }
  double side[3] = { 0.0, 0.0, 0.0 }, across[3], up[3];
  side[least] = 1.0;
  stratus_vector_cross(forward, side, across);
  const double length = sqrt(stratus_vector_dot(across, across));
  stratus_vector_cross(across, forward, up);
  const double back = reach + 4.0 * voxel * uniform_of((uint32_t)number, 2);
  *camera = (stratus_camera){ .far_k = INFINITY, .parallel = 1 };
  for (int axis = 0; axis < 3; ++axis) {
    camera->forward[axis] = forward[axis];
    camera->eye[axis] = point[axis] - back * forward[axis];
    camera->right[axis] = 0.5 * STRATUS_PROBE_WIDTH * PITCH * voxel * (cos(roll) * across[axis] + sin(roll) * up[axis]) / length;
    camera->up[axis] = 0.5 * STRATUS_PROBE_HEIGHT * PITCH * voxel * (cos(roll) * up[axis] - sin(roll) * across[axis]) / length;
  }
}

/* Makes the camera of a patch that looks at an index in a direction that is random in index coordinates. Where voxels are very thin nearly
 * all directions of the world cross the layers one after the other, and pictures from there are all alike. Three patches of four are of
 * this kind, so that views along the layers are measured, too. */
static void aim_by_cells(const stratus_volume* volume, const double to_world[16], const double index[3], int number, stratus_camera* camera)
{
  double reach = 0.0, eye[3], forward[3], right[3], up[3];
  for (int axis = 0; axis < 3; ++axis) {
    reach += (double)volume->dimensions[axis] + 1.0;
  }
  aim(index, reach, 1.0, number, camera);
  stratus_matrix_point(to_world, camera->eye, eye);
  stratus_matrix_vector(to_world, camera->forward, forward);
  stratus_matrix_vector(to_world, camera->right, right);
  stratus_matrix_vector(to_world, camera->up, up);
  memcpy(camera->eye, eye, sizeof eye);
  memcpy(camera->forward, forward, sizeof forward);
  memcpy(camera->right, right, sizeof right);
  memcpy(camera->up, up, sizeof up);
}

static void make_patch(const stratus_ray_caster* caster, const stratus_probe_classes* k, const int dealt[CLASSES], int64_t block,
  double voxel, int number, stratus_probe_patch* patch)
{
  const int64_t at[3] = { block % k->blocks[0], block / k->blocks[0] % k->blocks[1], block / k->blocks[0] / k->blocks[1] };
  const stratus_volume* volume = &caster->field.volume;
  const double size = caster->structure.occupancy->block_size;
  double to_world[16], to_index[16], index[3], point[3], place[3], direction[3], chords[CLASSES], reach = 0.0, scale = 0.0;
  stratus_volume_index_to_world(volume, to_world);
  for (int axis = 0; axis < 3; ++axis) { /* a point of the block, within the volume */
    const double last = (double)(volume->dimensions[axis] - 1);
    place[axis] = (double)at[axis] + uniform_of((uint32_t)number, 3 + (uint32_t)axis);
    index[axis] = fmin(place[axis] * size, last);
    if (caster->field.grid.table) {
      index[axis] = stratus_ray_grid_at(&caster->field.grid, axis, index[axis]);
    }
    double edge = 0.0;
    for (int row = 0; row < 3; ++row) {
      edge += to_world[4 * row + axis] * to_world[4 * row + axis];
    }
    reach += sqrt(edge) * (last + 2.0);
  }
  stratus_matrix_point(to_world, index, point);
  const bool by_cells = number % 4 && stratus_ray_follows_voxels(volume);
  if (by_cells) {
    aim_by_cells(volume, to_world, index, number, &patch->camera);
  } else {
    aim(point, reach, voxel, number, &patch->camera);
  }
  if (!stratus_matrix_invert_affine(to_world, to_index)) {
    patch->weight = 0.0; /* stratus_ray_frame_arguments() refuses the volume */
    return;
  }
  stratus_matrix_vector(to_index, patch->camera.forward, direction);
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] = index[axis] / size;
    direction[axis] *= by_cells ? 1.0 : voxel; /* in voxels a voxel */
    direction[axis] = fabs(direction[axis]) > 1e-9 ? direction[axis] : 1e-9;
    scale = fmax(scale, fabs(direction[axis]));
  }
  measure_chords(&caster->field.grid, k, at, place, direction, chords);
  double density = 0.0;
  for (int c = 0; c < CLASSES; ++c) {
    if (k->count[c] > 0) {
      const double least = chords[c] > 0.0 ? CHORD_LEAST / scale : 0.0;
      density += dealt[c] * fmax(chords[c], least) / (double)k->count[c];
    }
  }
  patch->weight = density > 0.0 ? 1.0 / density : 0.0;
}

static stratus_status make_patches(
  const stratus_ray_caster* caster, stratus_probe_patch patches[STRATUS_PROBE_PATCHES], int* count, stratus_probe_classes* k)
{
  const double voxel = stratus_ray_voxel_length(&caster->field.volume);
  int dealt[CLASSES], next[CLASSES] = { 0 };
  int64_t seen[CLASSES] = { 0 }, wanted[CLASSES];
  *count = 0;
  if (caster->structure.occupancy->count == 0) {
    return STRATUS_OK;
  }
  TRY(classify(caster, voxel, k));
  deal(k, dealt);
  int first[CLASSES], number = 0;
  for (int c = 0; c < CLASSES; ++c) {
    first[c] = number;
    number += dealt[c];
    wanted[c] = -1;
  }
  for (int64_t row = 0; row < rows_of(caster->structure.occupancy); ++row) {
    int64_t b, end;
    row_of(caster->structure.occupancy, row, &b, &end);
    for (b = pass_bytes(k->of, CLASSES, b, end); b < end; b = pass_bytes(k->of, CLASSES, b + 1, end)) {
      const int c = k->of[b];
      while (next[c] < dealt[c]) { /* blocks are drawn evenly from the class's list, one at random from each stretch of it */
        const int patch = first[c] + next[c];
        if (wanted[c] < 0) {
          wanted[c] = (int64_t)((next[c] + uniform_of((uint32_t)patch, 7)) / dealt[c] * (double)k->count[c]);
        }
        if (wanted[c] > seen[c]) {
          break;
        }
        make_patch(caster, k, dealt, b, voxel, patch, &patches[patch]);
        wanted[c] = -1;
        ++next[c];
      }
      ++seen[c];
    }
  }
  *count = number;
  return STRATUS_OK;
}

/* Makes patches by blocks of another size than the caster's: with ranges and occupancy of their own, which are dropped again. */
static stratus_status make_patches_by(stratus_ray_caster* caster, int block_size, stratus_probe_patch patches[STRATUS_PROBE_PATCHES],
  int* count, stratus_probe_classes* classes)
{
  stratus_ray_field* field = &caster->field;
  stratus_value_range *const ranges = caster->field.ranges, *others[4];
  stratus_occupancy* const occupancy = caster->structure.occupancy;
  stratus_status status = STRATUS_OK;
  memcpy(others, field->others, sizeof others);
  caster->field.ranges = NULL;
  caster->structure.occupancy = NULL;
  memset(field->others, 0, sizeof field->others);
  for (int c = 0; status == STRATUS_OK && c < field->components; ++c) {
    const stratus_volume view = stratus_volume_component(&caster->field.volume, c);
    status = stratus_value_range_create(
      caster->context, &view, block_size, c == caster->field.followed ? &caster->field.ranges : &field->others[c]);
  }
  if (status == STRATUS_OK) {
    status = stratus_ray_make_occupancy(caster);
  }
  if (status == STRATUS_OK) {
    status = make_patches(caster, patches, count, classes);
  }
  stratus_value_range_destroy(caster->field.ranges);
  stratus_occupancy_destroy(caster->structure.occupancy);
  for (int c = 0; c < 4; ++c) {
    stratus_value_range_destroy(field->others[c]);
  }
  caster->field.ranges = ranges;
  caster->structure.occupancy = occupancy;
  memcpy(field->others, others, sizeof others);
  return status;
}

stratus_status stratus_ray_probe_rays(
  stratus_ray_caster* caster, stratus_probe_patch patches[STRATUS_PROBE_PATCHES], int* count, stratus_probe_classes* classes)
{
  const int size = stratus_value_range_block_size(&caster->field.volume, 0);
  *count = 0;
  classes->of = NULL;
  return caster->field.ranges->block_size == size ? make_patches(caster, patches, count, classes)
                                                  : make_patches_by(caster, size, patches, count, classes);
}

stratus_status stratus_ray_probe_changes(const stratus_ray_caster* caster, double* changes, double* cells)
{
  const double size = caster->field.ranges->block_size, voxel = stratus_ray_voxel_length(&caster->field.volume);
  stratus_probe_classes k = { .of = NULL };
  *changes = *cells = 0.0;
  if (caster->structure.occupancy->count == 0) {
    return STRATUS_OK;
  }
  TRY(classify(caster, voxel, &k));
  stratus_release(caster->context, k.of);
  for (int c = 0; c < CLASSES; ++c) {
    *cells += (double)k.count[c] * size * size * size;
    *changes += c < CLASSES - 1 ? (double)k.count[c] * size * size * size * exp2(-2.0 * c) : 0.0;
  }
  return STRATUS_OK;
}
