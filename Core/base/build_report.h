/* SPDX-License-Identifier: BSD-3-Clause
 * Measures the stages of building: their time, the bytes of their results, and the kernels that they launch. */
#ifndef STRATUS_BUILD_REPORT_H
#define STRATUS_BUILD_REPORT_H

#include "stratus/context.h"

/* A part of every context. */
typedef struct stratus_build_report {
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  int count;
  uint64_t launched; /* kernels since the context was made, in stages or not */
  uint64_t returned; /* how often the host took over what the device had begun */
  /* Sums over all stages that have ended since the context was made. A stage subtracts what they grew by, for that belongs to the stages
   * within it. */
  double ended_ms;
  uint64_t ended_kernels, ended_returned;
} stratus_build_report;

/* The sums at the time when a stage began. */
typedef struct stratus_stage {
  double start_ms, ended_ms;
  uint64_t launched, ended_kernels, returned, ended_returned;
} stratus_stage;

/* Begins a stage. One that fails needs no end: it is not reported, and its time and kernels count for the stage around it. */
stratus_stage stratus_stage_begin(const stratus_context* context);
/* End a stage and add it to the context's report. name: a constant; one stage has one name in all its calls. bytes: size of its result. */
void stratus_stage_end(stratus_context* context, const stratus_stage* stage, const char* name, size_t bytes);

#endif
