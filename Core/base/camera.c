/* SPDX-License-Identifier: BSD-3-Clause
 * Cameras from what people say of them: where from, where to, which way is up. */
#include "base.h"

#define DEGREES_TO_RADIANS 0.017453292519943295
/* sin of the smallest angle between view direction and view-up that still tells which way is up in double. */
#define PARALLEL_BELOW 1e-9

/* Length 1; false for a zero or infinite vector. Scaled first, so that no square over- or underflows. */
static bool normalize(double v[3])
{
  const double largest = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
  if (!(largest > 0.0) || !isfinite(largest)) {
    return false;
  }
  for (int a = 0; a < 3; ++a) {
    v[a] /= largest;
  }
  const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int a = 0; a < 3; ++a) {
    v[a] /= length;
  }
  return true;
}

static void cross(const double a[3], const double b[3], double result[3])
{
  result[0] = a[1] * b[2] - a[2] * b[1];
  result[1] = a[2] * b[0] - a[0] * b[2];
  result[2] = a[0] * b[1] - a[1] * b[0];
}

static stratus_status check_vector(stratus_context* context, const char* what, const double* v)
{
  if (!v) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera %s is NULL", what);
  }
  for (int a = 0; a < 3; ++a) {
    if (!isfinite(v[a])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera %s[%d] is %g, must be finite", what, a, v[a]);
    }
  }
  return STRATUS_OK;
}

/* The camera whose window is half_height*aspect by half_height. */
static stratus_status aim(stratus_context* context, const double eye[3], const double focal[3], const double view_up[3], double half_height,
  double aspect, int parallel, stratus_camera* camera)
{
  TRY(check_vector(context, "eye", eye));
  TRY(check_vector(context, "focal", focal));
  TRY(check_vector(context, "view_up", view_up));
  if (!(aspect > 0.0) || !isfinite(aspect)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera aspect %g, must be positive and finite", aspect);
  }
  if (!camera) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera is NULL");
  }
  double forward[3] = { focal[0] - eye[0], focal[1] - eye[1], focal[2] - eye[2] };
  double upwards[3] = { view_up[0], view_up[1], view_up[2] };
  double right[3], up[3];
  if (!isfinite(half_height * aspect)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "camera aspect %g times half the window's height, %g, must be finite", aspect, half_height);
  }
  if (!normalize(forward)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera eye and focal point (%g, %g, %g) must differ, by a finite distance",
      focal[0], focal[1], focal[2]);
  }
  if (!normalize(upwards)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera view_up is (0, 0, 0), must have a length");
  }
  cross(forward, upwards, right);
  if (!(right[0] * right[0] + right[1] * right[1] + right[2] * right[2] > PARALLEL_BELOW * PARALLEL_BELOW)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera view_up (%g, %g, %g) is parallel to the view direction", view_up[0],
      view_up[1], view_up[2]);
  }
  (void)normalize(right);
  cross(right, forward, up);

  stratus_camera result = { .near_k = 0.0, .far_k = INFINITY, .parallel = parallel };
  for (int a = 0; a < 3; ++a) {
    result.eye[a] = eye[a];
    result.forward[a] = forward[a];
    result.right[a] = right[a] * half_height * aspect;
    result.up[a] = up[a] * half_height;
  }
  *camera = result;
  return STRATUS_OK;
}

stratus_status stratus_camera_perspective(stratus_context* context, const double eye[3], const double focal[3], const double view_up[3],
  double view_angle, double aspect, stratus_camera* camera)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!(view_angle > 0.0 && view_angle < 180.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera view_angle %g degrees outside 0..180, ends excluded", view_angle);
  }
  return aim(context, eye, focal, view_up, tan(0.5 * view_angle * DEGREES_TO_RADIANS), aspect, 0, camera);
}

stratus_status stratus_camera_parallel(stratus_context* context, const double eye[3], const double focal[3], const double view_up[3],
  double parallel_scale, double aspect, stratus_camera* camera)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!(parallel_scale > 0.0) || !isfinite(parallel_scale)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera parallel_scale %g, must be positive and finite", parallel_scale);
  }
  return aim(context, eye, focal, view_up, parallel_scale, aspect, 1, camera);
}
