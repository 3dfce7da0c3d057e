/* SPDX-License-Identifier: BSD-3-Clause
 * Cameras from the usual description (eye, focal point, view-up), their checks, and the window of pixels that a box covers. */
#include "camera.h"

#include "matrix.h"
#include "vector.h"

#define DEGREES_TO_RADIANS 0.017453292519943295
/* Sine of the smallest angle between view direction and view-up at which double still defines the upward direction. */
#define PARALLEL_BELOW 1e-9
#define FRAME 0.95 /* of the window, which a framed box fills at most */
/* Limits on the squared length of a camera's forward vector. */
#define SMALLEST_VECTOR 1e-30
#define LARGEST_VECTOR 1e30

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

/* Makes a camera whose `right` has the length half_height*aspect, and whose `up` has the length half_height. */
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
  if (stratus_vector_normalize(forward) == 0.0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera eye and focal point (%g, %g, %g) must differ, by a finite distance",
      focal[0], focal[1], focal[2]);
  }
  if (stratus_vector_normalize(upwards) == 0.0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera view_up is (0, 0, 0), must have a length");
  }
  stratus_vector_cross(forward, upwards, right);
  if (!(right[0] * right[0] + right[1] * right[1] + right[2] * right[2] > PARALLEL_BELOW * PARALLEL_BELOW)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera view_up (%g, %g, %g) is parallel to the view direction", view_up[0],
      view_up[1], view_up[2]);
  }
  (void)stratus_vector_normalize(right);
  stratus_vector_cross(right, forward, up);

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

/* The distance from a box's middle at which a perspective camera sees all of its corners, or half the height of a parallel camera's window.
 * axes: right, up and back, of length 1. slope: of the upper edge of the view; 0: parallel. */
static double framing(const double half[3], double axes[3][3], double slope, double aspect)
{
  double most = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const double p[3] = { corner & 1 ? half[0] : -half[0], corner & 2 ? half[1] : -half[1], corner & 4 ? half[2] : -half[2] };
    const double across = fmax(fabs(stratus_vector_dot(p, axes[0])) / aspect, fabs(stratus_vector_dot(p, axes[1]))) / FRAME;
    most = fmax(most, slope > 0.0 ? stratus_vector_dot(p, axes[2]) + across / slope : across);
  }
  return most;
}

stratus_status stratus_camera_frame(stratus_context* context, const double bounds[6], int up_axis, double azimuth, double elevation,
  double view_angle, double aspect, stratus_camera* camera)
{
  double middle[3], half[3], axes[3][3], eye[3], up[3] = { 0.0, 0.0, 0.0 };
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!bounds || up_axis < 0 || up_axis > 2) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, bounds ? "camera up_axis %d outside 0..2" : "camera bounds are NULL", up_axis);
  }
  if (!isfinite(azimuth) || !(elevation >= -89.0 && elevation <= 89.0) || !(view_angle >= 0.0 && view_angle < 180.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "camera azimuth %g, elevation %g and view_angle %g: must be finite, in -89..89, and in 0..180, less than 180", azimuth, elevation,
      view_angle);
  }
  if (!(aspect > 0.0) || !isfinite(aspect)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera aspect %g, must be positive and finite", aspect);
  }
  for (int a = 0; a < 3; ++a) {
    const double lo = bounds[2 * a], hi = bounds[2 * a + 1];
    if (!isfinite(lo) || !isfinite(hi) || lo > hi) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "camera bounds %g..%g along axis %d are not an ordered finite range", lo, hi, a);
    }
    middle[a] = 0.5 * lo + 0.5 * hi;
    half[a] = 0.5 * hi - 0.5 * lo;
  }
  up[up_axis] = 1.0;
  axes[2][up_axis] = sin(elevation * DEGREES_TO_RADIANS);
  axes[2][(up_axis + 1) % 3] = cos(elevation * DEGREES_TO_RADIANS) * cos(azimuth * DEGREES_TO_RADIANS);
  axes[2][(up_axis + 2) % 3] = cos(elevation * DEGREES_TO_RADIANS) * sin(azimuth * DEGREES_TO_RADIANS);
  stratus_vector_cross(up, axes[2], axes[0]);
  (void)stratus_vector_normalize(axes[0]);
  stratus_vector_cross(axes[2], axes[0], axes[1]);
  const double slope = tan(0.5 * view_angle * DEGREES_TO_RADIANS), fits = framing(half, axes, slope, aspect);
  if (!(fits > 0.0) || !isfinite(fits)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera bounds have no diagonal that is finite and above 0");
  }
  const double distance = slope > 0.0 ? fits : 4.0 * sqrt(stratus_vector_dot(half, half));
  for (int a = 0; a < 3; ++a) {
    eye[a] = middle[a] + distance * axes[2][a];
  }
  return slope > 0.0 ? stratus_camera_perspective(context, eye, middle, up, view_angle, aspect, camera)
                     : stratus_camera_parallel(context, eye, middle, up, fits, aspect, camera);
}

stratus_status stratus_camera_check(stratus_context* context, const stratus_camera* camera, const stratus_image* image)
{
  if (!camera) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera is NULL");
  }
  if (!stratus_vector_finite(camera->eye) || !stratus_vector_finite(camera->forward) || !stratus_vector_finite(camera->right) ||
    !stratus_vector_finite(camera->up)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "camera eye (%g, %g, %g), forward (%g, %g, %g), right (%g, %g, %g) and up (%g, %g, %g) must be finite", camera->eye[0],
      camera->eye[1], camera->eye[2], camera->forward[0], camera->forward[1], camera->forward[2], camera->right[0], camera->right[1],
      camera->right[2], camera->up[0], camera->up[1], camera->up[2]);
  }
  const double* f = camera->forward;
  const double* r = camera->right;
  const double* u = camera->up;
  const double ff = stratus_vector_dot(f, f), rr = stratus_vector_dot(r, r), uu = stratus_vector_dot(u, u);
  if (!(ff >= SMALLEST_VECTOR && ff <= LARGEST_VECTOR)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "camera forward (%g, %g, %g) has no direction: its squared length %g must be %g..%g", f[0], f[1], f[2], ff, SMALLEST_VECTOR,
      LARGEST_VECTOR);
  }
  const double volume = f[0] * (r[1] * u[2] - r[2] * u[1]) + f[1] * (r[2] * u[0] - r[0] * u[2]) + f[2] * (r[0] * u[1] - r[1] * u[0]);
  if (!camera->parallel && rr > 0.0 && uu > 0.0 && !(fabs(volume) > 1e-12 * sqrt(ff) * sqrt(rr) * sqrt(uu))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "camera forward (%g, %g, %g), right (%g, %g, %g) and up (%g, %g, %g) are in one plane", f[0], f[1], f[2], r[0], r[1], r[2], u[0],
      u[1], u[2]);
  }
  if (!(camera->near_k < camera->far_k) || !isfinite(camera->near_k) || (!camera->parallel && camera->near_k < 0.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera near %g and far %g: near must be %sfinite and below far", camera->near_k,
      camera->far_k, camera->parallel ? "" : "at least 0, ");
  }
  if (image->opaque_depth && (!isfinite(camera->far_k) || (!camera->parallel && camera->near_k <= 0.0))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "opaque depth needs a finite far and a positive near, not %g and %g",
      camera->far_k, camera->near_k);
  }
  return STRATUS_OK;
}

double stratus_camera_place(const stratus_camera* camera, double depth)
{
  const double near_k = camera->near_k, far_k = camera->far_k, extent = depth * (far_k - near_k);
  return camera->parallel ? near_k + extent : near_k * far_k / (far_k - extent);
}

void stratus_camera_ray(const stratus_camera* camera, const int sides[2], int x, int y, double from[3], double along[3])
{
  const double u = (2.0 * x + 1.0) / sides[0] - 1.0, v = (2.0 * y + 1.0) / sides[1] - 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double side = u * camera->right[axis] + v * camera->up[axis];
    from[axis] = camera->parallel ? side : 0.0;
    along[axis] = camera->forward[axis] + (camera->parallel ? 0.0 : side);
  }
}

void stratus_camera_window(const double eye[3], const double right[3], const double up[3], const double forward[3], bool parallel,
  const double lo[3], const double hi[3], const int sides[2], int window[4])
{
  double matrix[16] = { [15] = 1.0 }, inverse[16], range[4] = { INFINITY, -INFINITY, INFINITY, -INFINITY };
  window[0] = window[2] = 0;
  window[1] = sides[0];
  window[3] = sides[1];
  for (int row = 0; row < 3; ++row) {
    matrix[4 * row] = right[row];
    matrix[4 * row + 1] = up[row];
    matrix[4 * row + 2] = forward[row];
  }
  if (!stratus_matrix_invert_affine(matrix, inverse)) {
    return;
  }
  for (int corner = 0; corner < 8; ++corner) {
    double point[3], uvk[3];
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = (corner >> axis & 1 ? hi[axis] : lo[axis]) - eye[axis];
    }
    stratus_matrix_vector(inverse, point, uvk);
    if (!parallel && !(uvk[2] > 0.0)) {
      return;
    }
    for (int side = 0; side < 2; ++side) {
      const double at = uvk[side] / (parallel ? 1.0 : uvk[2]);
      range[2 * side] = fmin(range[2 * side], at);
      range[2 * side + 1] = fmax(range[2 * side + 1], at);
    }
  }
  for (int side = 0; side < 2; ++side) {
    const double first = floor(0.5 * (range[2 * side] + 1.0) * sides[side] - 1.0),
                 last = ceil(0.5 * (range[2 * side + 1] + 1.0) * sides[side] + 1.0);
    window[2 * side] = first > 0.0 ? (int)fmin(first, sides[side]) : 0;
    window[2 * side + 1] = last < sides[side] ? (int)fmax(last, 0.0) : sides[side];
  }
}
