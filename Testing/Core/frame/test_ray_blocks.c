/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes that were cut into blocks: the order against brute force along rays, and pictures against the whole volume's. */
#include "picture_case.h"

#include "block_order.h"

#define BLOCKS_MOST 64

static picture whole, drawn;

/* A volume's blocks, which share the layers of points at which they meet, or the borders of cells. layers: how many layers of cells each
 * has of its neighbours besides. */
typedef struct cut {
  stratus_volume volume[BLOCKS_MOST];
  void* values[BLOCKS_MOST];
  uint8_t* ghosts[BLOCKS_MOST];
  stratus_ray_caster* caster[BLOCKS_MOST];
  int count, layers;
} cut;

static void add_block(stratus_context* context, const picture_case* c, const int64_t from[3], const int64_t to_cell[3], cut* b)
{
  const int64_t* n = c->volume.dimensions;
  int64_t lo[3], hi[3], cells[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t all = n[axis] - (c->volume.cell_centered ? 0 : 1);
    lo[axis] = from[axis] > b->layers ? from[axis] - b->layers : 0;
    hi[axis] = to_cell[axis] + b->layers < all ? to_cell[axis] + b->layers : all;
    cells[axis] = hi[axis] - lo[axis];
  }
  const size_t size = stratus_type_size(c->volume.type) * (size_t)c->volume.value_stride;
  stratus_volume* block = &b->volume[b->count];
  *block = c->volume;
  for (int axis = 0; axis < 3; ++axis) { /* cells lo..hi-1 */
    block->dimensions[axis] = hi[axis] - lo[axis] + (c->volume.cell_centered ? 0 : 1);
    block->origin[axis] = c->volume.origin[axis] + c->volume.spacing[axis] * (double)lo[axis];
  }
  char* to = malloc((size_t)(block->dimensions[0] * block->dimensions[1] * block->dimensions[2]) * size);
  b->values[b->count] = to;
  for (int64_t z = lo[2]; z < lo[2] + block->dimensions[2]; ++z) {
    for (int64_t y = lo[1]; y < lo[1] + block->dimensions[1]; ++y) {
      const size_t row = (size_t)block->dimensions[0] * size;
      memcpy(to, (const char*)c->values + (size_t)((z * n[1] + y) * n[0] + lo[0]) * size, row);
      to += row;
    }
  }
  block->values = b->values[b->count];
  b->ghosts[b->count] = calloc((size_t)(cells[0] * cells[1] * cells[2]), 1);
  for (int64_t cell = 0; b->layers && cell < cells[0] * cells[1] * cells[2]; ++cell) {
    const int64_t at[3] = { lo[0] + cell % cells[0], lo[1] + cell / cells[0] % cells[1], lo[2] + cell / (cells[0] * cells[1]) };
    for (int axis = 0; axis < 3; ++axis) {
      b->ghosts[b->count][cell] |= at[axis] < from[axis] || at[axis] >= to_cell[axis] ? STRATUS_GHOST_DUPLICATE : 0;
    }
  }
  block->cell_ghosts = b->layers ? b->ghosts[b->count] : NULL;
  assert_int_equal(stratus_ray_caster_create(context, &b->caster[b->count]), STRATUS_OK);
  ++b->count;
}

/* Cuts a box of cells in two at random places until there are as many blocks as wanted; `left` of them come of this box. */
static void cut_box(
  stratus_context* context, const picture_case* c, const int64_t lo[3], const int64_t hi[3], int left, uint32_t* random, cut* b)
{
  const int axis = (int)(case_random(random) % 3);
  const int64_t cells = hi[axis] - lo[axis];
  if (left <= 1 || cells < 2) {
    add_block(context, c, lo, hi, b);
    return;
  }
  int64_t middle[3] = { hi[0], hi[1], hi[2] }, start[3] = { lo[0], lo[1], lo[2] };
  middle[axis] = start[axis] = lo[axis] + 1 + (int64_t)(case_random(random) % (uint32_t)(cells - 1));
  cut_box(context, c, lo, middle, left / 2, random, b);
  cut_box(context, c, start, hi, left - left / 2, random, b);
}

/* Four blocks that wind around a fifth, so that no plane parts all of them. */
static void cut_wound(stratus_context* context, const picture_case* c, cut* b)
{
  static const double ends[5][6] = { { 0, .6, 0, .4, 0, 1 }, { .6, 1, 0, .7, 0, 1 }, { .3, 1, .7, 1, 0, 1 }, { 0, .3, .4, 1, 0, 1 },
    { .3, .6, .4, .7, 0, 1 } };
  for (int i = 0; i < 5; ++i) {
    int64_t lo[3], hi[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double cells = (double)(c->volume.dimensions[axis] - (c->volume.cell_centered ? 0 : 1));
      lo[axis] = (int64_t)(ends[i][2 * axis] * cells);
      hi[axis] = (int64_t)(ends[i][2 * axis + 1] * cells);
    }
    add_block(context, c, lo, hi, b);
  }
}

static void cut_at_random(stratus_context* context, const picture_case* c, int count, uint32_t seed, cut* b)
{
  const int64_t lo[3] = { 0, 0, 0 };
  int64_t hi[3];
  for (int axis = 0; axis < 3; ++axis) {
    hi[axis] = c->volume.dimensions[axis] - (c->volume.cell_centered ? 0 : 1);
  }
  cut_box(context, c, lo, hi, count, &seed, b);
}

static stratus_status draw_blocks(const picture_case* c, const cut* b, picture* p, stratus_ray_cast_report* reports)
{
  stratus_ray_cast_input inputs[BLOCKS_MOST];
  for (int i = 0; i < b->count || i == 0; ++i) {
    inputs[i] =
      (stratus_ray_cast_input){ .caster = b->caster[i], .volume = &b->volume[i], .transfer = &c->transfer, .options = &c->options };
  }
  const stratus_image image = {
    .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p->rgba, .depth = p->depth, .samples = p->samples, .opaque_depth = c->opaque_depth
  };
  return stratus_ray_caster_render_blocks(inputs, b->count, &c->camera, &image, reports);
}

static void destroy_blocks(cut* b)
{
  for (int i = 0; i < b->count; ++i) {
    stratus_ray_caster_destroy(b->caster[i]);
    free(b->values[i]);
    free(b->ghosts[i]);
  }
  b->count = 0;
}

static float largest_difference(void)
{
  float largest = 0.0f;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    largest = fmaxf(largest, fabsf(whole.rgba[i] - drawn.rgba[i]));
  }
  return largest;
}

/* ---- order */

/* Where a ray enters a box and leaves it; false if it misses it. */
static bool meets(const stratus_block_box* box, const double from[3], const double along[3], double* enter, double* leave)
{
  *enter = 0.0;
  *leave = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box->lo[axis] - from[axis]) / along[axis], z = (box->hi[axis] - from[axis]) / along[axis];
    *enter = fmax(*enter, fmin(a, z));
    *leave = fmin(*leave, fmax(a, z));
  }
  return *leave > *enter + 1e-9;
}

/* Boxes of cut volumes, some left out, from eyes outside and inside: along random rays no box comes after a box that it hides. */
static void no_ray_meets_boxes_in_another_order(void** state)
{
  uint64_t pairs = 0, wrong = 0;
  for (uint32_t seed = 0; seed < 40; ++seed) {
    uint32_t random = seed * 7919u + 1u;
    stratus_block_box boxes[BLOCKS_MOST];
    stratus_block_eye eye;
    picture_case c;
    cut b = { .count = 0 };
    int order[BLOCKS_MOST], place[BLOCKS_MOST], overlap[2], count = 0;
    case_create(*state, &c, STRATUS_UINT8, 30, 26, 34, seed);
    if (seed % 4 == 0) {
      cut_wound(*state, &c, &b);
    } else {
      cut_at_random(*state, &c, 2 + (int)(seed % 60), seed, &b);
    }
    for (int i = 0; i < b.count; ++i) {
      if (case_random(&random) % 5 > 0 || seed % 4 == 0) {
        for (int axis = 0; axis < 3; ++axis) {
          boxes[count].lo[axis] = b.volume[i].origin[axis];
          boxes[count].hi[axis] = b.volume[i].origin[axis] + (double)(b.volume[i].dimensions[axis] - 1);
        }
        ++count;
      }
    }
    eye.parallel = seed % 3 == 0;
    for (int axis = 0; axis < 3; ++axis) {
      eye.point[axis] = eye.parallel ? case_uniform(&random, -1, 1)
        : seed % 5 == 1              ? case_uniform(&random, 0, 30)
                                     : case_uniform(&random, -50, 80);
    }
    assert_int_equal(stratus_block_order(*state, boxes, count, &eye, 1e-6, order, overlap), STRATUS_OK);
    assert_int_equal(overlap[0], -1);
    for (int i = 0; i < count; ++i) {
      place[order[i]] = i;
    }
    for (int ray = 0; ray < 400; ++ray) {
      double from[3], along[3];
      for (int axis = 0; axis < 3; ++axis) {
        from[axis] = eye.parallel ? case_uniform(&random, 0, 30) - 100.0 * eye.point[axis] : eye.point[axis];
        along[axis] = eye.parallel ? eye.point[axis] : case_uniform(&random, 0, 30) - from[axis];
      }
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < i; ++j) {
          double enter[2], leave[2];
          if (meets(&boxes[i], from, along, &enter[0], &leave[0]) && meets(&boxes[j], from, along, &enter[1], &leave[1])) {
            ++pairs;
            wrong += enter[0] + leave[0] < enter[1] + leave[1] ? place[i] > place[j] : place[i] < place[j];
          }
        }
      }
    }
    destroy_blocks(&b);
    case_destroy(&c);
  }
  print_message("             %llu pairs of boxes along rays, %llu wrong\n", (unsigned long long)pairs, (unsigned long long)wrong);
  assert_true(pairs > 50000);
  assert_int_equal(wrong, 0);
}

/* ---- pictures */

/* A cut moves the samples next to it, except by rule cells, which integrates each cell separately. The remaining difference is that each
 * block's table covers only the block's values, so that it has other entries. */
static void blocks_draw_the_whole(void** state)
{
  static const double most[] = {
    [STRATUS_SAMPLING_MIDPOINT] = 1e-3, [STRATUS_SAMPLING_PREINTEGRATED] = 2e-3, [STRATUS_SAMPLING_CELLS] = 3e-4
  };
  float worst[4] = { 0 };
  for (uint32_t seed = 0; seed < 24; ++seed) {
    picture_case c;
    cut b = { .count = 0 };
    case_create(*state, &c, (stratus_type)(seed % 10), 30, 26, 34, seed);
    c.volume.spacing[1] = 1.3;
    c.volume.cell_centered = 0;
    const double angle = 0.3 * seed, turn[4] = { cos(angle), -sin(angle), sin(angle), cos(angle) };
    for (int i = 0; i < 4; ++i) { /* and mirrored */
      c.volume.matrix[4 * (i / 2) + i % 2] = turn[i] * (i % 2 && seed % 2 ? -1.0 : 1.0);
    }
    c.options.sampling.rule = (stratus_sampling)(STRATUS_SAMPLING_MIDPOINT + (int)(seed % 3));
    c.options.sampling.cell_error = 1e-4; /* so that the tolerance, which differs, has no say */
    case_camera(*state, &c, (int)(seed % 8), (int)(seed / 8 % 2));
    if (seed % 6 == 5) { /* from inside */
      for (int axis = 0; axis < 3; ++axis) {
        c.camera.eye[axis] += c.camera.forward[axis] * 40.0;
      }
    }
    if (seed % 4 == 0) {
      cut_wound(*state, &c, &b);
    } else {
      cut_at_random(*state, &c, 40, seed, &b);
    }
    case_render(*state, &c, &whole);
    assert_int_equal(draw_blocks(&c, &b, &drawn, NULL), STRATUS_OK);
    const float d = largest_difference();
    worst[c.options.sampling.rule] = fmaxf(worst[c.options.sampling.rule], d);
    assert_true(case_lit(&whole) > CASE_PIXELS / 20);
    if (!(d <= most[c.options.sampling.rule])) {
      fail_msg("seed %u, %s, %d blocks: %g", seed, stratus_sampling_name(c.options.sampling.rule), b.count, (double)d);
    }
    for (int i = 0; i < CASE_PIXELS; ++i) {
      assert_true(isfinite(whole.depth[i]) == isfinite(drawn.depth[i]) || fabsf(whole.rgba[4 * i + 3] - drawn.rgba[4 * i + 3]) < 1e-5f);
    }
    destroy_blocks(&b);
    case_destroy(&c);
  }
  print_message("             most of 1: midpoint %.2g, pre-integrated %.2g, cells %.2g\n", (double)worst[STRATUS_SAMPLING_MIDPOINT],
    (double)worst[STRATUS_SAMPLING_PREINTEGRATED], (double)worst[STRATUS_SAMPLING_CELLS]);
}

/* If blocks include a layer of their neighbours' cells, they have the whole volume's gradients, and their order is found as without it.
 * Each case is drawn twice, because the caster has not seen the blocks' boxes in the first frame. */
static void blocks_with_layers_of_others_draw_the_whole_lit(void** state)
{
  stratus_ray_cast_report reports[BLOCKS_MOST];
  float worst = 0.0f;
  for (uint32_t seed = 0; seed < 6; ++seed) {
    picture_case c;
    cut b = { .layers = 2 };
    case_create(*state, &c, STRATUS_FLOAT32, 30, 26, 34, seed);
    c.volume.cell_centered = (int)(seed % 2);
    c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
    c.options.light.shade = 1;
    c.options.light.shading.specular = 0.4;
    case_camera(*state, &c, (int)(seed % 8), 0);
    cut_at_random(*state, &c, 12, seed, &b);
    case_render(*state, &c, &whole);
    for (int time = 0; time < 2; ++time) {
      assert_int_equal(draw_blocks(&c, &b, &drawn, reports), STRATUS_OK);
      worst = fmaxf(worst, largest_difference());
      for (int i = 0; i < b.count; ++i) {
        assert_null(strstr(reports[i].why, "overlaps"));
      }
    }
    assert_true(case_lit(&whole) > CASE_PIXELS / 20);
    destroy_blocks(&b);
    case_destroy(&c);
  }
  print_message("             lit, with layers of others: %.2g of 1\n", (double)worst);
  assert_true(worst <= 1e-3f);
}

/* Surfaces, solid voxels, extremes and sums are the same, of two dependent components, too; light and gradient opacity are one-sided at
 * cuts, and left out. */
static void other_modes_draw_the_whole(void** state)
{
  static const stratus_mode modes[] = { STRATUS_MODE_FIRST_HIT, STRATUS_MODE_SLICE, STRATUS_MODE_ISOSURFACE, STRATUS_MODE_MAXIMUM,
    STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE, STRATUS_MODE_ADDITIVE };
  for (uint32_t seed = 0; seed < 21; ++seed) {
    picture_case c;
    cut b = { .count = 0 };
    int different = 0;
    case_create(*state, &c, STRATUS_FLOAT32, seed < 14 ? 28 : 56, 31, 25, seed);
    if (seed >= 14) { /* every second value is the other component's */
      c.volume.dimensions[0] = 28;
      c.volume.components = 2;
      c.volume.value_stride = 2;
      c.options.optics.dependent = 1;
    }
    c.options.mode = modes[seed % 7];
    c.options.sampling.distance = seed % 7 > 2 ? 0.02 : 0.0; /* samples are cut at the blocks' borders */
    c.options.slice = (stratus_slice){ .center = { 12.2, 13.1, 11.4 }, .linear = { 0.3, 0.5, -0.7 } };
    c.options.optics.contour_count = 1;
    c.options.optics.contours[0] = -19.5;
    case_camera(*state, &c, (int)(seed % 8), (int)(seed % 2));
    cut_at_random(*state, &c, 30, seed, &b);
    case_render(*state, &c, &whole);
    assert_int_equal(draw_blocks(&c, &b, &drawn, NULL), STRATUS_OK);
    assert_true(case_lit(&whole) > CASE_PIXELS / 50);
    for (int i = 0; i < CASE_PIXELS; ++i) { /* rays along a voxel's edge may take its neighbour */
      float d = 0.0f;
      for (int ch = 0; ch < 4; ++ch) {
        d = fmaxf(d, fabsf(whole.rgba[4 * i + ch] - drawn.rgba[4 * i + ch]));
      }
      different += d > 1e-3f;
    }
    print_message(
      "             %s: %d pixels of %d differ by more than .001\n", stratus_mode_name(c.options.mode), different, case_lit(&whole));
    assert_true(different <= CASE_PIXELS / 500);
    destroy_blocks(&b);
    case_destroy(&c);
  }
}

/* Rays end at opaque geometry, and blocks behind what is opaque cost nothing. */
static void what_is_hidden_is_not_drawn(void** state)
{
  static float depth[CASE_PIXELS_MOST];
  stratus_ray_cast_report reports[BLOCKS_MOST];
  picture_case c;
  cut b = { .count = 0 };
  case_create(*state, &c, STRATUS_FLOAT32, 30, 26, 34, 3);
  const double distance = sqrt(c.camera.eye[0] * c.camera.eye[0] + c.camera.eye[1] * c.camera.eye[1] + c.camera.eye[2] * c.camera.eye[2]);
  c.camera.near_k = 0.1 * distance;
  c.camera.far_k = 4.0 * distance;
  cut_at_random(*state, &c, 40, 3, &b);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    depth[i] = 0.85f + 0.1f * (float)(i % 7) / 7.0f;
  }
  c.opaque_depth = depth;
  case_render(*state, &c, &whole);
  assert_int_equal(draw_blocks(&c, &b, &drawn, reports), STRATUS_OK);
  assert_true(case_lit(&whole) > CASE_PIXELS / 20);
  assert_true(largest_difference() < 1e-3f);
  c.opaque_depth = NULL;
  case_render(*state, &c, &drawn);
  assert_true(largest_difference() > 0.01f); /* the depths did end rays */

  const double solid[8] = { -100, 1, -20, 1, -18, 1, 0, 1 };
  uint64_t samples = 0, hidden = 0;
  memcpy(c.opacity, solid, sizeof solid);
  c.options.sampling.termination = 0.0;
  c.transfer.color_count = 1; /* a sample that a cut moves has the same colour */
  case_render(*state, &c, &whole);
  assert_int_equal(draw_blocks(&c, &b, &drawn, reports), STRATUS_OK);
  assert_true(largest_difference() < 1e-3f);
  for (int i = 0; i < b.count; ++i) {
    samples += reports[i].samples;
    hidden += strstr(reports[i].why, "not drawn") != NULL;
  }
  print_message("             %llu samples for the whole, %llu for the blocks, %llu of %d blocks hidden\n",
    (unsigned long long)whole.report.samples, (unsigned long long)samples, (unsigned long long)hidden, b.count);
  assert_true(samples <= 2 * whole.report.samples + CASE_PIXELS);
  assert_true(hidden > 0);
  destroy_blocks(&b);
  case_destroy(&c);
}

/* ---- one probe for all blocks */

static uint64_t probes_of(const stratus_ray_cast_report* reports, int count)
{
  uint64_t probes = 0;
  for (int i = 0; i < count; ++i) {
    probes += reports[i].probe_builds;
  }
  return probes;
}

/* A picture of many blocks measures one of them. Another camera measures nothing, other functions once more. The picture keeps the
 * tolerance. */
static void one_block_is_measured_for_all(void** state)
{
  stratus_ray_cast_report reports[BLOCKS_MOST];
  for (uint32_t seed = 0; seed < 6; ++seed) {
    picture_case c;
    cut b = { .count = 0 };
    double squares = 0.0;
    int lit = 0;
    case_create(*state, &c, STRATUS_FLOAT32, 30, 26, 34, seed);
    case_camera(*state, &c, (int)seed, (int)(seed % 2));
    case_render(*state, &c, &whole);
    c.options.sampling = stratus_ray_cast_options_default().sampling;
    c.options.sampling.tolerance = 0.01;
    cut_at_random(*state, &c, 40, seed, &b);
    assert_int_equal(draw_blocks(&c, &b, &drawn, reports), STRATUS_OK);
    assert_int_equal(probes_of(reports, b.count), 1);
    int measured = 0;
    while (reports[measured].probe_builds == 0) {
      ++measured;
    }
    for (int i = 0; i < b.count; ++i) {
      if (reports[i].occupied_blocks > 0 && !strstr(reports[i].why, "not drawn")) {
        assert_int_equal(reports[i].sampling, reports[measured].sampling);
        assert_true(reports[i].sample_distance == reports[measured].sample_distance);
        assert_true(i == measured || strstr(reports[i].why, "as measured in another block"));
      }
    }
    for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
      squares += (double)(whole.rgba[i] - drawn.rgba[i]) * (double)(whole.rgba[i] - drawn.rgba[i]);
      lit += i % 4 == 3 && whole.rgba[i] > 0.0f;
    }
    print_message("             error %.2g of %.2g\n", sqrt(squares / (4.0 * lit)), c.options.sampling.tolerance);
    assert_true(lit > CASE_PIXELS / 20);
    assert_true(sqrt(squares / (4.0 * lit)) <= c.options.sampling.tolerance);

    case_camera(*state, &c, (int)seed + 1, 0); /* which shows further blocks, perhaps */
    assert_int_equal(draw_blocks(&c, &b, &drawn, reports), STRATUS_OK);
    assert_int_equal(probes_of(reports, b.count), 1);
    c.opacity[1] *= 0.5;
    c.opacity[3] *= 0.5;
    c.opacity[5] *= 0.5;
    assert_int_equal(draw_blocks(&c, &b, &drawn, reports), STRATUS_OK);
    assert_int_equal(probes_of(reports, b.count), 2);
    destroy_blocks(&b);
    case_destroy(&c);
  }
}

/* Of two blocks, the one whose values change most from voxel to voxel is measured, whichever comes first. A block of other voxels takes as
 * many of its own a step. */
static void the_roughest_block_is_measured(void** state)
{
  enum { SIDE = 17 };
  static float values[2][SIDE * SIDE * SIDE];
  stratus_ray_cast_report reports[BLOCKS_MOST];
  for (int rough = 0; rough < 2; ++rough) {
    picture_case c;
    cut b = { .count = 2 };
    uint32_t random = 5;
    case_create(*state, &c, STRATUS_FLOAT32, 2 * SIDE, SIDE, SIDE, 1);
    for (int i = 0; i < SIDE * SIDE * SIDE; ++i) {
      values[rough][i] = (float)case_uniform(&random, -23.0, -17.0);
      values[1 - rough][i] = -19.0f + 0.001f * (float)(i % SIDE);
    }
    for (int n = 0; n < 2; ++n) {
      b.volume[n] = c.volume;
      b.volume[n].values = values[n];
      for (int axis = 0; axis < 3; ++axis) {
        b.volume[n].dimensions[axis] = SIDE;
        b.volume[n].spacing[axis] = n == 1 ? 0.5 : 1.0;
      }
      b.volume[n].origin[0] = n * SIDE;
      assert_int_equal(stratus_ray_caster_create(*state, &b.caster[n]), STRATUS_OK);
    }
    c.options.sampling = stratus_ray_cast_options_default().sampling;
    c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
    assert_int_equal(draw_blocks(&c, &b, &drawn, reports), STRATUS_OK);
    assert_int_equal(reports[rough].probe_builds, 1);
    assert_int_equal(reports[1 - rough].probe_builds, 0);
    assert_true(reports[0].samples > 0 && reports[1].samples > 0);
    assert_true(fabs(reports[0].sample_distance - 2.0 * reports[1].sample_distance) < 1e-12);
    destroy_blocks(&b);
    case_destroy(&c);
  }
}

static void uncut_volumes_are_refused(void** state)
{
  stratus_ray_cast_report reports[BLOCKS_MOST];
  picture_case c;
  cut b = { .count = 0 };
  case_create(*state, &c, STRATUS_UINT8, 20, 20, 20, 1);
  cut_at_random(*state, &c, 4, 1, &b);
  c.options.mode = STRATUS_MODE_MAXIMUM;
  b.volume[2].components = 2;
  b.volume[2].value_stride *= 2;
  assert_int_equal(draw_blocks(&c, &b, &drawn, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "block 2 has 2 independent components, block 0 has 1"));
  b.volume[2].components = b.volume[1].components;
  b.volume[2].value_stride = b.volume[1].value_stride;
  c.options.mode = STRATUS_MODE_COMPOSITE;
  b.volume[2].dimensions[1] = 0;
  assert_int_not_equal(draw_blocks(&c, &b, &drawn, NULL), STRATUS_OK);
  b.volume[2] = b.volume[1];
  assert_int_equal(draw_blocks(&c, &b, &drawn, reports), STRATUS_OK);
  assert_non_null(strstr(reports[1].why, "overlaps block 2"));
  assert_non_null(strstr(reports[2].why, "overlaps block 1"));
  stratus_ray_caster* kept = b.caster[3];
  b.caster[3] = NULL;
  assert_int_equal(draw_blocks(&c, &b, &drawn, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "block 3 has no ray caster"));
  b.caster[3] = kept;
  const int count = b.count;
  b.count = 0;
  assert_int_equal(draw_blocks(&c, &b, &drawn, NULL), STRATUS_INVALID_ARGUMENT);
  b.count = count;
  destroy_blocks(&b);
  case_destroy(&c);
}

int test_ray_blocks(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(no_ray_meets_boxes_in_another_order),
    cmocka_unit_test(blocks_draw_the_whole),
    cmocka_unit_test(blocks_with_layers_of_others_draw_the_whole_lit),
    cmocka_unit_test(other_modes_draw_the_whole),
    cmocka_unit_test(what_is_hidden_is_not_drawn),
    cmocka_unit_test(one_block_is_measured_for_all),
    cmocka_unit_test(the_roughest_block_is_measured),
    cmocka_unit_test(uncut_volumes_are_refused),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
