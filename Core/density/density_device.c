/* SPDX-License-Identifier: BSD-3-Clause
 * Computes the sums of density_rows.c on the context's OpenCL device: buffers, arguments and launches of kernels/density.cl. */
#include "density_plan.h"
#include "device.h"

#define CPU_GROUPS 64 /* of one item, each with a run of bricks */

typedef struct density_buffers {
  cl_mem bricks, start, rows, table, sums, rooms;
} density_buffers;

static size_t groups_of(int64_t count)
{
  return count < CPU_GROUPS ? (size_t)count : CPU_GROUPS;
}

bool stratus_device_takes_density(const stratus_context* context, const density_plan* plan, int64_t count, int64_t voxels)
{
  const size_t largest = stratus_device_largest_allocation(context->device);
  return count > 0 && (size_t)count <= largest / sizeof(stratus_brick) && (size_t)voxels <= largest / sizeof(uint64_t) &&
    (size_t)count + 1 <= largest / sizeof(int64_t) && plan->table_size <= largest / sizeof(uint32_t);
}

static stratus_status make_buffers(
  stratus_context* context, const density_plan* plan, const stratus_brick* bricks, int64_t count, const int64_t* start, density_buffers* b)
{
  const size_t values = (size_t)(plan->exact ? start[count] : count);
  TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, (size_t)count * sizeof *bricks, bricks, true, &b->bricks));
  TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, plan->table_size * sizeof *plan->table, plan->table, true, &b->table));
  TRY(stratus_device_buffer(context, CL_MEM_READ_WRITE, values * sizeof(uint64_t), NULL, false, &b->sums));
  if (plan->exact) {
    TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, ((size_t)count + 1) * sizeof *start, start, true, &b->start));
    TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, (size_t)plan->row_count * sizeof *plan->rows, plan->rows, true, &b->rows));
  }
  if (plan->exact && stratus_device_is_cpu(context->device)) {
    const size_t side = (size_t)(2 * plan->reach + 1), room = 17 * side * side * sizeof(cl_ulong);
    TRY(stratus_device_buffer(context, CL_MEM_READ_WRITE, groups_of(count) * room, NULL, false, &b->rooms));
  }
  return STRATUS_OK;
}

static stratus_status run_sums(stratus_context* context, const density_plan* plan, int64_t count, const density_buffers* b)
{
  const cl_ulong bricks = (cl_ulong)count;
  const size_t side = (size_t)(STRATUS_BRICK * (2 * plan->reach + 1));
  const stratus_kernel_argument exact[] = { ARGUMENT(b->bricks), ARGUMENT(bricks), ARGUMENT(b->start), ARGUMENT(plan->reach),
    ARGUMENT(plan->radius), ARGUMENT(plan->width), ARGUMENT(plan->row_count), ARGUMENT(b->rows), ARGUMENT(b->table), ARGUMENT(b->sums),
    { side * side * sizeof(cl_ulong), NULL } };
  const stratus_kernel_argument runs[] = { exact[0], exact[1], exact[2], exact[3], exact[4], exact[5], exact[6], exact[7], exact[8],
    exact[9], ARGUMENT(b->rooms) };
  const stratus_kernel_argument binned[] = { ARGUMENT(b->bricks), ARGUMENT(bricks), ARGUMENT(plan->reach), ARGUMENT(b->table),
    ARGUMENT(b->sums) };
  if (plan->exact && stratus_device_is_cpu(context->device)) {
    return stratus_device_launch_groups(context, "density", "", "exact_run", runs, COUNT_OF(runs), groups_of(count), 1);
  }
  /* A brick has a work-group, and each of its 64 places an item. */
  if (plan->exact) {
    const int64_t items[3] = { count * STRATUS_DEVICE_GROUP, 1, 1 };
    return stratus_device_launch(context, "density", "", "exact", exact, COUNT_OF(exact), items);
  }
  /* A processor has few items at work, and saves searches by longer runs. */
  const int run = stratus_device_is_cpu(context->device) ? 16 : 1;
  return stratus_device_launch(context, "density", run == 16 ? "-DRUN=16" : "-DRUN=1", "binned", binned, COUNT_OF(binned),
    (const int64_t[]){ (count + run - 1) / run, 1, 1 });
}

stratus_status stratus_device_density(
  stratus_context* context, const density_plan* plan, const stratus_brick* bricks, int64_t count, const int64_t* start, uint64_t* sums)
{
  stratus_status status = STRATUS_OK;
  density_buffers b = { .bricks = NULL };
  TRY_CLEANUP(make_buffers(context, plan, bricks, count, start, &b));
  TRY_CLEANUP(run_sums(context, plan, count, &b));
  TRY_CLEANUP(stratus_device_read(context, b.sums, 0, (size_t)(plan->exact ? start[count] : count) * sizeof *sums, sums));

cleanup:
  stratus_device_buffer_release(b.bricks);
  stratus_device_buffer_release(b.start);
  stratus_device_buffer_release(b.rows);
  stratus_device_buffer_release(b.table);
  stratus_device_buffer_release(b.sums);
  stratus_device_buffer_release(b.rooms);
  return status;
}
