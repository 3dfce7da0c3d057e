/* SPDX-License-Identifier: BSD-3-Clause
 * One case: its set-up, its calls, its end. */
#define _XOPEN_SOURCE 700
#include "fuzz.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/time.h>
#include <unistd.h>

/* Limits of a call: seconds of processor time, and of wall time, which a shared machine makes longer. */
#define CALL_SECONDS_OF_PROCESSOR 20
#define CALL_SECONDS 300
#define GARBAGE 0x5a

const fuzz_kind fuzz_kinds[] = {
  { "pictures", fuzz_pictures },
  { "tetra", fuzz_tetra_pictures },
  { "structures", fuzz_structures },
  { "voxels", fuzz_voxels },
  { "trees", fuzz_trees },
  { "octrees", fuzz_octrees },
  { "orders", fuzz_orders },
  { "contexts", fuzz_contexts },
  { "paths", fuzz_paths },
};
const int fuzz_kind_count = (int)(sizeof fuzz_kinds / sizeof *fuzz_kinds);

void fuzz_call_begins(fuzz* f, const char* call)
{
  const struct itimerval processor = { .it_value.tv_sec = CALL_SECONDS_OF_PROCESSOR }, clock = { .it_value.tv_sec = CALL_SECONDS };
  f->tally->call = call;
  ++f->tally->calls;
  if (f->driven) {
    return;
  }
  /* No handler catches the signals, so that the supervisor sees which one it was. */
  setitimer(ITIMER_PROF, &processor, NULL);
  setitimer(ITIMER_REAL, &clock, NULL);
}

stratus_status fuzz_call_ended(fuzz* f, const stratus_context* context, stratus_status status)
{
  EXPECT((unsigned)status < FUZZ_STATUSES, "status %d", (int)status);
  ++f->tally->statuses[status];
  if (status != STRATUS_OK) {
    const char* message = stratus_context_message(context);
    EXPECT(message && strlen(message) > 3 && strlen(message) < 1024, "%s without a message", stratus_status_name(status));
    EXPECT(strcmp(stratus_status_name(status), "unknown status") != 0, "status %d has no name", (int)status);
    EXPECT(status != STRATUS_CANCELLED || f->progress.cancelled > 0, "cancelled by nobody: %s", message);
    EXPECT(status != STRATUS_OUT_OF_MEMORY || f->memory.refused > 0 || !fuzz_is_tame(f), "memory was there: %s", message);
    EXPECT(status != STRATUS_NO_DEVICE && status != STRATUS_DEVICE_ERROR, "%s: %s", stratus_status_name(status), message);
  }
  return status;
}

void fuzz_create_begins(fuzz* f, void* place)
{
  if (place) {
    memset(place, GARBAGE, sizeof(void*));
  }
  (void)f;
}

stratus_status fuzz_created(fuzz* f, void* place, stratus_status status)
{
  void *made = NULL, *nothing;
  memset(&nothing, GARBAGE, sizeof nothing);
  if (place) {
    memcpy(&made, place, sizeof made);
  }
  if (status == STRATUS_OK) {
    EXPECT(made && made != nothing, "ok, but nothing was made");
    ++f->tally->objects;
  } else if (place) {
    EXPECT(made == nothing, "%s, but the place for the object was written", stratus_status_name(status));
    memset(place, 0, sizeof made);
  }
  return status;
}

static void again(const fuzz* f)
{
  fprintf(stderr, "  again: %s %s 0 %llu device=%s case=%llu\n", f->program, f->kind, (unsigned long long)f->seed, f->device,
    (unsigned long long)f->number);
}

void fuzz_about(fuzz* f, const char* format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(f->tally->about, sizeof f->tally->about, format, arguments);
  va_end(arguments);
}

void fuzz_note(fuzz* f, double number)
{
  const size_t length = strlen(f->tally->odd);
  snprintf(f->tally->odd + length, sizeof f->tally->odd - length, " %g", number);
}

void fuzz_finding(fuzz* f, const char* format, ...)
{
  va_list arguments;
  fprintf(stderr, "FINDING in %s, case %llu: ", f->kind, (unsigned long long)f->number);
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  va_end(arguments);
  fprintf(stderr, "\n  after %s\n  %s; odd:%s\n", f->tally->call ? f->tally->call : "nothing", f->tally->about, f->tally->odd);
  again(f);
  fflush(stderr);
  f->tally->reported = true;
  if (f->here) {
    abort();
  }
  _exit(EXIT_FAILURE);
}

void fuzz_trouble(fuzz* f)
{
  if (fuzz_chance(f, 0.5)) {
    f->memory.fail_at = f->memory.calls + 1 + (int64_t)fuzz_below(f, fuzz_chance(f, 0.5) ? 6 : 60);
  } else {
    f->progress.cancel_at = f->progress.calls + 1 + (int64_t)fuzz_below(f, fuzz_chance(f, 0.5) ? 3 : 30);
  }
}

void fuzz_calm(fuzz* f)
{
  f->tally->refused_memory += f->memory.refused;
  f->tally->cancelled += f->progress.cancelled;
  f->memory.refused = f->progress.cancelled = 0;
  f->memory.fail_at = f->progress.cancel_at = 0;
}

void fuzz_run_case(fuzz* f, uint64_t number)
{
  const fuzz_kind* kind = NULL;
  for (int i = 0; i < fuzz_kind_count; ++i) {
    kind = strcmp(fuzz_kinds[i].name, f->kind) == 0 ? fuzz_kinds + i : kind;
  }
  f->number = f->tally->number = number;
  f->random = f->seed * 0xd1342543de82ef95ull + number;
  fuzz_next(f);
  f->random ^= fuzz_next(f);
  f->tally->about[0] = f->tally->odd[0] = '\0';
  f->fields = 0;
  f->odd_at = -1;
  f->oddness = 0;
  f->progress = (fuzz_progress){ 0 };
  switch (fuzz_below(f, 5)) {
    case 0: /* one field only, so that no other refusal comes first */
      f->odd_at = (int)fuzz_below(f, 160);
      break;
    case 1:
      f->oddness = (int)fuzz_scale(f, 20.0, 2000.0);
      break;
    default:
      break;
  }
  f->context = fuzz_context(f, &f->memory);
  kind->run(f);
  fuzz_calm(f);
  fuzz_context_close(f, f->context, &f->memory);
  f->context = NULL;
  fuzz_free_blocks(f);
  ++f->tally->cases;
}
