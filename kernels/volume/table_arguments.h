/* SPDX-License-Identifier: BSD-3-Clause
 * How a kernel reads a transfer function's table (stratus_table on the host). The same bytes on host and device. */
#ifndef STRATUS_TABLE_ARGUMENTS_H
#define STRATUS_TABLE_ARGUMENTS_H

typedef struct stratus_table_arguments {
  float scale, offset, last; /* a value's entry is value * scale + offset, within 0..last */
  /* the rest is set only for a pre-integrated table */
  float shown_first, shown_beyond; /* entries outside [shown_first, shown_beyond) are transparent */
  float tau_scale;                 /* optical depth of one unit of the running sums */
  float color_slope;               /* the most that a colour changes between neighbouring entries, over the error allowed */
  int has_opaque;                  /* 1: an entry has opacity 1, and rows behind the sums tell where: opaque_on_the_way() */
} stratus_table_arguments;

#endif
