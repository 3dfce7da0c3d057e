/* SPDX-License-Identifier: BSD-3-Clause
 * Light that matter scatters more than once. The matter is drawn layer by layer into cells of extinction and albedo, so that whatever can
 * be drawn can scatter light. Of anisotropic scattering the forward part counts as light that goes on, and the rest as even (the delta
 * scaling of Joseph, Wiscombe & Weinman 1976, with as much forward as the asymmetry). The renderer adds the first scattering with the full
 * phase function, of light that is dimmed by the scaled extinction (Nakajima & Tanaka 1988). */
#include "light_scatter.h"

#include "light_surfaces.h"
#include "light_transport.h"
#include "lights.h"
#include "tiles.h"
#include "vector.h"

#include <string.h>

#define PIXELS_LEAST 256      /* rays across the longest side, so that a cell has the mean of several rays */
#define OPAQUE 1e-7           /* the least part of light that passes a layer: floats have no smaller difference from 1 */
#define FLAT 1e-6             /* a side counts as at least this part of the longest */
#define RESIDUAL 1e-4         /* relative, far below what the cells' size errs */
#define SCOUT 16              /* cells along the longest side, to find where matter is */
#define CUBE 64               /* as many cells as a cube of so many are the most */
#define NODES_MOST 256        /* along a side, however thin the matter is */
#define SHARE 0.5             /* of the tolerance, that the cells' size may use up */
#define LIGHT_SCATTER_WORDS 5 /* of a node */

/* ---- matter */

static size_t count_of(const stratus_light_cells* c)
{
  return (size_t)c->size[0] * (size_t)c->size[1] * (size_t)c->size[2];
}

/* Adds a layer's pixels to its cells: optical depths, and albedos times these. */
static void add_layer(const stratus_light_cells* c, const float* rgba, int pixels, int layer)
{
  const size_t cells = count_of(c), first = (size_t)layer * (size_t)c->size[0] * (size_t)c->size[1];
  const size_t width = (size_t)c->size[0] * (size_t)pixels, height = (size_t)c->size[1] * (size_t)pixels;
  const float part = (float)(1.0 / (c->spacing[2] * pixels * pixels));
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      const float *pixel = rgba + 4 * (y * width + x), opacity = fminf(pixel[3], 1.0f);
      if (opacity > 0.0f) {
        const size_t cell = first + y / (size_t)pixels * (size_t)c->size[0] + x / (size_t)pixels;
        const float extinction = -part * logf(fmaxf(1.0f - opacity, (float)OPAQUE));
        c->extinction[cell] += extinction;
        for (int channel = 0; channel < 3; ++channel) {
          c->albedo[(size_t)channel * cells + cell] += extinction * fminf(pixel[channel] / opacity, 1.0f);
        }
      }
    }
  }
}

/* Draws matter into cells, of which the longest side of the bounds has `nodes`. */
static stratus_status draw_cells(
  stratus_context* context, stratus_light_draw* draw, void* of, const double bounds[6], int nodes, stratus_light_cells* cells)
{
  stratus_light_cells c = { .extinction = NULL };
  double longest = 1e-300, center[3], half[3];
  void *memory = NULL, *picture = NULL;
  stratus_status status;
  for (int axis = 0; axis < 3; ++axis) {
    longest = fmax(longest, bounds[2 * axis + 1] - bounds[2 * axis]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double side = fmax(bounds[2 * axis + 1] - bounds[2 * axis], FLAT * longest);
    center[axis] = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]);
    half[axis] = 0.5 * side;
    c.size[axis] = (int)fmin(fmax(ceil(side / longest * nodes - 1e-9), 1.0), nodes);
    c.spacing[axis] = side / c.size[axis];
    c.lo[axis] = center[axis] - half[axis];
  }
  const int pixels = (PIXELS_LEAST + nodes - 1) / nodes;
  const size_t count = count_of(&c);
  const stratus_image image = { .width = c.size[0] * pixels, .height = c.size[1] * pixels };
  TRY_CLEANUP(stratus_allocate_zero(context, count, 4 * sizeof(float), &memory));
  TRY_CLEANUP(stratus_allocate(context, (size_t)image.width * (size_t)image.height, 4 * sizeof(float), &picture));
  c.extinction = memory;
  c.albedo = c.extinction + count;
  for (int layer = 0; layer < c.size[2]; ++layer) {
    stratus_image drawn = image;
    drawn.rgba = picture;
    const stratus_camera camera = { .parallel = 1,
      .eye = { center[0], center[1], c.lo[2] },
      .forward = { 0.0, 0.0, 1.0 },
      .right = { half[0], 0.0, 0.0 },
      .up = { 0.0, half[1], 0.0 },
      .near_k = layer * c.spacing[2],
      .far_k = (layer + 1) * c.spacing[2] };
    TRY_CLEANUP(draw(of, &camera, 1, &drawn, true));
    add_layer(&c, picture, pixels, layer);
  }
  for (size_t i = 0; i < 3 * count; ++i) {
    c.albedo[i] = c.extinction[i % count] > 0.0f ? c.albedo[i] / c.extinction[i % count] : 0.0f;
  }
  *cells = c;
  memory = NULL;
cleanup:
  stratus_release(context, memory);
  stratus_release(context, picture);
  return status;
}

static double forward_share(const stratus_shading* shading)
{
  return fmax(shading->anisotropy, 0.0);
}

double stratus_light_forward(const stratus_light_scatter* scatter, const stratus_shading* shading)
{
  const stratus_light_cells* cells = &scatter->cells;
  const size_t count = cells->extinction ? count_of(cells) : 0;
  double sum = 0.0, scattered = 0.0;
  for (size_t i = 0; i < count; ++i) {
    sum += 3.0 * (double)cells->extinction[i];
    for (size_t channel = 0; channel < 3; ++channel) {
      scattered += (double)cells->extinction[i] * (double)cells->albedo[channel * count + i];
    }
  }
  return sum > 0.0 ? forward_share(shading) * scattered / sum : 0.0;
}

/* ---- light that has not been scattered */

/* Lights, and the surfaces that hide each. */
typedef struct sources {
  const stratus_shading* shading;
  const stratus_light* lights;
  int count;
  stratus_light_frame frame[STRATUS_LIGHTS_MAX];
  stratus_light_depths depths[STRATUS_LIGHTS_MAX];
} sources;

static void release_surfaces(stratus_context* context, const sources* s)
{
  for (int i = 0; i < s->count; ++i) {
    stratus_release(context, s->depths[i].depth);
  }
}

static stratus_status find_surfaces(stratus_context* context, const double bounds[6], sources* s)
{
  static const int size[2] = { NODES_MOST, NODES_MOST };
  TRY(stratus_surfaces_check(context, s->shading->surfaces));
  for (int i = 0; i < s->count; ++i) {
    double sides[3];
    stratus_light_frame_place(&s->lights[i], bounds, &s->frame[i], sides);
    TRY(stratus_light_surfaces_draw(context, &s->frame[i], s->shading->surfaces, size, &s->depths[i]));
  }
  return STRATUS_OK;
}

/* Lights, and one channel's scaled extinction. */
typedef struct direct {
  const stratus_light_cells* cells;
  const sources* from;
  int channel;
  const float* extinction;
  float* to;
} direct;

/* The part of a cell that surfaces leave in a light, by the middles of its octants. */
static double seen_part(const direct* d, int light, const int cell[3])
{
  const stratus_light_cells* c = d->cells;
  double sum = 0.0;
  for (int octant = 0; d->from->depths[light].depth && octant < 8; ++octant) {
    double place[3];
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = c->lo[axis] + (cell[axis] + (octant >> axis & 1 ? 0.75 : 0.25)) * c->spacing[axis];
    }
    sum += 0.125 * stratus_light_surfaces_passing(&d->from->frame[light], &d->from->depths[light], place);
  }
  return d->from->depths[light].depth ? sum : 1.0;
}

/* The optical depth along a direction from a cell's centre to where it leaves the cell, and from there to the end of the cells or to a
 * distance. */
static double depth_from(const direct* d, const int cell[3], const double way[3], double distance, double* own)
{
  const stratus_light_cells* c = d->cells;
  const size_t stride[3] = { 1, (size_t)c->size[0], (size_t)c->size[0] * (size_t)c->size[1] };
  int at[3] = { cell[0], cell[1], cell[2] };
  double next[3], each[3], here = 0.0, depth = 0.0;
  bool first = true;
  for (int axis = 0; axis < 3; ++axis) {
    each[axis] = way[axis] != 0.0 ? c->spacing[axis] / fabs(way[axis]) : (double)INFINITY;
    next[axis] = 0.5 * each[axis];
  }
  *own = 0.0;
  for (;;) {
    const int axis = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
    const double to = fmin(next[axis], distance);
    const double extinction = (double)d->extinction[(size_t)at[0] + (size_t)at[1] * stride[1] + (size_t)at[2] * stride[2]];
    if (first) {
      *own = extinction * (to - here);
      first = false;
    } else {
      depth += extinction * (to - here);
    }
    here = to;
    at[axis] += way[axis] > 0.0 ? 1 : -1;
    next[axis] += each[axis];
    if (here >= distance || at[axis] < 0 || at[axis] >= c->size[axis] || depth > 80.0) {
      return depth;
    }
  }
}

/* The mean transmittance over a cell of an optical depth, where light enters with 1. */
static double mean_passing(double depth)
{
  return depth > 1e-4 ? -expm1(-depth) / depth : 1.0 - 0.5 * depth;
}

static void shine_on_row(const void* data, int row, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const direct* d = data;
  const stratus_light_cells* c = d->cells;
  int cell[3] = { 0, row % c->size[1], row / c->size[1] };
  (void)counts;
  for (; cell[0] < c->size[0]; ++cell[0]) {
    const size_t at = (size_t)row * (size_t)c->size[0] + (size_t)cell[0];
    double sum = 0.0;
    for (int i = 0; i < d->from->count && d->extinction[at] > 0.0f; ++i) {
      const stratus_light* light = &d->from->lights[i];
      double way[3], own, distance = (double)INFINITY;
      for (int axis = 0; axis < 3; ++axis) {
        const double center = c->lo[axis] + (cell[axis] + 0.5) * c->spacing[axis];
        way[axis] = light->vector[axis] - (light->positional ? center : 0.0);
      }
      const double length = stratus_vector_normalize(way);
      double part = light->color[d->channel];
      if (light->positional) {
        distance = length;
        part *= stratus_lamp_reaching(light, way, length);
      }
      if (part > 0.0 && length > 0.0) {
        const double depth = depth_from(d, cell, way, distance, &own);
        sum += part * exp(-depth) * mean_passing(2.0 * own) * seen_part(d, i, cell);
      }
    }
    d->to[at] = (float)sum;
  }
}

/* ---- words */

static void set_sky(const stratus_shading* shading, int channel, stratus_transport* medium)
{
  double up[3];
  memcpy(up, shading->up, sizeof up);
  (void)stratus_vector_normalize(up);
  for (int i = 0; i < STRATUS_TRANSPORT_DIRECTIONS; ++i) {
    double way[3];
    (void)stratus_transport_direction(i, way);
    const double height = fmin(fmax(-stratus_vector_dot(way, up), 0.0), 1.0);
    medium->sky[i] = (float)(shading->sky_horizon[channel] + height * (shading->sky_zenith[channel] - shading->sky_horizon[channel]));
  }
}

/* Whether two channels have the same light and the same matter. */
static bool same_channel(const stratus_light_cells* cells, const sources* from, int a, int b)
{
  const stratus_shading* shading = from->shading;
  const size_t n = count_of(cells);
  bool same = shading->sky_zenith[a] == shading->sky_zenith[b] && shading->sky_horizon[a] == shading->sky_horizon[b];
  for (int i = 0; same && i < from->count; ++i) {
    same = from->lights[i].color[a] == from->lights[i].color[b];
  }
  return same && memcmp(cells->albedo + (size_t)a * n, cells->albedo + (size_t)b * n, n * sizeof(float)) == 0;
}

#define ARRAYS (2 + STRATUS_TRANSPORT_MOMENTS) /* of a channel's solution: the mean, the part of first scattering, and the moments */

/* Solves one channel. work: three arrays. */
static stratus_status solve_channel(
  stratus_context* context, const stratus_light_cells* cells, const sources* from, int channel, float* work, float* result)
{
  const size_t n = count_of(cells);
  const double forward = forward_share(from->shading);
  float *extinction = work, *albedo = work + n, *shone = work + 2 * n;
  int sweeps;
  for (size_t i = 0; i < n; ++i) {
    const double whole = (double)cells->albedo[(size_t)channel * n + i], goes_on = forward * whole;
    extinction[i] = (float)((double)cells->extinction[i] * (1.0 - goes_on));
    albedo[i] = (float)(whole * (1.0 - forward) / (1.0 - goes_on));
  }
  uint64_t counts[STRATUS_TILE_COUNTS];
  const direct d = { .cells = cells, .from = from, .channel = channel, .extinction = extinction, .to = shone };
  TRY(stratus_each_tile(context, "scattering", cells->size[1] * cells->size[2], shine_on_row, &d, counts));
  stratus_transport medium = { .extinction = extinction, .albedo = albedo, .direct = shone };
  memcpy(medium.size, cells->size, sizeof medium.size);
  memcpy(medium.spacing, cells->spacing, sizeof medium.spacing);
  set_sky(from->shading, channel, &medium);
  return stratus_transport_solve(context, &medium, RESIDUAL, result, result + n, result + 2 * n, &sweeps);
}

static uint32_t rounded(double part, double most)
{
  return (uint32_t)(fmin(fmax(part, 0.0), 1.0) * most + 0.5);
}

/* The largest size of a moment, as a part of the mean: all light comes from one direction. */
static double most_of(int moment)
{
  return moment < 3 ? 1.0 : moment < 5 ? 2.0 / 3.0 : 0.5;
}

static void words_of_node(float* const of[3], const double largest[3], size_t n, size_t i, int32_t words[LIGHT_SCATTER_WORDS])
{
  uint32_t number[LIGHT_SCATTER_WORDS] = { 0 }, even[3];
  double sum = 1e-30, first = 0.0;
  for (int c = 0; c < 3; ++c) {
    even[c] = rounded((double)of[c][i] / fmax(largest[c], 1e-30), 65535.0);
    sum += (double)of[c][i];
    first += (double)of[c][i] * (double)of[c][n + i];
  }
  number[0] = even[0] | even[1] << 16;
  number[1] = even[2];
  for (int moment = 0; moment < STRATUS_TRANSPORT_MOMENTS; ++moment) {
    const size_t at = (size_t)(2 + moment) * n + i;
    const double part = ((double)of[0][at] + (double)of[1][at] + (double)of[2][at]) / (sum * most_of(moment));
    number[2 + moment / 3] |= rounded(0.5 + 0.5 * part, 1022.0) << 10 * (moment % 3);
  }
  number[LIGHT_SCATTER_WORDS - 1] |= rounded(first / sum, 1022.0) << 20;
  for (int word = 0; word < LIGHT_SCATTER_WORDS; ++word) {
    words[word] = (int32_t)number[word];
  }
}

/* Solves for the light in the cells. */
static stratus_status solve(stratus_context* context, const sources* from, stratus_light_scatter* scatter)
{
  const stratus_light_cells* cells = &scatter->cells;
  const size_t n = count_of(cells);
  void* memory;
  double largest[3] = { 0.0, 0.0, 0.0 };
  stratus_status status;
  TRY(stratus_allocate(context, n, (3 + 3 * ARRAYS) * sizeof(float), &memory));
  float *work = memory, *of[3];
  for (int c = 0; c < 3; ++c) {
    of[c] = work + (3 + ARRAYS * (size_t)c) * n;
    for (int same = 0; same < c; ++same) {
      of[c] = same_channel(cells, from, same, c) ? of[same] : of[c];
    }
    if (of[c] == work + (3 + ARRAYS * (size_t)c) * n) {
      TRY_CLEANUP(solve_channel(context, cells, from, c, work, of[c]));
    }
    for (size_t i = 0; i < n; ++i) {
      largest[c] = fmax(largest[c], (double)of[c][i]);
    }
    scatter->scale[c] = (float)(largest[c] / 65535.0);
  }
  void* words;
  TRY_CLEANUP(stratus_allocate(context, n, LIGHT_SCATTER_WORDS * sizeof(int32_t), &words));
  scatter->words = words;
  for (size_t i = 0; i < n; ++i) {
    words_of_node(of, largest, n, i, scatter->words + LIGHT_SCATTER_WORDS * i);
  }
cleanup:
  stratus_release(context, memory);
  return status;
}

/* ---- all */

static void cell_of(const stratus_light_cells* c, size_t i, int cell[3])
{
  const size_t width = (size_t)c->size[0], height = (size_t)c->size[1];
  cell[0] = (int)(i % width);
  cell[1] = (int)(i / width % height);
  cell[2] = (int)(i / (width * height));
}

/* Adds the mean radiance of a node times a weight. */
static void add_mean(const stratus_light_scatter* s, size_t node, double weight, double rgb[3])
{
  const uint32_t red_green = (uint32_t)s->words[LIGHT_SCATTER_WORDS * node], blue = (uint32_t)s->words[LIGHT_SCATTER_WORDS * node + 1];
  rgb[0] += weight * (double)s->scale[0] * (double)(red_green & 0xffff);
  rgb[1] += weight * (double)s->scale[1] * (double)(red_green >> 16);
  rgb[2] += weight * (double)s->scale[2] * (double)blue;
}

/* Adds the mean radiance at a place of the world times a weight. */
static void add_mean_at(const stratus_light_scatter* s, const double place[3], double weight, double rgb[3])
{
  size_t at = 0, stride = 1, step[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int last = s->cells.size[axis] - 1;
    const double q = fmin(fmax((place[axis] - s->cells.lo[axis]) / s->cells.spacing[axis] - 0.5, 0.0), last);
    const int cell = q < last ? (int)q : last > 0 ? last - 1 : 0;
    part[axis] = q - cell;
    at += stride * (size_t)cell;
    step[axis] = last > 0 ? stride : 0;
    stride *= (size_t)s->cells.size[axis];
  }
  for (int corner = 0; corner < 8; ++corner) {
    double share = weight;
    size_t node = at;
    for (int axis = 0; axis < 3; ++axis) {
      share *= corner >> axis & 1 ? part[axis] : 1.0 - part[axis];
      node += corner >> axis & 1 ? step[axis] : 0;
    }
    add_mean(s, node, share, rgb);
  }
}

/* The root mean square of the difference between two solutions, weighted by the opacity of the finer one's cells. */
static double difference(const stratus_light_scatter* coarse, const stratus_light_scatter* fine)
{
  const stratus_light_cells* c = &fine->cells;
  const size_t n = count_of(c);
  const double depth = cbrt(c->spacing[0] * c->spacing[1] * c->spacing[2]);
  double squares = 0.0, weights = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const double opacity = -expm1(-(double)c->extinction[i] * depth);
    if (opacity > 0.0) {
      int cell[3];
      double place[3], apart[3] = { 0.0, 0.0, 0.0 };
      cell_of(c, i, cell);
      for (int axis = 0; axis < 3; ++axis) {
        place[axis] = c->lo[axis] + (cell[axis] + 0.5) * c->spacing[axis];
      }
      add_mean_at(coarse, place, -1.0, apart);
      add_mean(fine, i, 1.0, apart);
      for (size_t channel = 0; channel < 3; ++channel) {
        const double shown = (double)c->albedo[channel * n + i] * apart[channel];
        squares += opacity * shown * shown / 3.0;
      }
      weights += opacity;
    }
  }
  return weights > 0.0 ? sqrt(squares / weights) : 0.0;
}

/* The bounds of the cells that have matter, and of one more cell on each side, because matter between their rays was not seen. */
static void box_of_matter(const stratus_light_cells* c, const double bounds[6], double box[6])
{
  int first[3], last[3] = { -1, -1, -1 };
  memcpy(first, c->size, sizeof first);
  memcpy(box, bounds, 6 * sizeof *box);
  for (size_t i = 0; i < count_of(c); ++i) {
    int cell[3];
    cell_of(c, i, cell);
    for (int axis = 0; axis < 3 && c->extinction[i] > 0.0f; ++axis) {
      first[axis] = cell[axis] < first[axis] ? cell[axis] : first[axis];
      last[axis] = cell[axis] > last[axis] ? cell[axis] : last[axis];
    }
  }
  for (int axis = 0; axis < 3 && last[axis] >= 0; ++axis) {
    box[2 * axis] = fmax(bounds[2 * axis], c->lo[axis] + (first[axis] - 1) * c->spacing[axis]);
    box[2 * axis + 1] = fmin(bounds[2 * axis + 1], c->lo[axis] + (last[axis] + 2) * c->spacing[axis]);
  }
}

/* The cells along the longest side of a box that has as many as a cube of CUBE, none of them smaller than `detail`. */
static int finest_nodes(const double box[6], double detail)
{
  double longest = 1e-300, part = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    longest = fmax(longest, box[2 * axis + 1] - box[2 * axis]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    part *= fmax((box[2 * axis + 1] - box[2 * axis]) / longest, 1.0 / NODES_MOST);
  }
  const double enough = detail > 0.0 ? fmax(ceil(longest / detail), 4.0) : (double)NODES_MOST;
  return (int)fmin(fmin(CUBE / cbrt(part), enough), NODES_MOST);
}

stratus_status stratus_light_scatter_build(stratus_context* context, stratus_light_draw* draw, void* of, const double bounds[6],
  double detail, const stratus_shading* shading, const stratus_light* lights, int count, double tolerance, stratus_light_scatter* scatter)
{
  stratus_light_scatter rungs[2] = { { .words = NULL }, { .words = NULL } };
  sources from = { .shading = shading, .lights = lights, .count = count };
  double box[6];
  int now = 0;
  stratus_status status;
  TRY_CLEANUP(draw_cells(context, draw, of, bounds, SCOUT, &rungs[0].cells));
  box_of_matter(&rungs[0].cells, bounds, box);
  const int finest = finest_nodes(box, detail);
  TRY_CLEANUP(find_surfaces(context, box, &from));
  for (int part = 4; part > 0; part /= 2) {
    stratus_light_scatter* next = &rungs[1 - now];
    stratus_light_scatter_release(context, next);
    TRY_CLEANUP(draw_cells(context, draw, of, box, finest / part, &next->cells));
    TRY_CLEANUP(solve(context, &from, next));
    /* errors are of the first order in the cells' size, as light is uneven within them: the finer of two errs by their difference */
    next->error = part < 4 ? difference(&rungs[now], next) : (double)INFINITY;
    now = 1 - now;
    if (next->error <= SHARE * tolerance) {
      break;
    }
  }
  *scatter = rungs[now];
  rungs[now] = (stratus_light_scatter){ .words = NULL };
cleanup:
  release_surfaces(context, &from);
  stratus_light_scatter_release(context, &rungs[0]);
  stratus_light_scatter_release(context, &rungs[1]);
  return status;
}

void stratus_light_scatter_release(stratus_context* context, stratus_light_scatter* scatter)
{
  stratus_release(context, scatter->cells.extinction);
  stratus_release(context, scatter->words);
  scatter->cells.extinction = scatter->cells.albedo = NULL;
  scatter->words = NULL;
}

size_t stratus_light_scatter_words(const stratus_light_scatter* scatter)
{
  return scatter->words ? LIGHT_SCATTER_WORDS * count_of(&scatter->cells) : 0;
}

void stratus_light_scatter_arguments(const stratus_light_scatter* scatter, size_t at, const double to_world[16], stratus_light_arguments* a)
{
  a->scatter_at = scatter ? (int)at : -1;
  for (int row = 0; row < 3 && scatter; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double from = to_world[4 * row + column] - (column == 3 ? scatter->cells.lo[row] : 0.0);
      a->scatter_from[4 * row + column] = (float)(from / scatter->cells.spacing[row] - (column == 3 ? 0.5 : 0.0));
    }
    a->scatter_size[row] = scatter->cells.size[row];
    a->scatter_scale[row] = scatter->scale[row];
  }
}
