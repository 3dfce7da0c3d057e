/* SPDX-License-Identifier: BSD-3-Clause
 * How a kernel reads a transfer function's table (stratus_table on the host). The same bytes on host and device. */
#ifndef STRATUS_TABLE_ARGUMENTS_H
#define STRATUS_TABLE_ARGUMENTS_H

/* Inverse of the colour change allowed within a piece of a segment; longer pieces are cut. Averaging a piece's colours is wrong by about
 * 1/12 of that change, half of 1/255. */
#define TABLE_COLOR_ERROR_INVERSE 48.0f
/* Words of a stretch. */
#define TABLE_STRETCH_LOG2 3

typedef struct stratus_table_arguments {
  float scale, offset, last; /* a value's cell in the grid is value * scale + offset, within 0..last */
  int entries;
  int unit;                          /* width of a cell */
  int jumps;                         /* 1: the function has vertical steps, or features narrower than a cell */
  int search_steps;                  /* 0: entries are cells; else so many bisections find an entry of a cell */
  int first_at, bound_at, widths_at; /* where the arrays of such a table begin, in words of four bytes from the table's first */
  /* the rest is set only for a pre-integrated table */
  float shown_first, shown_beyond; /* cells outside [shown_first, shown_beyond) are transparent */
  float tau_scale;                 /* optical depth of one unit of the running sums */
  float color_slope, color_most;   /* the most that a colour changes per entry (or width), and in all, over the error allowed */
  int cut;                         /* 1: values lie beyond the table, and are transparent there */
  int has_opaque;                  /* 1: an entry has opacity 1, and rows behind the sums say where: opaque_on_the_way() */
  /* Number of stretches (table_stretch in transfer_table.h) of a function of constant opacities between vertical steps; 0: the function has
   * other opacities. They begin at word stretches_at, and so many bisections find one. */
  int stretches, stretches_at, stretch_steps;
} stratus_table_arguments;

#endif
