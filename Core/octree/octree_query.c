/* SPDX-License-Identifier: BSD-3-Clause
 * Queries of an octree: boxes, spheres, rays, nearest objects. Nodes are tested with room for rounding, objects by their given bounds in
 * double precision, so that the result equals a loop over all objects. */
#include "octree.h"

#include <stdlib.h>
#include <string.h>

typedef enum query_kind { QUERY_BOX, QUERY_SPHERE, QUERY_RAY } query_kind;

typedef struct query {
  query_kind kind;
  double bounds[6];    /* of a box query */
  double point[3];     /* the sphere's centre or the ray's origin */
  double radius;       /* the sphere's radius, or the ray's t_max in lengths of its direction */
  double direction[3]; /* of a ray */
} query;

typedef struct found {
  double value; /* distance, or t where the ray enters */
  uint32_t id;
} found;

/* ---- tests of boxes */

static double distance_to(const double bounds[6], const double point[3])
{
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double away = fmax(fmax(bounds[2 * a] - point[a], point[a] - bounds[2 * a + 1]), 0.0);
    sum += away * away;
  }
  return sqrt(sum);
}

static bool overlaps(const double a[6], const double b[6])
{
  return a[0] <= b[1] && b[0] <= a[1] && a[2] <= b[3] && b[2] <= a[3] && a[4] <= b[5] && b[4] <= a[5];
}

/* t where the ray enters the box: 0 if it begins inside, INFINITY if it misses. */
static double enters(const double bounds[6], const query* q)
{
  double from = 0.0, to = q->radius;
  for (int a = 0; a < 3; ++a) {
    if (q->direction[a] == 0.0) {
      if (q->point[a] < bounds[2 * a] || q->point[a] > bounds[2 * a + 1]) {
        return INFINITY;
      }
      continue;
    }
    const double s = (bounds[2 * a] - q->point[a]) / q->direction[a], t = (bounds[2 * a + 1] - q->point[a]) / q->direction[a];
    from = fmax(from, fmin(s, t));
    to = fmin(to, fmax(s, t));
  }
  return from <= to ? from : INFINITY;
}

/* True if the query hits the box; *value is then its distance, or t of the ray's entry. */
static bool has(const query* q, const double bounds[6], double* value)
{
  switch (q->kind) {
    case QUERY_BOX:
      *value = 0.0;
      return overlaps(bounds, q->bounds);
    case QUERY_SPHERE:
      *value = distance_to(bounds, q->point);
      return *value <= q->radius;
    case QUERY_RAY:
      *value = enters(bounds, q);
      return *value < INFINITY;
  }
  return false;
}

/* ---- the walk */

/* True if the query contains the whole box, so that splitting the node would gain nothing. */
static bool swallows(const query* q, const double bounds[6])
{
  double far = 0.0;
  for (int a = 0; a < 3; ++a) {
    if (q->kind == QUERY_BOX && !(q->bounds[2 * a] <= bounds[2 * a] && bounds[2 * a + 1] <= q->bounds[2 * a + 1])) {
      return false;
    }
    const double away = fmax(fabs(bounds[2 * a] - q->point[a]), fabs(bounds[2 * a + 1] - q->point[a]));
    far += away * away;
  }
  return q->kind == QUERY_BOX || (q->kind == QUERY_SPHERE && sqrt(far) <= q->radius);
}

static void ask_children(
  const stratus_octree* tree, const void* self, unsigned mask, const double center[3], double quarter, uint8_t masks[8])
{
  const query* q = self;
  const double half = quarter * (1.0 + 2.0 * tree->pad);
  (void)mask;
  for (unsigned o = 0; o < 8; ++o) {
    double bounds[6], value;
    for (int a = 0; a < 3; ++a) {
      const double middle = center[a] + (o >> a & 1 ? quarter : -quarter);
      /* `room` covers the lists' rounding to floats, and the rounding of doubles where the origin is far away. */
      const double room = 1e-6 * (fabs(middle) + half) + 1e-14 * (fabs(tree->origin[a]) + fabs(q->point[a]));
      bounds[2 * a] = tree->origin[a] + (middle - half - room);
      bounds[2 * a + 1] = tree->origin[a] + (middle + half + room);
    }
    masks[o] = !has(q, bounds, &value) ? 0x80 : swallows(q, bounds) ? 0 : 1;
  }
}

static bool ask_divides(const stratus_octree* tree, const void* self, int level, const stratus_octree_place* place)
{
  (void)tree, (void)self, (void)level, (void)place;
  return true;
}

static int by_id(const void* a, const void* b)
{
  const found *x = a, *y = b;
  return x->id < y->id ? -1 : x->id > y->id;
}

static int by_value(const void* a, const void* b)
{
  const found *x = a, *y = b;
  return x->value < y->value ? -1 : x->value > y->value ? 1 : by_id(a, b);
}

/* Collects all objects of the query in no particular order. The caller releases *list. */
static stratus_status collect(stratus_octree* tree, const query* q, found** list, size_t* count)
{
  stratus_octree_view* view = tree->walker;
  stratus_octree_walk walk = {
    .self = q, .mask = 1, .children = ask_children, .divides = ask_divides, .boxes_stick_out = true, .budget = INT64_MAX
  };
  void* memory = NULL;
  size_t capacity = 0, n = 0;
  stratus_status status = STRATUS_OK;
  stratus_octree_make_root(tree);
  TRY(stratus_octree_walk_nodes(view, &walk));
  if (tree->options.placement == STRATUS_OCTREE_TOUCHING) {
    TRY(stratus_octree_view_reserve_stamps(view));
  }
  for (size_t j = 0; j < view->job_count; ++j) {
    const stratus_octree_job* job = &view->jobs[j];
    TRY_CLEANUP(stratus_octree_reserve(tree->context, &memory, &capacity, n + job->count, n, sizeof **list));
    found* all = memory;
    for (uint32_t i = 0; i < job->count; ++i) {
      const uint32_t id = job->ids[i];
      double value;
      if (!has(q, tree->bounds[id], &value)) {
        continue;
      }
      if (tree->options.placement == STRATUS_OCTREE_TOUCHING) {
        if (view->stamps[id] == view->stamp) {
          continue;
        }
        view->stamps[id] = view->stamp;
      }
      all[n++] = (found){ value, id };
    }
  }
  *list = memory;
  *count = n;
  return STRATUS_OK;
cleanup:
  stratus_release(tree->context, memory);
  return status;
}

/* ---- the queries */

static stratus_status check_numbers(const stratus_octree* tree, const char* what, const double* numbers, int count)
{
  if (!tree) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!numbers) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree query's %s is NULL", what);
  }
  for (int i = 0; i < count; ++i) {
    if (!isfinite(numbers[i])) {
      return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree query's %s[%d] is %g, must be finite", what, i, numbers[i]);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_output(const stratus_octree* tree, const uint32_t* ids, size_t capacity, const size_t* count)
{
  if (!count || (capacity > 0 && !ids)) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree query's %s is NULL", count ? "ids" : "count");
  }
  return STRATUS_OK;
}

static void write_found(const found* list, size_t n, size_t capacity, uint32_t* ids, double* values)
{
  for (size_t i = 0; i < n && i < capacity; ++i) {
    ids[i] = list[i].id;
    if (values) {
      values[i] = list[i].value;
    }
  }
}

static void sort(found* list, size_t n, int (*order)(const void*, const void*))
{
  if (n > 1) {
    qsort(list, n, sizeof *list, order);
  }
}

stratus_status stratus_octree_query_box(stratus_octree* tree, const double bounds[6], uint32_t* ids, size_t capacity, size_t* count)
{
  TRY(check_numbers(tree, "bounds", bounds, 0));
  TRY(check_output(tree, ids, capacity, count));
  query q = { .kind = QUERY_BOX };
  for (int a = 0; a < 3; ++a) {
    if (!(bounds[2 * a] <= bounds[2 * a + 1])) {
      return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree query's bounds are %g..%g on axis %d, must not fall",
        bounds[2 * a], bounds[2 * a + 1], a);
    }
  }
  memcpy(q.bounds, bounds, sizeof q.bounds);
  found* list = NULL;
  size_t n = 0;
  TRY(collect(tree, &q, &list, &n));
  const stratus_octree_list* more = &tree->unbounded;
  void* memory = list;
  size_t room = n;
  const stratus_status status = stratus_octree_reserve(tree->context, &memory, &room, n + more->count, n, sizeof *list);
  list = memory;
  for (uint32_t i = 0; status == STRATUS_OK && i < more->count; ++i) {
    list[n++] = (found){ 0.0, stratus_list_ids(more)[i] };
  }
  if (status == STRATUS_OK) {
    sort(list, n, by_id);
    write_found(list, n, capacity, ids, NULL);
    *count = n;
  }
  stratus_release(tree->context, list);
  return status;
}

stratus_status stratus_octree_query_sphere(
  stratus_octree* tree, const double center[3], double radius, uint32_t* ids, size_t capacity, size_t* count)
{
  TRY(check_numbers(tree, "center", center, 3));
  TRY(check_output(tree, ids, capacity, count));
  if (!(radius >= 0.0)) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree query's radius %g, must be 0 or more", radius);
  }
  query q = { .kind = QUERY_SPHERE, .radius = radius };
  memcpy(q.point, center, sizeof q.point);
  found* list = NULL;
  size_t n = 0;
  TRY(collect(tree, &q, &list, &n));
  sort(list, n, by_id);
  write_found(list, n, capacity, ids, NULL);
  *count = n;
  stratus_release(tree->context, list);
  return STRATUS_OK;
}

stratus_status stratus_octree_query_ray(stratus_octree* tree, const double origin[3], const double direction[3], double t_max,
  uint32_t* ids, double* t, size_t capacity, size_t* count)
{
  TRY(check_numbers(tree, "origin", origin, 3));
  TRY(check_numbers(tree, "direction", direction, 3));
  TRY(check_output(tree, ids, capacity, count));
  if (!(t_max >= 0.0)) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree query's t_max %g, must be 0 or more", t_max);
  }
  if (direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree query's direction is (0, 0, 0), must have a length");
  }
  query q = { .kind = QUERY_RAY, .radius = t_max };
  memcpy(q.point, origin, sizeof q.point);
  memcpy(q.direction, direction, sizeof q.direction);
  found* list = NULL;
  size_t n = 0;
  TRY(collect(tree, &q, &list, &n));
  sort(list, n, by_value);
  write_found(list, n, capacity, ids, t);
  *count = n;
  stratus_release(tree->context, list);
  return STRATUS_OK;
}

/* Searches spheres of doubling radius. The first would hold about k objects if these were spread evenly. */
stratus_status stratus_octree_query_nearest(
  stratus_octree* tree, const double point[3], size_t k, uint32_t* ids, double* distances, size_t* count)
{
  TRY(check_numbers(tree, "point", point, 3));
  TRY(check_output(tree, ids, k, count));
  const size_t bounded = tree->count - tree->unbounded_count, wanted = k < bounded ? k : bounded;
  query q = { .kind = QUERY_SPHERE, .radius = INFINITY };
  memcpy(q.point, point, sizeof q.point);
  stratus_octree_make_root(tree);
  if (tree->rooted && wanted > 0) {
    double root[6];
    for (int a = 0; a < 3; ++a) {
      root[2 * a] = tree->origin[a] + tree->corner[a];
      root[2 * a + 1] = root[2 * a] + tree->edge;
    }
    q.radius = distance_to(root, point) + 0.5 * tree->edge * cbrt((double)wanted / (double)bounded);
  }
  found* list = NULL;
  size_t n = 0;
  while (wanted > 0) {
    TRY(collect(tree, &q, &list, &n));
    if (n >= wanted) {
      break;
    }
    stratus_release(tree->context, list);
    list = NULL;
    q.radius *= 2.0;
  }
  sort(list, n, by_value);
  write_found(list, n < wanted ? n : wanted, wanted, ids, distances);
  *count = wanted;
  stratus_release(tree->context, list);
  return STRATUS_OK;
}
