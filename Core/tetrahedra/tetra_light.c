/* SPDX-License-Identifier: BSD-3-Clause
 * Light and gradient opacity of tetrahedra: what of the mesh and the transfer function they need, and the arguments of rays. */
#include "tetra_caster.h"

#include "gradient_factors.h"
#include "lights.h"
#include "matrix.h"
#include "tetra_gradient.h"
#include "vector.h"

#include <string.h>

/* Ways of gradient_distance in a unit of length, at most and at least: products with optical depths stay floats. */
#define WAY_MOST 1e20

static bool shades(const stratus_tetra_options* options)
{
  return options->shade && (options->mode == STRATUS_TETRA_COMPOSITE || options->mode == STRATUS_TETRA_ISOSURFACE);
}

static bool thins(const stratus_transfer* transfer, const stratus_tetra_options* options)
{
  return transfer->gradient_count > 0 && options->mode == STRATUS_TETRA_COMPOSITE;
}

bool stratus_tetra_light_wanted(const stratus_transfer* transfer, const stratus_tetra_options* options)
{
  return shades(options) || thins(transfer, options);
}

stratus_status stratus_tetra_light_check(stratus_context* context, const stratus_transfer* transfer, const stratus_tetra_options* options)
{
  if (!isfinite(options->gradient_distance)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "gradient_distance %g, must be finite", options->gradient_distance);
  }
  if (options->method == STRATUS_TETRA_METHOD_PROJECT && stratus_tetra_light_wanted(transfer, options)) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "light and gradient opacity cannot be projected, only marched: take the method march or auto");
  }
  return shades(options) ? stratus_shading_check(context, &options->shading) : STRATUS_OK;
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
  caster->factors = NULL;
}

/* Makes the factors anew where they are not those of this function: the copy in caster->transfer is older then. */
static stratus_status update_factors(stratus_tetra_caster* caster, const stratus_transfer* transfer)
{
  void* memory = NULL;
  stratus_transfer* copy = NULL;
  if (caster->factors && stratus_transfer_same(caster->transfer, transfer)) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(caster->context, STRATUS_SHADING_FACTORS + 2, sizeof(float), &memory));
  const stratus_status status = stratus_transfer_copy(caster->context, transfer, 1, &copy);
  if (status != STRATUS_OK) {
    stratus_release(caster->context, memory);
    return status;
  }
  stratus_tetra_light_drop_factors(caster);
  stratus_release(caster->context, caster->transfer);
  caster->transfer = copy;
  caster->factors = memory;
  caster->factor_scale = stratus_gradient_factors(transfer, memory);
  return STRATUS_OK;
}

stratus_status stratus_tetra_light_update(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_tetra_options* options, double* ms)
{
  const double start = stratus_now_ms();
  if (!stratus_tetra_light_wanted(transfer, options)) {
    return STRATUS_OK;
  }
  if (!caster->gradients.vectors && caster->mesh->face_count > 0) {
    TRY(stratus_tetra_gradients_create(caster->mesh, mesh, &caster->gradients));
    ++caster->gradient_builds;
    *ms += stratus_now_ms() - start;
  }
  return thins(transfer, options) ? update_factors(caster, transfer) : STRATUS_OK;
}

/* The most that light changes where a normal turns: by the sine of the angle, and by its square. A highlight is as narrow as its power. */
static void set_bend(stratus_tetra_arguments* a, const stratus_shading* shading)
{
  double strength = 0.0;
  for (int i = 0; i < a->light.count; ++i) {
    strength += fmax(fmax((double)a->light.color[i][0], (double)a->light.color[i][1]), (double)a->light.color[i][2]);
  }
  const double power = fmax(shading->specular_power, 1.0);
  a->bend[0] = (float)fmin(strength * (shading->diffuse + sqrt(power) * shading->specular), 1e15);
  a->bend[1] = (float)fmin(strength * (shading->diffuse + power * shading->specular), 1e15);
}

static void set_lights(stratus_tetra_frame* frame, const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  stratus_tetra_arguments* a = &frame->arguments;
  const stratus_shading* shading = &options->shading;
  const stratus_camera* c = &frame->camera;
  const double unit = sqrt(stratus_vector_dot(frame->basis[2], frame->basis[2]));
  const double material[4] = { shading->ambient, shading->diffuse, shading->specular, shading->specular_power };
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
  for (int i = 0; i < 4; ++i) {
    a->light.material[0][i] = (float)material[i];
  }
  a->light.on = 1;
  stratus_lights_set(c, shading, origin, unit, &a->light);
  set_bend(a, shading);
}

/* The world length over which gradient opacity multiplies opacity. */
static double way_of(const stratus_mesh* mesh, const stratus_tetra_gradients* gradients, const stratus_tetra_options* options)
{
  const double* m = mesh->matrix;
  const double volume = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
  return options->gradient_distance < 0.0 ? 0.5 * gradients->spacing * cbrt(fabs(volume)) : options->gradient_distance;
}

void stratus_tetra_frame_light(stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_tetra_options* options)
{
  stratus_tetra_arguments* a = &frame->arguments;
  const stratus_tetra_gradients* g = &caster->gradients;
  frame->lit = stratus_tetra_light_wanted(transfer, options);
  if (!frame->lit) {
    return;
  }
  frame->gradients = g->vectors;
  if (thins(transfer, options)) {
    frame->factors = caster->factors;
    a->thins = 1;
    a->factor_scale = (float)fmin(g->unit * g->spacing * (double)caster->factor_scale, 1e30);
    a->factor_last = (float)STRATUS_SHADING_FACTORS;
    a->factor_way = (float)fmin(way_of(mesh, g, options), WAY_MOST);
  }
  if (shades(options)) {
    set_lights(frame, mesh, options);
  }
}
