/* SPDX-License-Identifier: BSD-3-Clause
 * The plain walk, the reference of all first hits, compared with the slabs of each voxel and every tie decided by the rule. */
#include "structures.h"
#include "voxels.h"

/* A random set of voxels and its positions. */
typedef struct test_set {
  int64_t n[3];
  int32_t positions[3 * 512];
  size_t count;
  stratus_voxels* voxels;
} test_set;

static void make_set(stratus_context* context, int64_t nx, int64_t ny, int64_t nz, int64_t one_in, uint32_t* random, test_set* s)
{
  s->n[0] = nx;
  s->n[1] = ny;
  s->n[2] = nz;
  s->count = 0;
  for (int64_t v = 0; v < nx * ny * nz; ++v) {
    if (one_in && random_below(random, one_in) == 0) {
      s->positions[3 * s->count] = (int32_t)(v % nx);
      s->positions[3 * s->count + 1] = (int32_t)(v / nx % ny);
      s->positions[3 * s->count + 2] = (int32_t)(v / nx / ny);
      ++s->count;
    }
  }
  assert_int_equal(stratus_voxels_create_list(context, s->n, s->positions, s->count, &s->voxels), STRATUS_OK);
}

/* A crossing and its axis; axis 3: the ray's beginning. Events are ordered by t, then by axis. */
typedef struct event {
  double t;
  int axis;
} event;

static bool before(event a, event b)
{
  return a.t < b.t || (a.t == b.t && a.axis < b.axis);
}

/* True if the ray is ever in the voxel by the rule of ties; *entry: the crossing by which it enters. */
static bool enters(const double o[3], const double d[3], double t_min, double t_max, const int32_t voxel[3], event* entry)
{
  event in = { t_min, 3 }, out = { INFINITY, 4 };
  for (int a = 0; a < 3; ++a) {
    if (d[a] == 0.0) {
      if (!(floor(o[a]) == (double)voxel[a])) {
        return false;
      }
      continue;
    }
    const event first = { ((double)(d[a] > 0.0 ? voxel[a] : voxel[a] + 1) - o[a]) / d[a], a };
    const event last = { ((double)(d[a] > 0.0 ? voxel[a] + 1 : voxel[a]) - o[a]) / d[a], a };
    in = before(in, first) ? first : in;
    out = before(last, out) ? last : out;
  }
  *entry = in;
  return before(in, out) && in.t <= t_max;
}

static stratus_hit brute_force(const test_set* s, const double o[3], const double d[3], double t_min, double t_max)
{
  stratus_hit hit = { .t = INFINITY, .voxel = { -1, -1, -1 }, .face = -1 };
  event nearest = { INFINITY, 9 };
  for (size_t v = 0; v < s->count; ++v) {
    event entry;
    if (enters(o, d, t_min, t_max, s->positions + 3 * v, &entry) && before(entry, nearest)) {
      nearest = entry;
      hit.t = entry.t;
      hit.face = entry.axis == 3 ? -1 : 2 * entry.axis + (d[entry.axis] < 0.0);
      memcpy(hit.voxel, s->positions + 3 * v, sizeof hit.voxel);
    }
  }
  return hit;
}

/* A ray with whole or half coordinates and one of few directions, so that most rays run along faces, pass edges and corners, or begin on
 * them. */
static stratus_ray make_ray(const test_set* s, int exact, uint32_t* random)
{
  stratus_ray r = { .t_max = INFINITY };
  do {
    for (int a = 0; a < 3; ++a) {
      if (exact) {
        r.origin[a] = (double)(random_below(random, 4 * s->n[a] + 16) - 8) / 4.0;
        r.direction[a] = (double)(random_below(random, 5) - 2);
        r.direction[a] = r.direction[a] == 0.0 && random_below(random, 2) ? -0.0 : r.direction[a];
      } else {
        r.origin[a] = ((double)random_below(random, 1 << 24) / (1 << 24) * 3.0 - 1.0) * (double)s->n[a];
        r.direction[a] = (double)random_below(random, 1 << 24) / (1 << 24) * (double)s->n[a] - r.origin[a];
      }
    }
  } while (r.direction[0] == 0.0 && r.direction[1] == 0.0 && r.direction[2] == 0.0);
  if (random_below(random, 3) == 0) {
    r.t_min = (double)(random_below(random, 17) - 8) / 2.0;
    r.t_max = random_below(random, 2) ? r.t_min + (double)random_below(random, 9) / 2.0 : INFINITY;
  }
  return r;
}

static void assert_same_hit(const stratus_hit* got, const stratus_hit* expected)
{
  assert_memory_equal(got->voxel, expected->voxel, sizeof got->voxel);
  assert_int_equal(got->face, expected->face);
  assert_true(got->t == expected->t);
}

static void every_hit_is_the_nearest_of_all_voxels(void** state)
{
  static const int64_t sizes[][3] = { { 1, 1, 1 }, { 2, 3, 1 }, { 5, 4, 7 }, { 8, 8, 8 }, { 9, 1, 6 } };
  static const int64_t fills[] = { 0, 1, 2, 9, 40 };
  uint32_t random = 7;
  (void)state;
  stratus_context* context = make_context("host", 1);
  int64_t hits = 0, inside = 0;
  for (int pass = 0; pass < 25; ++pass) {
    const int64_t* n = sizes[pass % 5];
    test_set s;
    make_set(context, n[0], n[1], n[2], fills[pass / 5], &random, &s);
    for (int r = 0; r < 4000; ++r) {
      const stratus_ray ray = make_ray(&s, r % 4 != 0, &random);
      const stratus_hit expected = brute_force(&s, ray.origin, ray.direction, ray.t_min, ray.t_max);
      stratus_hit hit;
      assert_int_equal(stratus_voxels_first_hit(context, s.voxels, &ray, 1, &hit), STRATUS_OK);
      assert_same_hit(&hit, &expected);
      hits += hit.voxel[0] >= 0;
      inside += hit.voxel[0] >= 0 && hit.face < 0;
    }
    stratus_voxels_destroy(s.voxels);
  }
  assert_true(hits > 10000 && inside > 2000); /* else the rays test nothing */
  stratus_context_destroy(context);
}

/* The rule, case by case, on voxels (1,1,1) and (2,2,1). */
static void ties_are_settled_as_written_down(void** state)
{
  static const struct {
    double origin[3], direction[3];
    int32_t voxel[3];
    double t;
    int face;
  } cases[] = {
    { { 0, 1.5, 1.5 }, { 1, 0, 0 }, { 1, 1, 1 }, 1, 0 },                                                      /* square on */
    { { 0, 1.5, 1.5 }, { 2, -0.0, 0 }, { 1, 1, 1 }, .5, 0 },                                                  /* a longer direction */
    { { 4, 2.5, 1.5 }, { -1, 0, 0 }, { 2, 2, 1 }, 1, 1 },                                                     /* from above */
    { { 1.5, 1.5, 1.5 }, { 0, 0, 1 }, { 1, 1, 1 }, 0, -1 },                                                   /* inside */
    { { 1, 1.5, 1.5 }, { 1, 0, 0 }, { 1, 1, 1 }, 0, -1 },                                                     /* on a face, inward */
    { { 2, 1.5, 1.5 }, { 1, 0, 0 }, { -1, -1, -1 }, INFINITY, -1 },                                           /* on a face, outward */
    { { 2, 1.5, 1.5 }, { -1, 0, 0 }, { 1, 1, 1 }, 0, -1 }, { { 0, 1, 1.5 }, { 1, 0, 0 }, { 1, 1, 1 }, 1, 0 }, /* along a lower face: in */
    { { 0, 2, 1.5 }, { 1, 0, 0 }, { 2, 2, 1 }, 2, 0 },    /* along a plane between: the upper voxel */
    { { 3, 3, 1.5 }, { -1, -1, 0 }, { 2, 2, 1 }, 0, -1 }, /* from the edge inward */
    { { 0, 3, 1.5 }, { 1, -1, 0 }, { 1, 1, 1 }, 1, 3 },   /* through an edge: x first, then y into the voxel */
    { { 0, 4, 1.5 }, { 1, -1, 0 }, { 2, 2, 1 }, 2, 0 },   /* through the edge that the two share: into the one that x leads to */
    { { 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 }, 1, 4 },      /* through a corner: z is crossed last */
  };
  static const int32_t positions[] = { 1, 1, 1, 2, 2, 1 };
  static const int64_t n[3] = { 4, 4, 4 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_voxels* voxels = NULL;
  assert_int_equal(stratus_voxels_create_list(context, n, positions, 2, &voxels), STRATUS_OK);
  for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c) {
    stratus_ray ray = { .t_max = INFINITY };
    stratus_hit hit;
    memcpy(ray.origin, cases[c].origin, sizeof ray.origin);
    memcpy(ray.direction, cases[c].direction, sizeof ray.direction);
    assert_int_equal(stratus_voxels_first_hit(context, voxels, &ray, 1, &hit), STRATUS_OK);
    assert_memory_equal(hit.voxel, cases[c].voxel, sizeof hit.voxel);
    assert_true(hit.t == cases[c].t);
    assert_int_equal(hit.face, cases[c].face);
  }
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

/* Matrices of powers of two and integers have exact inverses: hits do not depend on the position of the world. */
static void mirrors_shears_and_scales_change_the_world_only(void** state)
{
  static const double matrices[][16] = {
    { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 },
    { -2, 0, 0, 16, 0, 1, 0, -4, 0, 0, .5, 8, 0, 0, 0, 1 },
    { 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 32, 0, 0, 0, 1 },
    { 1, 2, 0, 0, 0, 1, 0, 0, 0, -1, 4, 0, 0, 0, 0, 1 },
    { -1, 0, 0, 0, 0, -1, 1, 0, 0, 0, -1, 0, 0, 0, 0, 1 },
  };
  uint32_t random = 5;
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (size_t m = 0; m < sizeof matrices / sizeof *matrices; ++m) {
    uint8_t values[6 * 5 * 7];
    test_set s;
    make_set(context, 6, 5, 7, 4, &random, &s);
    stratus_voxels* voxels = NULL;
    stratus_volume v = stratus_volume_default();
    stratus_criterion criterion = stratus_criterion_default();
    memset(values, 0, sizeof values);
    for (size_t p = 0; p < s.count; ++p) {
      values[(s.positions[3 * p + 2] * 5 + s.positions[3 * p + 1]) * 6 + s.positions[3 * p]] = 1;
    }
    v.values = values;
    v.type = STRATUS_UINT8;
    v.cell_centered = 1; /* so that voxels fill whole numbers of the local frame */
    memcpy(v.dimensions, s.n, sizeof v.dimensions);
    memcpy(v.matrix, matrices[m], sizeof v.matrix);
    criterion.lower = 1.0;
    assert_int_equal(stratus_voxels_create(context, &v, &criterion, &voxels), STRATUS_OK);
    for (int r = 0; r < 2000; ++r) {
      const stratus_ray local = make_ray(&s, 1, &random);
      stratus_ray ray = local;
      stratus_hit hit;
      stratus_matrix_point(matrices[m], local.origin, ray.origin);
      stratus_matrix_vector(matrices[m], local.direction, ray.direction);
      const stratus_hit expected = brute_force(&s, local.origin, local.direction, local.t_min, local.t_max);
      assert_int_equal(stratus_voxels_first_hit(context, voxels, &ray, 1, &hit), STRATUS_OK);
      assert_same_hit(&hit, &expected);
      if (hit.voxel[0] < 0) {
        continue;
      }
      double length = 0.0, along = 0.0;
      for (int a = 0; a < 3; ++a) {
        length += (double)hit.normal[a] * (double)hit.normal[a];
        along += (double)hit.normal[a] * ray.direction[a];
      }
      assert_float_equal(length, 1.0, 1e-6); /* floats */
      assert_true(along < 0.0);
      for (int edge = 0; hit.face >= 0 && edge < 3; ++edge) { /* right angles with both edges of the face */
        double across = 0.0;
        for (int a = 0; a < 3; ++a) {
          across += (double)hit.normal[a] * matrices[m][4 * a + edge];
        }
        assert_true(edge == hit.face / 2 || fabs(across) < 1e-6);
      }
    }
    stratus_voxels_destroy(voxels);
    stratus_voxels_destroy(s.voxels);
  }
  stratus_context_destroy(context);
}

/* From 1e6 away, and in a volume at UTM coordinates, along directions that end in the middle of a voxel. */
static void far_away_rays_still_hit_what_they_aim_at(void** state)
{
  static const int64_t n[3] = { 8, 8, 8 };
  uint32_t random = 3;
  float values[512] = { 0 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_volume v = stratus_volume_default();
  stratus_criterion criterion = stratus_criterion_default();
  memcpy(v.dimensions, n, sizeof n);
  v.values = values;
  v.origin[0] = 4.5e5;
  v.origin[1] = 6e6;
  v.origin[2] = 1e3;
  values[(3 * 8 + 4) * 8 + 5] = 1.0f;
  criterion.lower = 0.5;
  stratus_voxels* voxels = NULL;
  assert_int_equal(stratus_voxels_create(context, &v, &criterion, &voxels), STRATUS_OK);
  for (int r = 0; r < 1000; ++r) {
    const double target[3] = { 4.5e5 + 5.0, 6e6 + 4.0, 1e3 + 3.0 };
    stratus_ray ray = { .t_max = INFINITY };
    stratus_hit hit;
    for (int a = 0; a < 3; ++a) {
      ray.direction[a] = (double)(random_below(&random, 2000001) - 1000000) + 0.5;
      ray.origin[a] = target[a] - ray.direction[a];
    }
    assert_int_equal(stratus_voxels_first_hit(context, voxels, &ray, 1, &hit), STRATUS_OK);
    assert_int_equal(hit.voxel[0], 5);
    assert_int_equal(hit.voxel[1], 4);
    assert_int_equal(hit.voxel[2], 3);
    const int axis = hit.face / 2; /* entered half a voxel before its middle, which is at t = 1 */
    assert_true(fabs((1.0 - hit.t) * fabs(ray.direction[axis]) - 0.5) < 1e-8);
  }
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

/* Directions and places at the ends of the doubles end the walk, too. */
static void extreme_rays_end(void** state)
{
  static const int64_t n[3] = { 1 << 18, 3, 1 };
  static const int32_t positions[] = { 0, 0, 0, (1 << 18) - 1, 2, 0 };
  static const stratus_ray rays[] = {
    { { -1e300, .5, .5 }, { 1e300, 0, 0 }, 0, INFINITY }, /* crosses all planes at once, in doubles */
    { { -1, .5, .5 }, { 1e-290, 0, 0 }, 0, INFINITY },    /* the shortest */
    { { -1, .5, .5 }, { 1, 5e-324, 0 }, 0, INFINITY },
    { { 1e18, 1e18, 1e18 }, { -1, -1, -1 }, 0, INFINITY },
    { { -1, .5, .5 }, { 1, 0, 0 }, 1e308, INFINITY },
    { { -1, .5, .5 }, { 1, 0, 0 }, 5, 4 },
    { { -1, .5, .5 }, { 1, 0, 0 }, 0, -INFINITY },
  };
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_voxels* voxels = NULL;
  stratus_hit hits[7];
  assert_int_equal(stratus_voxels_create_list(context, n, positions, 2, &voxels), STRATUS_OK);
  assert_int_equal(stratus_voxels_first_hit(context, voxels, rays, 7, hits), STRATUS_OK);
  assert_int_equal(hits[2].voxel[0], 0);
  for (int r = 4; r < 7; ++r) {
    assert_int_equal(hits[r].voxel[0], -1);
    assert_true(isinf(hits[r].t));
  }
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

static void rays_that_are_none_are_refused_by_their_index(void** state)
{
  static const int64_t n[3] = { 4, 4, 4 };
  static const int32_t position[3] = { 1, 1, 1 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_voxels* voxels = NULL;
  stratus_hit hits[3];
  assert_int_equal(stratus_voxels_create_list(context, n, position, 1, &voxels), STRATUS_OK);
  for (int bad = 0; bad < 10; ++bad) {
    const stratus_ray good = { { -1, 1.5, 1.5 }, { 1, 0, 0 }, 0, INFINITY };
    stratus_ray rays[3] = { good, good, good };
    switch (bad) {
      case 0:
        rays[1].direction[0] = 0.0;
        break;
      case 1:
        rays[1].direction[1] = NAN;
        break;
      case 9:
        rays[1].direction[0] = 9e-291;
        break;
      case 2:
        rays[1].direction[2] = INFINITY;
        break;
      case 3:
        rays[1].origin[0] = NAN;
        break;
      case 4:
        rays[1].origin[1] = -INFINITY;
        break;
      case 5:
        rays[1].t_min = NAN;
        break;
      case 6:
        rays[1].t_min = -INFINITY;
        break;
      case 7:
        rays[1].t_max = NAN;
        break;
      default:
        rays[1].direction[0] = -0.0;
        break;
    }
    memset(hits, 1, sizeof hits);
    const stratus_hit kept = hits[0];
    assert_int_equal(stratus_voxels_first_hit(context, voxels, rays, 3, hits), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "ray 1"));
    assert_memory_equal(&hits[0], &kept, sizeof kept); /* outputs stay */
  }
  assert_int_equal(stratus_voxels_first_hit(context, NULL, NULL, 0, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_voxels_first_hit(context, voxels, NULL, 1, hits), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_voxels_first_hit(NULL, voxels, NULL, 0, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_voxels_first_hit(context, voxels, NULL, 0, NULL), STRATUS_OK);
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

int test_voxel_walk(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_hit_is_the_nearest_of_all_voxels),
    cmocka_unit_test(ties_are_settled_as_written_down),
    cmocka_unit_test(mirrors_shears_and_scales_change_the_world_only),
    cmocka_unit_test(far_away_rays_still_hit_what_they_aim_at),
    cmocka_unit_test(extreme_rays_end),
    cmocka_unit_test(rays_that_are_none_are_refused_by_their_index),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
