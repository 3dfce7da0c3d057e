/* SPDX-License-Identifier: BSD-3-Clause
 * Cuts a node's cells by a plane. Every edge that crosses the plane gets one new point, which a table finds by the edge's ends. Each cell
 * is then halved at its new points, in ascending order of their numbers. Two cells that share a face halve it in the same order, so their
 * pieces meet in the same triangles, and no table of cases is needed. A cell becomes the 2, 3, 4 or 6 pieces of Li et al. 2012, figure 2. A
 * cell of another leaf that only shares an edge or a face with a cut cell becomes 2 or 3. */
#include "partition_build.h"

#include <string.h>

#define PIECES_MAX 6

/* A hash table from edges that are cut to their new points. */
typedef struct edge_table {
  uint64_t* edges; /* lower end << 32 | higher end; 0: a free slot, as no edge joins point 0 to itself */
  int32_t* points;
  uint64_t mask;
} edge_table;

typedef struct cut_task {
  stratus_partition* partition;
  const stratus_kdtree_plane* plane;
  edge_table table;
} cut_task;

static double side_of(const cut_task* task, int32_t point)
{
  const stratus_partition* partition = task->partition;
  return stratus_kdtree_above(partition->along[3 * (int64_t)point + task->plane->axis], task->plane->value, partition->tolerance);
}

static bool crosses(const cut_task* task, const int32_t v[4])
{
  const double a = side_of(task, v[0]), b = side_of(task, v[1]), c = side_of(task, v[2]), d = side_of(task, v[3]);
  return fmin(fmin(a, b), fmin(c, d)) < 0.0 && fmax(fmax(a, b), fmax(c, d)) > 0.0;
}

/* The slot of an edge, or the free one where it belongs. */
static uint64_t edge_slot(const edge_table* table, int32_t p, int32_t q)
{
  const uint64_t low = (uint32_t)(p < q ? p : q), high = (uint32_t)(p < q ? q : p), edge = low << 32 | high;
  uint64_t slot = edge * UINT64_C(0x9e3779b97f4a7c15) >> 20 & table->mask;
  while (table->edges[slot] != 0 && table->edges[slot] != edge) {
    slot = (slot + 1) & table->mask;
  }
  return slot;
}

static stratus_status make_edge_table(cut_task* task, int64_t cells)
{
  stratus_context* context = task->partition->context;
  void* memory;
  /* At most 4 edges of a cell cross the plane; half of the slots stay free. */
  for (task->table.mask = 1; task->table.mask < 8 * (uint64_t)cells; task->table.mask = 2 * task->table.mask + 1) {}
  TRY(stratus_allocate_zero(context, task->table.mask + 1, sizeof(uint64_t), &memory));
  task->table.edges = memory;
  TRY(stratus_allocate(context, task->table.mask + 1, sizeof(int32_t), &memory));
  task->table.points = memory;
  return STRATUS_OK;
}

/* Interpolates, but never beyond the ends, whatever the rounding: an edge in a plane of the tree gets a point in that plane. */
static double between(double a, double b, double weight)
{
  return fmin(fmax((1.0 - weight) * a + weight * b, fmin(a, b)), fmax(a, b));
}

static stratus_status add_point(cut_task* task, int32_t p, int32_t q, int32_t* number)
{
  stratus_partition* partition = task->partition;
  stratus_context* context = partition->context;
  const bool turned = partition->along != partition->points;
  const size_t old = (size_t)partition->old_points, count = (size_t)partition->point_count;
  if (partition->point_count == INT32_MAX) {
    return stratus_fail(context, STRATUS_OVERFLOW, "partition: more than %d points", INT32_MAX);
  }
  TRY(stratus_kdtree_reserve(
    context, (void**)&partition->points, &partition->point_capacity, count + 1, count, 3 * sizeof *partition->points));
  if (turned) {
    TRY(stratus_kdtree_reserve(
      context, (void**)&partition->along, &partition->along_capacity, count + 1, count, 3 * sizeof *partition->along));
  } else {
    partition->along = partition->points;
  }
  TRY(stratus_kdtree_reserve(
    context, (void**)&partition->ends, &partition->ends_capacity, count + 1 - old, count - old, 2 * sizeof *partition->ends));
  TRY(stratus_kdtree_reserve(
    context, (void**)&partition->weights, &partition->weights_capacity, count + 1 - old, count - old, sizeof *partition->weights));
  const int32_t a = p < q ? p : q, b = p < q ? q : p; /* the same point from whichever end */
  const double from = side_of(task, a), to = side_of(task, b);
  const double weight = fmin(fmax(from / (from - to), 0x1p-1022), 1.0 - 0x1p-53);
  for (size_t axis = 0; axis < 3; ++axis) {
    partition->points[3 * count + axis] = between(partition->points[3 * (size_t)a + axis], partition->points[3 * (size_t)b + axis], weight);
    if (turned) {
      partition->along[3 * count + axis] = between(partition->along[3 * (size_t)a + axis], partition->along[3 * (size_t)b + axis], weight);
    }
  }
  partition->along[3 * count + (size_t)task->plane->axis] = task->plane->value;
  partition->ends[2 * (count - old)] = a;
  partition->ends[2 * (count - old) + 1] = b;
  partition->weights[count - old] = weight;
  *number = (int32_t)partition->point_count++;
  return STRATUS_OK;
}

/* Makes the points of all edges of the node's cells that cross the plane. */
static stratus_status cut_edges(cut_task* task, const stratus_kdtree_node* node)
{
  static const int8_t ends[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };
  for (int64_t i = 0; i < node->count; ++i) {
    const int32_t* v = node->cells[i].vertex;
    for (int e = 0; e < 6 && crosses(task, v); ++e) {
      const int32_t p = v[ends[e][0]], q = v[ends[e][1]];
      const double a = side_of(task, p), b = side_of(task, q);
      const uint64_t slot = edge_slot(&task->table, p, q);
      if (((a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)) && task->table.edges[slot] == 0) {
        TRY(add_point(task, p, q, &task->table.points[slot]));
        task->table.edges[slot] = (uint64_t)(uint32_t)(p < q ? p : q) << 32 | (uint32_t)(p < q ? q : p);
      }
    }
  }
  return STRATUS_OK;
}

/* Fills cuts[] with the new points on a cell's edges, ascending, each with its edge's ends. Returns how many. */
static int find_cuts(const cut_task* task, const int32_t v[4], int32_t cuts[4][3])
{
  int count = 0;
  for (int p = 0; p < 4; ++p) {
    for (int q = p + 1; q < 4; ++q) {
      const uint64_t slot = edge_slot(&task->table, v[p], v[q]);
      if (task->table.edges[slot] == 0 || count == 4) {
        continue;
      }
      int at = count++;
      for (; at > 0 && cuts[at - 1][0] > task->table.points[slot]; --at) {
        memcpy(cuts[at], cuts[at - 1], sizeof cuts[at]);
      }
      cuts[at][0] = task->table.points[slot];
      cuts[at][1] = v[p];
      cuts[at][2] = v[q];
    }
  }
  return count;
}

static int find_vertex(const int32_t v[4], int32_t point)
{
  return v[0] == point ? 0 : v[1] == point ? 1 : v[2] == point ? 2 : v[3] == point ? 3 : -1;
}

static bool is_flat(const stratus_partition* partition, const int32_t v[4])
{
  const double* x = partition->points;
  return stratus_orientation(x + 3 * (int64_t)v[0], x + 3 * (int64_t)v[1], x + 3 * (int64_t)v[2], x + 3 * (int64_t)v[3]) == 0;
}

/* Divides a cell into pieces, or copies it if no edge is cut, and returns how many. Rounding may leave a piece without volume, which is
 * dropped. Pieces of a flat cell are kept, as the visibility order passes through them. */
static int divide(cut_task* task, const stratus_kdtree_cell* cell, stratus_kdtree_cell pieces[PIECES_MAX])
{
  stratus_partition* partition = task->partition;
  int32_t cuts[4][3];
  const int cut_count = find_cuts(task, cell->vertex, cuts);
  int count = 1, kept = 0;
  pieces[0] = *cell;
  for (int c = 0; c < cut_count; ++c) {
    for (int i = 0, before = count; i < before; ++i) {
      const int p = find_vertex(pieces[i].vertex, cuts[c][1]), q = find_vertex(pieces[i].vertex, cuts[c][2]);
      if (p >= 0 && q >= 0) {
        pieces[count] = pieces[i];
        pieces[count++].vertex[p] = cuts[c][0];
        pieces[i].vertex[q] = cuts[c][0];
      }
    }
  }
  if (cut_count == 0) {
    return 1;
  }
  partition->cut_cells += partition->cut[cell->origin] == 0;
  partition->cut[cell->origin] = 1;
  const bool flat = is_flat(partition, cell->vertex);
  for (int i = 0; i < count; ++i) {
    const bool keep = flat || !is_flat(partition, pieces[i].vertex);
    pieces[kept] = pieces[i];
    kept += keep;
    partition->tiny_pieces += !keep;
  }
  return kept;
}

static stratus_status append(stratus_context* context, stratus_kdtree_node* node, const stratus_kdtree_cell* cell)
{
  TRY(stratus_kdtree_reserve(
    context, (void**)&node->cells, &node->capacity, (size_t)node->count + 1, (size_t)node->count, sizeof *node->cells));
  node->cells[node->count++] = *cell;
  return STRATUS_OK;
}

/* Divides the cells of another leaf that share a cut edge. Their pieces stay in the leaf. */
static stratus_status divide_beside(cut_task* task, stratus_kdtree_node* node)
{
  stratus_kdtree_cell pieces[PIECES_MAX];
  int64_t kept = 0;
  const int64_t count = node->count;
  for (int64_t i = 0; i < count; ++i) {
    const stratus_kdtree_cell cell = node->cells[i];
    int made = 1;
    pieces[0] = cell;
    if (crosses(task, cell.vertex)) {
      made = divide(task, &cell, pieces);
    }
    for (int p = 0; p < made; ++p) {
      if (p == 0) {
        node->cells[kept++] = pieces[p];
      } else {
        TRY(append(task->partition->context, node, pieces + p));
      }
    }
  }
  if (node->count > count) { /* pieces behind the last cell move up, where a cell left no piece */
    memmove(node->cells + kept, node->cells + count, (size_t)(node->count - count) * sizeof *node->cells);
  }
  node->count -= count - kept;
  return STRATUS_OK;
}

/* Whether two boxes touch. Cells may reach out of their boxes by the tolerance. */
static bool boxes_touch(const double p[6], const double q[6], double tolerance)
{
  for (int a = 0; a < 6; a += 2) {
    if (p[a] - 2.0 * tolerance > q[a + 1] || q[a] - 2.0 * tolerance > p[a + 1]) {
      return false;
    }
  }
  return true;
}

static stratus_status hand_down(cut_task* task, const stratus_kdtree_node* node, stratus_kdtree_node* below, stratus_kdtree_node* above)
{
  stratus_kdtree_cell pieces[PIECES_MAX];
  for (int64_t i = 0; i < node->count; ++i) {
    int made = 1;
    pieces[0] = node->cells[i];
    if (crosses(task, node->cells[i].vertex)) {
      made = divide(task, node->cells + i, pieces);
    }
    for (int p = 0; p < made; ++p) {
      const int32_t* v = pieces[p].vertex;
      const double highest = fmax(fmax(side_of(task, v[0]), side_of(task, v[1])), fmax(side_of(task, v[2]), side_of(task, v[3])));
      TRY(append(task->partition->context, highest > 0.0 ? above : below, pieces + p));
    }
  }
  return STRATUS_OK;
}

static stratus_status cut_node(cut_task* task, int32_t number)
{
  stratus_partition* partition = task->partition;
  stratus_context* context = partition->context;
  int64_t crossing = 0;
  TRY(stratus_kdtree_reserve(context, (void**)&partition->nodes, &partition->node_capacity, (size_t)partition->node_count + 2,
    (size_t)partition->node_count, sizeof *partition->nodes));
  stratus_kdtree_node* node = partition->nodes + number;
  for (int64_t i = 0; i < node->count; ++i) {
    crossing += crosses(task, node->cells[i].vertex);
  }
  TRY(make_edge_table(task, crossing));
  TRY(cut_edges(task, node));
  for (int32_t n = 0; n < partition->node_count && crossing > 0; ++n) {
    if (n != number && partition->nodes[n].plane.axis < 0 && boxes_touch(node->box, partition->nodes[n].box, partition->tolerance)) {
      TRY(divide_beside(task, partition->nodes + n));
    }
  }
  const int32_t below = partition->node_count, above = below + 1;
  for (int32_t child = below; child <= above; ++child) {
    partition->nodes[child] = (stratus_kdtree_node){ .plane = { .axis = -1 } };
    memcpy(partition->nodes[child].box, node->box, sizeof node->box);
    partition->nodes[child].box[2 * task->plane->axis + (child == below)] = task->plane->value;
  }
  partition->node_count += 2;
  node->plane = (stratus_partition_node){ task->plane->axis, below, above, 0, task->plane->value };
  TRY(hand_down(task, node, partition->nodes + below, partition->nodes + above));
  stratus_release(context, node->cells);
  node->cells = NULL;
  node->count = 0;
  return STRATUS_OK;
}

stratus_status stratus_kdtree_cut(stratus_partition* partition, int32_t node, const stratus_kdtree_plane* plane)
{
  cut_task task = { .partition = partition, .plane = plane };
  const stratus_status status = cut_node(&task, node);
  stratus_release(partition->context, task.table.edges);
  stratus_release(partition->context, task.table.points);
  return status;
}
