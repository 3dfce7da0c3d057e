/* SPDX-License-Identifier: BSD-3-Clause
 * Culling: the objects of an octree that a frustum sees. Nodes are tested from the root down (Li & Huang 2024, section 4), then their
 * boxes, sixteen at a time in floats. Boxes that floats cannot decide are tested in double precision. The result therefore equals a test of
 * every object, whatever the tree. */
#include "octree.h"

#include <string.h>

#define PACKS_A_THREAD 1024 /* fewer packs are not worth a second thread */

/* ---- nodes */

typedef struct looker {
  const stratus_frustum_plan* plan;
  stratus_octree_planes planes;
} looker;

static void look_at_children(
  const stratus_octree* tree, const void* self, unsigned mask, const double center[3], double quarter, uint8_t masks[8])
{
  const looker* look = self;
  stratus_octree_test_children(&look->planes, mask, center, quarter, 1.0 + 2.0 * tree->pad, masks);
}

/* `width` as a share of the window's height at the depth of the point. That height is the sum of the distances from the bottom and the top
 * plane. INFINITY behind the eye or without one of these planes. */
static double share_of_window(const stratus_frustum_plan* plan, const double point[3], double width)
{
  double height = 0.0;
  for (int p = 2; p < 4; ++p) {
    const double* n = plan->planes[p];
    if (!(plan->used >> p & 1)) {
      return INFINITY;
    }
    height += (n[0] * point[0] + n[1] * point[1] + n[2] * point[2] + n[3]) / plan->lengths[p];
  }
  return height > 0.0 ? width / height : INFINITY;
}

static bool look_divides(const stratus_octree* tree, const void* self, int level, const stratus_octree_place* place)
{
  const looker* look = self;
  const double size = stratus_octree_cell_size(tree, level);
  double center[3], manhattan = 0.0, euclid = 0.0;
  stratus_octree_cell_corner(tree, level, place, center);
  for (int a = 0; a < 3; ++a) {
    center[a] += tree->origin[a] + 0.5 * size;
    const double away = fabs(center[a] - look->plan->eye[a]);
    manhattan += away;
    euclid += away * away;
  }
  switch (tree->options.stop) {
    case STRATUS_OCTREE_STOP_MANHATTAN:
      return manhattan < tree->options.c * 3.0 * size;
    case STRATUS_OCTREE_STOP_EUCLID:
      return sqrt(euclid) < tree->options.c * sqrt(3.0) * size;
    case STRATUS_OCTREE_STOP_PIXELS:
      return 1000.0 * share_of_window(look->plan, center, sqrt(3.0) * size) > tree->options.pixels;
    case STRATUS_OCTREE_STOP_STATIC:
      return true;
  }
  return false;
}

/* ---- boxes */

/* False if doubles show the object outside (exact: separated). */
static bool object_is_seen(const stratus_octree* tree, const stratus_frustum_plan* plan, uint32_t id, bool exact)
{
  const bool turned = tree->kind[id] == STRATUS_OBJECT_TURNED;
  const stratus_solid_box box = turned ? stratus_solid_box_of_turned(tree->turned[id]) : stratus_solid_box_of_bounds(tree->bounds[id]);
  const stratus_side side =
    turned ? stratus_plan_side_turned(plan, plan->used, &box) : stratus_plan_side(plan, plan->used, tree->bounds[id]);
  return side == STRATUS_SIDE_INSIDE || (side == STRATUS_SIDE_CROSSING && !(exact && plan->solid && stratus_plan_separated(plan, &box)));
}

/* Fills keep[] of the job's packs and job->kept. Returns how many boxes were tested again in double precision. */
static uint64_t test_job(const stratus_octree_view* view, const looker* look, bool exact, stratus_octree_job* job)
{
  const stratus_octree* tree = view->tree;
  const uint32_t packs = (job->count + STRATUS_PACK - 1) / STRATUS_PACK;
  uint16_t *keep = view->keep + job->first, *unsure = view->unsure + job->first;
  uint64_t retested = 0;
  job->kept = 0;
  stratus_octree_test_packs(&look->planes, job->mask, exact || tree->turned, job->boxes, job->hints, packs, keep, unsure);
  for (uint32_t p = 0; p < packs; ++p) {
    const uint32_t rest = job->count - p * STRATUS_PACK;
    const unsigned lanes = rest < STRATUS_PACK ? (1u << rest) - 1u : 0xffffu;
    unsigned kept = keep[p] & lanes;
    for (unsigned ask = unsure[p] & kept; ask; ask &= ask - 1) {
      const int lane = __builtin_ctz(ask);
      ++retested;
      if (!object_is_seen(tree, look->plan, job->ids[p * STRATUS_PACK + (uint32_t)lane], exact)) {
        kept &= ~(1u << lane);
      }
    }
    keep[p] = (uint16_t)kept;
    job->kept += (uint32_t)__builtin_popcount(kept);
  }
  return retested;
}

static void list_kept(const stratus_octree_view* view, const stratus_octree_job* job, uint32_t* ids)
{
  if (job->kept == job->count) {
    memcpy(ids, job->ids, job->count * sizeof *ids);
    return;
  }
  const uint16_t* keep = view->keep + job->first;
  uint32_t listed = 0;
  for (uint32_t p = 0; listed < job->kept; ++p) {
    for (unsigned kept = keep[p]; kept; kept &= kept - 1) {
      ids[listed++] = job->ids[p * STRATUS_PACK + (uint32_t)__builtin_ctz(kept)];
    }
  }
}

static size_t drop_repeated(stratus_octree_view* view, size_t count)
{
  size_t once = 0;
  for (size_t i = 0; i < count; ++i) {
    const uint32_t id = view->ids[i];
    if (view->stamps[id] != view->stamp) {
      view->stamps[id] = view->stamp;
      view->ids[once++] = id;
    }
  }
  return once;
}

static stratus_status reserve_results(stratus_octree_view* view)
{
  stratus_context* context = view->tree->context;
  void *keep = view->keep, *unsure = view->unsure;
  TRY(stratus_octree_reserve(context, &keep, &view->keep_capacity, view->packs, 0, sizeof *view->keep));
  view->keep = keep;
  TRY(stratus_octree_reserve(context, &unsure, &view->unsure_capacity, view->packs, 0, sizeof *view->unsure));
  view->unsure = unsure;
  return STRATUS_OK;
}

/* Tests the boxes of all jobs and leaves the ids of the visible objects in the view. */
static stratus_status run_jobs(stratus_octree_view* view, const looker* look, bool exact, stratus_octree_visible* visible)
{
  const stratus_octree* tree = view->tree;
  const int64_t jobs = (int64_t)view->job_count;
  const int threads = tree->context->threads;
  const bool several = view->packs > PACKS_A_THREAD && threads > 1;
  uint64_t tested = 0, retested = 0;
  size_t count = tree->unbounded.count;
  TRY(reserve_results(view));
#pragma omp parallel for if (several) num_threads(threads) schedule(dynamic, 8) reduction(+ : tested, retested)
  for (int64_t j = 0; j < jobs; ++j) {
    stratus_octree_job* job = &view->jobs[j];
    if (job->mask) {
      tested += job->count;
      retested += test_job(view, look, exact, job);
    } else {
      job->kept = job->count;
    }
  }
  for (int64_t j = 0; j < jobs; ++j) {
    count += view->jobs[j].kept;
  }
  void* ids = view->ids;
  TRY(stratus_octree_reserve(tree->context, &ids, &view->ids_capacity, count, 0, sizeof *view->ids));
  view->ids = ids;
  if (tree->unbounded.count > 0) {
    memcpy(view->ids, stratus_list_ids(&tree->unbounded), tree->unbounded.count * sizeof *view->ids);
  }
  size_t listed = tree->unbounded.count;
  for (int64_t j = 0; j < jobs; ++j) {
    if (view->jobs[j].kept > 0) { /* view->ids may be NULL where no job keeps a box */
      list_kept(view, &view->jobs[j], view->ids + listed);
      listed += view->jobs[j].kept;
    }
  }
  visible->objects_tested = tested;
  visible->objects_retested = retested;
  visible->count = listed;
  if (tree->options.placement == STRATUS_OCTREE_TOUCHING) {
    TRY(stratus_octree_view_reserve_stamps(view));
    visible->count = drop_repeated(view, listed);
  }
  return STRATUS_OK;
}

/* ---- coverage and depth */

static double gap(const stratus_frustum_plan* plan, int p, const double point[3])
{
  const double* n = plan->planes[p];
  return (n[0] * point[0] + n[1] * point[1] + n[2] * point[2] + n[3]) / plan->lengths[p];
}

/* Share of the window that the square covers in one direction. low and high: distances of its centre from the two planes. */
static double covered(double low, double high, double radius)
{
  const double whole = low + high;
  const double part = whole - fmax(low - radius, 0.0) - fmax(high - radius, 0.0);
  return whole > 0.0 ? fmin(fmax(part / whole, 0.0), 1.0) : 1.0;
}

static void measure(const stratus_octree* tree, const stratus_frustum_plan* plan, uint32_t id, float* coverage, float* depth)
{
  *coverage = 1.0f;
  *depth = 0.0f;
  if (tree->kind[id] == STRATUS_OBJECT_UNBOUNDED) {
    return;
  }
  const double* b = tree->bounds[id];
  const double center[3] = { 0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5]) };
  const double x = b[1] - b[0], y = b[3] - b[2], z = b[5] - b[4], radius = 0.5 * sqrt(x * x + y * y + z * z);
  double share = 1.0;
  for (int p = 0; p < 4; p += 2) {
    if ((plan->used >> p & 3) == 3) {
      share *= covered(gap(plan, p, center), gap(plan, p + 1, center), radius);
    }
  }
  *coverage = (float)share;
  *depth = plan->used >> 4 & 1 ? (float)gap(plan, 4, center) : 0.0f;
}

static stratus_status measure_all(stratus_octree_view* view, const stratus_frustum_plan* plan, size_t count)
{
  const stratus_octree* tree = view->tree;
  const int threads = tree->context->threads;
  const int64_t n = (int64_t)count;
  void *coverage = view->coverage, *depth = view->depth;
  TRY(stratus_octree_reserve(tree->context, &coverage, &view->coverage_capacity, count, 0, sizeof *view->coverage));
  view->coverage = coverage;
  TRY(stratus_octree_reserve(tree->context, &depth, &view->depth_capacity, count, 0, sizeof *view->depth));
  view->depth = depth;
#pragma omp parallel for if (n > 16384) num_threads(threads)
  for (int64_t i = 0; i < n; ++i) {
    measure(tree, plan, view->ids[i], &view->coverage[i], &view->depth[i]);
  }
  return STRATUS_OK;
}

/* ---- one call */

/* Planes that cut the hull of all objects. If there are none, everything is in sight and no tree is needed. The linear list (levels 0)
 * tests every object, so that it keeps all planes. */
static unsigned planes_that_cut(const stratus_octree* tree, const stratus_frustum_plan* plan)
{
  unsigned mask = plan->used;
  for (int p = 0; p < STRATUS_PLANES && tree->options.levels > 0; ++p) {
    if (stratus_plan_side(plan, 1u << p, tree->hull) == STRATUS_SIDE_INSIDE) {
      mask &= ~(1u << p);
    }
  }
  return mask;
}

/* Merges nodes that no border has crossed for collapse_after calls. The deepest level goes first, since a node merges only after its
 * children have. */
static stratus_status collapse_unseen(stratus_octree* tree, uint64_t* collapses)
{
  const uint32_t after = (uint32_t)tree->options.collapse_after, every = after / 8 > 0 ? after / 8 : 1;
  if (after == 0 || tree->options.stop == STRATUS_OCTREE_STOP_STATIC || tree->clock % every != 0) {
    return STRATUS_OK;
  }
  for (int level = tree->depth - 1; level >= 0; --level) {
    TRY(stratus_octree_collapse(tree, level, after, collapses));
  }
  return STRATUS_OK;
}

static stratus_status look(
  stratus_octree_view* view, const stratus_frustum_plan* plan, const stratus_octree_cull_options* options, stratus_octree_visible* result)
{
  stratus_octree* tree = view->tree;
  looker look = { .plan = plan };
  stratus_octree_walk walk = { .self = &look, .mask = planes_that_cut(tree, plan), .children = look_at_children, .divides = look_divides };
  walk.boxes_stick_out = tree->options.placement == STRATUS_OCTREE_TOUCHING;
  walk.test_whole = walk.boxes_stick_out && options->exact;
  walk.budget = options->hold ? 0 : tree->options.split_budget > 0 ? tree->options.split_budget : INT64_MAX;
  uint64_t splits = 0, handed_down = 0;
  ++tree->clock;
  if (!options->hold && (walk.mask || tree->options.stop == STRATUS_OCTREE_STOP_STATIC)) {
    stratus_octree_make_root(tree);
  }
  if (!options->hold && tree->options.stop == STRATUS_OCTREE_STOP_STATIC && tree->changed) {
    TRY(stratus_octree_split_all(view, &splits, &handed_down));
    tree->changed = false;
  }
  stratus_octree_planes_prepare(tree, plan, &look.planes);
  if (!plan->empty) {
    TRY(stratus_octree_walk_nodes(view, &walk));
  } else {
    view->job_count = view->packs = 0;
  }
  TRY(run_jobs(view, &look, options->exact != 0, result));
  if (options->coverage) {
    TRY(measure_all(view, plan, result->count));
    result->coverage = view->coverage;
    result->depth = view->depth;
  }
  result->ids = view->ids;
  result->nodes_tested = walk.nodes_tested;
  result->splits = splits + walk.splits;
  result->objects_handed_down = handed_down + walk.handed_down;
  return options->hold ? STRATUS_OK : collapse_unseen(tree, &result->collapses);
}

stratus_status stratus_octree_cull(
  stratus_octree_view* view, const stratus_frustum* frustum, const stratus_octree_cull_options* options, stratus_octree_visible* visible)
{
  if (!view) {
    return STRATUS_INVALID_ARGUMENT;
  }
  stratus_context* context = view->tree->context;
  TRY(stratus_frustum_check(context, frustum));
  if (!visible) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree visible is NULL");
  }
  const stratus_octree_cull_options defaults = { 0 };
  const stratus_octree_cull_options* used = options ? options : &defaults;
  stratus_frustum_plan plan;
  stratus_octree_visible result = { 0 };
  stratus_frustum_prepare(frustum, used->exact != 0, &plan);
  TRY(look(view, &plan, used, &result));
  *visible = result;
  return STRATUS_OK;
}
