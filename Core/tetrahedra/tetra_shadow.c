/* SPDX-License-Identifier: BSD-3-Clause
 * Shadows of a mesh: maps of the light that passes it, of layers that a caster of its own draws without light. */
#include "lights.h"
#include "tetra_caster.h"

#include "matrix.h"

#include <string.h>

typedef struct matter {
  stratus_tetra_draw* draw;
  stratus_tetra_caster* dark;
  const stratus_mesh* mesh;
  const stratus_transfer* transfers;
  const stratus_tetra_options* lit;
  stratus_tetra_options options;
} matter;

stratus_status stratus_tetra_shadow_check(
  stratus_context* context, const stratus_mesh* mesh, const stratus_transfer* transfer, const stratus_tetra_options* options)
{
  TRY(stratus_mesh_check(context, mesh));
  TRY(stratus_transfer_check(context, transfer));
  return options && stratus_lights_want_shadows(&options->shading) ? stratus_shading_check(context, &options->shading) : STRATUS_OK;
}

/* Materials of the components' own, or NULL. */
static const stratus_material* materials_of(const stratus_mesh* mesh, const stratus_tetra_options* o)
{
  return stratus_tetra_mixes(mesh, o) && !o->dependent ? o->materials : NULL;
}

bool stratus_tetra_has_shadows(const stratus_mesh* mesh, const stratus_tetra_options* o)
{
  const bool lit = o->mode == STRATUS_TETRA_COMPOSITE || o->mode == STRATUS_TETRA_ISOSURFACE;
  return lit && stratus_lights_cast_shadows(&o->shading, o->shade != 0, materials_of(mesh, o), mesh->components);
}

stratus_tetra_options stratus_tetra_dark_options(const stratus_tetra_options* options)
{
  stratus_tetra_options dark = *options;
  dark.shade = 0;
  dark.materials = NULL;
  dark.method = STRATUS_TETRA_METHOD_MARCH;
  return dark;
}

void stratus_tetra_show_albedo(
  const stratus_tetra_options* options, int components, stratus_material materials[4], stratus_tetra_options* dark)
{
  dark->shade = 1;
  dark->materials = stratus_lights_show_albedo(&options->shading, options->materials, components, &dark->shading, materials);
}

/* Bytes under the same address are the same unless the mesh's revision has changed. */
static uint64_t key_of_mesh(uint64_t key, const stratus_mesh* m)
{
  const void* data[6] = { m->points, m->float_points, m->vertices, m->values, m->hidden, m->labels };
  const int64_t counts[11] = { (int64_t)m->revision, m->point_count, m->cell_count, m->value_stride, m->type, m->components, m->cell_values,
    m->lattice[0], m->lattice[1], m->lattice[2], m->block_count };
  key = stratus_light_key(key, data, sizeof data);
  key = stratus_light_key(key, counts, sizeof counts);
  for (int n = 0; n < m->block_count; ++n) {
    key = key_of_mesh(key, m->blocks + n);
  }
  return key;
}

uint64_t stratus_tetra_shadow_key(uint64_t key, const stratus_mesh* m, const stratus_transfer* transfers, const stratus_tetra_options* o)
{
  const bool surfaces = o->mode == STRATUS_TETRA_ISOSURFACE;
  const double numbers[11] = { o->mode, o->tolerance, o->gradient_distance, o->clip_plane_count, o->crop, o->crop_regions, o->dependent,
    o->mean_components, o->label_count, surfaces ? o->contour_count : 0.0, stratus_tetra_reflectance(m, o) };
  const int functions = o->label_count > 0 ? o->label_count + 1 : m->components > 1 && !o->dependent ? m->components : 1;
  key = key_of_mesh(key, m);
  key = stratus_light_key(key, numbers, sizeof numbers);
  key = stratus_light_key(key, o->clip_planes, (size_t)o->clip_plane_count * sizeof o->clip_planes[0]);
  key = stratus_light_key(key, o->crop_bounds, o->crop ? sizeof o->crop_bounds : 0);
  key = stratus_light_key(key, o->contours, surfaces ? (size_t)o->contour_count * sizeof o->contours[0] : 0);
  key = stratus_light_key(key, m->matrix, sizeof m->matrix);
  key = stratus_light_key_of_albedo(key, transfers, functions, o->materials, m->components);
  return stratus_light_key_of_transfers(key, transfers, functions);
}

double stratus_tetra_reflectance(const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  return stratus_lights_reflectance(&options->shading, materials_of(mesh, options), mesh->components);
}

/* Whether rays store all layers at once: they gather in one picture, and no crop region cuts them. */
static bool draws_together(const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  return !stratus_tetra_modes_regions(options) && !stratus_tetra_draws_parts(mesh, options);
}

static stratus_status draw_matter(void* of, const stratus_camera* camera, int layers, const stratus_image* image, bool colors)
{
  const matter* m = of;
  stratus_tetra_options options = m->options;
  stratus_material materials[4];
  if (colors) {
    stratus_tetra_show_albedo(m->lit, m->mesh->components, materials, &options);
  }
  if (layers > 1 && draws_together(m->mesh, &options)) {
    memset(image->rgba, 0, 4 * (size_t)layers * (size_t)image->width * (size_t)image->height * sizeof(float));
    m->dark->layers = layers;
    const stratus_status status = m->draw(m->dark, m->mesh, m->transfers, camera, &options, image, NULL);
    m->dark->layers = 0;
    return status;
  }
  for (int layer = 0; layer < layers; ++layer) {
    const stratus_camera part = stratus_light_layer_camera(camera, layer, layers);
    const stratus_image picture = stratus_light_layer_image(image, layer);
    TRY(m->draw(m->dark, m->mesh, m->transfers, &part, &options, &picture, NULL));
  }
  return STRATUS_OK;
}

stratus_status stratus_tetra_shadow_update(
  stratus_tetra_caster* caster, const stratus_tetra_subject* of, const stratus_camera* camera, stratus_tetra_draw* draw)
{
  stratus_light lights[STRATUS_LIGHTS_MAX];
  matter m = { .draw = draw,
    .dark = caster->dark,
    .mesh = of->mesh,
    .transfers = of->transfer,
    .lit = of->options,
    .options = stratus_tetra_dark_options(of->options) };
  stratus_light_matter all = { .draw = draw_matter, .of = &m, .tolerance = of->options->tolerance };
  const int count = stratus_lights_in_world(camera, &of->options->shading, lights);
  const uint64_t key =
    stratus_tetra_shadow_key(stratus_light_key_of_scattering(0, &of->options->shading, lights, count), of->mesh, of->transfer, of->options);
  all.together = draws_together(of->mesh, &m.options);
  all.reflectance = stratus_tetra_reflectance(of->mesh, of->options);
  if (!stratus_light_state_serves(&caster->light, key, lights, count)) {
    stratus_matrix_box(of->mesh->matrix, caster->mesh->lo, caster->mesh->hi, all.bounds); /* caster->mesh is up to date */
    TRY(stratus_light_state_build(caster->context, &all, &of->options->shading, lights, count, &caster->light));
    caster->light.key = key;
  }
  TRY(stratus_light_maps_hide(caster->light.maps, of->options->shading.surfaces));
  caster->lights = caster->light.maps;
  return STRATUS_OK;
}
