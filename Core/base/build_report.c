/* SPDX-License-Identifier: BSD-3-Clause
 * The report of building: stages of one name at one place are summed, so that a tree of a thousand fields has one stage of fields. */
#include "base.h"

#include <string.h>

stratus_stage stratus_stage_begin(const stratus_context* context)
{
  const stratus_build_report* report = &context->report;
  return (stratus_stage){ .start_ms = stratus_now_ms(),
    .ended_ms = report->ended_ms,
    .launched = report->launched,
    .ended_kernels = report->ended_kernels,
    .returned = report->returned,
    .ended_returned = report->ended_returned };
}

/* Returns the report's stage of this name and place, or NULL where the report is full. */
static stratus_build_stage* find_stage(stratus_build_report* report, const char* name, const char* where)
{
  for (int i = 0; i < report->count; ++i) {
    if (strcmp(report->stages[i].name, name) == 0 && strcmp(report->stages[i].where, where) == 0) {
      return &report->stages[i];
    }
  }
  if (report->count == STRATUS_BUILD_STAGES_MAX) {
    return NULL;
  }
  report->stages[report->count] = (stratus_build_stage){ .name = name, .where = where };
  return &report->stages[report->count++];
}

void stratus_stage_end(stratus_context* context, const stratus_stage* stage, const char* name, size_t bytes)
{
  stratus_build_report* report = &context->report;
  const double ms = stratus_now_ms() - stage->start_ms - (report->ended_ms - stage->ended_ms);
  const uint64_t kernels = report->launched - stage->launched - (report->ended_kernels - stage->ended_kernels);
  const uint64_t returned = report->returned - stage->returned - (report->ended_returned - stage->ended_returned);
  const bool on_device = kernels && !returned; /* if the host took the stage over, the device's kernels made nothing of it */
  stratus_build_stage* entry = find_stage(report, name, on_device ? context->device_name : "host");
  if (entry) {
    /* Differences of large sums may round below zero. */
    entry->ms += ms > 0.0 ? ms : 0.0;
    entry->bytes += bytes;
    entry->kernels += on_device ? kernels : 0;
  }
  report->ended_ms += ms;
  report->ended_kernels += kernels;
  report->ended_returned += returned;
}

void stratus_context_start_build_report(stratus_context* context)
{
  if (context) {
    context->report.count = 0;
  }
}

int stratus_context_get_build_report(const stratus_context* context, stratus_build_stage* stages, int capacity)
{
  const int count = context ? context->report.count : 0;
  for (int i = 0; stages && i < count && i < capacity; ++i) {
    stages[i] = context->report.stages[i];
  }
  return count;
}
