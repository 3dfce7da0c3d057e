/* SPDX-License-Identifier: BSD-3-Clause
 * Chooses between march and projection by their estimated cost for a view: the view's counts, times the time of each count on this machine.
 * Earlier frames have no influence, so a still camera never changes the method. A processor's OpenCL draws by the host's costs: both
 * methods run the host's code there, and slow down equally. */
#include "tetra_caster.h"

#include "tetra_cells.h"
#include "tetra_costs.h"

#include <stdio.h>

const char* stratus_tetra_method_name(stratus_tetra_method method)
{
  static const char* const names[] = { "auto", "march", "project" };
  return (unsigned)method < sizeof names / sizeof *names ? names[method] : "unknown";
}

stratus_status stratus_tetra_choose(const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, stratus_tetra_report* report)
{
  const stratus_tetra_shown shown = { caster->mesh, caster->look.table, caster->look.mode };
  stratus_tetra_costs costs;
  stratus_tetra_view view;
  report->method = options->method;
  if (options->method != STRATUS_TETRA_METHOD_AUTO) {
    snprintf(report->why, sizeof report->why, "%s as asked", stratus_tetra_method_name(options->method));
    return STRATUS_OK;
  }
  report->method = STRATUS_TETRA_METHOD_MARCH;
  if (stratus_tetra_modes_march(options)) {
    snprintf(report->why, sizeof report->why, "march: mode %s cannot be projected", stratus_tetra_mode_name(options->mode));
    return STRATUS_OK;
  }
  if (stratus_tetra_modes_regions(options)) {
    snprintf(report->why, sizeof report->why, "march: crop regions cannot be projected");
    return STRATUS_OK;
  }
  if (stratus_tetra_light_mask(mesh, transfer, options)) {
    snprintf(report->why, sizeof report->why, "march: light and gradient opacity cannot be projected");
    return STRATUS_OK;
  }
  if (stratus_tetra_component_count(mesh) > 1) {
    snprintf(report->why, sizeof report->why, "march: several components cannot be projected");
    return STRATUS_OK;
  }
  if (options->label_count > 0) {
    snprintf(report->why, sizeof report->why, "march: labels cannot be projected");
    return STRATUS_OK;
  }
  if (!caster->mesh->names) {
    snprintf(report->why, sizeof report->why, "march: the cells of a lattice are not listed, and so need no memory");
    return STRATUS_OK;
  }
  if (caster->context->device && !stratus_device_is_cpu(caster->context->device)) {
    snprintf(report->why, sizeof report->why, "march: the cost of projection on a GPU is not measured");
    return STRATUS_OK;
  }
  if (!stratus_tetra_count_view(&shown, mesh, camera, image, &view)) {
    snprintf(report->why, sizeof report->why, "march: the camera spans no space");
    return STRATUS_OK;
  }
  if (caster->costs) {
    costs = *caster->costs;
  } else {
    TRY(stratus_tetra_costs_here(caster->context, &costs));
  }
  const double sorted = options->mode == STRATUS_TETRA_MAXIMUM ? 0.0 : (double)mesh->cell_count;
  const double march = 1e-6 * costs.segment * view.passed;
  const double project = 1e-6 * (costs.piece * view.pieces + costs.packet * view.packets + costs.cell * view.shown + costs.sorted * sorted);
  report->method = project < march ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH;
  snprintf(report->why, sizeof report->why,
    "%s: some %.2g million cells to be passed by rays in %.2g ms, against %.2g million pieces of %.2g million cells, %.2g million sorted, "
    "in %.2g ms",
    stratus_tetra_method_name(report->method), 1e-6 * view.passed, march, 1e-6 * view.pieces, 1e-6 * view.shown, 1e-6 * sorted, project);
  return STRATUS_OK;
}
