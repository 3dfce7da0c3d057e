/* SPDX-License-Identifier: BSD-3-Clause
 * Light and gradient opacity of tetrahedra: the data of the mesh and the transfer function that they need, and the arguments of rays. */
#include "tetra_caster.h"

#include "gradient_factors.h"
#include "lights.h"
#include "matrix.h"
#include "tetra_cells.h"
#include "tetra_gradient.h"
#include "vector.h"

#include <string.h>

/* Ways of gradient_distance in a unit of length, at most and at least: products with optical depths stay floats. */
#define WAY_MOST 1e20

/* The shading's own where there are none of components. */
stratus_material stratus_tetra_material(const stratus_mesh* mesh, const stratus_tetra_options* options, int c)
{
  const stratus_shading* shading = &options->shading;
  const bool own = options->materials && stratus_tetra_mixes(mesh, options) && !options->dependent;
  return own ? options->materials[c]
             : (stratus_material){ options->shade, shading->ambient, shading->diffuse, shading->specular, shading->specular_power };
}

static bool lights(const stratus_tetra_options* options)
{
  return options->mode == STRATUS_TETRA_COMPOSITE || options->mode == STRATUS_TETRA_ISOSURFACE || options->mode == STRATUS_TETRA_FIRST_HIT;
}

/* Whether a component's function, or the function of any label, has a gradient opacity. */
static bool thins(const stratus_transfer* transfer, const stratus_tetra_options* options)
{
  bool any = false;
  for (int l = 0; l <= options->label_count && options->mode == STRATUS_TETRA_COMPOSITE; ++l) {
    any = any || transfer[l].gradient_count > 0;
  }
  return any;
}

unsigned stratus_tetra_light_mask(const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options)
{
  const bool faces = options->mode == STRATUS_TETRA_FIRST_HIT && options->normals != STRATUS_NORMALS_GRADIENT;
  const int count = lights(options) && !faces ? stratus_tetra_component_count(mesh) : 0;
  unsigned mask = 0;
  for (int c = options->dependent && count > 0 ? count - 1 : 0; c < count; ++c) {
    const bool counts = stratus_tetra_material(mesh, options, c).shade || thins(transfers + (options->dependent ? 0 : c), options);
    mask |= counts ? 1u << c : 0;
  }
  return mask;
}

static stratus_status check_materials(stratus_context* context, const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  const int count = stratus_tetra_component_count(mesh);
  for (int c = 0; c < count; ++c) {
    const stratus_material m = stratus_tetra_material(mesh, options, c);
    const double numbers[4] = { m.ambient, m.diffuse, m.specular, m.specular_power };
    if (m.shade) {
      TRY(stratus_shading_check(context, &options->shading));
    }
    for (int i = 0; m.shade && i < 4; ++i) {
      if (!(numbers[i] >= 0.0 && numbers[i] <= STRATUS_LIGHT_MAX)) {
        return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "material of component %d has (%g, %g, %g, %g), must be 0..%g", c,
          numbers[0], numbers[1], numbers[2], numbers[3], STRATUS_LIGHT_MAX);
      }
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_tetra_light_check(
  stratus_context* context, const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options)
{
  if (!isfinite(options->gradient_distance)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "gradient_distance %g, must be finite", options->gradient_distance);
  }
  if (options->method == STRATUS_TETRA_METHOD_PROJECT && stratus_tetra_light_mask(mesh, transfers, options)) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "light and gradient opacity cannot be projected, only marched: take the method march or auto");
  }
  return lights(options) ? check_materials(context, mesh, options) : STRATUS_OK;
}

void stratus_tetra_light_drop(stratus_tetra_caster* caster)
{
  stratus_tetra_device_drop_gradients(caster->device);
  stratus_release(caster->context, caster->gradients.vectors);
  caster->gradients = (stratus_tetra_gradients){ 0 };
}

void stratus_tetra_light_drop_factors(stratus_tetra_caster* caster)
{
  stratus_release(caster->context, caster->factors);
  stratus_release(caster->context, caster->factor_transfers);
  caster->factors = NULL;
  caster->factor_transfers = NULL;
  caster->factor_count = 0;
}

/* Make the factors of `count` components or labels again if they were made for other functions. A label without a gradient opacity has that
 * of label 0, and 1 if there is none. */
static stratus_status update_factors(stratus_tetra_caster* caster, const stratus_transfer* transfers, int count, bool dependent)
{
  const int functions = dependent ? 1 : count;
  const size_t factors = STRATUS_SHADING_FACTORS + 2;
  void* memory = NULL;
  bool same = caster->factors && caster->factor_count == count;
  for (int t = 0; t < functions && same; ++t) {
    same = stratus_transfer_same(caster->factor_transfers + t, transfers + t);
  }
  if (same) {
    return STRATUS_OK;
  }
  stratus_tetra_light_drop_factors(caster);
  TRY(stratus_transfer_copy(caster->context, transfers, functions, &caster->factor_transfers));
  const stratus_status status = stratus_allocate_zero(caster->context, (size_t)count * factors, sizeof(float), &memory);
  if (status != STRATUS_OK) {
    stratus_tetra_light_drop_factors(caster);
    return status;
  }
  caster->factors = memory;
  caster->factor_count = count;
  for (int c = 0; c < count; ++c) {
    const stratus_transfer* transfer = transfers + (dependent || transfers[c].gradient_count == 0 ? 0 : c);
    float *own = caster->factors + (size_t)c * factors, scale = 0.0f;
    for (size_t i = 0; i < factors; ++i) {
      own[i] = 1.0f;
    }
    if (transfer->gradient_count > 0) {
      scale = stratus_gradient_factors(transfer, own);
    }
    if (c < STRATUS_COMPONENTS_MAX) {
      caster->factor_scale[c] = scale;
    }
  }
  return STRATUS_OK;
}

/* Bit c where component c has a gradient opacity. */
static unsigned thinned(const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options)
{
  unsigned mask = 0;
  for (int c = 0; c < stratus_tetra_component_count(mesh); ++c) {
    mask |= thins(transfers + (options->dependent ? 0 : c), options) ? 1u << c : 0;
  }
  return mask & stratus_tetra_light_mask(mesh, transfers, options);
}

stratus_status stratus_tetra_light_update(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfers,
  const stratus_tetra_options* options, double* ms)
{
  const double start = stratus_now_ms();
  const unsigned mask = stratus_tetra_light_mask(mesh, transfers, options);
  if (mask == 0) {
    return STRATUS_OK;
  }
  if ((caster->gradients.mask & mask) != mask && caster->mesh->face_count > 0) {
    stratus_tetra_light_drop(caster);
    const stratus_status status = stratus_tetra_gradients_create(caster->mesh, mesh, mask, &caster->gradients);
    if (status != STRATUS_OK) {
      stratus_tetra_light_drop(caster);
      return status;
    }
    ++caster->gradient_builds;
    *ms += stratus_now_ms() - start;
  }
  const int labels = options->label_count, count = labels > 0 ? 1 + labels : stratus_tetra_component_count(mesh);
  return thinned(mesh, transfers, options)
    ? update_factors(caster, transfers, count, options->dependent && stratus_tetra_mixes(mesh, options))
    : STRATUS_OK;
}

/* The most that light changes where a normal turns: by the sine of the angle, and by its square. A highlight is as narrow as its power. Of
 * several materials the one that changes most counts. */
static void set_bend(stratus_tetra_arguments* a)
{
  double matt = 0.0, shine = 0.0;
  for (int i = 0; i < a->light.count; ++i) {
    const float *color = a->light.color[i], *specular_color = a->light.specular_color[i];
    matt += (double)fmaxf(fmaxf(color[0], color[1]), color[2]);
    shine += (double)fmaxf(fmaxf(specular_color[0], specular_color[1]), specular_color[2]);
  }
  for (int c = 0; c < STRATUS_COMPONENTS_MAX; ++c) {
    const float* m = a->light.material[c];
    const double diffuse = matt * (double)m[1], specular = shine * (double)m[2], power = fmax((double)m[3], 1.0);
    if (a->light.on >> c & 1) {
      a->bend[0] = fmaxf(a->bend[0], (float)fmin(diffuse + sqrt(power) * specular, 1e15));
      a->bend[1] = fmaxf(a->bend[1], (float)fmin(diffuse + power * specular, 1e15));
    }
  }
}

/* mask: the components that have gradients; no other is lit, as of dependent ones all but the last. */
static void set_lights(
  stratus_tetra_frame* frame, const stratus_light_maps* maps, const stratus_mesh* mesh, const stratus_tetra_options* options, unsigned mask)
{
  stratus_tetra_arguments* a = &frame->arguments;
  const stratus_shading* shading = &options->shading;
  const stratus_camera* c = &frame->camera;
  const double unit = sqrt(stratus_vector_dot(frame->basis[2], frame->basis[2]));
  double inverse[16], origin[3], largest = 0.0;
  if (!stratus_matrix_invert_affine(mesh->matrix, inverse)) {
    return; /* stratus_mesh_check() refuses such a matrix */
  }
  for (int axis = 0; axis < 3; ++axis) {
    origin[axis] = c->eye[axis] + frame->middle * c->forward[axis];
    for (int row = 0; row < 3; ++row) {
      largest = fmax(largest, fabs(inverse[4 * row + axis]));
      a->light.place[3 * row + axis] = (float)(frame->basis[axis][row] / unit);
    }
  }
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) { /* normals transform by the inverse's transpose and point against the gradient */
      a->light.normal[3 * row + axis] = (float)(-inverse[4 * axis + row] / largest);
    }
  }
  for (int m = 0; m < stratus_tetra_component_count(mesh); ++m) {
    const stratus_material material = stratus_tetra_material(mesh, options, m);
    const double numbers[4] = { material.ambient, material.diffuse, material.specular, material.specular_power };
    for (int i = 0; i < 4; ++i) {
      a->light.material[m][i] = (float)numbers[i];
    }
    a->light.on |= material.shade && mask >> m & 1 ? 1 << m : 0;
  }
  if (a->light.on) { /* else the lights are unchecked and unused */
    stratus_light lights[STRATUS_LIGHTS_MAX];
    double to_world[16] = { [15] = 1.0 };
    stratus_lights_set(c, shading, origin, unit, lights, &a->light);
    for (int row = 0; row < 3; ++row) {
      for (int axis = 0; axis < 3; ++axis) {
        to_world[4 * row + axis] = frame->basis[axis][row];
      }
      to_world[4 * row + 3] = origin[row];
    }
    stratus_light_maps_arguments(maps, lights, to_world, unit, 0.0, &a->light);
    frame->lights = stratus_light_maps_words(maps);
    frame->maps = maps;
    set_bend(a);
  }
}

/* The world length over which gradient opacity multiplies opacity. */
static double way_of(const stratus_mesh* mesh, const stratus_tetra_gradients* gradients, const stratus_tetra_options* options)
{
  const double* m = mesh->matrix;
  const double volume = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
  return options->gradient_distance < 0.0 ? 0.5 * gradients->spacing * cbrt(fabs(volume)) : options->gradient_distance;
}

void stratus_tetra_frame_light(stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfers, const stratus_tetra_options* options)
{
  stratus_tetra_arguments* a = &frame->arguments;
  const stratus_tetra_gradients* g = &caster->gradients;
  const unsigned mask = stratus_tetra_light_mask(mesh, transfers, options);
  frame->lit = mask != 0 && options->mode != STRATUS_TETRA_FIRST_HIT; /* hits are lit afterwards */
  if (!frame->lit) {
    return;
  }
  frame->gradients = g->vectors;
  frame->gradient_sets = g->sets;
  a->media.points = (int)caster->mesh->point_count;
  memcpy(a->media.gradients_at, g->set, sizeof a->media.gradients_at);
  a->thins = (int)thinned(mesh, transfers, options);
  if (a->thins) {
    frame->factors = caster->factors;
    frame->factor_count = (size_t)caster->factor_count * (STRATUS_SHADING_FACTORS + 2);
    a->factor_last = (float)STRATUS_SHADING_FACTORS;
    a->factor_way = (float)fmin(way_of(mesh, g, options), WAY_MOST);
  }
  for (int c = 0; c < STRATUS_COMPONENTS_MAX; ++c) {
    if (a->thins >> c & 1) {
      const double scale = options->label_count > 0 ? 1.0 : (double)caster->factor_scale[c];
      a->factor_scale[c] = (float)fmin(g->unit[c] * g->spacing * scale, 1e30);
    }
  }
  set_lights(frame, caster->lights, mesh, options, mask);
}
