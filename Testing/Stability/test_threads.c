/* SPDX-License-Identifier: BSD-3-Clause
 * Several contexts at once in several threads, over the same voxels, meshes and volumes, and calls that the caller cancels at any point:
 * the next try has the same bits. The preset `threads` builds it under the thread sanitizer, which also sees races that change no bit.
 *
 * STRATUS_LONG=1 cancels at each of the reports of progress, and goes on for more rounds. */
#define _POSIX_C_SOURCE 200809L
#include "calibration.h"
#include "device_jobs.h"
#include "testing.h"

#include <pthread.h>
#include <stdatomic.h>

#define CONTEXTS 4
#define JOBS COUNT_OF(device_jobs)

static uint64_t right[JOBS];

typedef struct cancelling {
  int64_t calls, at; /* number of the report that cancels, from 0; negative: none */
  const char* stage; /* of the report that cancelled */
} cancelling;

static int count_progress(void* user, const char* stage, double fraction)
{
  cancelling* c = user;
  (void)fraction;
  c->stage = c->calls == c->at ? stage : c->stage;
  return c->calls++ == c->at;
}

static stratus_context* open_context(cancelling* c, int threads)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  options.threads = threads;
  options.progress = c ? count_progress : NULL;
  options.progress_user = c;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

static stratus_status run_job(stratus_context* context, const device_job* job, void** kept, uint64_t* sum)
{
  *sum = 0;
  if (job->open && !*kept) {
    const stratus_status status = job->open(context, job->number, kept);
    if (status != STRATUS_OK) {
      return status;
    }
  }
  return job->run(context, job->number, *kept, sum);
}

static void close_job(const device_job* job, void* kept)
{
  if (kept) {
    job->close(kept);
  }
}

static int find_right(void** state)
{
  stratus_context* context = open_context(NULL, 1);
  (void)state;
  for (size_t j = 0; j < JOBS; ++j) {
    void* kept = NULL;
    assert_int_equal(run_job(context, device_jobs + j, &kept, right + j), STRATUS_OK);
    close_job(device_jobs + j, kept);
  }
  stratus_context_destroy(context);
  return 0;
}

/* ---- at once */

typedef struct worker {
  pthread_t thread;
  int number, rounds;
  int64_t cancelled;
  char wrong[1200]; /* the first failure; assertions are for the test's thread */
} worker;

static pthread_barrier_t begin;

static void work_once(worker* w, stratus_context* context, cancelling* c, size_t j, uint32_t* random)
{
  const device_job* job = device_jobs + j;
  void* kept = NULL;
  uint64_t sum = 0;
  c->calls = 0;
  c->at = (int64_t)(next_random(random) % 12);
  stratus_status status = run_job(context, job, &kept, &sum);
  w->cancelled += status == STRATUS_CANCELLED;
  const stratus_status first = status;
  c->at = -1;
  if (first == STRATUS_CANCELLED) {
    status = run_job(context, job, &kept, &sum);
  }
  if ((status != STRATUS_OK || sum != right[j]) && !w->wrong[0]) {
    snprintf(w->wrong, sizeof w->wrong, "%s %d: %s, then %s, %s bits: %.1000s", job->name, job->number, stratus_status_name(first),
      stratus_status_name(status), sum == right[j] ? "the same" : "other", stratus_context_message(context));
  }
  close_job(job, kept);
}

static void* work(void* argument)
{
  worker* w = argument;
  cancelling c = { .at = -1 };
  uint32_t random = (uint32_t)w->number;
  pthread_barrier_wait(&begin);
  for (int round = 0; round < w->rounds; ++round) {
    stratus_context* context = open_context(&c, 1 + (w->number + round) % 3);
    (void)stratus_device_count();
    for (size_t j = 0; j < JOBS; ++j) {
      work_once(w, context, &c, (j * 5 + (size_t)w->number * 7) % JOBS, &random); /* 5 and the number of jobs have no common divisor */
    }
    stratus_context_destroy(context);
  }
  return NULL;
}

static void contexts_in_threads_make_the_same_bits(void** state)
{
  static worker workers[CONTEXTS];
  int64_t cancelled = 0;
  (void)state;
  assert_true(JOBS % 5 != 0);
  pthread_barrier_init(&begin, NULL, CONTEXTS);
  for (int t = 0; t < CONTEXTS; ++t) {
    workers[t] = (worker){ .number = t, .rounds = long_run() ? 20 : 1 };
    assert_int_equal(pthread_create(&workers[t].thread, NULL, work, workers + t), 0);
  }
  for (int t = 0; t < CONTEXTS; ++t) {
    pthread_join(workers[t].thread, NULL);
    assert_string_equal(workers[t].wrong, "");
    cancelled += workers[t].cancelled;
  }
  pthread_barrier_destroy(&begin);
  print_message("%d contexts, %d cancelled calls\n", CONTEXTS, (int)cancelled);
  assert_true(cancelled > CONTEXTS);
}

/* ---- costs */

static atomic_int measuring, measured, together;

static stratus_status measure(stratus_context* context, void* job, double* numbers)
{
  (void)context;
  (void)job;
  together += ++measuring > 1;
  ++measured;
  numbers[0] = 3.0;
  --measuring;
  return STRATUS_OK;
}

static void* ask_for_costs(void* argument)
{
  stratus_context* context = open_context(NULL, 1);
  double* sum = argument;
  pthread_barrier_wait(&begin);
  for (int i = 0; i < 40; ++i) {
    char part[16];
    snprintf(part, sizeof part, "part %d", i % 4);
    stratus_calibration c = stratus_calibration_of("host", part, 1);
    *sum += stratus_calibrate(context, &c, measure, NULL) == STRATUS_OK ? c.numbers[0] : -1000.0;
  }
  stratus_context_destroy(context);
  return NULL;
}

/* Threads that need a cost at the same time: one measures it, and the others use its numbers. */
static void costs_are_measured_once(void** state)
{
  pthread_t threads[CONTEXTS];
  double sums[CONTEXTS] = { 0.0 };
  (void)state;
  stratus_calibration_forget();
  pthread_barrier_init(&begin, NULL, CONTEXTS);
  for (int t = 0; t < CONTEXTS; ++t) {
    assert_int_equal(pthread_create(threads + t, NULL, ask_for_costs, sums + t), 0);
  }
  for (int t = 0; t < CONTEXTS; ++t) {
    pthread_join(threads[t], NULL);
    assert_true(sums[t] == 40 * 3.0);
  }
  pthread_barrier_destroy(&begin);
  stratus_calibration_forget();
  assert_int_equal(measured, 4);
  assert_int_equal(together, 0);
}

/* ---- cancelled */

static void a_call_that_is_cancelled_anywhere_has_the_same_bits_next(void** state)
{
  cancelling c = { .at = -1 };
  stratus_context* context = open_context(&c, 2);
  int64_t tries = 0, cancelled = 0;
  (void)state;
  for (size_t j = 0; j < JOBS; ++j) {
    const device_job* job = device_jobs + j;
    uint64_t sum = 0;
    void* kept = NULL;
    c = (cancelling){ .at = -1 };
    assert_int_equal(run_job(context, job, &kept, &sum), STRATUS_OK);
    assert_true(sum == right[j]);
    close_job(job, kept);
    const int64_t reports = c.calls, step = long_run() || reports < 6 ? 1 : reports / 6;
    for (int64_t at = 0; at < reports; at += step, ++tries) {
      kept = NULL;
      c = (cancelling){ .at = at };
      const stratus_status status = run_job(context, job, &kept, &sum);
      c.at = -1;
      /* Where times decide, such as between structures, another run may have fewer reports. */
      const stratus_status expected = c.stage ? STRATUS_CANCELLED : STRATUS_OK;
      cancelled += c.stage != NULL;
      assert_true(c.stage || at > 0); /* every run has the first report */
      if (status != expected || run_job(context, job, &kept, &sum) != STRATUS_OK || sum != right[j]) {
        fail_msg("%s %d cancelled at report %d of %d (%s): %s, then %s bits", job->name, job->number, (int)at, (int)reports,
          c.stage ? c.stage : "none", stratus_status_name(status), sum == right[j] ? "the same" : "other");
      }
      close_job(job, kept);
    }
  }
  print_message("cancelled %d times of %d\n", (int)cancelled, (int)tries);
  assert_true(cancelled > 30);
  stratus_context_destroy(context);
}

int test_threads(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(contexts_in_threads_make_the_same_bits),
    cmocka_unit_test(costs_are_measured_once),
    cmocka_unit_test(a_call_that_is_cancelled_anywhere_has_the_same_bits_next),
  };
  if (setenv("STRATUS_CACHE_DIR", "", 1) != 0) {
    return 1;
  }
  jobs_prepare();
  const int failed = cmocka_run_group_tests(tests, find_right, NULL);
  jobs_release();
  return failed;
}
