/* SPDX-License-Identifier: BSD-3-Clause
 * Round numbers, for axes and the colour bar. */
#ifndef STRATUS_AXIS_TICKS_H
#define STRATUS_AXIS_TICKS_H

#include "base.h"
#include "stratus/annotation.h"

/* Returns the smallest of 1, 2 or 5 times a power of ten that is at least `least`; of degrees above 1/2 also 15, 30, 45, 60 and 90, and no
 * 20 and 50. */
double stratus_round_step(double least, bool degrees);
void stratus_number_text(double value, char text[32]);
stratus_status stratus_axis_check(stratus_context* context, const stratus_axis* axis);

#endif
