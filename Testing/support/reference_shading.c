/* SPDX-License-Identifier: BSD-3-Clause
 * Light, gradient opacity and components of the reference renderer, written from the contract in stratus/ray_cast.h, in doubles, without
 * regard to speed. */
#include "reference_shading.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Optical depth of an opaque sample: large, but finite, so that it can be weighted against others. */
#define OPAQUE_DEPTH 1e6

int reference_components(const stratus_volume* volume)
{
  return volume->components > 1 ? volume->components : 1;
}

int reference_has_shading(const reference_scene* scene)
{
  return scene->transfer_2d || scene->shading || scene->materials || scene->transfer->gradient_count > 0 ||
    reference_components(scene->volume) > 1 || scene->label_count > 0;
}

/* Returns the transfer function of the nearest value's label. */
static const stratus_transfer* function_of(const reference_scene* scene, const reference_place* place)
{
  const int64_t* n = scene->volume->dimensions;
  int64_t at[3];
  for (int a = 0; a < 3; ++a) {
    at[a] = place->spot[a].nearest;
  }
  const int label = scene->label_count > 0 ? scene->labels[(at[2] * n[1] + at[1]) * n[0] + at[0]] : 0;
  return scene->transfer + (label <= scene->label_count ? label : 0);
}

stratus_volume reference_component(const stratus_volume* volume, int c)
{
  stratus_volume view = *volume;
  view.values = (const char*)volume->values + (size_t)c * stratus_type_size(volume->type);
  view.components = 1;
  return view;
}

static double length_of(const double v[3])
{
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Normalizes a vector; 0 stays 0. */
static void unit(double v[3])
{
  const double length = length_of(v);
  for (int a = 0; a < 3; ++a) {
    v[a] = length > 0.0 ? v[a] / length : 0.0;
  }
}

/* ---- gradients */

/* Returns the slope, at the middle one of three values, of the parabola through them: Lagrange's polynomials, differentiated. */
static double parabola_slope(const stratus_volume* volume, const int64_t low[3], const int64_t at[3], const int64_t high[3], int axis)
{
  const double x[3] = { reference_axis_place(volume, axis, low[axis]), reference_axis_place(volume, axis, at[axis]),
    reference_axis_place(volume, axis, high[axis]) };
  const double v[3] = { reference_value(volume, low[0], low[1], low[2]), reference_value(volume, at[0], at[1], at[2]),
    reference_value(volume, high[0], high[1], high[2]) };
  return v[0] * (x[1] - x[2]) / ((x[0] - x[1]) * (x[0] - x[2])) + v[1] * (1.0 / (x[1] - x[0]) + 1.0 / (x[1] - x[2])) +
    v[2] * (x[1] - x[0]) / ((x[2] - x[0]) * (x[2] - x[1]));
}

static double difference(const stratus_volume* volume, const int64_t at[3], int axis)
{
  int64_t low[3] = { at[0], at[1], at[2] }, high[3] = { at[0], at[1], at[2] };
  low[axis] -= at[axis] > 0;
  high[axis] += at[axis] + 1 < volume->dimensions[axis];
  if (!isfinite(reference_value(volume, low[0], low[1], low[2]))) {
    low[axis] = at[axis];
  }
  if (!isfinite(reference_value(volume, high[0], high[1], high[2]))) {
    high[axis] = at[axis];
  }
  if (volume->coordinates[axis] && low[axis] < at[axis] && at[axis] < high[axis]) {
    return parabola_slope(volume, low, at, high, axis);
  }
  const double apart = reference_axis_place(volume, axis, high[axis]) - reference_axis_place(volume, axis, low[axis]);
  const double rise = reference_value(volume, high[0], high[1], high[2]) - reference_value(volume, low[0], low[1], low[2]);
  return apart != 0.0 ? rise / apart : 0.0;
}

/* Finds the gradient in values per unit of place: interpolates the differences at the corners of the cell around p. */
static void gradient_at(const stratus_volume* volume, const reference_spot p[3], bool linear, reference_gradients* kept, double g[3])
{
  const int corners = linear ? 8 : 1;
  int64_t lower[3];
  double t[3];
  for (int a = 0; a < 3; ++a) {
    lower[a] = linear ? p[a].cell : p[a].nearest;
    t[a] = linear ? p[a].fraction : 0.0;
  }
  if (memcmp(kept->at, lower, sizeof lower) != 0) {
    memcpy(kept->at, lower, sizeof lower);
    for (int corner = 0; corner < corners; ++corner) {
      int64_t at[3];
      for (int a = 0; a < 3; ++a) {
        at[a] = lower[a] + (corner >> a & 1);
        at[a] = at[a] < volume->dimensions[a] ? at[a] : volume->dimensions[a] - 1;
      }
      for (int a = 0; a < 3; ++a) {
        kept->corner[corner][a] = difference(volume, at, a);
      }
    }
  }
  memset(g, 0, 3 * sizeof *g);
  for (int corner = 0; corner < corners; ++corner) {
    double weight = 1.0;
    for (int a = 0; a < 3; ++a) {
      weight *= corner >> a & 1 ? t[a] : 1.0 - t[a];
    }
    for (int a = 0; weight > 0.0 && a < 3; ++a) {
      g[a] += weight * kept->corner[corner][a];
    }
  }
}

/* Returns whether a clip plane hides a position, given by places, of which a volume without coordinates has one a value. */
static bool is_clipped(const reference_scene* scene, const double p[3])
{
  const stratus_volume* v = scene->volume;
  bool hidden = false;
  for (int i = 0; i < scene->clip_plane_count; ++i) {
    double height = scene->clip_planes[i][3];
    for (int r = 0; r < 3; ++r) {
      double world = v->matrix[4 * r + 3];
      for (int m = 0; m < 3; ++m) {
        double local = v->origin[m];
        for (int a = 0; a < 3; ++a) {
          local += v->direction[3 * m + a] * v->spacing[a] * (p[a] + (v->cell_centered ? 0.5 : 0.0));
        }
        world += v->matrix[4 * r + m] * local;
      }
      height += scene->clip_planes[i][r] * world;
    }
    hidden = hidden || height < 0.0;
  }
  return hidden;
}

/* Returns the field at a place, NAN where there is none. */
static double field_near(const reference_scene* scene, const stratus_volume* view, const double p[3])
{
  double sum = 0.0;
  int64_t at[3], nearest[3];
  double t[3];
  for (int a = 0; a < 3; ++a) {
    const reference_spot spot = reference_axis_find(view, a, p[a]);
    if (p[a] < 0.0 || p[a] > (double)(view->dimensions[a] - 1)) {
      return (double)NAN;
    }
    at[a] = spot.cell;
    nearest[a] = spot.nearest;
    t[a] = spot.fraction;
  }
  if (scene->interpolation == STRATUS_INTERPOLATION_NEAREST) {
    return reference_value(view, nearest[0], nearest[1], nearest[2]);
  }
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    int64_t c[3];
    for (int a = 0; a < 3; ++a) {
      const int up = corner >> a & 1;
      weight *= up ? t[a] : 1.0 - t[a];
      c[a] = at[a] + up < view->dimensions[a] ? at[a] + up : at[a];
    }
    sum += weight * reference_value(view, c[0], c[1], c[2]);
  }
  return sum;
}

/* Takes the gradient anew along axes with a neighbour that clip planes hide. */
static void clip_gradient(const reference_scene* scene, const stratus_volume* view, const reference_place* place, double g[3])
{
  double here[3];
  for (int a = 0; a < 3; ++a) {
    here[a] = fmin(fmax(place->at[a], 0.0), (double)(view->dimensions[a] - 1));
  }
  for (int a = 0; a < 3; ++a) {
    double value[2], from = 0.0, to = 0.0;
    bool any = false;
    for (int side = 0; side < 2; ++side) {
      double p[3] = { place->at[0], place->at[1], place->at[2] };
      p[a] += side ? 1.0 : -1.0;
      const bool hidden = is_clipped(scene, p);
      for (int b = 0; b < 3; ++b) {
        p[b] = b == a ? p[b] : here[b];
      }
      value[side] = hidden ? scene->clipped_value : field_near(scene, view, p);
      any = any || hidden;
      from = side == 0 && isfinite(value[0]) ? -1.0 : from;
      to = side == 1 && isfinite(value[1]) ? 1.0 : to;
    }
    if (any) {
      const double middle = field_near(scene, view, here);
      g[a] = ((to > 0.0 ? value[1] : middle) - (from < 0.0 ? value[0] : middle)) / (to - from);
    }
  }
}

static void gradient_of(
  const reference_scene* scene, const stratus_volume* view, const reference_place* place, reference_gradients* kept, double g[3])
{
  gradient_at(view, place->spot, scene->interpolation == STRATUS_INTERPOLATION_LINEAR, kept, g);
  if (scene->clip_gradients) {
    clip_gradient(scene, view, place, g);
  }
}

/* Returns a gradient's length in values per mean spacing. */
static double magnitude_of(const stratus_volume* volume, const double g[3])
{
  double v[3];
  const double mean = (reference_axis_mean(volume, 0) + reference_axis_mean(volume, 1) + reference_axis_mean(volume, 2)) / 3.0;
  for (int a = 0; a < 3; ++a) {
    v[a] = g[a] / reference_axis_unit(volume, a) * mean;
  }
  return length_of(v);
}

static double gradient_factor(const stratus_volume* volume, const stratus_transfer* transfer, const double g[3])
{
  if (transfer->gradient_count == 0) {
    return 1.0;
  }
  const stratus_transfer function = { .opacity = transfer->gradient, .opacity_count = transfer->gradient_count, .clamp = 1 };
  return reference_opacity(&function, magnitude_of(volume, g));
}

/* ---- light */

/* The part of a positional light that reaches a place, from which `way` leads to it. */
static double part_of_light(const stratus_light* light, const double way[3])
{
  const double* k = light->attenuation;
  const double r = length_of(way), sum = k[0] + k[1] * r + k[2] * r * r;
  double part = k[0] + k[1] + k[2] > 0.0 ? 1.0 / sum : 1.0;
  if (light->cone_angle > 0.0 && light->cone_angle < 90.0) {
    const double cosine = -dot(way, light->axis) / (r * length_of(light->axis));
    part = acos(fmin(cosine, 1.0)) <= light->cone_angle * acos(-1.0) / 180.0 ? part * pow(cosine, light->cone_exponent) : 0.0;
  }
  return part;
}

/* Henyey and Greenstein's phase function times 4 pi. way: from the place to the light, of length 1. */
static double phase_of(const stratus_shading* shading, const reference_place* place, const double way[3])
{
  const double g = shading->anisotropy, cosine = dot(way, place->direction); /* the light goes along -way, and on along -direction */
  return (1.0 - g * g) / pow(1.0 + g * g - 2.0 * g * cosine, 1.5);
}

static void add_light(const reference_scene* scene, const stratus_material* shading, const stratus_light* light,
  const reference_place* place, const double normal[3], double diffuse[3], double specular[3])
{
  double to[3], half_way[3];
  for (int a = 0; a < 3; ++a) {
    to[a] = light->vector[a] - (light->positional ? place->world[a] : 0.0);
  }
  double part = light->positional ? part_of_light(light, to) : 1.0;
  if (scene->shading->shadows) {
    part *= reference_passing(scene, place->matter, light, place->world);
  }
  unit(to);
  for (int a = 0; a < 3; ++a) {
    diffuse[a] += scene->shading->scattering * part * shading->diffuse * phase_of(scene->shading, place, to) * light->color[a];
  }
  part *= 1.0 - scene->shading->scattering;
  for (int a = 0; a < 3; ++a) {
    half_way[a] = to[a] - place->direction[a];
  }
  unit(half_way);
  const double cosine = dot(normal, to), gloss = dot(normal, half_way);
  if (cosine > 0.0) {
    const double shine = gloss > 0.0 ? part * shading->specular * pow(gloss, shading->specular_power) : 0.0;
    for (int a = 0; a < 3; ++a) {
      diffuse[a] += part * shading->diffuse * cosine * light->color[a];
      specular[a] += shine * (light->separate_specular ? light->specular_color[a] : light->color[a]);
    }
  }
}

static void illuminate(
  const reference_scene* scene, const stratus_material* material, const reference_place* place, const double g[3], double rgb[3])
{
  const stratus_shading* shading = scene->shading;
  double normal[3], diffuse[3] = { material->ambient, material->ambient, material->ambient }, specular[3] = { 0.0, 0.0, 0.0 };
  for (int a = 0; a < 3; ++a) {
    normal[a] = -(g[0] * place->to_index[0][a] + g[1] * place->to_index[1][a] + g[2] * place->to_index[2][a]);
  }
  unit(normal);
  if (!shading->one_sided && dot(normal, place->direction) > 0.0) {
    for (int a = 0; a < 3; ++a) {
      normal[a] = -normal[a];
    }
  }
  stratus_light eye = { .color = { 1.0, 1.0, 1.0 }, .positional = !scene->camera->parallel };
  for (int a = 0; a < 3; ++a) {
    eye.vector[a] = scene->camera->parallel ? -scene->camera->forward[a] : scene->camera->eye[a];
  }
  for (int i = 0; i < (shading->light_count < 0 ? 1 : shading->light_count); ++i) {
    add_light(scene, material, shading->light_count < 0 ? &eye : &shading->lights[i], place, normal, diffuse, specular);
  }
  for (int a = 0; a < 3; ++a) {
    rgb[a] = rgb[a] * diffuse[a] + specular[a];
  }
}

/* ---- a sample */

static double depth_of(double opacity)
{
  return opacity < 1.0 ? fmin(-log1p(-opacity), OPAQUE_DEPTH) : OPAQUE_DEPTH;
}

/* The optical depth per unit distance that is left of `depth` by a gradient opacity. */
static double thinned(const reference_scene* scene, const stratus_transfer* transfer, double factor, double depth)
{
  const double units = scene->gradient_distance / transfer->unit_distance;
  if (!(units > 0.0) || factor >= 1.0) {
    return factor * depth;
  }
  return -log1p(factor * expm1(-depth * units)) / units;
}

/* Adds the light and optical depth of one medium. shown: the component whose gradient counts. squares: the sum of squared depths. */
static void add_medium(const reference_scene* scene, const reference_place* place, const stratus_transfer* transfer, int shown,
  double opacity, double weight, double rgb[3], double* tau, double* squares, double glow[3])
{
  const stratus_transfer* thinning = scene->label_count > 0 && transfer->gradient_count == 0 ? scene->transfer : transfer;
  double g[3] = { 0.0, 0.0, 0.0 };
  if (opacity <= 0.0) {
    return;
  }
  const stratus_shading* all = scene->shading;
  const stratus_material material = scene->materials && !scene->dependent ? scene->materials[shown]
    : all ? (stratus_material){ 1, all->ambient, all->diffuse, all->specular, all->specular_power }
          : (stratus_material){ 0 };
  if (material.shade || thinning->gradient_count > 0) {
    const stratus_volume view = reference_component(scene->volume, shown);
    gradient_of(scene, &view, place, place->gradients + shown, g);
  }
  const double factor = gradient_factor(scene->volume, thinning, g);
  const double depth = weight * thinned(scene, transfer, factor, depth_of(opacity)) / transfer->unit_distance;
  if (material.shade) {
    illuminate(scene, &material, place, g, rgb);
  }
  *tau += depth;
  *squares += depth * depth;
  for (int a = 0; a < 3; ++a) {
    glow[a] += depth * rgb[a];
  }
}

/* Shades by a function of two variables, whose second is the gradient's magnitude or the second component's value. */
static void shade_by_two(const reference_scene* scene, const reference_place* place, const double* values, double* tau, double glow[3])
{
  const stratus_transfer_2d* of = scene->transfer_2d;
  const stratus_volume view = reference_component(scene->volume, 0);
  const bool two = reference_components(scene->volume) > 1;
  double g[3], rgba[4];
  if (isnan(values[0]) || (two && isnan(values[1]))) {
    return;
  }
  gradient_of(scene, &view, place, place->gradients, g);
  reference_transfer_2d(
    of, scene->interpolation == STRATUS_INTERPOLATION_NEAREST, values[0], two ? values[1] : magnitude_of(&view, g), rgba);
  *tau = depth_of(rgba[3]) / of->unit_distance;
  if (scene->shading) {
    const stratus_material material = { 1, scene->shading->ambient, scene->shading->diffuse, scene->shading->specular,
      scene->shading->specular_power };
    illuminate(scene, &material, place, g, rgba);
  }
  for (int a = 0; a < 3; ++a) {
    glow[a] = *tau * rgba[a];
  }
}

void reference_shade(const reference_scene* scene, const reference_place* place, const double* values, double* tau, double glow[3])
{
  const int components = reference_components(scene->volume), last = components - 1;
  double rgb[3], squares = 0.0;
  bool whole = true;
  *tau = glow[0] = glow[1] = glow[2] = 0.0;
  if (scene->transfer_2d) {
    shade_by_two(scene, place, values, tau, glow);
    return;
  }
  for (int c = 0; c < components; ++c) {
    whole = whole && !isnan(values[c]);
  }
  for (int c = 0; c < components && !scene->dependent; ++c) {
    const stratus_transfer* transfer = components > 1 ? scene->transfer + c : function_of(scene, place);
    if (!isnan(values[c])) {
      reference_color(transfer, values[c], rgb);
      add_medium(scene, place, transfer, c, reference_opacity(transfer, values[c]), components > 1 ? transfer->weight : 1.0, rgb, tau,
        &squares, glow);
    }
  }
  if (scene->dependent && whole) {
    reference_color(scene->transfer, values[0], rgb);
    for (int c = 0; c < 3 && last == 3; ++c) {
      rgb[c] = values[c] / 255.0;
    }
    add_medium(scene, place, scene->transfer, last, reference_opacity(scene->transfer, values[last]), 1.0, rgb, tau, &squares, glow);
  }
  if (scene->mean_components && !scene->dependent && *tau > 0.0) {
    *tau = squares / *tau;
  }
}
