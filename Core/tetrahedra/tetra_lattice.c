/* SPDX-License-Identifier: BSD-3-Clause
 * Converts a lattice of hexahedra to the form that rays read. Rays find a cell's neighbours by the numbers of its points
 * (tetra_lattice_next() in kernels/tetrahedra/tetra_march.h), so that of cells only a bit for each hexahedron is kept, whether it shows. A
 * hexahedron is named by its first corner; the bits of points that are nobody's first corner stay 0, and so end the lattice on all sides.
 */
#include "tetra_lattice.h"

#include <string.h>

#define POINTS_MOST (INT32_MAX / TETRA_CELL) /* cells of rays are TETRA_CELL times a point's number, as are those of lists */
#define WORD 32                              /* bits of a word */

/* The axes along which a tetrahedron goes from the first corner of its hexahedron to the last. */
const int stratus_lattice_ways[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 1, 0, 2 }, { 2, 1, 0 } };

void stratus_lattice_steps(const stratus_mesh* mesh, int64_t step[3])
{
  step[0] = 1;
  step[1] = mesh->lattice[0];
  step[2] = step[1] * mesh->lattice[1];
}

typedef struct lattice_build {
  stratus_tetra_mesh* tetra;
  const stratus_mesh* mesh;
  stratus_volume volume; /* the mesh's values */
  int64_t step[3], corner[8];
  uint32_t* bits;
  int64_t words;
} lattice_build;

static lattice_build build_of(stratus_tetra_mesh* tetra, const stratus_mesh* mesh)
{
  lattice_build b = { .tetra = tetra, .mesh = mesh, .volume = stratus_mesh_values(mesh), .words = (mesh->point_count + WORD - 1) / WORD };
  stratus_lattice_steps(mesh, b.step);
  for (int corner = 0; corner < 8; ++corner) {
    b.corner[corner] = (corner & 1) * b.step[0] + (corner >> 1 & 1) * b.step[1] + (corner >> 2) * b.step[2];
  }
  return b;
}

/* A point's place in the lattice; a hexahedron is that of its first corner. */
typedef struct lattice_place {
  int64_t point;
  int32_t i, j, k;
} lattice_place;

static lattice_place place_of(const stratus_mesh* mesh, int64_t point)
{
  const int64_t row = point / mesh->lattice[0];
  return (
    lattice_place){ point, (int32_t)(point % mesh->lattice[0]), (int32_t)(row % mesh->lattice[1]), (int32_t)(row / mesh->lattice[1]) };
}

static void next_place(const stratus_mesh* mesh, lattice_place* at)
{
  ++at->point;
  if (++at->i == mesh->lattice[0]) {
    at->i = 0;
    if (++at->j == mesh->lattice[1]) {
      at->j = 0;
      ++at->k;
    }
  }
}

/* The number of the hexahedron whose first corner this is; -1: it is nobody's. */
static int64_t hexahedron_at(const stratus_mesh* mesh, const lattice_place* at)
{
  const int32_t* n = mesh->lattice;
  return at->i < n[0] - 1 && at->j < n[1] - 1 && at->k < n[2] - 1 ? ((int64_t)at->k * (n[1] - 1) + at->j) * (n[0] - 1) + at->i : -1;
}

bool stratus_lattice_shows(const stratus_mesh* mesh, const int64_t corner[8], int64_t first, int64_t cell)
{
  bool shows = !(mesh->hidden && mesh->hidden[cell]);
  for (int i = 0; i < 8 && shows; ++i) {
    double p[3];
    stratus_mesh_point(mesh, first + corner[i], p);
    shows = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
  }
  return shows;
}

/* Whether the hexahedron shows, by flags and coordinates and by its values. range: their least and greatest. */
static bool shows(const lattice_build* b, const float* values, int64_t first, int64_t cell, float range[2])
{
  range[0] = INFINITY;
  range[1] = -INFINITY;
  for (int i = 0; i < (b->mesh->cell_values ? 1 : 8); ++i) {
    const float value = values[first + b->corner[i]];
    if (!isfinite(value)) {
      return false;
    }
    range[0] = fminf(range[0], value);
    range[1] = fmaxf(range[1], value);
  }
  return stratus_lattice_shows(b->mesh, b->corner, first, cell);
}

/* Fetches a value for each point. Those of cells stand at their first corners. */
static stratus_status fetch_values(const lattice_build* b, double bias, float** out)
{
  const stratus_mesh* mesh = b->mesh;
  void* memory = NULL;
  TRY(stratus_allocate_zero(b->tetra->context, (size_t)mesh->point_count, sizeof(float), &memory));
  float* values = memory;
#pragma omp parallel for num_threads(b->tetra->context->threads)
  for (int64_t word = 0; word < b->words; ++word) {
    lattice_place at = place_of(mesh, WORD * word);
    for (int bit = 0; bit < WORD && at.point < mesh->point_count; ++bit, next_place(mesh, &at)) {
      const int64_t from = mesh->cell_values ? hexahedron_at(mesh, &at) : at.point;
      values[at.point] = from < 0 ? 0.0f : stratus_tetra_fetch(mesh, &b->volume, bias, (size_t)from);
    }
  }
  *out = values;
  return STRATUS_OK;
}

/* Sets the bits of hexahedra that show, and what is counted of them. Returns how many bits differ from those before. */
static int64_t find_shown(lattice_build* b, const float* values, const uint32_t* before)
{
  const stratus_mesh* mesh = b->mesh;
  int64_t shown = 0, hidden = 0, changed = 0;
  float low = INFINITY, high = -INFINITY;
  const int threads = b->tetra->context->threads;
#pragma omp parallel for num_threads(threads) reduction(+ : shown, hidden, changed) reduction(min : low) reduction(max : high)
  for (int64_t word = 0; word < b->words; ++word) {
    lattice_place at = place_of(mesh, WORD * word);
    uint32_t bits = 0;
    for (int bit = 0; bit < WORD && at.point < mesh->point_count; ++bit, next_place(mesh, &at)) {
      const int64_t cell = hexahedron_at(mesh, &at);
      float range[2];
      hidden += cell >= 0 && mesh->hidden && mesh->hidden[cell];
      if (cell >= 0 && shows(b, values, at.point, cell, range)) {
        bits |= 1u << bit;
        ++shown;
        low = fminf(low, range[0]);
        high = fmaxf(high, range[1]);
      }
    }
    changed += before && before[word] != bits;
    b->bits[word] = bits;
  }
  if (changed == 0) {
    b->tetra->low = low;
    b->tetra->high = high;
    b->tetra->shown_cells = 6 * shown;
    b->tetra->blanked = 6 * (mesh->cell_count - shown - hidden);
  }
  return changed;
}

static bool has_bit(const lattice_build* b, int64_t point)
{
  return point >= 0 && (b->bits[point / WORD] >> (point % WORD) & 1);
}

/* The points of a hexahedron's tetrahedron, which rise. */
static void tetrahedron(const int64_t step[3], int64_t first, int way, int32_t v[4])
{
  v[0] = (int32_t)first;
  for (int i = 0; i < 3; ++i) {
    v[i + 1] = v[i] + (int32_t)step[stratus_lattice_ways[way][i]];
  }
}

/* The orientation of a tetrahedron that has the lattice's: ways that are no rotation of the axes turn the other way. */
static int own_orientation(int way)
{
  return way < 3 ? 1 : -1;
}

/* Finds which way the hexahedra turn, and their bounds. *mixed: tetrahedra turn both ways, so that some overlap. */
static void find_orientation(const lattice_build* b, bool* mixed)
{
  const stratus_mesh* mesh = b->mesh;
  int64_t right = 0, left = 0, flat = 0;
  double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
  const int threads = b->tetra->context->threads;
#pragma omp parallel for num_threads(threads) reduction(+ : right, left, flat) reduction(min : lo[:3]) reduction(max : hi[:3])
  for (int64_t word = 0; word < b->words; ++word) {
    for (int bit = 0; bit < WORD; ++bit) {
      const int64_t first = WORD * word + bit;
      double p[8][3];
      if (!(b->bits[word] >> bit & 1)) {
        continue;
      }
      for (int i = 0; i < 8; ++i) {
        stratus_mesh_point(mesh, first + b->corner[i], p[i]);
        for (int axis = 0; axis < 3; ++axis) {
          lo[axis] = fmin(lo[axis], p[i][axis]);
          hi[axis] = fmax(hi[axis], p[i][axis]);
        }
      }
      for (int way = 0; way < 6; ++way) {
        const int one = 1 << stratus_lattice_ways[way][0], two = one | 1 << stratus_lattice_ways[way][1];
        const int sign = own_orientation(way) * stratus_orientation(p[0], p[one], p[two], p[7]);
        right += sign > 0;
        left += sign < 0;
        flat += sign == 0;
      }
    }
  }
  *mixed = right > 0 && left > 0;
  b->tetra->flat = flat;
  b->tetra->inverted = left;
  memcpy(b->tetra->lo, lo, sizeof lo);
  memcpy(b->tetra->hi, hi, sizeof hi);
}

/* Lists the faces between hexahedra that show and what does not, unless faces is NULL, and returns their count. */
static size_t list_faces(const lattice_build* b, stratus_tetra_face* faces)
{
  const int hand = b->tetra->inverted > 0 ? -1 : 1;
  size_t count = 0;
  for (int64_t first = 0; first < b->mesh->point_count; ++first) {
    if (first % WORD == 0 && b->bits[first / WORD] == 0) {
      first += WORD - 1;
      continue;
    }
    for (int axis = 0; has_bit(b, first) && axis < 3; ++axis) {
      const bool open[2] = { !has_bit(b, first + b->step[axis]), !has_bit(b, first - b->step[axis]) };
      for (int way = 0; way < 6 && (open[0] || open[1]); ++way) {
        for (int side = 0; side < 2; ++side) { /* opposite the first point, beyond the last; opposite the last, before the first */
          const int f = side == 0 ? 0 : 3;
          if (!open[side] || stratus_lattice_ways[way][side == 0 ? 0 : 2] != axis) {
            continue;
          }
          if (faces) {
            int32_t v[4], p[3];
            tetrahedron(b->step, first, way, v);
            const bool right = stratus_face_points(v, f, p) * own_orientation(way) * hand > 0;
            faces[count] = (stratus_tetra_face){ { p[0], p[right ? 1 : 2], p[right ? 2 : 1] }, v[f], (int32_t)(TETRA_CELL * first) };
          }
          ++count;
        }
      }
    }
  }
  return count;
}

static stratus_status make_faces(const lattice_build* b)
{
  stratus_tetra_mesh* tetra = b->tetra;
  void* memory = NULL;
  tetra->face_count = list_faces(b, NULL);
  if (tetra->face_count > INT32_MAX / TETRA_FACE) {
    return stratus_fail(tetra->context, STRATUS_UNSUPPORTED, "mesh with %zu border faces is too large to draw: at most %d",
      tetra->face_count, INT32_MAX / TETRA_FACE);
  }
  TRY(stratus_allocate(tetra->context, tetra->face_count, sizeof(stratus_tetra_face), &memory));
  tetra->faces = memory;
  (void)list_faces(b, tetra->faces);
  return STRATUS_OK;
}

static stratus_status build(lattice_build* b, bool* mixed)
{
  stratus_tetra_mesh* tetra = b->tetra;
  void* memory = NULL;
  float* values = NULL;
  tetra->bias = stratus_volume_bias(&b->volume);
  TRY(stratus_allocate(tetra->context, (size_t)b->words, sizeof *b->bits, &memory));
  tetra->cells = memory;
  tetra->cell_ints = (size_t)b->words;
  b->bits = memory;
  TRY(fetch_values(b, tetra->bias, &values));
  *(b->mesh->cell_values ? &tetra->cell_values : &tetra->values) = values;
  tetra->value_count = (size_t)b->mesh->point_count;
  (void)find_shown(b, values, NULL);
  find_orientation(b, mixed);
  if (*mixed) {
    return STRATUS_OK;
  }
  TRY(make_faces(b));
  tetra->bytes = tetra->cell_ints * sizeof *tetra->cells + tetra->value_count * sizeof *values + tetra->face_count * sizeof *tetra->faces;
  return STRATUS_OK;
}

stratus_status stratus_tetra_lattice_create(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_mesh** out, bool* mixed)
{
  void* memory = NULL;
  if (mesh->point_count > POINTS_MOST || mesh->cell_count > INT32_MAX / TETRA_CELL) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "lattice of %lld cells and %lld points is too large to draw: at most %d points",
      (long long)mesh->cell_count, (long long)mesh->point_count, POINTS_MOST);
  }
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_tetra_mesh), &memory));
  stratus_tetra_mesh* tetra = memory;
  tetra->context = context;
  tetra->cell_count = 6 * mesh->cell_count;
  tetra->point_count = mesh->point_count;
  memcpy(tetra->lattice, mesh->lattice, sizeof tetra->lattice);
  tetra->geometry = stratus_tetra_hash(context, mesh);
  lattice_build b = build_of(tetra, mesh);
  const stratus_status status = build(&b, mixed);
  if (status != STRATUS_OK) {
    stratus_tetra_mesh_destroy(tetra);
    return status;
  }
  stratus_stage_end(context, &stage, "bits and border", tetra->bytes);
  *out = tetra;
  return STRATUS_OK;
}

stratus_status stratus_tetra_lattice_take_values(stratus_tetra_mesh* tetra, const stratus_mesh* mesh, bool* taken)
{
  stratus_status status = STRATUS_OK;
  lattice_build b = build_of(tetra, mesh);
  const double bias = stratus_volume_bias(&b.volume);
  float* values = NULL;
  void* memory = NULL;
  TRY(fetch_values(&b, bias, &values));
  TRY_CLEANUP(stratus_allocate(tetra->context, (size_t)b.words, sizeof *b.bits, &memory));
  b.bits = memory;
  *taken = find_shown(&b, values, (const uint32_t*)tetra->cells) == 0;
  if (*taken) {
    float** old = mesh->cell_values ? &tetra->cell_values : &tetra->values;
    float* outdated = *old;
    *old = values;
    values = outdated;
    tetra->bias = bias;
  }

cleanup:
  stratus_release(tetra->context, memory);
  stratus_release(tetra->context, values);
  return status;
}
