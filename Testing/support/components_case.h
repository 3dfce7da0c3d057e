/* SPDX-License-Identifier: BSD-3-Clause
 * Picture cases of several components or labels, each with a transfer function of its own. */
#ifndef STRATUS_TESTING_COMPONENTS_CASE_H
#define STRATUS_TESTING_COMPONENTS_CASE_H

#include "picture_case.h"

/* dB against the reference at a quarter of a voxel, as for one component: only the sampling's own error is left. */
#define MIDPOINT_DB 64.0
#define COMPONENTS 4

typedef struct many {
  picture_case c; /* geometry, camera and options; its values are of component 0 */
  stratus_transfer transfers[COMPONENTS];
  void* values; /* interleaved */
} many;

static picture drawn; /* by many_check() */

/* `count` fields of one type at one place. Component i comes from seed + i and has a transfer function in a colour of its own. */
static inline void many_create(
  stratus_context* context, many* m, stratus_type type, int count, int64_t nx, int64_t ny, int64_t nz, uint32_t seed)
{
  static const double colors[COMPONENTS][4] = { { 0, 1, 0.2, 0.1 }, { 0, 0.1, 0.9, 0.3 }, { 0, 0.2, 0.3, 1 }, { 0, 0.9, 0.9, 0.1 } };
  const size_t size = stratus_type_size(type), voxels = (size_t)(nx * ny * nz);
  case_create(context, &m->c, type, nx, ny, nz, seed);
  m->values = malloc(voxels * size * (size_t)count);
  assert_non_null(m->values);
  for (int i = 0; i < count; ++i) {
    case_fill(&m->c, seed + 31u * (uint32_t)i);
    for (size_t v = 0; v < voxels; ++v) {
      memcpy((char*)m->values + (v * (size_t)count + (size_t)i) * size, (const char*)m->c.values + v * size, size);
    }
    m->transfers[i] = m->c.transfer;
    m->transfers[i].color = i == 0 ? m->c.transfer.color : colors[i];
    m->transfers[i].color_count = i == 0 ? m->c.transfer.color_count : 1;
    m->transfers[i].unit_distance = 1.0 + 0.5 * i;
  }
  m->c.volume.values = m->values;
  m->c.volume.components = count;
  m->c.volume.value_stride = count;
}

static inline void many_destroy(many* m)
{
  case_destroy(&m->c);
  free(m->values);
}

static inline stratus_status many_status(stratus_context* context, const many* m, picture* p)
{
  stratus_ray_caster* caster = NULL;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p->rgba, .depth = p->depth, .samples = p->samples };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  memset(&p->report, 0, sizeof p->report);
  stratus_status status = stratus_ray_caster_render(caster, &m->c.volume, m->transfers, &m->c.camera, &m->c.options, &image, &p->report);
  for (int again = 0; status == STRATUS_OK && again < 2;
       ++again) { /* once rays have read enough, values are kept as floats: the same bits */
    static picture kept;
    const stratus_image next = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = kept.rgba, .depth = kept.depth };
    status = stratus_ray_caster_render(caster, &m->c.volume, m->transfers, &m->c.camera, &m->c.options, &next, NULL);
    assert_memory_equal(kept.rgba, p->rgba, 4 * (size_t)CASE_PIXELS * sizeof *kept.rgba);
    assert_memory_equal(kept.depth, p->depth, (size_t)CASE_PIXELS * sizeof *kept.depth);
  }
  stratus_ray_caster_destroy(caster);
  return status;
}

static inline void many_draw(stratus_context* context, const many* m, picture* p)
{
  const stratus_status status = many_status(context, m, p);
  if (status != STRATUS_OK) {
    print_error("%s\n", stratus_context_message(context));
  }
  assert_int_equal(status, STRATUS_OK);
}

static inline void many_check(const char* what, stratus_context* context, const many* m, double wanted)
{
  static float reference[4 * CASE_PIXELS_MOST];
  reference_scene scene = case_scene(&m->c);
  double reference_db = 0.0;
  scene.transfer = m->transfers;
  scene.dependent = m->c.options.optics.dependent;
  scene.mean_components = m->c.options.optics.mean_components;
  scene.gradient_distance = m->c.options.optics.gradient_distance;
  scene.shading = m->c.options.light.shade || m->c.options.light.materials ? &m->c.options.light.shading : NULL;
  scene.materials = m->c.options.light.materials;
  many_draw(context, m, &drawn);
  assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, 62.0, reference, NULL, &reference_db), 0);
  const double db = reference_psnr(drawn.rgba, reference, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels\n", what, db, reference_db, case_lit(&drawn));
  assert_true(case_lit(&drawn) > case_share(50));
  assert_true(db >= wanted);
}

#endif
