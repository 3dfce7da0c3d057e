/* SPDX-License-Identifier: BSD-3-Clause
 * DBSCAN of counts, compared with the textbook's method on the list of points, which tests every pair. */
#include "structures.h"
#include "tree.h"

#define POINTS_MAX 400

typedef struct points {
  int count;
  int32_t at[POINTS_MAX];
  int cluster[POINTS_MAX]; /* 0: noise */
  int core[POINTS_MAX];
  int clusters;
} points;

static int64_t neighbours(const points* p, int i, int32_t eps)
{
  int64_t count = 0;
  for (int j = 0; j < p->count; ++j) {
    count += abs(p->at[j] - p->at[i]) <= eps;
  }
  return count;
}

/* Spreads cluster `name` from core point i. */
static void expand(points* p, int i, int name, int32_t eps)
{
  static int queue[POINTS_MAX];
  int head = 0, tail = 0;
  p->cluster[i] = name;
  queue[tail++] = i;
  while (head < tail) {
    const int at = queue[head++];
    for (int j = 0; j < p->count && p->core[at]; ++j) {
      if (p->cluster[j] == 0 && abs(p->at[j] - p->at[at]) <= eps) {
        p->cluster[j] = name;
        queue[tail++] = j;
      }
    }
  }
}

static void cluster_plainly(points* p, const int64_t* counts, int32_t n, int32_t eps, int64_t min_points)
{
  p->count = p->clusters = 0;
  for (int32_t i = 0; i < n; ++i) {
    for (int64_t c = 0; c < counts[i]; ++c) {
      assert_true(p->count < POINTS_MAX);
      p->at[p->count] = i;
      p->cluster[p->count++] = 0;
    }
  }
  for (int i = 0; i < p->count; ++i) {
    p->core[i] = neighbours(p, i, eps) >= min_points;
  }
  for (int i = 0; i < p->count; ++i) {
    if (p->core[i] && p->cluster[i] == 0) {
      expand(p, i, ++p->clusters, eps);
    }
  }
}

static void check_counts(const int64_t* counts, int32_t n, int32_t eps, int64_t min_points)
{
  static points p;
  cluster_plainly(&p, counts, n, eps, min_points);
  for (int32_t peak = -1; peak <= n; ++peak) {
    int32_t lo = -7, hi = -7, clusters = -7, first = peak, last = peak - 1, cores = 0;
    int name = 0;
    for (int i = 0; i < p.count; ++i) {
      name = p.at[i] == peak ? p.cluster[i] : name;
    }
    for (int i = 0; i < p.count && name; ++i) {
      if (p.cluster[i] == name) {
        first = p.at[i] < first ? p.at[i] : first;
        last = p.at[i] > last ? p.at[i] : last;
        cores += p.core[i] && (i == 0 || p.at[i] != p.at[i - 1]);
      }
    }
    const int32_t found = stratus_dbscan_counts(counts, n, eps, min_points, peak, &lo, &hi, &clusters);
    if (found != cores || lo != first || hi != last + 1 || clusters != p.clusters) {
      fail_msg("n %d eps %d min %d peak %d: [%d,%d) of %d cores, %d clusters, not [%d,%d) of %d, %d", n, eps, (int)min_points, peak, lo, hi,
        found, clusters, first, last + 1, cores, p.clusters);
    }
  }
}

static void clusters_are_the_textbooks(void** state)
{
  uint32_t random = 1;
  int64_t counts[60];
  (void)state;
  for (int repeat = 0; repeat < 3000; ++repeat) {
    const int32_t n = 1 + (int32_t)random_below(&random, 60);
    const int64_t most = 1 + random_below(&random, 6), one_in = 1 + random_below(&random, 4);
    for (int32_t i = 0; i < n; ++i) {
      counts[i] = random_below(&random, one_in) ? 0 : random_below(&random, most + 1);
    }
    check_counts(counts, n, 1 + (int32_t)random_below(&random, 6), 1 + random_below(&random, 3 * most + 2));
  }
}

static void a_reach_beyond_the_line_makes_one_cluster_or_none(void** state)
{
  const int64_t counts[5] = { 1, 0, 2, 0, 1 };
  (void)state;
  check_counts(counts, 5, 100, 4);
  check_counts(counts, 5, 100, 5);
  check_counts(counts, 5, INT32_MAX, 1);
}

/* Noise within reach of two clusters. */
static void a_point_between_belongs_to_the_lower_cluster(void** state)
{
  const int64_t counts[7] = { 5, 0, 0, 1, 0, 0, 5 };
  int32_t lo, hi, clusters;
  (void)state;
  check_counts(counts, 7, 3, 7);
  assert_int_equal(stratus_dbscan_counts(counts, 7, 3, 6, 0, &lo, &hi, &clusters), 3);
  check_counts(counts, 7, 3, 6);
  const int64_t apart[9] = { 5, 1, 0, 0, 1, 0, 0, 1, 5 };
  check_counts(apart, 9, 3, 7);
  assert_int_equal(stratus_dbscan_counts(apart, 9, 3, 7, 0, &lo, &hi, &clusters), 1);
  assert_int_equal(hi, 5);
}

int test_dbscan(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(clusters_are_the_textbooks),
    cmocka_unit_test(a_reach_beyond_the_line_makes_one_cluster_or_none),
    cmocka_unit_test(a_point_between_belongs_to_the_lower_cluster),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
