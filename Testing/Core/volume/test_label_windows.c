/* SPDX-License-Identifier: BSD-3-Clause
 * Windows of single labels and plateaus of a millionth of the range: blocks are occupied exactly where the function in double shows a value
 * between a block's least and greatest label, for every label of bytes and 500 of each larger type. */
#include "structures.h"

#define SIDE_X 37
#define SIDE_Y 28
#define SIDE_Z 19
#define LABELS (SIDE_X * SIDE_Y * SIDE_Z)
#define REGION 9 /* voxels across: two blocks of 4 cells hold one label, the third holds two */
#define BLOCK 4
#define BLOCKS (9 * 7 * 5)

enum { WINDOW, PLATEAU, TENT, STEP_UP, STEP_DOWN, FUNCTIONS };

static double labels[LABELS], hull[BLOCKS][2];
static const stratus_type types[] = { STRATUS_UINT8, STRATUS_UINT16, STRATUS_INT32, STRATUS_FLOAT32 };
static const double least[] = { 0, 0, -2e9, 0 }, most[] = { 255, 65535, 2e9, 1e6 };

static double random_label(int type, uint32_t* random)
{
  return least[type] + floor((most[type] - least[type] + 1.0) * ((double)random_below(random, 1 << 24) + 0.5) * 0x1p-24);
}

/* Fills regions with a label each. */
static void fill_labels(int type, void* values, uint32_t* random)
{
  enum { ACROSS = SIDE_X / REGION + 1 };
  double of[ACROSS * ACROSS * ACROSS];
  for (int i = 0; i < ACROSS * ACROSS * ACROSS; ++i) {
    of[i] = random_label(type, random);
  }
  for (int i = 0; i < LABELS; ++i) {
    const int x = i % SIDE_X, y = i / SIDE_X % SIDE_Y, z = i / SIDE_X / SIDE_Y;
    const double label = of[(z / REGION * ACROSS + y / REGION) * ACROSS + x / REGION];
    if (types[type] == STRATUS_UINT8) {
      ((uint8_t*)values)[i] = (uint8_t)label;
    } else if (types[type] == STRATUS_UINT16) {
      ((uint16_t*)values)[i] = (uint16_t)label;
    } else if (types[type] == STRATUS_INT32) {
      ((int32_t*)values)[i] = (int32_t)label;
    } else {
      ((float*)values)[i] = (float)label;
    }
    labels[i] = label;
  }
}

/* The least and greatest label that rays can read in each block: of its cells' corners. */
static void find_hulls(void)
{
  for (int b = 0; b < BLOCKS; ++b) {
    hull[b][0] = INFINITY;
    hull[b][1] = -INFINITY;
    for (int v = 0; v < (BLOCK + 1) * (BLOCK + 1) * (BLOCK + 1); ++v) {
      const int x = b % 9 * BLOCK + v % (BLOCK + 1), y = b / 9 % 7 * BLOCK + v / (BLOCK + 1) % (BLOCK + 1);
      const int z = b / 9 / 7 * BLOCK + v / (BLOCK + 1) / (BLOCK + 1);
      if (x < SIDE_X && y < SIDE_Y && z < SIDE_Z) {
        hull[b][0] = fmin(hull[b][0], labels[(z * SIDE_Y + y) * SIDE_X + x]);
        hull[b][1] = fmax(hull[b][1], labels[(z * SIDE_Y + y) * SIDE_X + x]);
      }
    }
  }
}

/* Makes the points of a function about label k, and the interval ends[0]..ends[1] of visible values; closed[] says which ends belong to it.
 * Of several points at one value, the last one counts. */
static size_t make_function(int function, int type, double k, double points[8], double ends[2], bool closed[2])
{
  const double half = function == WINDOW ? 0.5 : 0.5e-6 * (most[type] - least[type]);
  const bool steps = function == WINDOW || function == PLATEAU;
  ends[0] = function == STEP_DOWN ? -INFINITY : function == STEP_UP ? k : k - half;
  ends[1] = function == STEP_DOWN ? k : function == STEP_UP ? INFINITY : k + half;
  closed[0] = steps || function == STEP_UP;
  closed[1] = false;
  if (function == STEP_UP || function == STEP_DOWN) {
    const double step[] = { k, function == STEP_UP ? 0.0 : 0.3, k, function == STEP_UP ? 0.3 : 0.0 };
    memcpy(points, step, sizeof step);
    return 2;
  }
  const double window[] = { k - half, 0, steps ? k - half : k, 0.3, steps ? k + half : k, 0.3, k + half, 0 };
  memcpy(points, window, sizeof window);
  return 4;
}

/* Compares the occupancy with the values that show. An int of 32 bits may be fetched as the float of its neighbours: blocks at the ends of
 * whose labels that happens may be occupied for it. */
static void compare(const stratus_value_range* r, const stratus_occupancy* o, int type, double k, const char* what, const double ends[2],
  const bool closed[2])
{
  for (int b = 0; b < BLOCKS; ++b) {
    const bool above = hull[b][1] > ends[0] || (closed[0] && hull[b][1] == ends[0]);
    const bool below = hull[b][0] < ends[1] || (closed[1] && hull[b][0] == ends[1]);
    const bool occupied = stratus_occupancy_get(o, b % 9, b / 9 % 7, b / 9 / 7), expected = above && below;
    const bool same_float = types[type] == STRATUS_INT32 &&
      ((float)(hull[b][1] - r->bias) == (float)(ends[0] - r->bias) || (float)(hull[b][0] - r->bias) == (float)(ends[1] - r->bias));
    if (occupied != expected && (expected || !same_float)) {
      fail_msg("type %d, %s of label %.9g, block %d of labels %.9g..%.9g: occupied is %d", type, what, k, b, hull[b][0], hull[b][1],
        (int)occupied);
    }
  }
}

static void check_label(stratus_context* context, const stratus_value_range* r, int type, double k)
{
  static const char* const names[] = { "window", "plateau", "tent", "step up", "step down" };
  static const double white[] = { 0, 1, 1, 1 };
  stratus_occupancy* o = NULL;
  for (int function = 0; function < FUNCTIONS; ++function) {
    stratus_transfer transfer = stratus_transfer_default();
    double points[8], ends[2];
    bool closed[2];
    transfer.opacity_count = make_function(function, type, k, points, ends, closed);
    transfer.opacity = points;
    transfer.color = white;
    transfer.color_count = 1;
    assert_int_equal(stratus_occupancy_create(context, r, &transfer, STRATUS_SAMPLING_AUTO, &o), STRATUS_OK);
    compare(r, o, type, k, names[function], ends, closed);
    stratus_occupancy_destroy(o);
  }
  assert_int_equal(stratus_occupancy_create_between(context, r, k, k, &o), STRATUS_OK);
  compare(r, o, type, k, "threshold", (const double[]){ k, k }, (const bool[]){ true, true });
  stratus_occupancy_destroy(o);
}

static void a_label_window_occupies_what_the_function_shows(void** state)
{
  static union {
    uint8_t of_uint8[LABELS];
    float of_float[LABELS];
  } values;
  uint32_t random = 11;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int type = 0; type < 4; ++type) {
    stratus_volume v = stratus_volume_default();
    stratus_value_range* r = NULL;
    fill_labels(type, &values, &random);
    find_hulls();
    v.values = &values;
    v.type = types[type];
    v.dimensions[0] = SIDE_X;
    v.dimensions[1] = SIDE_Y;
    v.dimensions[2] = SIDE_Z;
    assert_int_equal(stratus_value_range_create(context, &v, BLOCK, &r), STRATUS_OK);
    assert_int_equal(r->blocks[0] * r->blocks[1] * r->blocks[2], BLOCKS);
    for (int n = 0; n < (type == 0 ? 256 : 500); ++n) { /* half of them are in the volume, the others anywhere */
      check_label(context, r, type, type == 0 ? n : n % 2 ? labels[random_below(&random, LABELS)] : random_label(type, &random));
    }
    stratus_value_range_destroy(r);
  }
  stratus_context_destroy(context);
}

int test_label_windows(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_label_window_occupies_what_the_function_shows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
