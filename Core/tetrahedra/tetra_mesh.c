/* SPDX-License-Identifier: BSD-3-Clause
 * Converts a mesh of tetrahedra to the form that rays read: a few ints per cell, packed from its neighbours, and the border faces by which
 * rays enter. Cells that show nothing (hidden, with a value that is not finite, or with a point named twice) are left out as hollows. */
#include "mesh.h"
#include "tetra_cells.h"

#include <string.h>

#define CELL_INTS_MOST INT32_MAX
#define POINTS_MOST (INT32_MAX / 4) /* four floats per point */
#define HASHED_AT_ONCE ((size_t)1 << 16)

bool stratus_tetra_shows(
  const stratus_mesh* mesh, const stratus_volume* volume, const float* point_values, double bias, int64_t cell, float range[2])
{
  const int32_t* v = mesh->vertices + 4 * cell;
  bool shows = !(mesh->hidden && mesh->hidden[cell]) && !stratus_names_a_point_twice(v);
  range[0] = range[1] = point_values ? point_values[v[0]] : stratus_tetra_fetch(mesh, volume, bias, (size_t)cell);
  shows = shows && isfinite(range[0]);
  for (int i = 1; i < 4 && point_values; ++i) {
    const float value = point_values[v[i]];
    shows = shows && isfinite(value);
    range[0] = fminf(range[0], value);
    range[1] = fmaxf(range[1], value);
  }
  return shows;
}

/* Counts from the values of a mesh: the cells that show, and the range of values of the cells with a volume. */
typedef struct value_counts {
  int64_t shown, blanked, repeated, changed; /* changed: cells that show and did not, or the other way round */
  float low, high;
} value_counts;

static value_counts count_values(
  const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_volume* volume, const float* values, double bias)
{
  int64_t shown = 0, blanked = 0, repeated = 0, changed = 0;
  float low = INFINITY, high = -INFINITY;
  const int threads = tetra->context->threads;
#pragma omp parallel for num_threads(threads) reduction(+ : shown, blanked, repeated, changed) reduction(min : low) reduction(max : high)
  for (int64_t cell = 0; cell < mesh->cell_count; ++cell) {
    const bool hidden = mesh->hidden && mesh->hidden[cell], twice = stratus_names_a_point_twice(mesh->vertices + 4 * cell);
    float range[2];
    const bool shows = stratus_tetra_shows(mesh, volume, values, bias, cell, range);
    shown += shows;
    blanked += !shows && !hidden;
    repeated += twice && !hidden;
    changed += shows != (tetra->shown[cell] != STRATUS_TETRA_HIDDEN);
    if (shows && tetra->shown[cell] == STRATUS_TETRA_SHOWN) {
      low = fminf(low, range[0]);
      high = fmaxf(high, range[1]);
    }
  }
  return (value_counts){ shown, blanked, repeated, changed, low, high };
}

static void keep_counts(stratus_tetra_mesh* tetra, const value_counts* counts)
{
  tetra->shown_cells = counts->shown;
  tetra->blanked = counts->blanked;
  tetra->repeated = counts->repeated;
  tetra->low = counts->low;
  tetra->high = counts->high;
}

static void find_shown(
  stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_volume* volume, const stratus_adjacency* adjacency)
{
#pragma omp parallel for num_threads(tetra->context->threads)
  for (int64_t cell = 0; cell < mesh->cell_count; ++cell) {
    float range[2];
    const bool shows = stratus_tetra_shows(mesh, volume, tetra->values, tetra->bias, cell, range);
    tetra->shown[cell] = !shows ? STRATUS_TETRA_HIDDEN : adjacency->orientation[cell] != 0 ? STRATUS_TETRA_SHOWN : STRATUS_TETRA_FLAT;
  }
  const value_counts counts = count_values(tetra, mesh, volume, tetra->values, tetra->bias);
  keep_counts(tetra, &counts);
}

static void find_bounds(stratus_tetra_mesh* tetra, const stratus_mesh* mesh)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
#pragma omp parallel for num_threads(tetra->context->threads) reduction(min : lo[:3]) reduction(max : hi[:3])
  for (int64_t cell = 0; cell < mesh->cell_count; ++cell) {
    for (int i = 0; i < 4 && tetra->shown[cell]; ++i) {
      const double* p = mesh->points + 3 * (int64_t)mesh->vertices[4 * cell + i];
      for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = fmin(lo[axis], p[axis]);
        hi[axis] = fmax(hi[axis], p[axis]);
      }
    }
  }
  memcpy(tetra->lo, lo, sizeof lo);
  memcpy(tetra->hi, hi, sizeof hi);
}

/* Returns the face of `cell` with these points, ordered by stratus_face_points(); -1: none. */
static int face_with(const int32_t cell[4], const int32_t point[3])
{
  for (int f = 0; f < 4; ++f) {
    int32_t own[3];
    (void)stratus_face_points(cell, f, own);
    if (memcmp(own, point, sizeof own) == 0) {
      return f;
    }
  }
  return -1;
}

/* Return the orientation of a cell that agrees with the neighbour behind its face f: the two are on either side of the face. */
static int fitting_orientation(const stratus_mesh* mesh, int64_t cell, int f, int32_t neighbour, int orientation)
{
  const int32_t* w = mesh->vertices + 4 * (int64_t)neighbour;
  int32_t point[3], same[3];
  const int sign = stratus_face_points(mesh->vertices + 4 * cell, f, point), face = face_with(w, point);
  return face < 0 ? 0 : -sign * stratus_face_points(w, face, same) * orientation;
}

/* Orient each flat cell to fit a neighbour: one with volume or, failing that, a flat one already oriented. Other flat cells keep 0. */
static stratus_status orient_flat_cells(stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_adjacency* adjacency)
{
  void* memory = NULL;
  int64_t count = 0;
  TRY(stratus_allocate(tetra->context, (size_t)mesh->cell_count, 1, &memory));
  tetra->nominal = memory;
  if (adjacency->flat > 0) {
    TRY(stratus_allocate(tetra->context, (size_t)adjacency->flat, sizeof(int32_t), &memory));
  }
  int32_t* found = adjacency->flat > 0 ? memory : NULL; /* flat cells whose neighbours are still to be looked at */
  for (int64_t cell = 0; cell < mesh->cell_count; ++cell) {
    tetra->nominal[cell] = adjacency->orientation[cell];
    for (int f = 0; f < 4 && tetra->nominal[cell] == 0; ++f) {
      const int32_t other = adjacency->neighbours[4 * cell + f];
      if (other >= 0 && adjacency->orientation[other] != 0) {
        tetra->nominal[cell] = (int8_t)fitting_orientation(mesh, cell, f, other, adjacency->orientation[other]);
        found[count] = (int32_t)cell;
        count += tetra->nominal[cell] != 0;
      }
    }
  }
  while (count > 0) {
    const int32_t cell = found[--count];
    for (int f = 0; f < 4; ++f) {
      const int32_t other = adjacency->neighbours[4 * (int64_t)cell + f];
      if (other >= 0 && tetra->nominal[other] == 0) {
        tetra->nominal[other] = (int8_t)fitting_orientation(mesh, cell, f, other, tetra->nominal[cell]);
        found[count] = other;
        count += tetra->nominal[other] != 0;
      }
    }
  }
  stratus_release(tetra->context, found);
  return STRATUS_OK;
}

/* Returns the shown neighbour behind face f; -1: none, the face is a border face. A flat cell may have neighbours that overlap, on the same
 * side of it: those that its orientation does not fit are no neighbours. */
static int32_t shown_neighbour(
  const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_adjacency* adjacency, int64_t cell, int f)
{
  const int32_t other = adjacency->neighbours[4 * cell + f];
  if (other < 0 || !tetra->shown[other]) {
    return -1;
  }
  const bool flat = adjacency->orientation[cell] == 0 || adjacency->orientation[other] == 0;
  return flat && tetra->nominal[cell] * fitting_orientation(mesh, cell, f, other, tetra->nominal[other]) < 0 ? -1 : other;
}

/* Packs a cell. Each of its points, lowest name first, has two ints: the neighbour behind the opposite face, and the neighbour's fourth
 * point. */
static void pack_cell(const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_adjacency* adjacency, const int32_t* places,
  int64_t cell, int32_t ints[TETRA_CELL])
{
  const int32_t* v = mesh->vertices + 4 * cell;
  const int32_t all = v[0] ^ v[1] ^ v[2] ^ v[3];
  for (int f = 0; f < 4; ++f) {
    int rank = 0; /* cells that name a point twice have no neighbours, so the order of equals does not matter */
    for (int i = 0; i < 4; ++i) {
      rank += tetra->names[v[i]] < tetra->names[v[f]] || (v[i] == v[f] && i < f);
    }
    const int32_t other = shown_neighbour(tetra, mesh, adjacency, cell, f);
    ints[2 * rank] = -1;
    ints[2 * rank + 1] = 0;
    if (other >= 0) {
      const int32_t* w = mesh->vertices + 4 * (int64_t)other;
      ints[2 * rank] = TETRA_CELL * places[other];
      ints[2 * rank + 1] = tetra->names[w[0] ^ w[1] ^ w[2] ^ w[3] ^ all ^ v[f]];
    }
  }
}

static void pack_cells(
  stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_adjacency* adjacency, const stratus_tetra_places* places)
{
#pragma omp parallel for num_threads(tetra->context->threads)
  for (int64_t place = 0; place < mesh->cell_count; ++place) {
    pack_cell(tetra, mesh, adjacency, places->of, places->at[place], tetra->cells + TETRA_CELL * place);
  }
}

/* List the border faces unless faces is NULL, and return their count. They are in the order of their cells' places, so that the faces of a
 * tile are near each other in memory. */
static size_t list_faces(const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_adjacency* adjacency,
  const stratus_tetra_places* places, stratus_tetra_face* faces)
{
  size_t count = 0;
  for (int64_t place = 0; place < mesh->cell_count; ++place) {
    const int64_t cell = places->at[place];
    const int32_t* v = mesh->vertices + 4 * cell;
    for (int f = 0; f < 4 && tetra->shown[cell]; ++f) {
      if (shown_neighbour(tetra, mesh, adjacency, cell, f) >= 0) {
        continue;
      }
      const int nominal = tetra->nominal[cell];
      if (nominal == 0) {
        break;
      }
      if (faces) {
        int32_t p[3];
        const bool right = stratus_face_points(v, f, p) * nominal > 0;
        faces[count] = (stratus_tetra_face){ { tetra->names[p[0]], tetra->names[p[right ? 1 : 2]], tetra->names[p[right ? 2 : 1]] },
          tetra->names[v[f]], (int32_t)(TETRA_CELL * place) };
      }
      ++count;
    }
  }
  return count;
}

/* Fetches a value for each point or, where values belong to cells, for each place of `at`. */
static stratus_status fetch_values(
  stratus_context* context, const stratus_mesh* mesh, const stratus_volume* volume, double bias, const uint32_t* at, float** values)
{
  void* memory = NULL;
  const int64_t count = mesh->cell_values ? mesh->cell_count : mesh->point_count;
  TRY(stratus_allocate(context, (size_t)count, sizeof(float), &memory));
  float* out = memory;
#pragma omp parallel for num_threads(context->threads)
  for (int64_t i = 0; i < count; ++i) {
    out[i] = stratus_tetra_fetch(mesh, volume, bias, mesh->cell_values ? (size_t)at[i] : (size_t)i);
  }
  *values = out;
  return STRATUS_OK;
}

/* Of the points and vertices of a part. */
static uint64_t hash_part(const stratus_context* context, const stratus_mesh* mesh)
{
  const size_t point = mesh->points ? sizeof *mesh->points : sizeof *mesh->float_points;
  const size_t sizes[2] = { (size_t)mesh->point_count * 3 * point,
    stratus_mesh_is_lattice(mesh) ? sizeof mesh->lattice : (size_t)mesh->cell_count * 4 * sizeof *mesh->vertices };
  const uint8_t* arrays[2] = { mesh->points ? (const uint8_t*)mesh->points : (const uint8_t*)mesh->float_points,
    stratus_mesh_is_lattice(mesh) ? (const uint8_t*)mesh->lattice : (const uint8_t*)mesh->vertices };
  uint64_t sum = 0;
  for (int a = 0; a < 2; ++a) {
    const int64_t parts = (int64_t)((sizes[a] + HASHED_AT_ONCE - 1) / HASHED_AT_ONCE);
#pragma omp parallel for num_threads(context->threads) reduction(+ : sum)
    for (int64_t part = 0; part < parts; ++part) {
      const size_t first = (size_t)part * HASHED_AT_ONCE, left = sizes[a] - first;
      sum += stratus_hash(arrays[a] + first, left < HASHED_AT_ONCE ? left : HASHED_AT_ONCE, (uint64_t)part << 1 | (uint64_t)a);
    }
  }
  return sum;
}

uint64_t stratus_tetra_hash(const stratus_context* context, const stratus_mesh* mesh)
{
  uint64_t sum = 0;
  for (int part = 0; part < stratus_mesh_part_count(mesh); ++part) {
    const uint64_t own = hash_part(context, stratus_mesh_part(mesh, part));
    sum += mesh->block_count > 0 ? stratus_hash(&own, sizeof own, (uint64_t)part) : own;
  }
  return sum;
}

uint64_t stratus_tetra_identity(const stratus_mesh* mesh)
{
  uint64_t identity = 0;
  for (int part = 0; part < stratus_mesh_part_count(mesh); ++part) {
    const stratus_mesh* of = stratus_mesh_part(mesh, part);
    if (of->geometry == 0) {
      return 0;
    }
    identity = stratus_hash(&of->geometry, sizeof of->geometry, identity);
  }
  return identity;
}

static stratus_status build(
  stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_adjacency* adjacency, const stratus_tetra_places* places)
{
  const stratus_volume volume = stratus_mesh_values(mesh);
  void* memory = NULL;
  tetra->bias = stratus_volume_bias(&volume);
  TRY(stratus_allocate(tetra->context, (size_t)mesh->cell_count, 1, &memory));
  tetra->shown = memory;
  TRY(fetch_values(tetra->context, mesh, &volume, tetra->bias, places->at, mesh->cell_values ? &tetra->cell_values : &tetra->values));
  find_shown(tetra, mesh, &volume, adjacency);
  find_bounds(tetra, mesh);
  TRY(orient_flat_cells(tetra, mesh, adjacency));
  TRY(stratus_allocate(tetra->context, (size_t)mesh->cell_count, TETRA_CELL * sizeof(int32_t), &memory));
  tetra->cells = memory;
  tetra->cell_ints = (size_t)mesh->cell_count * TETRA_CELL;
  tetra->value_count = (size_t)(mesh->cell_values ? mesh->cell_count : mesh->point_count);
  pack_cells(tetra, mesh, adjacency, places);
  tetra->face_count = list_faces(tetra, mesh, adjacency, places, NULL);
  if (tetra->face_count > INT32_MAX / TETRA_FACE) {
    return stratus_fail(tetra->context, STRATUS_UNSUPPORTED, "mesh with %zu border faces is too large to draw: at most %d",
      tetra->face_count, INT32_MAX / TETRA_FACE);
  }
  TRY(stratus_allocate(tetra->context, tetra->face_count, sizeof(stratus_tetra_face), &memory));
  tetra->faces = memory;
  (void)list_faces(tetra, mesh, adjacency, places, tetra->faces);
  stratus_release(tetra->context, tetra->nominal);
  tetra->nominal = NULL;
  tetra->bytes = tetra->cell_ints * sizeof(int32_t) + tetra->face_count * sizeof(stratus_tetra_face) +
    (size_t)mesh->point_count * sizeof(int32_t) + tetra->value_count * sizeof(float) +
    (size_t)mesh->cell_count * (mesh->cell_values || mesh->labels ? 1 + sizeof *places->at : 1);
  return STRATUS_OK;
}

bool stratus_tetra_box(const stratus_mesh* mesh, double lo[3], double hi[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = INFINITY;
    hi[axis] = -INFINITY;
  }
  for (int part = 0; part < stratus_mesh_part_count(mesh); ++part) {
    const stratus_mesh* of = stratus_mesh_part(mesh, part);
    for (int64_t p = 0; p < of->point_count; ++p) {
      double at[3];
      stratus_mesh_point(of, p, at);
      for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = isfinite(at[axis]) ? fmin(lo[axis], at[axis]) : lo[axis];
        hi[axis] = isfinite(at[axis]) ? fmax(hi[axis], at[axis]) : hi[axis];
      }
    }
  }
  return lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2];
}

bool stratus_tetra_mesh_fits(const stratus_tetra_mesh* tetra, const stratus_mesh* mesh)
{
  const bool lattice = stratus_mesh_is_lattice(mesh);
  const uint64_t identity = stratus_tetra_identity(mesh);
  return tetra->cell_count == (lattice ? 6 : 1) * mesh->cell_count && tetra->lattices == (lattice ? stratus_mesh_part_count(mesh) : 0) &&
    (lattice || (tetra->point_count == mesh->point_count && (tetra->at || !mesh->labels))) &&
    (tetra->values == NULL) == (mesh->cell_values != 0) &&
    ((identity && identity == tetra->identity) || tetra->geometry == stratus_tetra_hash(tetra->context, mesh));
}

stratus_status stratus_tetra_mesh_take_values(stratus_tetra_mesh* tetra, const stratus_mesh* mesh, bool* taken)
{
  const stratus_volume volume = stratus_mesh_values(mesh);
  const double bias = stratus_volume_bias(&volume);
  float* values = NULL;
  TRY(fetch_values(tetra->context, mesh, &volume, bias, tetra->at, &values));
  const value_counts counts = count_values(tetra, mesh, &volume, mesh->cell_values ? NULL : values, bias);
  *taken = counts.changed == 0;
  if (*taken) {
    float** old = mesh->cell_values ? &tetra->cell_values : &tetra->values;
    float* outdated = *old;
    *old = values;
    values = outdated;
    tetra->bias = bias;
    keep_counts(tetra, &counts);
  }
  stratus_release(tetra->context, values);
  return STRATUS_OK;
}

stratus_status stratus_tetra_mesh_create(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_mesh** out)
{
  stratus_status status = STRATUS_OK;
  stratus_adjacency* adjacency = NULL;
  void* memory = NULL;
  stratus_tetra_places places = { 0 };
  if (mesh->cell_count > CELL_INTS_MOST / TETRA_CELL || mesh->point_count > POINTS_MOST) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "mesh of %lld cells and %lld points is too large to draw: at most %d and %lld",
      (long long)mesh->cell_count, (long long)mesh->point_count, CELL_INTS_MOST / TETRA_CELL, (long long)POINTS_MOST);
  }
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_tetra_mesh), &memory));
  stratus_tetra_mesh* tetra = memory;
  tetra->context = context;
  tetra->cell_count = mesh->cell_count;
  tetra->point_count = mesh->point_count;
  tetra->geometry = stratus_tetra_hash(context, mesh);
  tetra->identity = stratus_tetra_identity(mesh);
  TRY_CLEANUP(stratus_adjacency_create(context, mesh, &adjacency));
  tetra->flat = adjacency->flat;
  tetra->inverted = adjacency->inverted;
  tetra->broken = adjacency->broken_faces;
  tetra->folded = adjacency->folded_faces;
  TRY_CLEANUP(stratus_tetra_order(context, mesh, &places, &tetra->names));
  TRY_CLEANUP(build(tetra, mesh, adjacency, &places));
  stratus_stage_end(context, &stage, "cells and border",
    (size_t)tetra->cell_count * TETRA_CELL * sizeof *tetra->cells + tetra->face_count * sizeof *tetra->faces);
  if (mesh->cell_values || mesh->labels) { /* where to fetch other values and labels from */
    tetra->at = places.at;
    places.at = NULL;
  }
  *out = tetra;
  tetra = NULL;

cleanup:
  stratus_release(context, places.of);
  stratus_release(context, places.at);
  stratus_adjacency_destroy(adjacency);
  stratus_tetra_mesh_destroy(tetra);
  return status;
}

void stratus_tetra_mesh_destroy(stratus_tetra_mesh* mesh)
{
  if (mesh) {
    stratus_release(mesh->context, mesh->first);
    stratus_release(mesh->context, mesh->cells);
    stratus_release(mesh->context, mesh->turns);
    stratus_release(mesh->context, mesh->values);
    stratus_release(mesh->context, mesh->cell_values);
    stratus_release(mesh->context, mesh->names);
    stratus_release(mesh->context, mesh->shown);
    stratus_release(mesh->context, mesh->at);
    stratus_release(mesh->context, mesh->nominal);
    stratus_release(mesh->context, mesh->faces);
    stratus_release(mesh->context, mesh);
  }
}
