/* SPDX-License-Identifier: BSD-3-Clause
 * One probe for all blocks of a volume: a volume of thousands of blocks looks alike in most of them, and a probe for each would take longer
 * than the picture. */
#include "ray_probe_blocks.h"

#include "block_window.h"
#include "ray_frame.h"
#include "ray_probe.h"
#include "ray_voxels.h"
#include "volume.h"

#include <stdio.h>
#include <string.h>

double stratus_block_tolerance(double tolerance, int count)
{
  return tolerance / sqrt(cbrt((double)count));
}

void stratus_probe_blocks_share(const stratus_probe_blocks* blocks, const stratus_probe_blocks* shared)
{
  for (int n = 0; n < blocks->count; ++n) {
    blocks->inputs[n].caster->blocks = shared;
  }
}

static stratus_ray_cast_options options_of(const stratus_probe_blocks* blocks, int number)
{
  const stratus_ray_cast_options* given = blocks->inputs[number].options;
  stratus_ray_cast_options options = given ? *given : stratus_ray_cast_options_default();
  options.sampling.tolerance = stratus_block_tolerance(options.sampling.tolerance, blocks->count);
  return options;
}

/* Whether two casters have the same transfer functions. */
static bool same_functions(const stratus_ray_caster* a, const stratus_ray_caster* b)
{
  bool same = a->optics.transfer_count == b->optics.transfer_count && a->optics.dependent == b->optics.dependent && a->optics.transfers &&
    b->optics.transfers && !a->optics.transfer_2d.on && !b->optics.transfer_2d.on;
  for (int i = 0; same && i < a->optics.transfer_count; ++i) {
    same = stratus_transfer_same(a->optics.transfers + i, b->optics.transfers + i);
  }
  return same;
}

static bool shows_nothing(const stratus_ray_caster* caster)
{
  return !caster->structure.occupancy || caster->structure.occupancy->count == 0;
}

/* Whether a block's measurement holds for the data, functions and options that the caster has now. */
static bool serves(const stratus_ray_cast_input* in, const stratus_ray_caster* caster)
{
  const stratus_ray_caster* of = in->caster;
  stratus_ray_choice_inputs inputs;
  memcpy(&inputs, &of->measured_for, sizeof inputs); /* padding, too */
  inputs.voxel = caster->inputs.voxel;
  return of != caster && of->measured.sample_distance > 0.0 && !shows_nothing(of) && memcmp(&inputs, &caster->inputs, sizeof inputs) == 0 &&
    of->field.ranges && stratus_volume_same_data(&of->field.volume, in->volume) && same_functions(of, caster);
}

/* ---- which block is measured */

/* Brings a block's structures up to date, as its picture will need them, and adds the time to the report. */
static stratus_status update(const stratus_probe_blocks* blocks, int number, size_t rays, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_input* in = &blocks->inputs[number];
  const stratus_ray_cast_options options = options_of(blocks, number);
  stratus_ray_cast_report mine = { .range_ms = 0.0 };
  stratus_structure used;
  char why[192];
  TRY(stratus_ray_update_transfer_2d(in->caster, in->volume, &options));
  const stratus_transfer* transfer = options.optics.transfer_2d ? &in->caster->optics.transfer_2d.shown : in->transfer;
  TRY(stratus_ray_check_input(in->caster->context, in->volume, transfer, &options));
  in->caster->together = false;
  TRY(stratus_ray_update_tables(in->caster, in->volume, transfer, &options, rays, &mine));
  TRY(stratus_ray_update_structures(
    in->caster, options.skipping.structure, !blocks->image->samples && !in->volume->tiles.values, &used, why, sizeof why, &mine));
  report->range_ms += mine.range_ms;
  report->table_ms += mine.table_ms;
  report->occupancy_ms += mine.occupancy_ms;
  report->structure_ms += mine.structure_ms;
  return STRATUS_OK;
}

/* Finds the block that is measured, of those that the picture shows and whose choice is open. *found: -1 if there is none. */
static stratus_status find_roughest(const stratus_probe_blocks* blocks, int* found, stratus_ray_cast_report* report)
{
  stratus_context* context = blocks->inputs[0].caster->context;
  const size_t count = (size_t)blocks->count;
  stratus_status status = STRATUS_OK;
  double all = 0.0, most = -1.0;
  int shown = 0;
  void* memory = NULL;
  *found = -1;
  TRY(stratus_allocate_zero(context, 2 * count, sizeof(double), &memory));
  double *changes = memory, *cells = changes + count;
  for (int n = 0; n < blocks->count; ++n) {
    const stratus_ray_caster* caster = blocks->inputs[n].caster;
    int window[4];
    stratus_block_window(blocks->inputs[n].volume, blocks->camera, blocks->image, window);
    if (window[0] < window[1] && window[2] < window[3]) {
      TRY_CLEANUP(update(blocks, n, (size_t)(window[1] - window[0]) * (size_t)(window[3] - window[2]), report));
      if (caster->integrator.choice.provisional) {
        TRY_CLEANUP(stratus_ray_probe_changes(caster, &changes[n], &cells[n]));
        all += changes[n];
        shown += cells[n] > 0.0;
      }
    }
  }
  for (int n = 0; n < blocks->count; ++n) {
    const bool matters = cells[n] > 0.0 && changes[n] >= 0.5 * all / shown;
    if (matters && changes[n] / cells[n] > most) {
      most = changes[n] / cells[n];
      *found = n;
    }
  }
cleanup:
  stratus_release(context, memory);
  return status;
}

/* ---- what the others take of it */

/* Makes the map of the caster's own rough blocks. */
static stratus_status make_rough(stratus_ray_caster* caster, int beyond)
{
  stratus_probe_patch patches[STRATUS_PROBE_PATCHES];
  stratus_probe_classes classes = { .of = NULL };
  stratus_distance_map* rough = NULL;
  int count = 0;
  TRY(stratus_ray_probe_rays(caster, patches, &count, &classes));
  const stratus_status status = count > 0 ? stratus_ray_make_rough(caster->context, &classes, beyond, &rough) : STRATUS_OK;
  stratus_release(caster->context, classes.of);
  TRY(status);
  stratus_ray_drop_rough(&caster->structure);
  caster->structure.rough = rough;
  return STRATUS_OK;
}

/* Takes the measured choice of another block. *taken: false if this block cannot be drawn by it. */
static stratus_status take(stratus_ray_caster* caster, const stratus_ray_cast_options* options, const stratus_ray_caster* from, bool* taken)
{
  stratus_ray_choice choice = from->measured;
  const bool cells = choice.sampling == STRATUS_SAMPLING_CELLS, open = cells || !(options->sampling.distance > 0.0);
  choice.sample_distance *= open ? caster->inputs.voxel / from->measured_for.voxel : 1.0;
  choice.follows = open && stratus_ray_follows_voxels(&caster->field.traversed);
  *taken = stratus_ray_can_sample(caster, options, choice.sampling) &&
    stratus_ray_step_fits(&caster->field.traversed, choice.sample_distance, choice.follows);
  if (*taken && choice.sampling == STRATUS_SAMPLING_LOCAL) {
    TRY(make_rough(caster, from->measured_beyond));
    *taken = caster->structure.rough != NULL;
  }
  if (!*taken) {
    return STRATUS_OK;
  }
  caster->integrator.choice = caster->measured = choice;
  caster->measured_beyond = from->measured_beyond;
  memcpy(&caster->measured_for, &caster->inputs, sizeof caster->inputs);
  snprintf(caster->tried, sizeof caster->tried, "as measured in another block");
  return stratus_ray_update_table(caster, options);
}

stratus_status stratus_probe_blocks_choose(
  stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options, stratus_ray_cast_report* report)
{
  const stratus_probe_blocks* blocks = caster->blocks;
  const stratus_ray_caster* from = NULL;
  bool taken = false;
  if (shows_nothing(caster)) { /* nothing is measured, and nothing is found out */
    return stratus_ray_probe(caster, volume, blocks->camera, options, report);
  }
  for (int n = 0; n < blocks->count && !from; ++n) {
    from = serves(&blocks->inputs[n], caster) ? blocks->inputs[n].caster : NULL;
  }
  if (!from) {
    int roughest;
    TRY(find_roughest(blocks, &roughest, report));
    if (roughest >= 0 && blocks->inputs[roughest].caster != caster) {
      const stratus_ray_cast_input* in = &blocks->inputs[roughest];
      const stratus_ray_cast_options its = options_of(blocks, roughest);
      TRY(stratus_ray_probe(in->caster, in->volume, blocks->camera, &its, report));
      from = serves(in, caster) ? in->caster : NULL;
    }
  }
  if (from) {
    TRY(take(caster, options, from, &taken));
  }
  return taken ? STRATUS_OK : stratus_ray_probe(caster, volume, blocks->camera, options, report);
}
