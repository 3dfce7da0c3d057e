/* SPDX-License-Identifier: BSD-3-Clause
 * Converts lattices of hexahedra to the form that rays read. Rays find a cell's neighbours by the numbers of its points
 * (tetra_lattice_next() in kernels/tetrahedra/tetra_march.h), so that only one bit is kept for each hexahedron: whether it shows. A
 * hexahedron is named by its first corner; the bits of points that are nobody's first corner stay 0, and so end the lattice on all sides.
 * The points of several lattices are numbered one lattice after the other. A ray that leaves one lattice by its border enters the next as
 * it enters the mesh: the same rays pass a face of both, because its points are the same floats.
 *
 * Where lattices fold some tetrahedra turn left and others right. A face between two of them has both on the same side, so that it is a
 * border face of each. Then a byte is kept for each hexahedron, so that rays know which way its tetrahedra turn (tetra_arguments.h). */
#include "tetra_lattice.h"

#include <string.h>

#define POINTS_MOST (INT32_MAX / TETRA_CELL) /* cells of rays are TETRA_CELL times a point's number, as are cells of lists */
#define WORD 32                              /* bits of a word */
#define TETRA_TURNS_ALL 0xdb                 /* the bits of all tetrahedra */

/* A lattice, its numbers counted from its own first point. */
typedef struct lattice_build {
  stratus_tetra_mesh* tetra;
  const stratus_mesh* mesh;
  stratus_volume volume; /* the lattice's values */
  int64_t step[3], corner[8];
  int64_t first, words; /* the number of its first point; its words of bits */
  uint32_t* bits;
  uint8_t* turns; /* NULL: all lattices turn one way each */
  float* values;
  bool left; /* its tetrahedra turn left */
} lattice_build;

static lattice_build build_of(stratus_tetra_mesh* tetra, const stratus_mesh* whole, int part, uint32_t* bits, float* values)
{
  const stratus_mesh* mesh = stratus_mesh_part(whole, part);
  lattice_build b = { .tetra = tetra, .mesh = mesh, .volume = stratus_mesh_values(mesh), .first = tetra->first[part] };
  b.words = (mesh->point_count + WORD - 1) / WORD;
  b.bits = bits + b.first / WORD;
  b.values = values + b.first;
  stratus_lattice_steps(mesh, b.step);
  for (int corner = 0; corner < 8; ++corner) {
    b.corner[corner] = (corner & 1) * b.step[0] + (corner >> 1 & 1) * b.step[1] + (corner >> 2) * b.step[2];
  }
  return b;
}

/* Number the points of all lattices. Leave unused point numbers before a lattice, so that a step out of its lower end finds no hexahedron
 * there: up to one layer, less the last layer of the lattice before. Lattices begin at whole words of bits. */
static stratus_status number_points(stratus_tetra_mesh* tetra, const stratus_mesh* whole)
{
  const int count = stratus_mesh_part_count(whole);
  int64_t end = 0, layer = 0;
  void* memory = NULL;
  TRY(stratus_allocate(tetra->context, (size_t)count + 1, sizeof *tetra->first, &memory));
  tetra->first = memory;
  tetra->lattices = count;
  for (int part = 0; part <= count; ++part) {
    const stratus_mesh* mesh = part < count ? stratus_mesh_part(whole, part) : NULL;
    const int64_t own = mesh ? (int64_t)mesh->lattice[0] * mesh->lattice[1] : 0;
    end += part > 0 && own > layer ? own - layer : 0;
    tetra->first[part] = mesh ? (end + WORD - 1) / WORD * WORD : end;
    end = tetra->first[part] + (mesh ? mesh->point_count : 0);
    layer = own;
    if (end > POINTS_MOST) {
      return stratus_fail(tetra->context, STRATUS_UNSUPPORTED,
        "lattices of %lld cells and more than %d points, with those between them, are too large to draw", (long long)whole->cell_count,
        POINTS_MOST);
    }
  }
  tetra->point_count = end;
  return STRATUS_OK;
}

/* A point's place in the lattice; a hexahedron has the place of its first corner. */
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

/* Whether the hexahedron shows, by its values and by flags and coordinates. before: it showed with other values, and so by its coordinates.
 * range: least and greatest of its values. */
static bool shows(const lattice_build* b, int64_t first, int64_t cell, bool before, float range[2])
{
  range[0] = INFINITY;
  range[1] = -INFINITY;
  for (int i = 0; i < (b->mesh->cell_values ? 1 : 8); ++i) {
    const float value = b->values[first + b->corner[i]];
    if (!isfinite(value)) {
      return false;
    }
    range[0] = value < range[0] ? value : range[0];
    range[1] = value > range[1] ? value : range[1];
  }
  return before ? !(b->mesh->hidden && b->mesh->hidden[cell]) : stratus_lattice_shows(b->mesh, b->corner, first, cell);
}

/* Fetch a value for each point. Values of cells are stored at their first corners. */
static void fetch_values(const lattice_build* b, double bias)
{
  const stratus_mesh* mesh = b->mesh;
#pragma omp parallel for num_threads(b->tetra->context->threads)
  for (int64_t word = 0; word < b->words; ++word) {
    lattice_place at = place_of(mesh, WORD * word);
    for (int bit = 0; bit < WORD && at.point < mesh->point_count; ++bit, next_place(mesh, &at)) {
      const int64_t from = mesh->cell_values ? hexahedron_at(mesh, &at) : at.point;
      b->values[at.point] = from < 0 ? 0.0f : stratus_tetra_fetch(mesh, &b->volume, bias, (size_t)from);
    }
  }
}

/* The hexahedra of lattices that show, and their values' range. */
typedef struct lattice_counts {
  int64_t shown, hidden, changed; /* hexahedra; words of bits that differ from those before */
  float low, high;
} lattice_counts;

/* Sets the bits of hexahedra that show, and adds what is counted of them. before: the bits of all lattices before; NULL: there were none.
 */
static void find_shown(lattice_build* b, const uint32_t* before, lattice_counts* counts)
{
  const stratus_mesh* mesh = b->mesh;
  int64_t shown = 0, hidden = 0, changed = 0;
  float low = counts->low, high = counts->high;
  const int threads = b->tetra->context->threads;
#pragma omp parallel for num_threads(threads) reduction(+ : shown, hidden, changed) reduction(min : low) reduction(max : high)
  for (int64_t word = 0; word < b->words; ++word) {
    lattice_place at = place_of(mesh, WORD * word);
    const uint32_t known = before ? before[b->first / WORD + word] : 0;
    uint32_t bits = 0;
    for (int bit = 0; bit < WORD && at.point < mesh->point_count; ++bit, next_place(mesh, &at)) {
      const int64_t cell = hexahedron_at(mesh, &at);
      float range[2];
      hidden += cell >= 0 && mesh->hidden && mesh->hidden[cell];
      if (cell >= 0 && shows(b, at.point, cell, known >> bit & 1, range)) {
        bits |= 1u << bit;
        ++shown;
        low = range[0] < low ? range[0] : low;
        high = range[1] > high ? range[1] : high;
      }
    }
    changed += before && known != bits;
    b->bits[word] = bits;
  }
  *counts = (lattice_counts){ counts->shown + shown, counts->hidden + hidden, counts->changed + changed, low, high };
}

static void keep_counts(stratus_tetra_mesh* tetra, const stratus_mesh* whole, const lattice_counts* counts)
{
  tetra->low = counts->low;
  tetra->high = counts->high;
  tetra->shown_cells = 6 * counts->shown;
  tetra->blanked = 6 * (whole->cell_count - counts->shown - counts->hidden);
}

static inline bool has_bit(const lattice_build* b, int64_t point)
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

/* Returns the orientation of a hexahedron's tetrahedron, whose corners are p: 1 right, -1 left, 0 flat. */
static int orientation_of(double p[8][3], int way)
{
  const int one = 1 << stratus_lattice_ways[way][0], two = one | 1 << stratus_lattice_ways[way][1];
  return own_orientation(way) * stratus_orientation(p[0], p[one], p[two], p[7]);
}

/* Finds which way the hexahedra turn, and adds their bounds. Returns true where tetrahedra turn both ways, so that some overlap. */
static bool find_orientation(lattice_build* b)
{
  const stratus_mesh* mesh = b->mesh;
  int64_t right = 0, left = 0, flat = 0;
  double lo[3], hi[3];
  memcpy(lo, b->tetra->lo, sizeof lo);
  memcpy(hi, b->tetra->hi, sizeof hi);
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
        const int sign = orientation_of(p, way);
        right += sign > 0;
        left += sign < 0;
        flat += sign == 0;
      }
    }
  }
  b->left = left > 0;
  b->tetra->flat += flat;
  b->tetra->inverted += left;
  memcpy(b->tetra->lo, lo, sizeof lo);
  memcpy(b->tetra->hi, hi, sizeof hi);
  return right > 0 && left > 0;
}

/* Number of the bit of a tetrahedron whose steps go along these axes. */
static int turn_of(const int axes[3])
{
  return TETRA_TURN(axes[0], axes[1], axes[2]);
}

/* Sets the bytes of hexahedra that show. A flat tetrahedron turns as most of its hexahedron does. */
static void find_turns(lattice_build* b, uint8_t* turns)
{
  const stratus_mesh* mesh = b->mesh;
  b->turns = turns + b->first;
#pragma omp parallel for num_threads(b->tetra->context->threads)
  for (int64_t first = 0; first < mesh->point_count; ++first) {
    double p[8][3];
    int sign[6], sum = 0, byte = TETRA_TURNS_SHOWN;
    if (!has_bit(b, first)) {
      continue;
    }
    for (int i = 0; i < 8; ++i) {
      stratus_mesh_point(mesh, first + b->corner[i], p[i]);
    }
    for (int way = 0; way < 6; ++way) {
      sign[way] = orientation_of(p, way);
      sum += sign[way];
    }
    for (int way = 0; way < 6; ++way) {
      byte |= sign[way] < 0 || (sign[way] == 0 && sum < 0) ? 1 << turn_of(stratus_lattice_ways[way]) : 0;
    }
    b->turns[first] = (uint8_t)byte;
  }
}

/* The byte of a hexahedron, also of a lattice that turns one way and keeps none; 0: there is no visible hexahedron. */
static inline int byte_at(const lattice_build* b, int64_t point)
{
  if (point < 0 || point >= b->mesh->point_count) {
    return 0;
  }
  return b->turns ? b->turns[point] : has_bit(b, point) ? TETRA_TURNS_SHOWN | (b->left ? TETRA_TURNS_ALL : 0) : 0;
}

/* Whether a hexahedron and all its neighbours show and turn one way. */
static bool is_inner(const lattice_build* b, int64_t first)
{
  const int byte = byte_at(b, first);
  bool inner = byte == TETRA_TURNS_SHOWN || byte == (TETRA_TURNS_SHOWN | TETRA_TURNS_ALL);
  for (int axis = 0; axis < 3 && inner; ++axis) {
    inner = byte_at(b, first - b->step[axis]) == byte && byte_at(b, first + b->step[axis]) == byte;
  }
  return inner;
}

/* The byte of the hexahedron behind face f of a tetrahedron, and the number of the tetrahedron's bit there. */
static int byte_behind(const lattice_build* b, int64_t first, int way, int f, int* turn)
{
  static const int after[4][3] = { { 1, 2, 0 }, { 1, 0, 2 }, { 0, 2, 1 }, { 2, 0, 1 } };
  const int* axes = stratus_lattice_ways[way];
  const int behind[3] = { axes[after[f][0]], axes[after[f][1]], axes[after[f][2]] };
  *turn = turn_of(behind);
  return byte_at(b, first + (f == 0 ? b->step[axes[0]] : f == 3 ? -b->step[axes[2]] : 0));
}

/* Lists the faces between visible hexahedra and hidden ones, and between tetrahedra that turn left and others, unless faces is NULL, and
 * returns their count. *folded: raised by the number of the latter, of which each tetrahedron lists its own. */
static size_t list_faces(const lattice_build* b, stratus_tetra_face* faces, int64_t* folded)
{
  size_t count = 0;
  int64_t turning = 0;
  for (int64_t first = 0; first < b->mesh->point_count; ++first) {
    if (first % WORD == 0 && b->bits[first / WORD] == 0) {
      first += WORD - 1;
      continue;
    }
    const int byte = byte_at(b, first);
    if (!byte || is_inner(b, first)) {
      continue;
    }
    for (int part = 0; part < 24; ++part) {
      const int way = part / 4, f = part % 4;
      const int left = byte >> turn_of(stratus_lattice_ways[way]) & 1;
      int turn;
      const int behind = byte_behind(b, first, way, f, &turn);
      if (behind && (behind >> turn & 1) == left) {
        continue;
      }
      if (faces) {
        int32_t v[4], p[3];
        tetrahedron(b->step, b->first + first, way, v);
        const bool right = stratus_face_points(v, f, p) * own_orientation(way) * (left ? -1 : 1) > 0;
        faces[count] = (stratus_tetra_face){ { p[0], p[right ? 1 : 2], p[right ? 2 : 1] }, v[f],
          TETRA_CELL * ((int32_t)b->first + (int32_t)first) + (b->turns ? left : 0) };
      }
      turning += behind != 0;
      ++count;
    }
  }
  *folded += turning;
  return count;
}

static stratus_status make_faces(stratus_tetra_mesh* tetra, const lattice_build* builds)
{
  void* memory = NULL;
  size_t count = 0;
  for (int part = 0; part < tetra->lattices; ++part) {
    count += list_faces(builds + part, NULL, &tetra->folded);
  }
  if (count > INT32_MAX / TETRA_FACE) {
    return stratus_fail(
      tetra->context, STRATUS_UNSUPPORTED, "mesh with %zu border faces is too large to draw: at most %d", count, INT32_MAX / TETRA_FACE);
  }
  TRY(stratus_allocate(tetra->context, count, sizeof(stratus_tetra_face), &memory));
  tetra->faces = memory;
  for (int part = 0; part < tetra->lattices; ++part) {
    int64_t counted = 0;
    tetra->face_count += list_faces(builds + part, tetra->faces + tetra->face_count, &counted);
  }
  return STRATUS_OK;
}

/* builds: room for one of each lattice. */
static stratus_status build(stratus_tetra_mesh* tetra, const stratus_mesh* whole, lattice_build* builds)
{
  stratus_context* context = tetra->context;
  const size_t points = (size_t)tetra->point_count;
  bool mixed = false;
  lattice_counts counts = { .low = INFINITY, .high = -INFINITY };
  void* memory = NULL;
  tetra->bias = stratus_tetra_bias(whole, 0);
  tetra->cell_ints = (points + WORD - 1) / WORD;
  tetra->value_count = points;
  TRY(stratus_allocate_zero(context, tetra->cell_ints, sizeof *tetra->cells, &memory));
  tetra->cells = memory;
  TRY(stratus_allocate_zero(context, points, sizeof(float), &memory));
  *(whole->cell_values ? &tetra->cell_values : &tetra->values) = memory;
  for (int axis = 0; axis < 3; ++axis) {
    tetra->lo[axis] = INFINITY;
    tetra->hi[axis] = -INFINITY;
  }
  for (int part = 0; part < tetra->lattices; ++part) {
    lattice_build* b = builds + part;
    *b = build_of(tetra, whole, part, (uint32_t*)tetra->cells, memory);
    fetch_values(b, tetra->bias);
    find_shown(b, NULL, &counts);
    mixed = find_orientation(b) || mixed;
  }
  keep_counts(tetra, whole, &counts);
  if (mixed) {
    tetra->cell_ints = (points + sizeof(int32_t) - 1) / sizeof(int32_t);
    TRY(stratus_allocate_zero(context, tetra->cell_ints, sizeof(int32_t), &memory));
    tetra->turns = memory;
    for (int part = 0; part < tetra->lattices; ++part) {
      find_turns(builds + part, tetra->turns);
    }
  }
  TRY(make_faces(tetra, builds));
  tetra->bytes = (points + WORD - 1) / WORD * sizeof *tetra->cells + (tetra->turns ? points : 0) + points * sizeof(float) +
    tetra->face_count * sizeof *tetra->faces;
  return STRATUS_OK;
}

stratus_status stratus_tetra_lattice_create(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_mesh** out)
{
  void *memory = NULL, *builds = NULL;
  stratus_status status;
  if (mesh->point_count > POINTS_MOST || mesh->cell_count > INT32_MAX / TETRA_CELL) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "lattice of %lld cells and %lld points is too large to draw: at most %d points",
      (long long)mesh->cell_count, (long long)mesh->point_count, POINTS_MOST);
  }
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_tetra_mesh), &memory));
  stratus_tetra_mesh* tetra = memory;
  tetra->context = context;
  tetra->cell_count = 6 * mesh->cell_count;
  TRY_CLEANUP(number_points(tetra, mesh));
  TRY_CLEANUP(stratus_allocate_zero(context, (size_t)tetra->lattices, sizeof(lattice_build), &builds));
  tetra->geometry = stratus_tetra_hash(context, mesh);
  tetra->identity = stratus_tetra_identity(mesh);
  TRY_CLEANUP(build(tetra, mesh, builds));
  stratus_stage_end(context, &stage, "bits and border", tetra->bytes);
  *out = tetra;
  tetra = NULL;

cleanup:
  stratus_release(context, builds);
  stratus_tetra_mesh_destroy(tetra);
  return status;
}

stratus_status stratus_tetra_lattice_take_values(stratus_tetra_mesh* tetra, const stratus_mesh* mesh, bool* taken)
{
  const double bias = stratus_tetra_bias(mesh, 0);
  lattice_counts counts = { .low = INFINITY, .high = -INFINITY };
  const size_t words = (tetra->value_count + WORD - 1) / WORD;
  void *values = NULL, *bits = NULL;
  stratus_status status;
  TRY_CLEANUP(stratus_allocate_zero(tetra->context, tetra->value_count, sizeof(float), &values));
  TRY_CLEANUP(stratus_allocate_zero(tetra->context, words, sizeof *tetra->cells, &bits));
  for (int part = 0; part < tetra->lattices; ++part) {
    lattice_build b = build_of(tetra, mesh, part, bits, values);
    fetch_values(&b, bias);
    find_shown(&b, (const uint32_t*)tetra->cells, &counts);
  }
  *taken = counts.changed == 0;
  if (*taken) {
    float** old = mesh->cell_values ? &tetra->cell_values : &tetra->values;
    float* outdated = *old;
    *old = values;
    values = outdated;
    tetra->bias = bias;
    keep_counts(tetra, mesh, &counts);
  }

cleanup:
  stratus_release(tetra->context, bits);
  stratus_release(tetra->context, values);
  return status;
}
