/* SPDX-License-Identifier: BSD-3-Clause
 * All work of the core on a device or on the host, as jobs: a job returns one number that depends on every bit of its result. */
#ifndef STRATUS_TESTING_DEVICE_JOBS_H
#define STRATUS_TESTING_DEVICE_JOBS_H

#include "density.h"
#include "device_choice.h"
#include "device_state.h"
#include "mesh_case.h"
#include "small_scene.h"
#include "tetra_case.h"
#include "voxel_sets.h"

#define JOB_RAYS 40

/* The jobs' input, made on the host. */
typedef struct job_data {
  stratus_context* host;
  small_scene scene;
  voxel_set set;
  stratus_voxels* voxels;
  tetra_case tetra;
  mesh_case mesh;
  stratus_ray rays[JOB_RAYS];
} job_data;

static job_data jobs_data; /* jobs only read it, in any thread */
/* Sum of the thread's last picture of a volume without its counts of samples, which depend on the structure. */
static _Thread_local uint64_t job_colors;

typedef struct device_job {
  const char* name;
  int number; /* setting of the picture, method of the tree or field */
  /* Makes what the job keeps from try to try. NULL: nothing. */
  stratus_status (*open)(stratus_context* context, int number, void** kept);
  void (*close)(void* kept);
  /* Drawn without a fault before the job, and again after a job that failed. NULL: nothing. */
  stratus_status (*before)(stratus_context* context, int number, void* kept, uint64_t* sum);
  stratus_status (*run)(stratus_context* context, int number, void* kept, uint64_t* sum);
} device_job;

static inline uint64_t job_sum(uint64_t sum, const void* bytes, size_t size)
{
  for (size_t i = 0; i < size; ++i) {
    sum = (sum ^ ((const uint8_t*)bytes)[i]) * 0x100000001b3u;
  }
  return sum;
}

/* Defines what opens a job that keeps a caster. */
#define JOB_OPEN(name, caster)                                                                                                             \
  static stratus_status name(stratus_context* context, int number, void** kept)                                                            \
  {                                                                                                                                        \
    caster* made = NULL;                                                                                                                   \
    (void)number;                                                                                                                          \
    const stratus_status status = caster##_create(context, &made);                                                                         \
    *kept = made;                                                                                                                          \
    return status;                                                                                                                         \
  }

/* ---- pictures of volumes: number is the setting */

JOB_OPEN(job_picture_open, stratus_ray_caster)

static void job_picture_close(void* kept)
{
  stratus_ray_caster_destroy(kept);
}

static stratus_status job_draw(void* caster, const stratus_transfer* transfer, int number, uint64_t* sum)
{
  small_picture picture;
  const stratus_status status = small_render(caster, &jobs_data.scene, transfer, number, &picture, NULL);
  job_colors = job_sum(job_sum(7, picture.rgba, sizeof picture.rgba), picture.depth, sizeof picture.depth);
  *sum = job_sum(job_colors, picture.samples, sizeof picture.samples);
  return status;
}

static stratus_status job_picture(stratus_context* context, int number, void* kept, uint64_t* sum)
{
  (void)context;
  return job_draw(kept, &jobs_data.scene.transfer, number, sum);
}

static stratus_status job_picture_edited(stratus_context* context, int number, void* kept, uint64_t* sum)
{
  (void)context;
  return job_draw(kept, &jobs_data.scene.edited, number, sum);
}

/* ---- structures */

static stratus_status job_structures(stratus_context* context, int number, void* kept, uint64_t* sum)
{
  (void)number;
  (void)kept;
  return small_structures(context, &jobs_data.scene, sum);
}

static stratus_status job_density(stratus_context* context, int exact, void* kept, uint64_t* sum)
{
  const stratus_voxels* voxels = jobs_data.voxels;
  stratus_density* density = NULL;
  (void)kept;
  const stratus_status status = stratus_density_create(context, voxels->bricks, voxels->brick_count, 3.0, exact, &density);
  if (status == STRATUS_OK) {
    *sum = job_sum(7, density->of, sizeof(float) * (size_t)(exact ? voxels->count : voxels->brick_count));
  }
  stratus_density_destroy(density);
  return status;
}

static stratus_status job_field(stratus_context* context, int method, void* kept, uint64_t* sum)
{
  stratus_field_options options = stratus_field_options_default();
  stratus_field* field = NULL;
  const int64_t* n = jobs_data.set.dimensions;
  const size_t bytes = (size_t)(n[0] * n[1] * n[2]) * sizeof(float);
  float* distances = malloc(bytes);
  (void)kept;
  assert_non_null(distances);
  options.method = (stratus_field_method)method;
  options.is_signed = 1;
  const stratus_status status = stratus_field_create(context, jobs_data.voxels, &options, &field, NULL);
  if (status == STRATUS_OK) {
    stratus_field_distances(field, distances);
    *sum = job_sum(7, distances, bytes);
  }
  stratus_field_destroy(field);
  free(distances);
  return status;
}

static stratus_status job_tree(stratus_context* context, int method, void* kept, uint64_t* sum)
{
  stratus_tree_options options = stratus_tree_options_default();
  stratus_tree* tree = NULL;
  (void)kept;
  options.method = (stratus_tree_method)method;
  stratus_status status = stratus_tree_create(context, jobs_data.voxels, &options, &tree);
  if (status == STRATUS_OK) {
    stratus_hit hits[JOB_RAYS];
    void* bytes = malloc(stratus_tree_bytes(tree));
    assert_non_null(bytes);
    memset(hits, 0, sizeof hits);
    status = stratus_tree_first_hit(context, tree, jobs_data.rays, JOB_RAYS, hits);
    for (int i = 0; i < JOB_RAYS && method == STRATUS_TREE_WIDE; ++i) {
      hits[i].visited = 0; /* which depends on how rays share their way */
    }
    stratus_tree_save(tree, bytes);
    *sum = job_sum(job_sum(7, bytes, stratus_tree_bytes(tree)), hits, sizeof hits);
    free(bytes);
  }
  stratus_tree_destroy(tree);
  return status;
}

/* ---- tetrahedra */

JOB_OPEN(job_tetra_open, stratus_tetra_caster)

static void job_tetra_close(void* kept)
{
  stratus_tetra_caster_destroy(kept);
}

static stratus_status job_tetra(stratus_context* context, int mode, void* kept, uint64_t* sum)
{
  tetra_picture p;
  const tetra_case* c = &jobs_data.tetra;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = p.rgba, .depth = p.depth, .samples = p.samples };
  stratus_tetra_options options = c->options;
  (void)context;
  options.mode = (stratus_tetra_mode)mode;
  memset(&p, 0, sizeof p);
  const stratus_status status = stratus_tetra_caster_render(kept, &c->mesh, &c->transfer, &c->camera, &options, &image, NULL);
  *sum = job_sum(7, &p, sizeof p);
  return status;
}

/* Draws the other mode first, so that buffers and kernels are there. */
static stratus_status job_tetra_before(stratus_context* context, int mode, void* kept, uint64_t* sum)
{
  return job_tetra(context, mode == STRATUS_TETRA_MAXIMUM ? STRATUS_TETRA_COMPOSITE : STRATUS_TETRA_MAXIMUM, kept, sum);
}

static stratus_status job_order_open(stratus_context* context, int number, void** kept)
{
  const stratus_mesh mesh = mesh_case_view(&jobs_data.mesh);
  stratus_visibility_order* order = NULL;
  (void)number;
  const stratus_status status = stratus_visibility_order_create(context, &mesh, NULL, &order);
  *kept = order;
  return status;
}

static void job_order_close(void* kept)
{
  stratus_visibility_order_destroy(kept);
}

static stratus_status job_order(stratus_context* context, int number, void* kept, uint64_t* sum)
{
  const stratus_camera camera = { .eye = { -20, 31, 3 + number }, .forward = { 1, 0, 0 } };
  stratus_visibility_result result;
  (void)context;
  const stratus_status status = stratus_visibility_order_sort(kept, &camera, NULL, STRATUS_PEELING_NEAREST, &result);
  if (status == STRATUS_OK) {
    *sum = job_sum(7, result.cells, (size_t)result.count * sizeof *result.cells);
  }
  return status;
}

static stratus_status job_layers(stratus_context* context, int number, void* kept, uint64_t* sum)
{
  const stratus_camera camera = { .eye = { -20, 31, 3 + number }, .forward = { 1, 0, 0 } };
  stratus_visibility_result result;
  (void)context;
  const stratus_status status = stratus_visibility_order_sort(kept, &camera, NULL, STRATUS_PEELING_LAYERS, &result);
  if (status == STRATUS_OK) {
    *sum = job_sum(7, result.cells, (size_t)result.count * sizeof *result.cells);
  }
  return status;
}

static stratus_status job_order_before(stratus_context* context, int number, void* kept, uint64_t* sum)
{
  return job_order(context, number + 7, kept, sum);
}

/* ---- the list */

#define JOB_PICTURE(number)                                                                                                                \
  {                                                                                                                                        \
    "first picture", number, job_picture_open, job_picture_close, NULL, job_picture                                                        \
  }
#define JOB_EDIT(number)                                                                                                                   \
  {                                                                                                                                        \
    "edited picture", number, job_picture_open, job_picture_close, job_picture, job_picture_edited                                         \
  }
#define JOB_BUILD(name, number, run)                                                                                                       \
  {                                                                                                                                        \
    name, number, NULL, NULL, NULL, run                                                                                                    \
  }

static const device_job device_jobs[] = {
  JOB_PICTURE(0),
  JOB_PICTURE(1),
  JOB_PICTURE(2),
  JOB_PICTURE(3),
  JOB_PICTURE(4),
  JOB_PICTURE(5),
  JOB_PICTURE(6),
  JOB_PICTURE(7),
  JOB_PICTURE(8),
  JOB_PICTURE(9),
  JOB_PICTURE(10),
  JOB_PICTURE(11),
  JOB_PICTURE(12),
  JOB_EDIT(0),
  JOB_EDIT(3),
  JOB_EDIT(4),
  JOB_EDIT(6),
  JOB_EDIT(11),
  JOB_EDIT(12),
  JOB_BUILD("structures", 0, job_structures),
  JOB_BUILD("density of bricks", 0, job_density),
  JOB_BUILD("density of voxels", 1, job_density),
  JOB_BUILD("exact field", STRATUS_FIELD_EXACT, job_field),
  JOB_BUILD("flooded field", STRATUS_FIELD_JFA, job_field),
  JOB_BUILD("adaptively flooded field", STRATUS_FIELD_AJFA, job_field),
  JOB_BUILD("hybrid tree", STRATUS_TREE_HYBRID, job_tree),
  JOB_BUILD("hybrid tree of the paper", STRATUS_TREE_HYBRID_PAPER, job_tree),
  JOB_BUILD("octant tree", STRATUS_TREE_OCTANT, job_tree),
  JOB_BUILD("tree of boxes", STRATUS_TREE_LBVH, job_tree),
  JOB_BUILD("wide hierarchy", STRATUS_TREE_WIDE, job_tree),
  JOB_BUILD("tree of clustered boxes", STRATUS_TREE_PLOC, job_tree),
  { "tetrahedra", STRATUS_TETRA_COMPOSITE, job_tetra_open, job_tetra_close, NULL, job_tetra },
  { "tetrahedra drawn before", STRATUS_TETRA_MAXIMUM, job_tetra_open, job_tetra_close, job_tetra_before, job_tetra },
  { "visibility order", 0, job_order_open, job_order_close, NULL, job_order },
  { "order by layers", 0, job_order_open, job_order_close, NULL, job_layers },
  { "another view's order", 1, job_order_open, job_order_close, job_order_before, job_order },
};

static void jobs_prepare(void)
{
  static const int cells[3] = { 15, 14, 14 }; /* enough for a device to be asked */
  uint32_t random = 5;
  job_data* d = &jobs_data;
  d->host = make_context("host", 1);
  small_scene_fill(&d->scene);
  assert_int_equal(small_scene_camera(d->host, &d->scene), STRATUS_OK);
  set_begin(&d->set, 24, 20, 16);
  set_add_noise(&d->set, 60, &random);
  set_add_box(&d->set, 3, 11, 4, 12, 2, 9);
  d->voxels = make_voxels(d->host, &d->set);
  tetra_create(&d->tetra, 2, 0.2, 0.1, 4);
  tetra_camera(d->host, &d->tetra, 2, 1, 0);
  d->mesh = mesh_grid(cells, 0.19, 3);
  for (int i = 0; i < JOB_RAYS; ++i) {
    d->rays[i] = (stratus_ray){ .origin = { -5.0, i % 20 + 0.3, i % 16 + 0.6 }, .direction = { 1.0, 0.01 * i, -0.02 * i }, .t_max = 100.0 };
  }
}

static void jobs_release(void)
{
  stratus_voxels_destroy(jobs_data.voxels);
  tetra_destroy(&jobs_data.tetra);
  mesh_case_free(&jobs_data.mesh);
  stratus_context_destroy(jobs_data.host);
}

#endif
