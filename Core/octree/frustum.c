/* SPDX-License-Identifier: BSD-3-Clause
 * Frusta as six half-spaces, made from a camera. Boxes are tested by their nearest and farthest corner (Assarsson & Moller 2000), or by
 * every separating axis (frustum_exact.c). A rounding error never hides a box that is seen. */
#include "frustum.h"

#include "vector.h"

#include <string.h>

/* ---- from a camera */

static void set_plane(double plane[4], const double normal[3], const double point[3], double offset)
{
  double unit[3] = { normal[0], normal[1], normal[2] };
  const double length = stratus_vector_normalize(unit);
  memcpy(plane, unit, sizeof unit);
  plane[3] = offset / length - stratus_vector_dot(unit, point);
}

/* Rows of the inverse of the matrix (right, up, forward): their products with a point give its u, v and k. Returns false if the three axes
 * are linearly dependent. */
static bool invert_axes(const stratus_camera* camera, double rows[3][3])
{
  const double* given[3] = { camera->right, camera->up, camera->forward };
  double axes[3][3], lengths[3];
  for (int i = 0; i < 3; ++i) {
    memcpy(axes[i], given[i], sizeof axes[i]);
    lengths[i] = stratus_vector_normalize(axes[i]);
    if (!(lengths[i] > 0.0)) {
      return false;
    }
  }
  for (int i = 0; i < 3; ++i) {
    stratus_vector_cross(axes[(i + 1) % 3], axes[(i + 2) % 3], rows[i]);
    const double volume = stratus_vector_dot(rows[i], axes[i]);
    if (!(fabs(volume) > STRATUS_DEPENDENT_BELOW)) {
      return false;
    }
    for (int a = 0; a < 3; ++a) {
      rows[i][a] /= volume * lengths[i];
    }
  }
  return true;
}

stratus_status stratus_frustum_from_camera(stratus_context* context, const stratus_camera* camera, stratus_frustum* frustum)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!camera || !frustum) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", camera ? "frustum" : "camera");
  }
  if (!(camera->near_k < camera->far_k) || (!camera->parallel && !(camera->near_k >= 0.0))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera near_k %g and far_k %g must rise%s", camera->near_k, camera->far_k,
      camera->parallel ? "" : ", from 0 at least");
  }
  double rows[3][3];
  if (!invert_axes(camera, rows)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera right, up and forward must be finite and span the space");
  }
  stratus_frustum result = { .eye = { camera->eye[0], camera->eye[1], camera->eye[2] } };
  for (int p = 0; p < 4; ++p) {
    double normal[3];
    for (int a = 0; a < 3; ++a) {
      normal[a] = (p % 2 ? -rows[p / 2][a] : rows[p / 2][a]) + (camera->parallel ? 0.0 : rows[2][a]);
    }
    set_plane(result.planes[p], normal, camera->eye, camera->parallel ? 1.0 : 0.0);
  }
  const double backward[3] = { -rows[2][0], -rows[2][1], -rows[2][2] }, none[4] = { 0.0, 0.0, 0.0, 1.0 };
  if (isfinite(camera->near_k)) {
    set_plane(result.planes[4], rows[2], camera->eye, -camera->near_k);
  } else {
    memcpy(result.planes[4], none, sizeof none);
  }
  if (isfinite(camera->far_k)) {
    set_plane(result.planes[5], backward, camera->eye, camera->far_k);
  } else {
    memcpy(result.planes[5], none, sizeof none);
  }
  TRY(stratus_frustum_check(context, &result));
  *frustum = result;
  return STRATUS_OK;
}

stratus_status stratus_frustum_check(stratus_context* context, const stratus_frustum* frustum)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!frustum) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "frustum is NULL");
  }
  for (int p = 0; p < STRATUS_PLANES; ++p) {
    for (int i = 0; i < 4; ++i) {
      if (!isfinite(frustum->planes[p][i])) {
        return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "frustum planes[%d][%d] is %g, must be finite", p, i, frustum->planes[p][i]);
      }
    }
  }
  for (int a = 0; a < 3; ++a) {
    if (!isfinite(frustum->eye[a])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "frustum eye[%d] is %g, must be finite", a, frustum->eye[a]);
    }
  }
  return STRATUS_OK;
}

/* ---- preparation */

void stratus_frustum_prepare(const stratus_frustum* frustum, bool exact, stratus_frustum_plan* plan)
{
  memset(plan, 0, sizeof *plan);
  memcpy(plan->eye, frustum->eye, sizeof plan->eye);
  for (int p = 0; p < STRATUS_PLANES; ++p) {
    const double* from = frustum->planes[p];
    const double largest = fmax(fmax(fabs(from[0]), fabs(from[1])), fabs(from[2]));
    int exponent = 0;
    if (largest == 0.0) {
      plan->empty |= from[3] < 0.0;
      plan->planes[p][3] = from[3];
      continue;
    }
    (void)frexp(largest, &exponent);
    for (int i = 0; i < 4; ++i) {
      plan->planes[p][i] = ldexp(from[i], -exponent);
    }
    plan->lengths[p] = sqrt(stratus_vector_dot(plan->planes[p], plan->planes[p]));
    plan->used |= 1u << p;
  }
  plan->solid = exact && stratus_plan_find_corners(plan);
}

/* ---- boxes */

bool stratus_bounds_finite(const double bounds[6])
{
  for (int i = 0; i < 6; ++i) {
    if (!(fabs(bounds[i]) <= STRATUS_COORDINATE_MAX)) {
      return false;
    }
  }
  return true;
}

stratus_solid_box stratus_solid_box_of_bounds(const double bounds[6])
{
  stratus_solid_box box = { .turned = false };
  for (int a = 0; a < 3; ++a) {
    box.center[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]);
    box.half[a][a] = 0.5 * (bounds[2 * a + 1] - bounds[2 * a]);
  }
  return box;
}

stratus_solid_box stratus_solid_box_of_turned(const double numbers[12])
{
  stratus_solid_box box = { .turned = true };
  memcpy(box.center, numbers, sizeof box.center);
  memcpy(box.half, numbers + 3, sizeof box.half);
  return box;
}

stratus_side stratus_plan_side(const stratus_frustum_plan* plan, unsigned mask, const double bounds[6])
{
  stratus_side side = STRATUS_SIDE_INSIDE;
  for (int p = 0; p < STRATUS_PLANES; ++p) {
    if (!((mask & plan->used) >> p & 1)) {
      continue;
    }
    const double* n = plan->planes[p];
    double far_value = n[3], near_value = n[3], size = fabs(n[3]);
    for (int a = 0; a < 3; ++a) {
      const double lo = n[a] * bounds[2 * a], hi = n[a] * bounds[2 * a + 1];
      far_value += lo > hi ? lo : hi;
      near_value += lo > hi ? hi : lo;
      size += fmax(fabs(lo), fabs(hi));
    }
    if (far_value < -STRATUS_PLANE_SLACK * size) {
      return STRATUS_SIDE_OUTSIDE;
    }
    if (!(near_value >= STRATUS_PLANE_SLACK * size)) {
      side = STRATUS_SIDE_CROSSING;
    }
  }
  return side;
}

/* The bounding sphere decides most planes at less cost than the box. */
stratus_side stratus_plan_side_turned(const stratus_frustum_plan* plan, unsigned mask, const stratus_solid_box* box)
{
  const double radius = stratus_solid_box_radius(box);
  stratus_side side = STRATUS_SIDE_INSIDE;
  for (int p = 0; p < STRATUS_PLANES; ++p) {
    if (!((mask & plan->used) >> p & 1)) {
      continue;
    }
    const double* n = plan->planes[p];
    const double sphere = radius * plan->lengths[p] * (1.0 + 1e-12);
    const double value = stratus_vector_dot(n, box->center) + n[3];
    const double slack = STRATUS_PLANE_SLACK *
      (fabs(n[0] * box->center[0]) + fabs(n[1] * box->center[1]) + fabs(n[2] * box->center[2]) + fabs(n[3]) + 4.0 * sphere);
    if (value + sphere < -slack) {
      return STRATUS_SIDE_OUTSIDE;
    }
    if (value - sphere >= slack) {
      continue;
    }
    const double reach =
      fabs(stratus_vector_dot(n, box->half[0])) + fabs(stratus_vector_dot(n, box->half[1])) + fabs(stratus_vector_dot(n, box->half[2]));
    if (value + reach < -slack) {
      return STRATUS_SIDE_OUTSIDE;
    }
    if (!(value - reach >= slack)) {
      side = STRATUS_SIDE_CROSSING;
    }
  }
  return side;
}

stratus_side stratus_frustum_side(const stratus_frustum* frustum, const double bounds[6], int exact)
{
  stratus_frustum_plan plan;
  if (!frustum || !bounds) {
    return STRATUS_SIDE_CROSSING;
  }
  stratus_frustum_prepare(frustum, exact != 0, &plan);
  if (plan.empty) {
    return STRATUS_SIDE_OUTSIDE;
  }
  if (!stratus_bounds_finite(bounds)) {
    return STRATUS_SIDE_CROSSING;
  }
  const stratus_side side = stratus_plan_side(&plan, plan.used, bounds);
  if (side == STRATUS_SIDE_CROSSING && exact) {
    const stratus_solid_box box = stratus_solid_box_of_bounds(bounds);
    return stratus_plan_separated(&plan, &box) ? STRATUS_SIDE_OUTSIDE : side;
  }
  return side;
}
