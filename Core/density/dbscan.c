/* SPDX-License-Identifier: BSD-3-Clause
 * DBSCAN (Ester et al. 1996) of points on a line at whole coordinates, given as counts: one scan with a sliding window. Noise between
 * clusters that two of them reach belongs to the lower one, as in a scan of the points in ascending order. */
#include "density.h"

typedef struct cluster {
  int32_t first, last; /* core coordinates */
  int32_t cores;
  int32_t floor; /* least coordinate that does not belong to the cluster before */
} cluster;

/* Sets [*lo, *hi) to the cluster's interval, the border points within eps of its cores included, and returns 1 if that interval holds
 * `peak`; else returns 0. */
static int closes_on(const int64_t* counts, int32_t n, int32_t eps, int32_t peak, const cluster* c, int32_t* lo, int32_t* hi)
{
  int32_t first = c->first - eps > c->floor ? c->first - eps : c->floor, last = c->last > n - 1 - eps ? n - 1 : c->last + eps;
  if (!c->cores || peak < first || peak > last) {
    return 0;
  }
  while (counts[first] == 0) {
    ++first;
  }
  while (counts[last] == 0) {
    --last;
  }
  *lo = first;
  *hi = last + 1;
  return 1;
}

int32_t stratus_dbscan_counts(
  const int64_t* counts, int32_t n, int32_t eps, int64_t min_points, int32_t peak, int32_t* lo, int32_t* hi, int32_t* clusters)
{
  int64_t window = 0;
  int32_t cores = 0;
  cluster c = { .cores = 0 };
  *lo = *hi = peak;
  *clusters = 0;
  if (peak < 0 || peak >= n || counts[peak] == 0) {
    peak = -1; /* no cluster holds it, but clusters are still counted */
  }
  eps = eps < n ? eps : n;
  for (int32_t i = 0; i < n && i < eps; ++i) {
    window += counts[i];
  }
  for (int32_t i = 0; i < n; ++i) {
    window += i + eps < n ? counts[i + eps] : 0;
    window -= i - eps > 0 ? counts[i - eps - 1] : 0;
    if (counts[i] == 0 || window < min_points) {
      continue;
    }
    if (*clusters == 0 || i - c.last > eps) {
      cores += closes_on(counts, n, eps, peak, &c, lo, hi) * c.cores;
      c = (cluster){ i, i, 0, *clusters ? c.last + eps + 1 : 0 };
      ++*clusters;
    }
    c.last = i;
    ++c.cores;
  }
  return cores + closes_on(counts, n, eps, peak, &c, lo, hi) * c.cores;
}
