/* SPDX-License-Identifier: BSD-3-Clause
 * stratus-fuzz: random values for the public structs of the core, with every buffer at a guard page. A child process works through cases.
 * This process sees how the child dies, reports the case, and continues after it. */
#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE
#include "fuzz.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define FINDINGS_MOST 40 /* findings of one kind after which the run stops, since more add no information */

typedef struct run {
  const char *program, *device;
  uint64_t seed, first, count;
  double seconds;
  bool here;
} run;

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Runs cases from `first` on until the time is over or `end` is reached. */
static void work(const run* r, const char* kind, fuzz_tally* tally, uint64_t first, uint64_t end, double until)
{
  fuzz f = { .kind = kind, .program = r->program, .device = r->device, .seed = r->seed, .tally = tally, .here = r->here };
  for (uint64_t number = first; number < end && (number == r->first || r->seconds <= 0.0 || now() < until); ++number) {
    fuzz_run_case(&f, number);
  }
  free(f.blocks);
}

static void report_death(const run* r, const char* kind, fuzz_tally* tally, int status)
{
  ++tally->findings;
  if (!tally->reported) {
    const bool slow = WIFSIGNALED(status) && (WTERMSIG(status) == SIGPROF || WTERMSIG(status) == SIGALRM);
    fprintf(stderr,
      "FINDING in %s, case %" PRIu64 ": %s %d\n  in %s\n  %s; odd:%s\n  again: %s %s 0 %" PRIu64 " device=%s case=%" PRIu64 "\n", kind,
      tally->number,
      slow                    ? "a call that does not end, signal"
        : WIFSIGNALED(status) ? "signal"
                              : "exit status",
      WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status), tally->call ? tally->call : "nothing", tally->about, tally->odd,
      r->program, kind, r->seed, r->device, tally->number);
  }
  tally->reported = false;
}

static void supervise(const run* r, const char* kind, fuzz_tally* tally, double seconds)
{
  const double until = now() + seconds;
  uint64_t first = r->first;
  const uint64_t end = r->count > 0 ? first + r->count : UINT64_MAX;
  while (tally->findings < FINDINGS_MOST && first < end) {
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
      work(r, kind, tally, first, end, until);
      exit(EXIT_SUCCESS); /* exit() also runs the leak check */
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child) {
      perror("stratus-fuzz");
      exit(EXIT_FAILURE);
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS) {
      return;
    }
    report_death(r, kind, tally, status);
    first = tally->number + 1;
    if (r->seconds > 0.0 && now() >= until) {
      return;
    }
  }
}

static void print_tallies(const fuzz_tally* tallies, const char* only)
{
  printf("%-11s %9s %10s %9s %9s %8s %9s %9s %9s %9s %9s %8s %9s %9s\n", "kind", "cases", "calls", "pictures", "objects", "bytes",
    "compared", "buffers", "ok", "refused", "overflow", "memory", "cancelled", "findings");
  fuzz_tally all = { 0 };
  for (int k = 0; k <= fuzz_kind_count; ++k) {
    const fuzz_tally* t = k < fuzz_kind_count ? tallies + k : &all;
    if (k < fuzz_kind_count && only && strcmp(only, fuzz_kinds[k].name) != 0) {
      continue;
    }
    printf("%-11s %9" PRIu64 " %10" PRIu64 " %9" PRIu64 " %9" PRIu64 " %8" PRIu64 " %9" PRIu64 " %9" PRIu64 " %9" PRIu64 " %9" PRIu64
           " %9" PRIu64 " %8" PRIu64 " %9" PRIu64 " %9" PRIu64 "\n",
      k < fuzz_kind_count ? fuzz_kinds[k].name : "all", t->cases, t->calls, t->pictures, t->objects, t->byte_strings, t->compared,
      t->buffers, t->statuses[STRATUS_OK], t->statuses[STRATUS_INVALID_ARGUMENT] + t->statuses[STRATUS_UNSUPPORTED],
      t->statuses[STRATUS_OVERFLOW], t->statuses[STRATUS_OUT_OF_MEMORY], t->statuses[STRATUS_CANCELLED], t->findings);
    uint64_t* sums = (uint64_t*)&all.cases;
    const uint64_t* terms = &t->cases;
    for (size_t i = 0; k < fuzz_kind_count && i <= (size_t)(&t->findings - &t->cases); ++i) {
      sums[i] += terms[i];
    }
  }
}

static int usage(void)
{
  fprintf(stderr,
    "stratus-fuzz KIND SECONDS SEED [count=N] [first=N] [case=N] [device=NAME]\n"
    "  KIND: all, which shares the seconds out");
  for (int k = 0; k < fuzz_kind_count; ++k) {
    fprintf(stderr, ", %s", fuzz_kinds[k].name);
  }
  fprintf(stderr,
    "\n  SECONDS 0: until count=N cases of each kind are done\n"
    "  case=N: only that case, in this process, for a debugger\n"
    "  device=NAME: of the contexts; default host\n"
    "Exit status: 0 without a finding, 1 with one, 2 for other arguments.\n");
  return 2;
}

static bool read_word(run* r, const char* word)
{
  uint64_t number = 0;
  if (strncmp(word, "device=", 7) == 0) {
    r->device = word + 7;
  } else if (sscanf(word, "count=%" SCNu64, &number) == 1) {
    r->count = number;
  } else if (sscanf(word, "first=%" SCNu64, &number) == 1) {
    r->first = number;
  } else if (sscanf(word, "case=%" SCNu64, &number) == 1) {
    r->first = number;
    r->count = 1;
    r->here = true;
  } else {
    return false;
  }
  return true;
}

int main(int argc, char** argv)
{
  /* OpenMP reads the variable before main(). Waiting threads must sleep, as there are thousands of small parallel regions. */
  if (!getenv("OMP_WAIT_POLICY")) {
    setenv("OMP_WAIT_POLICY", "passive", 1);
    execv("/proc/self/exe", argv);
  }
  run r = { .program = argv[0], .device = "host" };
  bool good = argc >= 4;
  char* end = NULL;
  if (good) {
    r.seconds = strtod(argv[2], &end);
    good = !*end && r.seconds >= 0.0;
    r.seed = strtoull(argv[3], &end, 10);
    good = good && !*end;
  }
  for (int i = 4; i < argc; ++i) {
    good = good && read_word(&r, argv[i]);
  }
  const char* only = good && strcmp(argv[1], "all") != 0 ? argv[1] : NULL;
  int kinds = 0;
  for (int k = 0; k < fuzz_kind_count; ++k) {
    kinds += !only || strcmp(only, fuzz_kinds[k].name) == 0;
  }
  if (!good || kinds == 0 || (r.seconds <= 0.0 && r.count == 0)) {
    return usage();
  }
  fuzz_tally* tallies = mmap(NULL, sizeof *tallies * (size_t)fuzz_kind_count, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (tallies == MAP_FAILED) {
    perror("stratus-fuzz");
    return EXIT_FAILURE;
  }
  uint64_t findings = 0;
  for (int k = 0; k < fuzz_kind_count; ++k) {
    if (only && strcmp(only, fuzz_kinds[k].name) != 0) {
      continue;
    }
    if (r.here) {
      work(&r, fuzz_kinds[k].name, tallies + k, r.first, r.first + 1, 0.0);
    } else {
      supervise(&r, fuzz_kinds[k].name, tallies + k, r.seconds / kinds);
    }
    findings += tallies[k].findings;
  }
  print_tallies(tallies, only);
  return findings > 0;
}
