/* SPDX-License-Identifier: BSD-3-Clause
 * The simulation's interface to Catalyst, in C. Every rank calls each function. */
#ifndef STRATUS_IN_SITU_ADAPTOR_H
#define STRATUS_IN_SITU_ADAPTOR_H

#ifdef __cplusplus
extern "C" {
#endif

/* Returns 0, or 1 if Catalyst does not start with this Python script. */
int adaptor_start(const char* script);
/* Shows a step to the script. whole: the last point along each axis; first, last: this rank's own points along x, borders shared with its
 * neighbours, all of y and z. values: those points' with x fastest, borrowed until the call returns. */
void adaptor_show(const int whole[3], int first, int last, const float* values, double time, int step);
void adaptor_end(void);

#ifdef __cplusplus
}
#endif
#endif
