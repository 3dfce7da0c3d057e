/* SPDX-License-Identifier: BSD-3-Clause
 * Neighbours through faces. Each face is a record in the bucket of its lowest point number, so that a bucket holds faces near one another
 * in memory. A bucket pairs its faces in a hash table that fits a cache. Neither a record's place nor the result depends on the number of
 * threads. A device that builds pairs the faces of large meshes. */
#include "adjacency_device.h"
#include "device.h"

#include <string.h>

#define FACES_PER_BUCKET 2048 /* a bucket's records and table then take 64 KiB */
#define BUCKETS_MAX 2048      /* dealing writes a stream to each bucket, and more would thrash the TLB */
#define SIDE_BIT 0x80000000u  /* point numbers have 31 bits */
#define NO_FACE UINT32_MAX
#define MANY (UINT32_MAX - 1) /* in face_slot.second: more than two faces coincide, and all count as broken */

/* A face's points, ascending. b's high bit: the cell is on the positive side of (a, b, c); c's: on the negative; neither: the cell is
 * flat. */
typedef struct face_record {
  uint32_t a, b, c, face;
} face_record;

/* The first two records of one face; NO_FACE: not seen yet. */
typedef struct face_slot {
  uint32_t first, second;
} face_slot;

typedef struct adjacency_build {
  stratus_context* context;
  const stratus_mesh* mesh;
  stratus_adjacency* adjacency;
  face_record* records;
  size_t* places; /* for each chunk of cells a row of each bucket's next place; a last row of the buckets' ends */
  face_slot* tables;
  size_t largest; /* records of the largest bucket */
  int shift, buckets, chunks, workers;
} adjacency_build;

static int64_t chunk_begin(const adjacency_build* build, int chunk)
{
  return build->mesh->cell_count * chunk / build->chunks;
}

static void find_orientations(adjacency_build* build)
{
  const stratus_mesh* mesh = build->mesh;
  int64_t flat = 0, inverted = 0;
#pragma omp parallel for schedule(static) num_threads(build->context->threads) reduction(+ : flat, inverted)
  for (int64_t cell = 0; cell < mesh->cell_count; ++cell) {
    const int32_t* v = mesh->vertices + 4 * cell;
    const double* const points = mesh->points;
    const int sign = stratus_names_a_point_twice(v)
      ? 0
      : stratus_orientation(points + 3 * (int64_t)v[0], points + 3 * (int64_t)v[1], points + 3 * (int64_t)v[2], points + 3 * (int64_t)v[3]);
    build->adjacency->orientation[cell] = (int8_t)sign;
    flat += sign == 0;
    inverted += sign < 0;
  }
  build->adjacency->flat = flat;
  build->adjacency->inverted = inverted;
}

static void count_faces(const adjacency_build* build, int chunk)
{
  size_t* counts = build->places + (size_t)chunk * (size_t)build->buckets;
  memset(counts, 0, (size_t)build->buckets * sizeof *counts);
  for (int64_t cell = chunk_begin(build, chunk); cell < chunk_begin(build, chunk + 1); ++cell) {
    const int32_t* v = build->mesh->vertices + 4 * cell;
    if (!stratus_names_a_point_twice(v)) { /* three faces have the lowest point, and the fourth begins with the second lowest */
      const int32_t low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
      const int32_t other_low = v[2] < v[3] ? v[2] : v[3], other_high = v[2] < v[3] ? v[3] : v[2];
      const int32_t second = low < other_low ? (high < other_low ? high : other_low) : (other_high < low ? other_high : low);
      counts[(low < other_low ? low : other_low) >> build->shift] += 3;
      ++counts[second >> build->shift];
    }
  }
}

static void place_buckets(adjacency_build* build)
{
  size_t* ends = build->places + (size_t)build->chunks * (size_t)build->buckets;
  size_t place = 0;
  build->largest = 0;
  for (int bucket = 0; bucket < build->buckets; ++bucket) {
    const size_t begin = place;
    for (int chunk = 0; chunk < build->chunks; ++chunk) {
      size_t* count = build->places + (size_t)chunk * (size_t)build->buckets + bucket;
      const size_t here = *count;
      *count = place;
      place += here;
    }
    ends[bucket] = place;
    build->largest = place - begin > build->largest ? place - begin : build->largest;
  }
}

static void deal_faces(const adjacency_build* build, int chunk)
{
  size_t* places = build->places + (size_t)chunk * (size_t)build->buckets;
  for (int64_t cell = chunk_begin(build, chunk); cell < chunk_begin(build, chunk + 1); ++cell) {
    const int32_t* v = build->mesh->vertices + 4 * cell;
    for (int f = 0; f < 4 && !stratus_names_a_point_twice(v); ++f) {
      int32_t point[3];
      const int side = stratus_face_points(v, f, point) * build->adjacency->orientation[cell];
      face_record* record = build->records + places[point[0] >> build->shift]++;
      record->a = (uint32_t)point[0];
      record->b = (uint32_t)point[1] | (side > 0 ? SIDE_BIT : 0);
      record->c = (uint32_t)point[2] | (side < 0 ? SIDE_BIT : 0);
      record->face = (uint32_t)(4 * cell + f);
    }
  }
}

static inline bool same_face(const face_record* p, const face_record* q)
{
  return p->a == q->a && ((p->b ^ q->b) & ~SIDE_BIT) == 0 && ((p->c ^ q->c) & ~SIDE_BIT) == 0;
}

static inline size_t slot_of(const face_record* record, size_t slots)
{
  const uint64_t hash = record->a * UINT64_C(0x9e3779b97f4a7c15) + (record->b & ~SIDE_BIT) * UINT64_C(0xbf58476d1ce4e5b9) +
    (record->c & ~SIDE_BIT) * UINT64_C(0x94d049bb133111eb);
  return (size_t)((hash >> 33) * slots >> 31); /* slots below 2^33 */
}

/* Cells on the same side of a face overlap, and are not neighbours through it. */
static inline bool is_folded(const face_record* p, const face_record* q)
{
  return (p->b & q->b & SIDE_BIT) || (p->c & q->c & SIDE_BIT);
}

/* Pairs the faces of a bucket. Slots index its records with 32 bits, which is enough for the at most 2^32 faces of a mesh. */
static void pair_bucket(adjacency_build* build, int bucket, face_slot* table, int64_t* broken, int64_t* folded)
{
  const size_t* ends = build->places + (size_t)build->chunks * (size_t)build->buckets;
  const size_t begin = bucket == 0 ? 0 : ends[bucket - 1], count = ends[bucket] - begin, slots = count + count / 2 + 1;
  const face_record* records = build->records + begin;
  int32_t* neighbours = build->adjacency->neighbours;
  memset(table, 0xff, slots * sizeof *table);
  for (size_t i = 0; i < count; ++i) {
    const face_record* q = records + i;
    size_t s = slot_of(q, slots);
    while (table[s].first != NO_FACE && !same_face(records + table[s].first, q)) {
      s = s + 1 == slots ? 0 : s + 1;
    }
    face_slot* slot = table + s;
    if (slot->first == NO_FACE) {
      slot->first = (uint32_t)i;
      continue;
    }
    const face_record* p = records + slot->first;
    if (slot->second == NO_FACE) {
      slot->second = (uint32_t)i;
      if (is_folded(p, q)) {
        *folded += 2;
      } else {
        neighbours[p->face] = (int32_t)(q->face / 4);
        neighbours[q->face] = (int32_t)(p->face / 4);
      }
    } else {
      ++*broken;
      if (slot->second != MANY) {
        const face_record* other = records + slot->second;
        *broken += 2;
        *folded -= is_folded(p, other) ? 2 : 0;
        neighbours[p->face] = neighbours[other->face] = -1;
        slot->second = MANY;
      }
    }
  }
}

static void pair_faces(adjacency_build* build)
{
  stratus_adjacency* adjacency = build->adjacency;
  int64_t broken = 0, folded = 0;
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (int64_t i = 0; i < 4 * build->mesh->cell_count; ++i) {
    adjacency->neighbours[i] = -1;
  }
  const size_t slots = build->largest + build->largest / 2 + 1;
#pragma omp parallel for schedule(static, 1) num_threads(build->workers) reduction(+ : broken, folded)
  for (int worker = 0; worker < build->workers; ++worker) {
    for (int bucket = worker; bucket < build->buckets; bucket += build->workers) {
      pair_bucket(build, bucket, build->tables + (size_t)worker * slots, &broken, &folded);
    }
  }
  adjacency->broken_faces = broken;
  adjacency->folded_faces = folded;
}

static stratus_status pair_on_host(adjacency_build* build)
{
  stratus_context* context = build->context;
  const int64_t faces = 4 * build->mesh->cell_count;
  void* memory;
  build->chunks = faces < 4 * FACES_PER_BUCKET ? 1 : context->threads;
  const int64_t wanted = faces / FACES_PER_BUCKET < 1 ? 1 : faces / FACES_PER_BUCKET > BUCKETS_MAX ? BUCKETS_MAX : faces / FACES_PER_BUCKET;
  while (build->mesh->point_count >> build->shift > wanted) {
    ++build->shift;
  }
  build->buckets = (int)(build->mesh->point_count >> build->shift) + 1;
  TRY(stratus_allocate(context, (size_t)(build->chunks + 1) * (size_t)build->buckets, sizeof(size_t), &memory));
  build->places = memory;
  TRY(stratus_allocate(context, (size_t)faces, sizeof(face_record), &memory));
  build->records = memory;
#pragma omp parallel for schedule(static, 1) num_threads(build->chunks)
  for (int chunk = 0; chunk < build->chunks; ++chunk) {
    count_faces(build, chunk);
  }
  place_buckets(build);
#pragma omp parallel for schedule(static, 1) num_threads(build->chunks)
  for (int chunk = 0; chunk < build->chunks; ++chunk) {
    deal_faces(build, chunk);
  }
  TRY(stratus_progress(context, "adjacency", 0.6));
  /* Each thread has a table. Where all cells share few points, a bucket is so large that one table has to do for all, lest memory grow with
   * the threads. */
  build->workers = build->largest > 16 * FACES_PER_BUCKET && build->largest > (size_t)faces / 64 ? 1 : build->chunks;
  TRY(stratus_allocate(context, (size_t)build->workers, (build->largest + build->largest / 2 + 1) * sizeof(face_slot), &memory));
  build->tables = memory;
  pair_faces(build);
  return STRATUS_OK;
}

static stratus_status pair(adjacency_build* build)
{
  if (stratus_adjacency_on_device(build->context, build->mesh)) {
    const stratus_status status = stratus_adjacency_pair_on_device(build->context, build->mesh, build->adjacency);
    if (!stratus_device_hands_back(build->context, status)) {
      return status;
    }
  }
  return pair_on_host(build);
}

static stratus_status build_adjacency(adjacency_build* build)
{
  stratus_adjacency* adjacency = build->adjacency;
  int64_t border = 0;
  find_orientations(build);
  TRY(stratus_progress(build->context, "adjacency", 0.3));
  TRY(pair(build));
#pragma omp parallel for schedule(static) num_threads(build->context->threads) reduction(+ : border)
  for (int64_t i = 0; i < 4 * build->mesh->cell_count; ++i) {
    border += adjacency->neighbours[i] < 0;
  }
  adjacency->border_faces = border;
  return STRATUS_OK;
}

stratus_status stratus_adjacency_create(stratus_context* context, const stratus_mesh* mesh, stratus_adjacency** out)
{
  adjacency_build build = { .context = context, .mesh = mesh };
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_adjacency), &memory));
  stratus_adjacency* adjacency = build.adjacency = memory;
  *adjacency = (stratus_adjacency){ .context = context, .cell_count = mesh->cell_count };
  stratus_status status = STRATUS_OK;
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->cell_count, 4 * sizeof(int32_t), &memory));
  adjacency->neighbours = memory;
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->cell_count, sizeof(int8_t), &memory));
  adjacency->orientation = memory;
  TRY_CLEANUP(build_adjacency(&build));
  *out = adjacency;
  adjacency = NULL;

cleanup:
  stratus_release(context, build.tables);
  stratus_release(context, build.records);
  stratus_release(context, build.places);
  stratus_adjacency_destroy(adjacency);
  return status;
}

void stratus_adjacency_destroy(stratus_adjacency* adjacency)
{
  if (adjacency) {
    stratus_release(adjacency->context, adjacency->neighbours);
    stratus_release(adjacency->context, adjacency->orientation);
    stratus_release(adjacency->context, adjacency);
  }
}
