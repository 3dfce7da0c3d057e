/* SPDX-License-Identifier: BSD-3-Clause
 * The modes' names, and which of them need all components of a value at once. */
#include "tetra_caster.h"

#include "tetra_cells.h"

const char* stratus_tetra_mode_name(stratus_tetra_mode mode)
{
  static const char* const names[] = { "composite", "maximum", "minimum", "average", "additive", "isosurface", "slice", "first-hit",
    "quantities" };
  return (unsigned)mode < sizeof names / sizeof *names ? names[mode] : "unknown";
}

bool stratus_tetra_mixes(const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  return stratus_tetra_meets_components(mesh, options) ||
    (stratus_tetra_component_count(mesh) > 1 &&
      (options->dependent || options->mode == STRATUS_TETRA_COMPOSITE || options->mode == STRATUS_TETRA_SLICE));
}

bool stratus_tetra_meets_components(const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  return stratus_tetra_component_count(mesh) > 1 && !options->dependent &&
    (options->mode == STRATUS_TETRA_ISOSURFACE || options->mode == STRATUS_TETRA_FIRST_HIT);
}
