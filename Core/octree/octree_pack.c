/* SPDX-License-Identifier: BSD-3-Clause
 * Sixteen boxes, or eight nodes, against a frustum's planes at once: by the corner farthest inside (p-vertex) and, where it matters, the
 * one farthest outside (n-vertex). Plane coherency: the plane that last rejected a pack is tested first. */
#include "clones.h"
#include "octree.h"

#include <float.h>
#include <string.h>

/* Bound on the rounding error of a plane's value in floats, relative to its largest term: six roundings and the boxes' outward step. */
#define FLOAT_SLACK 8e-7
#define OUTSIDE 0x80

void stratus_octree_planes_prepare(const stratus_octree* tree, const stratus_frustum_plan* plan, stratus_octree_planes* planes)
{
  double reach = tree->reach;
  for (int a = 0; tree->rooted && a < 3; ++a) {
    reach = fmax(reach, fmax(fabs(tree->corner[a]), fabs(tree->corner[a] + tree->edge)) + tree->pad * tree->edge);
  }
  memset(planes, 0, sizeof *planes);
  for (int p = 0; p < STRATUS_PLANES; ++p) {
    const double* n = plan->planes[p];
    double offset = n[3], size = fabs(n[3]), sum = 0.0;
    for (int a = 0; a < 3; ++a) {
      offset += n[a] * tree->origin[a];
      size += fabs(n[a] * tree->origin[a]);
      sum += fabs(n[a]);
    }
    const double band = FLOAT_SLACK * (sum * reach + fabs(offset)) + 4.0 * STRATUS_PLANE_SLACK * (size + sum * reach) + (double)FLT_MIN;
    if (!(band < 1e30)) {
      /* Floats cannot hold this plane. With an infinite band every box is near it, and doubles decide. */
      planes->band[p] = FLT_MAX;
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      planes->normal[p][a] = (float)n[a];
      planes->wide[p][a] = n[a];
    }
    planes->offset[p] = (float)offset;
    planes->wide[p][3] = offset;
    planes->band[p] = (float)band;
  }
}

/* ---- packs */

/* Adds the lanes that plane p rejects to *rejected, and the lanes that are near it, rejected ones included, to *near. */
static ALWAYS_INLINE void test_pack(
  const stratus_octree_planes* planes, int p, int turned, const float* restrict box, unsigned* restrict rejected, unsigned* restrict near)
{
  static const unsigned bit[STRATUS_PACK] = { 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768 };
  const float a = planes->normal[p][0], b = planes->normal[p][1], c = planes->normal[p][2], d = planes->offset[p], band = planes->band[p];
  const int row = 3 * STRATUS_PACK;
  const float *x = box + (a > 0.0f ? row : 0), *y = box + (b > 0.0f ? row : 0) + STRATUS_PACK,
              *z = box + (c > 0.0f ? row : 0) + 2 * STRATUS_PACK;
  const float *u = box + (a > 0.0f ? 0 : row), *v = box + (b > 0.0f ? 0 : row) + STRATUS_PACK,
              *w = box + (c > 0.0f ? 0 : row) + 2 * STRATUS_PACK;
  unsigned out = 0, close = 0;
  for (int i = 0; i < STRATUS_PACK; ++i) {
    const float inner = a * x[i] + b * y[i] + c * z[i] + d;
    out |= inner < -band ? bit[i] : 0u;
    close |= inner < band ? bit[i] : 0u;
  }
  if (turned) {
    for (int i = 0; i < STRATUS_PACK; ++i) {
      const float outer = a * u[i] + b * v[i] + c * w[i] + d;
      close |= outer < band ? bit[i] : 0u;
    }
  }
  *rejected |= out;
  *near |= close;
}

static ALWAYS_INLINE void test_packs(const stratus_octree_planes* planes, unsigned mask, int turned, const float* boxes, uint8_t* hints,
  size_t packs, uint16_t* keep, uint16_t* unsure)
{
  for (size_t i = 0; i < packs; ++i) {
    const float* box = boxes + i * STRATUS_PACK_FLOATS;
    const unsigned first = hints[i];
    unsigned rejected = 0, near = 0;
    if (mask >> first & 1) {
      test_pack(planes, (int)first, turned, box, &rejected, &near);
    }
    for (unsigned rest = mask & ~(1u << first); rest && rejected != 0xffff; rest &= rest - 1) {
      const int p = __builtin_ctz(rest);
      test_pack(planes, p, turned, box, &rejected, &near);
      if (rejected == 0xffff) {
        hints[i] = (uint8_t)p;
      }
    }
    keep[i] = (uint16_t)(~rejected & 0xffffu);
    unsure[i] = (uint16_t)(near & ~rejected);
  }
}

/* ---- children */

/* A cube lies outside a plane when its centre does by more than a constant, which is the same for all eight children. The same is true of
 * its sphere, so that testing the sphere first, as the paper does, would save nothing. */
static ALWAYS_INLINE void test_children(
  const stratus_octree_planes* planes, unsigned mask, const double center[3], double quarter, double looseness, uint8_t* restrict masks)
{
  static const double sign_x[8] = { -1, 1, -1, 1, -1, 1, -1, 1 }, sign_y[8] = { -1, -1, 1, 1, -1, -1, 1, 1 },
                      sign_z[8] = { -1, -1, -1, -1, 1, 1, 1, 1 };
  int outside[8] = { 0 }, crossed[8] = { 0 };
  for (; mask; mask &= mask - 1) {
    const int p = __builtin_ctz(mask);
    const double* n = planes->wide[p];
    const double band = (double)planes->band[p], a = n[0] * quarter, b = n[1] * quarter, c = n[2] * quarter;
    const double middle = n[0] * center[0] + n[1] * center[1] + n[2] * center[2] + n[3];
    const double radius = (fabs(a) + fabs(b) + fabs(c)) * looseness + band;
    for (int o = 0; o < 8; ++o) {
      const double value = middle + sign_x[o] * a + sign_y[o] * b + sign_z[o] * c;
      outside[o] |= value < -radius ? OUTSIDE : 0;
      crossed[o] |= value < radius ? 1 << p : 0;
    }
  }
  for (int o = 0; o < 8; ++o) {
    masks[o] = (uint8_t)(outside[o] | crossed[o]);
  }
}

/* ---- one clone for each instruction set: they compare and add only, so that all give the same bits */

#define CLONE(name, attribute)                                                                                                             \
  attribute static void packs_##name(const stratus_octree_planes* planes, unsigned mask, int turned, const float* boxes, uint8_t* hints,   \
    size_t packs, uint16_t* keep, uint16_t* unsure)                                                                                        \
  {                                                                                                                                        \
    if (turned) {                                                                                                                          \
      test_packs(planes, mask, 1, boxes, hints, packs, keep, unsure);                                                                      \
    } else {                                                                                                                               \
      test_packs(planes, mask, 0, boxes, hints, packs, keep, unsure);                                                                      \
    }                                                                                                                                      \
  }                                                                                                                                        \
  attribute static void children_##name(                                                                                                   \
    const stratus_octree_planes* planes, unsigned mask, const double center[3], double quarter, double looseness, uint8_t masks[8])        \
  {                                                                                                                                        \
    test_children(planes, mask, center, quarter, looseness, masks);                                                                        \
  }

CLONE(portable, )
#if HAVE_CLONES
CLONE(avx2, TARGET_AVX2)
CLONE(avx512, TARGET_AVX512)
#endif

void stratus_octree_test_packs(const stratus_octree_planes* planes, unsigned mask, int turned, const float* boxes, uint8_t* hints,
  size_t packs, uint16_t* keep, uint16_t* unsure)
{
#if HAVE_CLONES
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq")) {
    packs_avx512(planes, mask, turned, boxes, hints, packs, keep, unsure);
    return;
  }
  if (__builtin_cpu_supports("avx2")) {
    packs_avx2(planes, mask, turned, boxes, hints, packs, keep, unsure);
    return;
  }
#endif
  packs_portable(planes, mask, turned, boxes, hints, packs, keep, unsure);
}

void stratus_octree_test_children(
  const stratus_octree_planes* planes, unsigned mask, const double center[3], double quarter, double looseness, uint8_t masks[8])
{
#if HAVE_CLONES
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq")) {
    children_avx512(planes, mask, center, quarter, looseness, masks);
    return;
  }
  if (__builtin_cpu_supports("avx2")) {
    children_avx2(planes, mask, center, quarter, looseness, masks);
    return;
  }
#endif
  children_portable(planes, mask, center, quarter, looseness, masks);
}
