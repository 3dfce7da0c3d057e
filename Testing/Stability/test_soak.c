/* SPDX-License-Identifier: BSD-3-Clause
 * Random edits for long: pictures of changed volumes, functions, settings and meshes by casters that live on, structures built and dropped,
 * contexts made and destroyed, on the host and on a device. Memory, open files, threads and files in folders do not grow, and a caster
 * that has seen many edits draws a new caster's picture.
 *
 * Testing/run takes some hundred edits. STRATUS_LONG=1 goes on for an hour, or for as many seconds as STRATUS_SOAK_SECONDS says. */
#define _XOPEN_SOURCE 700
#include "device_jobs.h"
#include "faulty_allocator.h"
#include "testing.h"

#include <dirent.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define ROUND 40  /* edits with the same objects */
#define CONTEXT 4 /* rounds with the same context */
#define ROUNDS 4  /* without STRATUS_LONG */
#define SAMPLES_MAX 4000
#define GROWTH_PAGES 2048 /* that the allocator's fragments may take, 8 MiB */

/* The process's resources after a round, with its casters destroyed. */
typedef struct holding {
  int64_t edits, pages, files, threads, entries, live;
} holding;

static holding holdings[SAMPLES_MAX];
static char folder[64];

static int64_t entries_of(const char* path)
{
  int64_t count = 0;
  DIR* opened = opendir(path);
  assert_non_null(opened);
  while (readdir(opened)) {
    ++count;
  }
  closedir(opened);
  return count - 2; /* the folder itself and its parent are listed, too */
}

static holding look(int64_t edits, const faulty_allocator* allocator)
{
  long pages = 0;
  FILE* file = fopen("/proc/self/statm", "r");
  assert_non_null(file);
  assert_int_equal(fscanf(file, "%*d %ld", &pages), 1);
  fclose(file);
  /* The listing itself has one file open. */
  return (holding){ edits, pages, entries_of("/proc/self/fd") - 1, entries_of("/proc/self/task"), entries_of(folder), allocator->live };
}

/* ---- edits */

typedef struct soak {
  stratus_context* context;
  stratus_ray_caster* caster;
  stratus_tetra_caster* tetra;
  double opacity[8];
  stratus_transfer transfer;
  uint32_t random;
} soak;

static double some(soak* s)
{
  return (double)(next_random(&s->random) & 0xffff) / 65536.0;
}

static void change_function(soak* s)
{
  double at = 1e6;
  for (int p = 0; p < 4; ++p) {
    s->opacity[2 * p] = at;
    s->opacity[2 * p + 1] = p % 3 == 0 ? 0.0 : some(s);
    at += 0.05 + 0.3 * some(s);
  }
  s->transfer = jobs_data.scene.transfer;
  s->transfer.opacity = s->opacity;
  s->transfer.opacity_count = 4;
}

static void change_values(soak* s)
{
  small_scene* scene = &jobs_data.scene;
  for (int i = 0; i < 20; ++i) {
    scene->values[random_below(&s->random, SMALL_VALUES)] = random_below(&s->random, 40) == 0 ? NAN : 1e6 + some(s);
  }
  ++scene->volume.revision;
}

static void change_mesh(soak* s)
{
  tetra_case* c = &jobs_data.tetra;
  c->values[random_below(&s->random, c->mesh.point_count)] = (float)some(s);
  ++c->mesh.revision;
}

/* A caster that has seen many edits draws what a new one draws. */
static void compare_with_new(soak* s, int setting)
{
  uint64_t sum = 0;
  const uint64_t colors = job_colors;
  stratus_ray_caster* fresh = NULL;
  assert_int_equal(stratus_ray_caster_create(s->context, &fresh), STRATUS_OK);
  assert_int_equal(job_draw(fresh, &s->transfer, setting, &sum), STRATUS_OK);
  assert_true(job_colors == colors);
  stratus_ray_caster_destroy(fresh);
}

static void edit(soak* s)
{
  uint64_t sum = 0;
  stratus_status status = STRATUS_OK;
  switch (random_below(&s->random, 8)) {
    case 0:
      change_function(s);
      break;
    case 1:
      change_values(s);
      break;
    case 2:
      change_mesh(s);
      status = job_tetra(s->context, (int)random_below(&s->random, 2), s->tetra, &sum);
      break;
    case 3: {
      const device_job* job = device_jobs + random_below(&s->random, (int64_t)COUNT_OF(device_jobs));
      void* kept = NULL;
      status = job->open ? job->open(s->context, job->number, &kept) : STRATUS_OK;
      status = status == STRATUS_OK ? job->run(s->context, job->number, kept, &sum) : status;
      if (kept) {
        job->close(kept);
      }
      break;
    }
    default: {
      const int setting = (int)random_below(&s->random, SMALL_SETTINGS);
      status = job_draw(s->caster, &s->transfer, setting, &sum);
      if (status == STRATUS_OK && random_below(&s->random, 6) == 0) {
        compare_with_new(s, setting);
      }
    }
  }
  if (status != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(s->context));
  }
}

static stratus_context* open_context(faulty_allocator* allocator, const char* device, int threads)
{
  stratus_context* context = NULL;
  stratus_context_options options = faulty_options(allocator, device);
  options.threads = threads;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  if (context->device) {
    context->device->is_cpu = false; /* it builds structures, too */
  }
  return context;
}

static void round_of_edits(soak* s)
{
  assert_int_equal(stratus_ray_caster_create(s->context, &s->caster), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_create(s->context, &s->tetra), STRATUS_OK);
  change_function(s);
  for (int e = 0; e < ROUND; ++e) {
    edit(s);
  }
  stratus_ray_caster_destroy(s->caster);
  stratus_tetra_caster_destroy(s->tetra);
}

/* ---- the run */

static double seconds_now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double seconds_asked(void)
{
  const char* value = getenv("STRATUS_SOAK_SECONDS");
  return value ? strtod(value, NULL) : long_run() ? 3600.0 : 0.0;
}

static void print_holding(const holding* h)
{
  print_message("%9lld edits: %6.1f MiB, %lld files open, %lld threads, %lld files in the folder, %lld allocations\n", (long long)h->edits,
    (double)h->pages * (double)sysconf(_SC_PAGESIZE) / 1048576.0, (long long)h->files, (long long)h->threads, (long long)h->entries,
    (long long)h->live);
}

static int compare_pages(const void* a, const void* b)
{
  const int64_t d = ((const holding*)a)->pages - ((const holding*)b)->pages;
  return (d > 0) - (d < 0);
}

static int64_t median_pages(const holding* from, int count)
{
  static holding sorted[SAMPLES_MAX];
  memcpy(sorted, from, (size_t)count * sizeof *from);
  qsort(sorted, (size_t)count, sizeof *sorted, compare_pages);
  return sorted[count / 2].pages;
}

/* Returns whether pages show growth. A few edits do not exceed the libraries' own set-up, and the address sanitizer holds back freed
 * memory; the counts of allocations, files and threads show growth in any case. */
static bool pages_show_growth(void)
{
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
  return false;
#endif
#endif
  return seconds_asked() > 0.0;
}

/* The last quarter holds no more than the second, which comes after what is made once. */
static void assert_no_growth(int count)
{
  const int quarter = count / 4;
  holding most = { 0 };
  for (int i = quarter; i < 2 * quarter; ++i) {
    most.files = holdings[i].files > most.files ? holdings[i].files : most.files;
    most.threads = holdings[i].threads > most.threads ? holdings[i].threads : most.threads;
    most.entries = holdings[i].entries > most.entries ? holdings[i].entries : most.entries;
  }
  for (int i = count - quarter; i < count; ++i) {
    assert_true(holdings[i].files <= most.files && holdings[i].threads <= most.threads && holdings[i].entries <= most.entries);
  }
  const int64_t early = median_pages(holdings + quarter, quarter), late = median_pages(holdings + count - quarter, quarter);
  if (pages_show_growth() && late > early + GROWTH_PAGES) {
    fail_msg("%lld pages in the second quarter, %lld in the last", (long long)early, (long long)late);
  }
}

static void nothing_grows(void** state)
{
  const char* device = *state;
  const double seconds = seconds_asked() / 2.0, start = seconds_now();
  faulty_allocator allocator = { 0 };
  soak s = { .random = 9 };
  int count = 0, keep_every = 1;
  int64_t rounds = 0;
  for (; rounds < ROUNDS || seconds_now() - start < seconds; ++rounds) {
    if (!s.context) {
      s.context = open_context(&allocator, device, 1 + (int)(rounds / CONTEXT % 2));
    }
    round_of_edits(&s);
    if (rounds % CONTEXT == CONTEXT - 1) {
      stratus_context_destroy(s.context);
      s.context = NULL;
      assert_int_equal(allocator.live, 0);
    }
    if (rounds % keep_every == 0) {
      if (count == SAMPLES_MAX) { /* half of them, twice as far apart */
        for (int i = 0; i < SAMPLES_MAX / 2; ++i) {
          holdings[i] = holdings[2 * i];
        }
        count /= 2;
        keep_every *= 2;
      }
      holdings[count++] = look((rounds + 1) * ROUND, &allocator);
    }
  }
  stratus_context_destroy(s.context);
  assert_int_equal(allocator.live, 0);
  for (int i = 0; i < 9; ++i) {
    print_holding(holdings + (count - 1) * i / 8);
  }
  assert_no_growth(count);
}

int test_soak(void)
{
  static char host[] = "host", first[] = "0";
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(nothing_grows, host),
    cmocka_unit_test_prestate(nothing_grows, first),
  };
  snprintf(folder, sizeof folder, "/tmp/stratus-soak-XXXXXX");
  if (!mkdtemp(folder) || setenv("STRATUS_CACHE_DIR", folder, 1) != 0) {
    return 1;
  }
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  jobs_prepare();
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  jobs_release();
  return failed | rmdir(folder);
}
