/* SPDX-License-Identifier: BSD-3-Clause
 * How a frame's cells are drawn: into how many pieces they are cut, and where rays end. */
#include "tetra_caster.h"

#include "table_fill.h"

/* The table's color_slope is so many times the most that a colour changes between neighbouring entries. */
#define TABLE_SLOPE 48.0
/* A stretch of optical depth d, over which a colour changes by c, in n pieces of averaged colour, is wrong by at most c d min(d, 1) / 12 n
 * n: the integral of (s - 1/2) c d exp(-d s) over a piece, summed over pieces behind one another. With n n = c d / 12 e that is e min(d,
 * 1), at most 1.6 e (1 - exp(-d)). The shares of a ray's cells in its alpha add up to 1 at most. Therefore 1.6 e bounds the error of the
 * ray, however many cells it has. e is this share of the tolerance: 1.6 times it, and the transparency left where the ray ends, stay below
 * the tolerance. */
#define PIECES_SHARE 0.4
#define TERMINATION_SHARE 0.1
/* Tolerances below count as this one: floats and the table's entries leave more. */
#define TOLERANCE_LEAST 1e-6
/* Below this a transparency does not change 1 as a float. */
#define TERMINATION_LEAST 0x1p-24
#define TERMINATION_MOST 0.5

double stratus_tetra_termination(const stratus_tetra_options* options)
{
  return options->termination > 0.0 ? 1.0 - options->termination
                                    : fmax(fmin(TERMINATION_SHARE * options->tolerance, TERMINATION_MOST), TERMINATION_LEAST);
}

void stratus_tetra_frame_shade(stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_tetra_options* options)
{
  stratus_tetra_arguments* arguments = &frame->arguments;
  const stratus_image* image = &frame->image;
  arguments->table = options->label_count > 0 ? caster->components.table : stratus_table_arguments_of(frame->table);
  const double pieces = 1.0 / (12.0 * PIECES_SHARE * fmax(options->tolerance, TOLERANCE_LEAST));
  arguments->table.color_slope *= (float)(pieces / TABLE_SLOPE);
  arguments->pieces = (float)pieces;
  arguments->picture.want_depth = image->depth != NULL;
  arguments->picture.want_samples = image->samples != NULL;
  arguments->picture.want_bytes = image->rgba8 != NULL;
  stratus_tetra_frame_mode(frame, options);
  switch (arguments->mode) {
    case TETRA_EXTREMES:
    case TETRA_ADD:
      arguments->termination = 0.0f;
      break;
    case TETRA_HITS:
      arguments->termination = (float)TERMINATION_MOST;
      break;
    default:
      arguments->termination = (float)stratus_tetra_termination(options);
  }
}
