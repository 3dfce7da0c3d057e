/* SPDX-License-Identifier: BSD-3-Clause
 * stratus-bench-structures [--size PIXELS] [--frames N] [--scenes 0|1] [--only NAMES] [--random N] [--first SEED] [--trees 0|1] [--seconds
 * N]: measures the cost of the automatic structure compared with each fixed one, over the scenes of record and random ones, for still
 * pictures and for orbits, builds included. Lines of CSV, then the ratios of automatic to the best fixed choice, by the clock and by the
 * processor's time. */
#define _POSIX_C_SOURCE 200809L
#define CASE_FULL_SIZE
#include "random_scene.h"

#include "stratus/scenes.h"
#include "stratus/voxels.h"

#include <errno.h>
#include <time.h>

#define STRIDE 10    /* fixed choices draw the first frame of an orbit and every so many-th, which stand for all */
#define HOPELESS 2.5 /* fixed choices draw no orbit whose still pictures take so many times the least */
#define STILLS 5
#define SCENES_MOST 4096

/* Ways to choose: the structures, of blocks of 4, then distances of blocks of other sizes. OFFERED: a tree comes with the data. */
enum { AUTO, NONE, BLOCK, DISTANCE, OCTANT, HYBRID, DISTANCE_2, DISTANCE_8, DISTANCE_16, OFFERED, AUTO_OFFERED, WAYS };

static const struct way {
  const char* name;
  stratus_structure structure;
  int block_size; /* 0: the default */
} ways[WAYS] = { [AUTO] = { "auto", STRATUS_STRUCTURE_AUTO, 0 },
  [NONE] = { "none", STRATUS_STRUCTURE_NONE, 0 },
  [BLOCK] = { "block", STRATUS_STRUCTURE_BLOCK, 0 },
  [DISTANCE] = { "distance", STRATUS_STRUCTURE_DISTANCE, 0 },
  [OCTANT] = { "octant", STRATUS_STRUCTURE_OCTANT, 0 },
  [HYBRID] = { "hybrid", STRATUS_STRUCTURE_HYBRID, 0 },
  [DISTANCE_2] = { "distance of 2", STRATUS_STRUCTURE_DISTANCE, 2 },
  [DISTANCE_8] = { "distance of 8", STRATUS_STRUCTURE_DISTANCE, 8 },
  [DISTANCE_16] = { "distance of 16", STRATUS_STRUCTURE_DISTANCE, 16 },
  [OFFERED] = { "tree", STRATUS_STRUCTURE_HYBRID, 0 },
  [AUTO_OFFERED] = { "auto+tree", STRATUS_STRUCTURE_AUTO, 0 } };

typedef struct cost {
  double wall, cpu; /* milliseconds */
} cost;

typedef struct view {
  const char* name;
  const stratus_volume* volume;
  const stratus_transfer* transfers;
  stratus_camera camera;
  int axis;
  double middle[3];
} view;

typedef struct settings {
  int size, frames, scenes, random, first, trees, seconds;
  const char* only; /* names of scenes; NULL: all */
} settings;

static double clock_ms(clockid_t clock)
{
  struct timespec now;
  clock_gettime(clock, &now);
  return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static void turn(const view* v, double angle, const double from[3], double to[3])
{
  const int a = (v->axis + 1) % 3, b = (v->axis + 2) % 3;
  to[v->axis] = from[v->axis];
  to[a] = cos(angle) * from[a] - sin(angle) * from[b];
  to[b] = sin(angle) * from[a] + cos(angle) * from[b];
}

static stratus_camera camera_at(const view* v, int frame, int frames)
{
  const double angle = 2.0 * 3.14159265358979 * frame / frames;
  stratus_camera camera = v->camera;
  double arm[3], turned[3];
  for (int i = 0; i < 3; ++i) {
    arm[i] = v->camera.eye[i] - v->middle[i];
  }
  turn(v, angle, arm, turned);
  for (int i = 0; i < 3; ++i) {
    camera.eye[i] = v->middle[i] + turned[i];
  }
  turn(v, angle, v->camera.right, camera.right);
  turn(v, angle, v->camera.up, camera.up);
  turn(v, angle, v->camera.forward, camera.forward);
  return camera;
}

static void check(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    fprintf(stderr, "%s: %s\n", stratus_status_name(status), stratus_context_message(context));
    exit(1);
  }
}

static stratus_ray_caster* caster_of(stratus_context* context, int way, const void* tree, size_t tree_size)
{
  stratus_ray_caster* caster;
  check(context, stratus_ray_caster_create(context, &caster));
  if (way == OFFERED || way == AUTO_OFFERED) {
    check(context, stratus_ray_caster_offer_tree(caster, tree, tree_size));
  }
  return caster;
}

static void draw(stratus_context* context, stratus_ray_caster* caster, const view* v, int way, int frame, const settings* s, float* rgba,
  cost* sum, stratus_ray_cast_report* report)
{
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  const stratus_image image = { .width = s->size, .height = s->size, .rgba = rgba };
  const stratus_camera camera = camera_at(v, frame, s->frames);
  options.skipping.structure = ways[way].structure;
  options.skipping.block_size = ways[way].block_size;
  const double wall = clock_ms(CLOCK_MONOTONIC), cpu = clock_ms(CLOCK_PROCESS_CPUTIME_ID);
  check(context, stratus_ray_caster_render(caster, v->volume, v->transfers, &camera, &options, &image, report));
  sum->cpu += clock_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu;
  sum->wall += clock_ms(CLOCK_MONOTONIC) - wall;
}

static int by_wall(const void* a, const void* b)
{
  const double x = ((const cost*)a)->wall, y = ((const cost*)b)->wall;
  return (x > y) - (x < y);
}

static int by_cpu(const void* a, const void* b)
{
  const double x = ((const cost*)a)->cpu, y = ((const cost*)b)->cpu;
  return (x > y) - (x < y);
}

static int by_value(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

/* Ratios of automatic to the best fixed choice: still and orbit, wall and processor. */
static double ratios[2][4][SCENES_MOST];
static int counted[2];

static void* tree_bytes;
static size_t tree_size;

static void make_tree(stratus_context* context, const view* v)
{
  stratus_criterion criterion = stratus_criterion_default();
  stratus_voxels* cells = NULL;
  stratus_tree* tree = NULL;
  criterion.transfer = v->transfers;
  tree_bytes = NULL;
  if (stratus_voxels_create_cells(context, v->volume, &criterion, &cells) == STRATUS_OK) {
    if (stratus_tree_create(context, cells, NULL, &tree) == STRATUS_OK) {
      tree_size = stratus_tree_bytes(tree);
      tree_bytes = malloc(tree_size);
      stratus_tree_save(tree, tree_bytes);
      stratus_tree_destroy(tree);
    }
    stratus_voxels_destroy(cells);
  }
}

static void measure(stratus_context* context, const view* v, const settings* s, float* rgba, bool tree)
{
  cost still[WAYS], orbit[WAYS] = { { 0 } }, stills[WAYS][STILLS];
  stratus_ray_caster* casters[WAYS] = { NULL };
  stratus_ray_cast_report first[WAYS], last[WAYS];
  make_tree(context, v);
  const int count = tree && tree_bytes ? WAYS : OFFERED;
  memset(stills, 0, sizeof stills);
  for (int i = -1; i < STILLS; ++i) {
    for (int way = 0; way < count; ++way) {
      stratus_ray_caster* caster = caster_of(context, way, tree_bytes, tree_size);
      cost ignored = { 0 };
      draw(context, caster, v, way, 0, s, rgba, i < 0 ? &ignored : &stills[way][i], &first[way]);
      stratus_ray_caster_destroy(caster);
    }
  }
  for (int way = 0; way < count; ++way) {
    qsort(stills[way], STILLS, sizeof(cost), by_wall);
    still[way].wall = stills[way][0].wall;
    qsort(stills[way], STILLS, sizeof(cost), by_cpu);
    still[way].cpu = stills[way][0].cpu;
    casters[way] = caster_of(context, way, tree_bytes, tree_size);
  }
  double least = INFINITY;
  for (int way = 0; way < count; ++way) {
    least = fmin(least, still[way].cpu);
  }
  /* The first frame builds, and counts for itself; the later ones that are drawn stand for equal parts of the rest. */
  const int stride = s->frames > STRIDE ? STRIDE : s->frames > 1 ? s->frames - 1 : 1;
  const double weight = s->frames > 1 ? (double)(s->frames - 1) / ((s->frames - 1) / stride) : 0.0;
  for (int frame = 0; frame < s->frames; ++frame) {
    const bool counts = frame % stride == 0;
    for (int way = 0; way < count; ++way) {
      const bool chooses = way == AUTO || way == AUTO_OFFERED;
      if (!chooses && still[way].cpu > HOPELESS * least) {
        orbit[way].wall = orbit[way].cpu = INFINITY;
      } else if (chooses || counts) {
        cost mine = { 0 }, ignored = { 0 };
        if (frame > 0 && !chooses) { /* the caches as an orbit leaves them */
          draw(context, casters[way], v, way, frame - 1, s, rgba, &ignored, &last[way]);
        }
        draw(context, casters[way], v, way, frame, s, rgba, &mine, &last[way]);
        const double share = chooses || frame == 0 ? 1.0 : weight;
        orbit[way].wall += share * mine.wall;
        orbit[way].cpu += share * mine.cpu;
      }
    }
  }
  for (int way = 0; way < count; ++way) {
    stratus_ray_caster_destroy(casters[way]);
    printf("%s,%s,%s,%s,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\n", v->name, ways[way].name, stratus_structure_name(first[way].structure),
      stratus_structure_name(last[way].structure), still[way].wall, still[way].cpu, orbit[way].wall, orbit[way].cpu,
      first[way].structure_ms, first[way].cast_ms, last[way].cast_ms);
  }
  printf("# %s: %s | %s\n", v->name, first[AUTO].why, last[AUTO].why);
  for (int offered = 0; offered < (count == WAYS ? 2 : 1); ++offered) {
    const int mine = offered ? AUTO_OFFERED : AUTO;
    double best[4] = { INFINITY, INFINITY, INFINITY, INFINITY };
    for (int way = NONE; way < (offered ? AUTO_OFFERED : OFFERED); ++way) {
      const double costs[4] = { still[way].wall, still[way].cpu, orbit[way].wall, orbit[way].cpu };
      for (int i = 0; i < 4; ++i) {
        best[i] = fmin(best[i], costs[i]);
      }
    }
    const double costs[4] = { still[mine].wall, still[mine].cpu, orbit[mine].wall, orbit[mine].cpu };
    printf("# %s %s over best:", v->name, ways[mine].name);
    const bool room = counted[offered] < SCENES_MOST; /* more scenes are printed, and left out of the summary */
    for (int i = 0; i < 4; ++i) {
      if (room) {
        ratios[offered][i][counted[offered]] = costs[i] / best[i];
      }
      printf(" %.3f", costs[i] / best[i]);
    }
    counted[offered] += room;
    printf("\n");
  }
  fflush(stdout);
  free(tree_bytes);
}

static view view_of(const char* name, stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfers)
{
  view v = { .name = name, .volume = volume, .transfers = transfers, .axis = 2 };
  double bounds[6];
  check(context, stratus_volume_bounds(context, volume, bounds));
  for (int i = 0; i < 3; ++i) {
    v.middle[i] = 0.5 * (bounds[2 * i] + bounds[2 * i + 1]);
  }
  return v;
}

static void measure_scene(stratus_context* context, const char* name, const settings* s, float* rgba)
{
  stratus_scene* scene;
  double bounds[6];
  check(context, stratus_scene_create(context, name, &scene));
  view v = view_of(name, context, &scene->volume, scene->transfers);
  v.axis = scene->up_axis;
  check(context, stratus_volume_bounds(context, &scene->volume, bounds));
  check(context, stratus_scene_camera(context, bounds, scene->up_axis, 0, 0, 1.0, &v.camera));
  measure(context, &v, s, rgba, scene->volume.components <= 1 && s->trees != 0);
  stratus_scene_destroy(context, scene);
}

static void measure_random(stratus_context* context, int seed, const settings* s, float* rgba)
{
  random_scene scene;
  char name[96];
  random_scene_create(context, (uint32_t)seed, 1.0, &scene);
  snprintf(name, sizeof name, "%d %s", seed, scene.kind);
  view v = view_of(name, context, &scene.volume, &scene.transfer);
  v.camera = scene.camera;
  measure(context, &v, s, rgba, s->trees != 0);
  random_scene_destroy(&scene);
}

static void summary(void)
{
  static const char* const names[] = { "still, wall", "still, processor", "orbit, wall", "orbit, processor" };
  for (int offered = 0; offered < 2; ++offered) {
    const int n = counted[offered];
    for (int i = 0; i < 4 && n > 0; ++i) {
      double* r = ratios[offered][i];
      qsort(r, (size_t)n, sizeof(double), by_value);
      printf("# %s: %s over best fixed, %d scenes: median %.3f, 90 %% %.3f, 98 %% %.3f, worst %.3f\n", names[i],
        ways[offered ? AUTO_OFFERED : AUTO].name, n, r[n / 2], r[n * 9 / 10], r[n * 98 / 100], r[n - 1]);
    }
  }
}

/* Sets an option. Returns false, with a message, if there is none of this name or if its value is not a number in its range. */
static bool set_option(settings* s, const char* name, const char* value)
{
  const struct {
    const char* name;
    int *number, least, most;
  } numbers[] = { { "--size", &s->size, 1, 8192 }, { "--frames", &s->frames, 1, 100000 }, { "--scenes", &s->scenes, 0, 1 },
    { "--random", &s->random, 0, 1000000 }, { "--first", &s->first, 0, 1000000 }, { "--trees", &s->trees, 0, 1 },
    { "--seconds", &s->seconds, 0, 1 << 30 } };
  const size_t count = sizeof numbers / sizeof *numbers;
  char* end = NULL;
  size_t i = 0;
  if (!strcmp(name, "--only") && value) {
    s->only = value;
    return true;
  }
  while (i < count && strcmp(name, numbers[i].name) != 0) {
    ++i;
  }
  if (i == count || !value) {
    const bool known = i < count || !strcmp(name, "--only");
    fprintf(stderr, "%s%s: options, each with a value, are --only", name, known ? " has no value" : " is no option");
    for (size_t k = 0; k < count; ++k) {
      fprintf(stderr, ", %s", numbers[k].name);
    }
    fprintf(stderr, "\n");
    return false;
  }
  errno = 0;
  const long number = strtol(value, &end, 10);
  if (end == value || *end || errno || number < numbers[i].least || number > numbers[i].most) {
    fprintf(stderr, "%s %s, must be %d..%d\n", name, value, numbers[i].least, numbers[i].most);
    return false;
  }
  *numbers[i].number = (int)number;
  return true;
}

int main(int argc, char** argv)
{
  settings s = { .size = 256, .frames = 100, .scenes = 1, .random = 200, .trees = 1, .seconds = 1 << 30 };
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context;
  for (int i = 1; i < argc; i += 2) {
    if (!set_option(&s, argv[i], i + 1 < argc ? argv[i + 1] : NULL)) {
      return 2;
    }
  }
  if (stratus_context_create(&options, &context, NULL, 0) != STRATUS_OK) {
    return 1;
  }
  float* rgba = malloc(4 * sizeof(float) * (size_t)s.size * (size_t)s.size);
  printf("scene,way,first,last,still_ms,still_cpu_ms,orbit_ms,orbit_cpu_ms,structure_ms,first_cast_ms,last_cast_ms\n");
  for (int i = 0; s.scenes && i < stratus_scene_count(); ++i) {
    const char* const name = stratus_scene_name(i);
    if (s.only ? strstr(s.only, name) != NULL : strcmp(name, "archipelago-1024") != 0) { /* which takes 1 GiB */
      measure_scene(context, name, &s, rgba);
    }
  }
  const double until = clock_ms(CLOCK_MONOTONIC) + 1e3 * s.seconds;
  for (int i = s.first; i < s.first + s.random && clock_ms(CLOCK_MONOTONIC) < until; ++i) {
    measure_random(context, i, &s, rgba);
  }
  summary();
  free(rgba);
  stratus_context_destroy(context);
  return 0;
}
