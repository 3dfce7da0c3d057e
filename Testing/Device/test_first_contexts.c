/* SPDX-License-Identifier: BSD-3-Clause
 * The first contexts of a process, made by several threads at once. A platform's first use happens once a process, so each try is a
 * separate process: this program, run by itself. */
#define _POSIX_C_SOURCE 200809L
#include "small_scene.h"
#include "testing.h"

#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#define THREADS 8
#define TRIES 12
#define TRIES_FEW 4 /* with --few */
#define SECONDS_MOST 120
#define LOOKS_PER_SECOND 50

static pthread_barrier_t begin;

typedef struct work {
  pthread_t thread;
  int devices;
  stratus_status status;
  char message[1024];
  small_picture picture;
} work;

static void* draw_first(void* argument)
{
  work* w = argument;
  small_scene scene;
  stratus_context* context = NULL;
  stratus_ray_caster* caster = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = "0";
  options.threads = 1;
  small_scene_fill(&scene);
  pthread_barrier_wait(&begin);
  w->status = stratus_context_create(&options, &context, w->message, sizeof w->message);
  if (w->status == STRATUS_OK) {
    w->devices = stratus_device_count();
    (void)small_scene_camera(context, &scene);
    (void)stratus_ray_caster_create(context, &caster);
    w->status = small_render(caster, &scene, &scene.transfer, 1, &w->picture, NULL);
    snprintf(w->message, sizeof w->message, "%s", stratus_context_message(context));
  }
  stratus_ray_caster_destroy(caster);
  stratus_context_destroy(context);
  return NULL;
}

/* In the process that is all ours: 0 if every thread found the devices and drew the same picture. */
static int draw_at_once(void)
{
  static work works[THREADS];
  int failed = 0;
  pthread_barrier_init(&begin, NULL, THREADS);
  for (int t = 0; t < THREADS; ++t) {
    pthread_create(&works[t].thread, NULL, draw_first, &works[t]);
  }
  for (int t = 0; t < THREADS; ++t) {
    pthread_join(works[t].thread, NULL);
  }
  for (int t = 0; t < THREADS; ++t) {
    const bool same = works[t].status == STRATUS_OK && works[t].devices == works[0].devices &&
      memcmp(&works[t].picture, &works[0].picture, sizeof works[t].picture) == 0;
    if (!same) {
      fprintf(stderr, "thread %d: %s, %d devices; %s\n", t, stratus_status_name(works[t].status), works[t].devices, works[t].message);
    }
    failed |= !same;
  }
  return failed;
}

static void threads_that_make_the_first_contexts_at_once_all_draw(void** state)
{
  (void)state;
  const int tries = few_run() ? TRIES_FEW : TRIES;
  for (int number = 0; number < tries; ++number) {
    int status = 0;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
      execl(test_program(), test_program(), "test_first_contexts", "--first", (char*)NULL);
      _exit(127);
    }
    for (int waited = 0; waitpid(child, &status, WNOHANG) == 0; ++waited) {
      if (waited == SECONDS_MOST * LOOKS_PER_SECOND) {
        (void)kill(child, SIGABRT);
        (void)waitpid(child, &status, 0);
        fail_msg("try %d of %d: the threads hang after %d s", number, tries, SECONDS_MOST);
      }
      (void)nanosleep(&(struct timespec){ .tv_nsec = 1000000000 / LOOKS_PER_SECOND }, NULL);
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      fail_msg("try %d of %d: %s %d", number, tries, WIFSIGNALED(status) ? "killed by signal" : "exit status",
        WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
    }
  }
}

int test_first_contexts(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(threads_that_make_the_first_contexts_at_once_all_draw) };
  if (test_option("--first")) {
    return draw_at_once();
  }
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
