/* SPDX-License-Identifier: BSD-3-Clause
 * Loads the volume's values for a packet, as floats. Included once for each STRATUS_TYPE (the number of a stratus_type) with 32-bit
 * indices, and once with STRATUS_TYPE -1 for the generic fetch. That takes any type, stride and size, and axes of one value; it is slow.
 * Types 6 and 7 have a fetch of their own from pages only (RAY_PAGES), which takes any size, too. A value of a page that the device does
 * not have is not finite. On the host only: STRATUS_TYPE -2 calls the fetch that the arguments name (Core/field/ray_reading.h), and -3
 * loads from tiles (fetch_tiles.h).
 *
 *   fetch_pair(a, values, index, mask, end, &v0, &v1)   values[index] and values[index+1]; of a fixed type only
 *   fetch_cell(a, values, i, j, k, mask, v)              the eight corners of cell (i,j,k): v[x + 2 y + 4 z]
 *   fetch_nearest(a, values, i, j, k, mask)              the value (i,j,k) */
#ifndef STRATUS_TYPE
#error "STRATUS_TYPE is not set"
#endif
#include "load_square.h"

#if STRATUS_TYPE == 0
#ifdef STRATUS_DEVICE
#define VALUE char
#else
#define VALUE signed char
#endif
#elif STRATUS_TYPE == 1
#define VALUE uchar
#elif STRATUS_TYPE == 2
#define VALUE short
#elif STRATUS_TYPE == 3
#define VALUE ushort
#elif STRATUS_TYPE == 4
#define VALUE int
#elif STRATUS_TYPE == 5
#define VALUE uint
#elif STRATUS_TYPE == 6
#define VALUE long
#elif STRATUS_TYPE == 7
#define VALUE ulong
#elif STRATUS_TYPE == 8
#define VALUE float
#elif STRATUS_TYPE == 9
#define VALUE double
#endif
#define VALUE_WIDE (STRATUS_TYPE >= 4 && STRATUS_TYPE != 8)

/* ------------------------------------------------------------------------------------------------ pages */
#if RAY_IN_PAGES

/* The value (i,j,k) in the page of its cell; NULL where there is no such page. */
INLINE GLOBAL const VALUE* RAY_NAME(in_page)(CONSTANT stratus_ray_cast_arguments* a, const value_source* values, int i, int j, int k)
{
  const size_t row = (size_t)(k >> PAGE_LOG2) * (size_t)a->values.pages_rows + (size_t)(j >> PAGE_LOG2);
  const int entry = values->table[row * (size_t)a->values.pages_across + (size_t)(i >> PAGE_LOG2)], in_row = PAGE_SIDE - 1;
  if (entry < 0) {
    return 0;
  }
  const size_t page = (size_t)(entry & ((1 << PAGE_SLAB_SHIFT) - 1)) * (size_t)a->values.page_components + (size_t)values->component;
  const int slab = entry >> PAGE_SLAB_SHIFT, at = ((k & in_row) * PAGE_ROW + (j & in_row)) * PAGE_ROW + (i & in_row);
  GLOBAL const void* from = slab < 2 ? (slab ? values->slab[1] : values->slab[0]) : slab == 2 ? values->slab[2] : values->slab[3];
  return (GLOBAL const VALUE*)from + page * PAGE_VALUES + at;
}

INLINE float RAY_NAME(load_one)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const VALUE* at)
{
#if VALUE_WIDE
  return (float)((double)*at - BIAS_OF(a));
#else
  (void)a;
  return (float)*at;
#endif
}

INLINE void RAY_NAME(fetch_cell)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask, vfloat v[8])
{
  int li[STRATUS_WIDTH], lj[STRATUS_WIDTH], lk[STRATUS_WIDTH], lm[STRATUS_WIDTH];
  float lv[8][STRATUS_WIDTH];
  vi_store(li, i);
  vi_store(lj, j);
  vi_store(lk, k);
  vi_store(lm, vi_select(mask, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    GLOBAL const VALUE* at = lm[lane] ? RAY_NAME(in_page)(a, &values, li[lane], lj[lane], lk[lane]) : 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int behind = ((corner >> 2) * PAGE_ROW + (corner >> 1 & 1)) * PAGE_ROW + (corner & 1);
      lv[corner][lane] = at ? RAY_NAME(load_one)(a, at + behind) : lm[lane] ? NAN : 0.0f;
    }
  }
  for (int corner = 0; corner < 8; ++corner) {
    v[corner] = v_load(lv[corner]);
  }
}

INLINE vfloat RAY_NAME(fetch_nearest)(CONSTANT stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask)
{
  int li[STRATUS_WIDTH], lj[STRATUS_WIDTH], lk[STRATUS_WIDTH], lm[STRATUS_WIDTH];
  float lv[STRATUS_WIDTH];
  vi_store(li, i);
  vi_store(lj, j);
  vi_store(lk, k);
  vi_store(lm, vi_select(mask, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    GLOBAL const VALUE* at = lm[lane] ? RAY_NAME(in_page)(a, &values, li[lane], lj[lane], lk[lane]) : 0;
    lv[lane] = at ? RAY_NAME(load_one)(a, at) : lm[lane] ? NAN : 0.0f;
  }
  return v_load(lv);
}

/* ------------------------------------------------------------------------------------------------ known at run time */
#elif STRATUS_TYPE == -2

INLINE void RAY_NAME(fetch_cell)(const stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask, vfloat v[8])
{
  RAY_READING(a)->cell(a, values, i, j, k, mask, v);
}

INLINE vfloat RAY_NAME(fetch_nearest)(const stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask)
{
  return RAY_READING(a)->nearest(a, values, i, j, k, mask);
}

/* ------------------------------------------------------------------------------------------------ tiles */
#elif STRATUS_TYPE == -3
#include "fetch_tiles.h"

/* ------------------------------------------------------------------------------------------------ generic */
#elif STRATUS_TYPE == -1

INLINE float RAY_NAME(load_any)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, stratus_index index)
{
  switch (a->values.type) {
#ifdef STRATUS_DEVICE
    case 0:
      return (float)((GLOBAL const char*)values)[index];
#else
    case 0:
      return (float)((const signed char*)values)[index];
#endif
    case 1:
      return (float)((GLOBAL const uchar*)values)[index];
    case 2:
      return (float)((GLOBAL const short*)values)[index];
    case 3:
      return (float)((GLOBAL const ushort*)values)[index];
    case 8:
      return ((GLOBAL const float*)values)[index];
#ifndef STRATUS_REAL_PAIR
    case 4:
      return (float)((double)((GLOBAL const int*)values)[index] - BIAS_OF(a));
    case 5:
      return (float)((double)((GLOBAL const uint*)values)[index] - BIAS_OF(a));
#ifdef STRATUS_DEVICE
    case 6:
      return (float)((double)((GLOBAL const long*)values)[index] - BIAS_OF(a));
    case 7:
      return (float)((double)((GLOBAL const ulong*)values)[index] - BIAS_OF(a));
#else
    case 6:
      return (float)((double)((const int64_t*)values)[index] - BIAS_OF(a));
    case 7:
      return (float)((double)((const uint64_t*)values)[index] - BIAS_OF(a));
#endif
    case 9:
      return (float)(((GLOBAL const double*)values)[index] - BIAS_OF(a));
#endif
    default:
      return 0.0f;
  }
}

INLINE stratus_index RAY_NAME(generic_index)(CONSTANT stratus_ray_cast_arguments* a, int i, int j, int k)
{
  const stratus_index row = ((stratus_index)(uint)a->values.row_high << 32) | (stratus_index)(uint)a->values.row;
  const stratus_index slice = ((stratus_index)(uint)a->values.slice_high << 32) | (stratus_index)(uint)a->values.slice;
  return (stratus_index)i * (stratus_index)a->values.stride + (stratus_index)j * row + (stratus_index)k * slice;
}

INLINE void RAY_NAME(fetch_cell)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, vint i, vint j, vint k, vmask mask, vfloat v[8])
{
  int li[STRATUS_WIDTH], lj[STRATUS_WIDTH], lk[STRATUS_WIDTH], lm[STRATUS_WIDTH];
  float lv[8][STRATUS_WIDTH];
  vi_store(li, i);
  vi_store(lj, j);
  vi_store(lk, k);
  vi_store(lm, vi_select(mask, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    for (int corner = 0; corner < 8; ++corner) {
      lv[corner][lane] = 0.0f;
      if (lm[lane]) {
        const int x = li[lane] + (corner & 1), y = lj[lane] + (corner >> 1 & 1), z = lk[lane] + (corner >> 2);
        lv[corner][lane] = RAY_NAME(load_any)(a, values,
          RAY_NAME(generic_index)(
            a, x < a->values.dimensions[0] ? x : x - 1, y < a->values.dimensions[1] ? y : y - 1, z < a->values.dimensions[2] ? z : z - 1));
      }
    }
  }
  for (int corner = 0; corner < 8; ++corner) {
    v[corner] = v_load(lv[corner]);
  }
}

INLINE vfloat RAY_NAME(fetch_nearest)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, vint i, vint j, vint k, vmask mask)
{
  int li[STRATUS_WIDTH], lj[STRATUS_WIDTH], lk[STRATUS_WIDTH], lm[STRATUS_WIDTH];
  float lv[STRATUS_WIDTH];
  vi_store(li, i);
  vi_store(lj, j);
  vi_store(lk, k);
  vi_store(lm, vi_select(mask, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    lv[lane] = lm[lane] ? RAY_NAME(load_any)(a, values, RAY_NAME(generic_index)(a, li[lane], lj[lane], lk[lane])) : 0.0f;
  }
  return v_load(lv);
}

#else /* -------------------------------------------------------------------------------------------- a fixed type */

#define VALUES ((GLOBAL const VALUE*)values)

#if defined(LANES_LOAD) && (STRATUS_TYPE <= 3 || STRATUS_TYPE >= 8) && (!defined(STRATUS_GATHERS) || STRATUS_TYPE == 9)
#define SQUARES 1
/* The floats of at[0], at[1], at[row] and at[row + 1]. */
INLINE __m128 RAY_NAME(load_square)(CONSTANT stratus_ray_cast_arguments* a, const VALUE* at, size_t row)
{
  return load_square(STRATUS_TYPE, STRATUS_TYPE == 9 ? BIAS_OF(a) : 0.0, at, at + row);
}

/* out: the four floats of load_square() at each lane's place. */
INLINE void RAY_NAME(load_squares)(
  CONSTANT stratus_ray_cast_arguments* a, const VALUE* values, const lane_places* places, size_t row, vfloat out[4])
{
  vfloat joined[4];
  for (int lane = 0; lane < 4; ++lane) {
    __m128 quad[STRATUS_WIDTH / 4];
    for (int part = 0; part < STRATUS_WIDTH / 4; ++part) {
      quad[part] = RAY_NAME(load_square)(a, values + places->at[4 * part + lane], row);
    }
    joined[lane] = join_quads(quad);
  }
  transpose_quads(joined, out);
}
#endif

#if STRATUS_WIDTH == 16 && STRATUS_TYPE <= 3 && (defined(STRATUS_DEVICE_AVX512) || defined(STRATUS_GATHERS))
#define FETCH_DWORD 1 /* values of one or two bytes: one gather of four bytes loads a pair */
#endif

#ifndef FETCH_DWORD
INLINE float RAY_NAME(load_one)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, int index)
{
#if VALUE_WIDE
  return (float)((double)VALUES[index] - BIAS_OF(a));
#else
  (void)a;
  return (float)VALUES[index];
#endif
}

INLINE vfloat RAY_NAME(fetch_lanes)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, vint index, vmask mask)
{
#if STRATUS_WIDTH == 1
  return mask ? RAY_NAME(load_one)(a, values, index) : 0.0f;
#else
  int li[STRATUS_WIDTH];
  float lv[STRATUS_WIDTH];
  vi_store(li, vi_select(mask, index, vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    lv[lane] = RAY_NAME(load_one)(a, values, li[lane]);
  }
  return v_load(lv);
#endif
}
#endif

#ifdef FETCH_DWORD
#if STRATUS_TYPE <= 1
#define DWORD_LOG2 0
#define DWORD_SHIFT 8
#else
#define DWORD_LOG2 1
#define DWORD_SHIFT 16
#endif
/* Value number `which` of the dword, with its sign if the type has one. */
INLINE vint RAY_NAME(dword_part)(vint dword, int which)
{
#if STRATUS_TYPE == 0 || STRATUS_TYPE == 2
  return (dword << vi_set(32 - DWORD_SHIFT * (which + 1))) >> vi_set(32 - DWORD_SHIFT);
#else
  return LOGICAL_RIGHT(dword, vi_set(DWORD_SHIFT * which)) & vi_set((1 << DWORD_SHIFT) - 1);
#endif
}
INLINE vint RAY_NAME(gather_bytes)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, vint index, vmask mask, int end)
{
#if STRATUS_TYPE <= 1
  if (end) { /* near the volume's end the four bytes begin further left and are shifted, so that none beyond the end is read */
    const vint from = vi_min(index, vi_set(a->values.tail));
    return LOGICAL_RIGHT(GATHER_DWORD(values, from, mask, DWORD_LOG2), (index - from) << vi_set(3));
  }
#else
  (void)a;
  (void)end;
#endif
  return GATHER_DWORD(values, index, mask, DWORD_LOG2);
}
#endif

/* values[index] and values[index+1]. end: 1 where the pair may be the last of the volume. */
INLINE void RAY_NAME(fetch_pair)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, vint index, vmask mask, int end, vfloat* v0, vfloat* v1)
{
#ifdef FETCH_DWORD
  const vint dword = RAY_NAME(gather_bytes)(a, values, index, mask, end);
  *v0 = v_from_int(RAY_NAME(dword_part)(dword, 0));
  *v1 = v_from_int(RAY_NAME(dword_part)(dword, 1));
#elif defined(SQUARES)
  lane_places places;
  vfloat twice[4];
  lane_places_of(index, mask, &places);
  RAY_NAME(load_squares)(a, VALUES, &places, 0, twice);
  *v0 = twice[0];
  *v1 = twice[1];
  (void)end;
#elif STRATUS_TYPE == 8 && defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
  const int16 low = STRATUS_GATHER_LONG(VALUES, index.lo, (uchar)mask, 4),
              high = STRATUS_GATHER_LONG(VALUES, index.hi, (uchar)(mask >> 8), 4);
  *v0 = as_float16((int16)(low.even, high.even));
  *v1 = as_float16((int16)(low.odd, high.odd));
  (void)a;
  (void)end;
#elif STRATUS_TYPE == 8 && defined(STRATUS_GATHERS)
  vint two[2];
  GATHER_TWO(values, index, mask, 4, two);
  *v0 = v_from_bits(two[0]);
  *v1 = v_from_bits(two[1]);
  (void)a;
  (void)end;
#else
  *v0 = RAY_NAME(fetch_lanes)(a, values, index, mask);
  *v1 = RAY_NAME(fetch_lanes)(a, values, index + vi_set(1), mask);
  (void)end;
#endif
}

INLINE vint RAY_NAME(fixed_index)(CONSTANT stratus_ray_cast_arguments* a, vint i, vint j, vint k)
{
  return i + j * vi_set(a->values.row) + k * vi_set(a->values.slice);
}

INLINE void RAY_NAME(fetch_cell)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, vint i, vint j, vint k, vmask mask, vfloat v[8])
{
  const vint index = RAY_NAME(fixed_index)(a, i, j, k);
#ifdef SQUARES
  lane_places places;
  lane_places_of(index, mask, &places);
  RAY_NAME(load_squares)(a, VALUES, &places, (size_t)a->values.row, v);
  RAY_NAME(load_squares)(a, VALUES + a->values.slice, &places, (size_t)a->values.row, v + 4);
#else
  RAY_NAME(fetch_pair)(a, values, index, mask, 0, &v[0], &v[1]);
  RAY_NAME(fetch_pair)(a, values, index + vi_set(a->values.row), mask, 0, &v[2], &v[3]);
  RAY_NAME(fetch_pair)(a, values, index + vi_set(a->values.slice), mask, 0, &v[4], &v[5]);
  RAY_NAME(fetch_pair)(a, values, index + vi_set(a->values.row + a->values.slice), mask, 1, &v[6], &v[7]);
#endif
}

INLINE vfloat RAY_NAME(fetch_nearest)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, vint i, vint j, vint k, vmask mask)
{
  const vint index = RAY_NAME(fixed_index)(a, i, j, k);
#ifdef FETCH_DWORD
#if STRATUS_TYPE <= 1
  return v_from_int(RAY_NAME(dword_part)(RAY_NAME(gather_bytes)(a, values, index, mask, 1), 0));
#else
  /* gathers the pair that ends with this value: a pair that begins with it may reach beyond the volume */
  const vint from = vi_max(index - vi_set(1), vi_set(0));
  const vint dword = GATHER_DWORD(values, from, mask, DWORD_LOG2);
  return v_from_int(vi_select(vi_lt(from, index), RAY_NAME(dword_part)(dword, 1), RAY_NAME(dword_part)(dword, 0)));
#endif
#elif STRATUS_TYPE == 8 && defined(GATHER_FLOAT)
  return GATHER_FLOAT(VALUES, index, mask);
#else
  return RAY_NAME(fetch_lanes)(a, values, index, mask);
#endif
}
#endif

#undef VALUE
#undef VALUES
#undef VALUE_WIDE
#undef SQUARES
#undef FETCH_DWORD
#undef DWORD_LOG2
#undef DWORD_SHIFT
