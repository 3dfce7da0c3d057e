/* SPDX-License-Identifier: BSD-3-Clause
 * Random volumes and meshes of tetrahedra that overlap, and their picture as one medium. */
#ifndef STRATUS_TESTING_MIXED_CASE_H
#define STRATUS_TESTING_MIXED_CASE_H

#include "several_case.h"

#undef TETRA_PIXELS /* the kernels' */
#include "tetra_case.h"

/* Volumes and meshes, at most three of each. */
typedef struct mixed_case {
  several_case volumes;
  tetra_case meshes[3];
  const stratus_transfer* transfers[3]; /* of a mesh's components; NULL: the case's own */
  int mesh_count;
  bool meshes_first; /* in the order of inputs */
  stratus_tetra_caster* tetra[3];
  several_casters casters;
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
} mixed_case;

/* A mesh of n^3 boxes of 20 units about the origin, turned by its seed, in colours of its own. */
static inline void place_mesh(tetra_case* c, int n, uint32_t seed)
{
  const double turn = 0.3 + 0.7 * seed, size = 20.0 / n, ca = cos(turn), sa = sin(turn);
  const double middle[3] = { 10.0, 10.0, 10.0 },
               rows[3][3] = { { ca, -sa * 0.8, sa * 0.6 }, { sa, ca * 0.8, -ca * 0.6 }, { 0.0, 0.6, 0.8 } };
  for (int row = 0; row < 3; ++row) {
    double shift = 0.0;
    for (int a = 0; a < 3; ++a) {
      c->mesh.matrix[4 * row + a] = rows[row][a] * size;
      shift += rows[row][a] * middle[a];
    }
    c->mesh.matrix[4 * row + 3] = 2.0 * (double)seed - 2.0 - shift;
  }
  const double color[12] = { 0.0, 0.1, 0.9, 0.3, 0.5, 0.2, 0.3, 1.0, 1.0, 0.9, 0.9, 0.1 };
  memcpy(c->color, color, sizeof color);
  c->transfer.unit_distance = 4.0;
  c->options.termination = 0.0;
  c->options.method = STRATUS_TETRA_METHOD_AUTO;
}

static inline void mixed_casters_create(stratus_context* context, mixed_case* m)
{
  several_casters_create(context, &m->casters);
  for (int n = 0; n < m->mesh_count; ++n) {
    assert_int_equal(stratus_tetra_caster_create(context, &m->tetra[n]), STRATUS_OK);
  }
}

static inline void mixed_casters_destroy(mixed_case* m)
{
  several_casters_destroy(&m->casters);
  for (int n = 0; n < m->mesh_count; ++n) {
    stratus_tetra_caster_destroy(m->tetra[n]);
  }
}

static inline void mixed_create(stratus_context* context, mixed_case* m, int count, int mesh_count, uint32_t seed)
{
  memset(m, 0, sizeof *m);
  if (count > 0) {
    several_create(context, &m->volumes, count, seed);
  }
  m->mesh_count = mesh_count;
  for (int n = 0; n < mesh_count; ++n) {
    tetra_create(&m->meshes[n], 3 + n, 0.2, n == 0 ? 0.1 : 0.0, seed + (uint32_t)n);
    place_mesh(&m->meshes[n], 3 + n, seed % 5u + (uint32_t)n);
  }
  mixed_casters_create(context, m);
  const double eye[3] = { 50, 40, 30.0 - 3.0 * (double)(seed % 20u) }, focal[3] = { 0, 0, 0 }, up[3] = { 0.1, 0.2, 1 };
  const double aspect = (double)CASE_WIDTH / CASE_HEIGHT;
  stratus_camera* camera = &m->volumes.of[0].camera;
  assert_int_equal(seed % 2 ? stratus_camera_perspective(context, eye, focal, up, 34.0, aspect, camera)
                            : stratus_camera_parallel(context, eye, focal, up, 19.0, aspect, camera),
    STRATUS_OK);
}

static inline void mixed_destroy(mixed_case* m)
{
  mixed_casters_destroy(m);
  several_destroy(&m->volumes);
  for (int n = 0; n < m->mesh_count; ++n) {
    tetra_destroy(&m->meshes[n]);
  }
}

static inline stratus_status mixed_draw(mixed_case* m, picture* p)
{
  stratus_ray_cast_input inputs[STRATUS_SEVERAL_MAX];
  const int count = m->volumes.count, all = count + m->mesh_count;
  const stratus_image image = { .width = CASE_WIDTH,
    .height = CASE_HEIGHT,
    .rgba = p->rgba,
    .depth = p->depth,
    .samples = p->samples,
    .opaque_depth = m->volumes.of[0].opaque_depth };
  for (int n = 0; n < count; ++n) {
    inputs[n + (m->meshes_first ? m->mesh_count : 0)] = (stratus_ray_cast_input){ .caster = m->casters.of[n],
      .volume = &m->volumes.of[n].volume,
      .transfer = &m->volumes.of[n].transfer,
      .options = &m->volumes.of[n].options };
  }
  for (int n = 0; n < m->mesh_count; ++n) {
    inputs[n + (m->meshes_first ? 0 : count)] = (stratus_ray_cast_input){ .tetra = m->tetra[n],
      .mesh = &m->meshes[n].mesh,
      .transfer = m->transfers[n] ? m->transfers[n] : &m->meshes[n].transfer,
      .options = &m->volumes.of[0].options,
      .tetra_options = &m->meshes[n].options };
  }
  const stratus_status status = stratus_ray_caster_render_several(inputs, all, &m->volumes.of[0].camera, &image, m->reports);
  p->report = m->reports[0];
  return status;
}

/* Draws with another context. */
static inline stratus_status mixed_draw_by(stratus_context* context, const mixed_case* m, picture* p)
{
  mixed_case mine = *m;
  mixed_casters_create(context, &mine);
  const stratus_status status = mixed_draw(&mine, p);
  mixed_casters_destroy(&mine);
  return status;
}

#endif
