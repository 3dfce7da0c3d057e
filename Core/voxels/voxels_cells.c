/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels for ray casting: whole blocks of 4^3 cells. A block whose range of values meets an interval that shows becomes a full
 * brick at the same place. */
#include "voxels_build.h"

#include "volume_hash.h"
#include "matrix.h"

#include <string.h>

/* A block with gaps counts if anything shows at all. */
static stratus_status mark_blocks(const stratus_voxels* voxels, const stratus_value_range* ranges, uint64_t* masks)
{
  stratus_context* context = voxels->context;
  const int64_t count = ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2];
  const stratus_fetching fetching = stratus_value_range_fetching(ranges);
  stratus_origin origin = voxels->origin;
  stratus_occupancy* occupancy = NULL;
  stratus_shown shown;
  TRY(stratus_shown_create(context, &fetching, &(stratus_intervals){ origin.intervals, origin.interval }, &shown));
  const stratus_status status = stratus_occupancy_build(context, ranges, &shown, true, &occupancy);
  stratus_release(context, shown.of);
  TRY(status);
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t b = 0; b < count; ++b) {
    masks[b] = occupancy->occupied[b] ? ~UINT64_C(0) : 0;
  }
  stratus_occupancy_destroy(occupancy);
  return STRATUS_OK;
}

/* Voxel (i,j,k) is cell (i,j,k), whose middle lies half a step beyond value (i,j,k). A volume with coordinates has its cells in index
 * coordinates, for no matrix takes those to the world. */
static stratus_status place_cells(const stratus_volume* volume, stratus_voxels* voxels)
{
  static const double half[3] = { 0.5, 0.5, 0.5 };
  const stratus_volume plain = stratus_volume_default();
  double index_to_world[16], first[3];
  stratus_volume_index_to_world(stratus_volume_is_stretched(volume) ? &plain : volume, index_to_world);
  stratus_matrix_point(index_to_world, half, first);
  for (int a = 0; a < 3; ++a) {
    index_to_world[4 * a + 3] = first[a];
  }
  return stratus_voxels_place(voxels, index_to_world);
}

/* ranges: of blocks of 4^3 cells of the volume, whose hash this is. */
static stratus_status create_from_ranges(stratus_context* context, const stratus_volume* volume, const stratus_value_range* ranges,
  const stratus_criterion* criterion, uint64_t hash, stratus_voxels** out)
{
  stratus_voxels* voxels = NULL;
  stratus_status status;
  void* masks = NULL;
  int64_t dimensions[3];
  for (int a = 0; a < 3; ++a) {
    dimensions[a] = STRATUS_BRICK * ranges->blocks[a];
  }
  TRY(stratus_voxels_create_empty(context, dimensions, &voxels));
  TRY_CLEANUP(place_cells(volume, voxels));
  TRY_CLEANUP(stratus_origin_take_cells(context, ranges, criterion, &voxels->origin));
  voxels->origin.hash = hash;
  TRY_CLEANUP(stratus_allocate(context, (size_t)(ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2]), sizeof(uint64_t), &masks));
  TRY_CLEANUP(mark_blocks(voxels, ranges, masks));
  TRY_CLEANUP(stratus_voxels_take_masks(voxels, masks));
  *out = voxels;
  voxels = NULL;
cleanup:
  stratus_release(context, masks);
  stratus_voxels_destroy(voxels);
  return status;
}

stratus_status stratus_voxels_create_cells(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, stratus_voxels** out)
{
  stratus_value_range* ranges = NULL;
  stratus_status status;
  uint64_t hash = 0;
  TRY(stratus_volume_check(context, volume));
  TRY(stratus_criterion_check(context, criterion));
  if (!out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "voxels is NULL");
  }
  const stratus_stage stage = stratus_stage_begin(context);
  TRY_CLEANUP(stratus_value_range_create(context, volume, STRATUS_BRICK, &ranges));
  TRY_CLEANUP(stratus_volume_hash(context, volume, &hash));
  TRY_CLEANUP(create_from_ranges(context, volume, ranges, criterion, hash, out));
  stratus_voxels_end_stage(*out, &stage);
cleanup:
  stratus_value_range_destroy(ranges);
  return status;
}
