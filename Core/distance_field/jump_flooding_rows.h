/* SPDX-License-Identifier: BSD-3-Clause
 * One row of a flooding pass. jump_flooding_host.c includes this file for each width of squared distances and each instruction set: plain
 * loops over x, which the compiler vectorises. FLOOD_NAME(x) names a function, LENGTH and ULENGTH are the types of distances, LENGTH_MAX
 * means "unknown". */

/* Squared distance from voxel (x, j, k) to `position`. Unsigned, because the sum for an unknown position may overflow; it is not used. */
static ALWAYS_INLINE FLOOD_TARGET LENGTH FLOOD_NAME(squared)(uint32_t position, int32_t x, int32_t j, int32_t k, flood_layout layout)
{
  const uint32_t mask_x = (1u << layout.shift_y) - 1, mask_y = (1u << (layout.shift_z - layout.shift_y)) - 1;
  const ULENGTH dx = (ULENGTH)((int32_t)(position & mask_x) - x);
  const ULENGTH dy = (ULENGTH)((int32_t)(position >> layout.shift_y & mask_y) - j);
  const ULENGTH dz = (ULENGTH)((int32_t)(position >> layout.shift_z) - k);
  const LENGTH sum = (LENGTH)(dx * dx + dy * dy + dz * dz);
  return position == FLOOD_UNKNOWN ? LENGTH_MAX : sum;
}

/* Replaces nearest[x] by other[x + shift] where that is nearer to voxel (x, j, k), or as near and of a smaller index. */
static ALWAYS_INLINE FLOOD_TARGET void FLOOD_NAME(ask)(const uint32_t* restrict other, int64_t shift, int64_t n, int32_t j, int32_t k,
  flood_layout layout, uint32_t* restrict nearest, LENGTH* restrict distance)
{
  const int64_t first = shift < 0 ? -shift : 0, last = shift > 0 ? n - shift : n;
  for (int64_t x = first; x < last; ++x) {
    const uint32_t position = other[x + shift];
    const LENGTH d = FLOOD_NAME(squared)(position, (int32_t)x, j, k, layout), best = distance[x];
    const int nearer = (d < best) | ((d == best) & (position < nearest[x]));
    distance[x] = nearer ? d : best;
    nearest[x] = nearer ? position : nearest[x];
  }
}

static FLOOD_TARGET void FLOOD_NAME(row)(const flood_pass* p, int64_t j, int64_t k, void* room, flood_count* count)
{
  const int64_t nx = p->n[0], ny = p->n[1], nz = p->n[2], step = p->step;
  const int32_t y = (int32_t)j, z = (int32_t)k;
  LENGTH* restrict distance = room;
  LENGTH* restrict before = distance + nx;
  const uint32_t* own = p->from + (k * ny + j) * nx;
  uint32_t* nearest = p->to + (k * ny + j) * nx;
  for (int64_t x = 0; x < nx; ++x) {
    nearest[x] = own[x];
    distance[x] = before[x] = FLOOD_NAME(squared)(own[x], (int32_t)x, y, z, p->layout);
  }
  for (int64_t dz = k < step ? 0 : -step; dz <= step && k + dz < nz; dz += step) {
    for (int64_t dy = j < step ? 0 : -step; dy <= step && j + dy < ny; dy += step) {
      const uint32_t* other = p->from + ((k + dz) * ny + j + dy) * nx;
      FLOOD_NAME(ask)(other, -step, nx, y, z, p->layout, nearest, distance);
      FLOOD_NAME(ask)(other, 0, nx, y, z, p->layout, nearest, distance);
      FLOOD_NAME(ask)(other, step, nx, y, z, p->layout, nearest, distance);
    }
  }
  int64_t updated = 0, ratios = 0;
  for (int64_t x = 0; x < nx; ++x) {
    const int nearer = distance[x] < before[x];
    const int ratio = flood_ratio(nearer ? (float)distance[x] : 1.0f, nearer ? (float)before[x] : 1.0f);
    updated += nearer;
    ratios += (nearer & (before[x] != LENGTH_MAX)) ? ratio : 0;
  }
  count->updated += (uint64_t)updated;
  count->ratios += (uint64_t)ratios;
}

#undef FLOOD_NAME
#undef FLOOD_TARGET
#undef LENGTH
#undef ULENGTH
#undef LENGTH_MAX
