/* SPDX-License-Identifier: BSD-3-Clause
 * Builds maps of light: the matter is drawn layer by layer as the light sees it, and the light that passes a layer is 1 less its opacity.
 * So whatever can be drawn can cast shadows, and within a layer the picture's own integration holds. Only between nodes is anything
 * interpolated. */
#include "light_maps.h"

#include "device_frame.h"
#include "light_frame.h"
#include "light_surfaces.h"
#include "matrix.h"
#include "tiles.h"
#include "vector.h"

#include <string.h>

/* Nodes along the longest side of the first map and of the last. */
#define NODES_FIRST 32
#define NODES_LAST 256
/* Rays may pass near matter on so many lengths, each the map's spacing or NEAR_STEPS_LEAST steps if that is more, and in so many steps at
 * most. Less than a spacing is no help, since the nodes about a place reach as far. */
#define NEARS 4
static const int near_lengths[NEARS] = { 0, 1, 2, 4 };
#define NEAR_STEPS_LEAST 2
#define NEAR_STEPS_MOST 16
#define DEPTH_MOST 80.0f                 /* of a layer; behind it is no light */
#define FAINT 1e-4f                      /* nodes that add less than this to a picture are not compared */
#define LINES 16                         /* a map is compared with so many rows and columns of a finer one; only these are drawn of that */
#define LAYERS 32                        /* and so many of its layers are compared from the side */
#define PICTURES_BYTES ((size_t)1 << 24) /* of layers that are drawn together, which should be in the cache until they are summed */
#define ROWS 16                          /* of nodes are drawn at once at least */
#define NODES_A_BLOCK 512                /* of nodes that a thread sums at a time */
/* A map has at most so many words, 64 MiB. NODES_LAST nodes along each side are within it, but not in six faces of a cube. */
#define WORDS_MOST ((size_t)NODES_LAST * NODES_LAST * NODES_LAST)
/* The share of the tolerance that maps may use up. Errors of the picture's sampling add to it by their squares, and have .65. */
#define SHARE 0.7
/* The share that surfaces' edges may use up. The squares of the three add up to 1. */
#define SURFACE_SHARE 0.29
/* Surfaces are known at nodes that are up to so many times closer than a map's, and have at most so many words, 16 MiB. */
#define SURFACE_STEPS 64
#define SURFACE_WORDS ((size_t)1 << 22)
/* The part to which an error falls if the spacing is halved: of the second order where the light that passes is smooth, of the first where
 * it jumps, since as much smaller a part of the picture errs. A picture has both, so that not less than FALL_LEAST = 2^-1.5 is counted on,
 * and a map is not kept before a fall was measured. */
#define FALL_LEAST 0.354

typedef struct map {
  stratus_light light;
  stratus_light_frame frame;
  int size[3];
  size_t at;   /* in words */
  double near; /* the length on which rays pass near matter, in near_steps */
  int near_steps;
  double error; /* that is expected of a picture, if the light is white */
  bool finest;  /* even the finest map errs by more than was wanted, so that none built anew would err less */
  /* Of surfaces that hide the light: nodes of a face, where their words begin, and the error that is expected of them. */
  int surface_size[2]; /* 0: there are none */
  size_t surface_at;
  double surface_error;
} map;

struct stratus_light_maps {
  stratus_context* context;
  map of[STRATUS_LIGHTS_MAX];
  int count;
  int32_t* words; /* of the maps, of scattered light, and of surfaces */
  size_t words_count;
  size_t own_count;                 /* of them, those before the surfaces' */
  uint64_t surfaces_key;            /* of the surfaces that are in the words; 0: none */
  double reflectance;               /* of the matter */
  stratus_device_slot* slot;        /* the words on the context's device, once they were sent */
  stratus_light_scatter scatter;    /* its arrays are released: the words are among all words */
  size_t scatter_at, scatter_words; /* of light that is scattered more than once; scatter_words: 0: there is none */
  double goes_on;                   /* as in drawing */
  double most, brightness;          /* the error that all maps may have, and the lights' brightness when they were built */
  double scatter_error;
};

static size_t map_words(const map* m)
{
  return stratus_light_faces(&m->frame) * (size_t)m->size[0] * (size_t)m->size[1] * (size_t)m->size[2];
}

/* ---- where a map is */

/* Sets the numbers of nodes of a map whose longest side has `nodes`. Returns whether its words are few enough. */
static bool size_map(map* m, const double sides[3], int nodes)
{
  const double spacing = fmax(fmax(sides[0], sides[1]), sides[2]) / (nodes - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const int steps = (int)fmax(fmin(ceil(sides[axis] / spacing - 1e-9), nodes - 1), 1.0);
    m->size[axis] = axis < 2 ? steps + 1 : steps;
  }
  return map_words(m) <= WORDS_MOST;
}

/* ---- drawing a map */

/* The nodes of a face that are drawn: numbers first, first + step, ... across and up. */
typedef struct lattice {
  int first[2], step[2], count[2];
} lattice;

static lattice all_nodes(const map* m)
{
  return (lattice){ { 0, 0 }, { 1, 1 }, { m->size[0], m->size[1] } };
}

/* The camera of a face of a map that looks from the light, whose pixels are nodes of the lattice. Returns whether the face may see any
 * matter. */
static bool face_camera(const map* m, int face, const double bounds[6], const lattice* l, stratus_camera* camera)
{
  const stratus_light_frame* f = &m->frame;
  double basis[3][3], middle[2], half[2];
  stratus_light_face_basis(f, face, basis);
  if (f->faces == 6) {
    const int along = face / 2;
    const double end = bounds[2 * along + (face & 1 ? 0 : 1)] - f->origin[along];
    if (!(basis[2][along] * end > 0.0)) {
      return false;
    }
  }
  *camera = (stratus_camera){ .parallel = !f->perspective };
  for (int i = 0; i < 2; ++i) { /* the map's first and last nodes are at its ends, and pixels' centres are nodes */
    const double spacing = (f->hi[i] - f->lo[i]) / (m->size[i] - 1.0);
    middle[i] = f->lo[i] + spacing * (l->first[i] + 0.5 * l->step[i] * (l->count[i] - 1.0));
    half[i] = 0.5 * spacing * l->step[i] * l->count[i];
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double aside = middle[0] * basis[0][axis] + middle[1] * basis[1][axis];
    camera->eye[axis] = f->origin[axis] + (f->perspective ? 0.0 : aside);
    camera->forward[axis] = basis[2][axis] + (f->perspective ? aside : 0.0);
    camera->right[axis] = half[0] * basis[0][axis];
    camera->up[axis] = half[1] * basis[1][axis];
  }
  return true;
}

/* Nodes of a map that are being drawn. To compare a coarser map with it, the differences between pictures by both, if rays pass near matter
 * on each of near_lengths before. */
typedef struct drawing {
  stratus_context* context;
  const stratus_light_matter* matter;
  double goes_on; /* the part of the extinction that light passes as if it were not there */
  const map* map;
  lattice nodes;
  /* of a face: the light that passes to each node at the layers' near sides, one layer after the other, and at the last's far side */
  uint16_t* planes;
  float* depths;                   /* of limited reach: the optical depth up to each layer, as planes; else NULL */
  float *pictures, *rgba, *passed; /* rgba: of the layer that is looked at */
  int32_t* words;                  /* of the map; NULL: it is drawn to be compared */
  bool column;                     /* columns are drawn to compare, else rows */
  const map* coarse;               /* all that follows is set to compare */
  const int32_t* coarse_words;
  float* along;                               /* of the view along the light's way, each node's differences so far */
  double near_layers, squares[NEARS], pixels; /* near_layers: of the finer map, in a near length of the coarser */
} drawing;

static size_t drawn_nodes(const drawing* d)
{
  return (size_t)d->nodes.count[0] * (size_t)d->nodes.count[1];
}

/* The opacity at a node of a layer's picture. */
static float opacity_at(const float* rgba, size_t node)
{
  const float opacity = rgba[4 * node + 3];
  return opacity < 1.0f ? opacity > 0.0f ? opacity : 0.0f : 1.0f;
}

/* The part of light that passes the layer there. */
static float passes(const drawing* d, const float* rgba, size_t node)
{
  const float passed = 1.0f - opacity_at(rgba, node);
  return d->goes_on > 0.0 && passed < 1.0f ? powf(passed, (float)(1.0 - d->goes_on)) : passed;
}

/* The optical depth of a layer there. */
static float depth_of_layer(const drawing* d, const float* rgba, size_t node)
{
  return fminf(-logf(fmaxf(passes(d, rgba, node), 1e-30f)), DEPTH_MOST);
}

/* The part of light that passes to the end of an optical depth, `layers` from the side that the light comes from, if the matter within
 * reach hides it. */
static float passes_within_reach(const drawing* d, size_t node, float depth, double layers)
{
  const stratus_light_frame* f = &d->map->frame;
  const size_t nodes = drawn_nodes(d), at[2] = { node % (size_t)d->nodes.count[0], node / (size_t)d->nodes.count[0] };
  double square = 1.0; /* of a way that goes through a layer of depth 1 */
  for (int axis = 0; axis < 2 && f->perspective; ++axis) {
    const double number = d->nodes.first[axis] + (double)at[axis] * d->nodes.step[axis];
    const double slope = f->lo[axis] + number * (f->hi[axis] - f->lo[axis]) / (d->map->size[axis] - 1);
    square += slope * slope;
  }
  const double from = layers - d->matter->reach * d->map->size[2] / ((f->hi[2] - f->lo[2]) * sqrt(square));
  if (from <= 0.0) {
    return expf(-depth);
  }
  if (from >= layers) { /* a reach that rounding loses hides nothing */
    return 1.0f;
  }
  const size_t layer = (size_t)from;
  const float *before = d->depths + layer * nodes + node, part = (float)(from - (double)layer);
  /* in the layer that is being drawn, only the middle is known */
  const float rise = layer < (size_t)layers ? (before[nodes] - *before) * part : (depth - *before) * part / (float)(layers - (double)layer);
  return expf(*before + rise - depth);
}

/* The light that passes to the middle of a layer that is being compared. */
static float passes_to_middle(const drawing* d, size_t node, int layer)
{
  if (!d->depths) {
    return d->passed[node] * 0.5f * (1.0f + passes(d, d->rgba, node));
  }
  const float depth = d->depths[(size_t)layer * drawn_nodes(d) + node] + 0.5f * depth_of_layer(d, d->rgba, node);
  return passes_within_reach(d, node, depth, layer + 0.5);
}

/* The part that passes to a depth, in layers, of a node. */
static float passed_to(const drawing* d, size_t node, double depth)
{
  const size_t nodes = drawn_nodes(d), layer = (size_t)depth;
  const float part = (float)(depth - (double)layer);
  return ((float)d->planes[layer * nodes + node] * (1.0f - part) + (float)d->planes[(layer + 1) * nodes + node] * part) / 65535.0f;
}

/* The root mean square of the colour of the layer that was drawn last. */
static float color_at(const drawing* d, size_t node)
{
  const float* c = d->rgba + 4 * node;
  return c[3] > 0.0f ? sqrtf((c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) / 3.0f) / c[3] : 0.0f;
}

/* Adds the differences of the coarser map at a drawn node in the middle of a layer, each times `part` and the matter's colour there. */
static void add_difference(const drawing* d, int face, int x, int y, int layer, float part, float sum[NEARS])
{
  const int *n = d->map->size, *c = d->coarse->size, at[2] = { x, y };
  const size_t node = (size_t)y * (size_t)d->nodes.count[0] + (size_t)x;
  const float here = passes_to_middle(d, node, layer);
  part *= color_at(d, node);
  double place[3] = { 0.0, 0.0, 0.0 };
  for (int i = 0; i < 2; ++i) {
    place[i] = (double)(d->nodes.first[i] + d->nodes.step[i] * at[i]) / (n[i] - 1) * (c[i] - 1);
  }
  for (int m = 0; m < (d->matter->step > 0.0 ? NEARS : 1); ++m) {
    const double depth = layer + 0.5 - near_lengths[m] * d->near_layers;
    const float there = m == 0 || depth >= layer ? here : depth > 0.0 ? passed_to(d, node, depth) : 0.0f;
    place[2] = depth / n[2] * c[2];
    if (there > 0.0f) { /* else there is no matter between, and all of it is passed */
      sum[m] += part * here / there * (there - stratus_light_passing(d->coarse->size, d->coarse_words, face, place));
    }
  }
}

/* Looks at the layer along one of the rows or columns that are drawn, from both ends. Nodes are as far apart as layers are deep, so that
 * their opacities are the same in all directions. */
static void look_along(drawing* d, int face, int layer, int line, bool column)
{
  const int* n = d->nodes.count;
  float left[2] = { 1.0f, 1.0f }, sum[2][NEARS] = { { 0.0f } };
  for (int i = 0; i < n[column]; ++i) {
    for (int back = 0; back < 2; ++back) {
      const int at = back ? n[column] - 1 - i : i, x = column ? line : at, y = column ? at : line;
      const float opacity = opacity_at(d->rgba, (size_t)y * (size_t)n[0] + (size_t)x), part = left[back] * opacity;
      if (part > FAINT) {
        add_difference(d, face, x, y, layer, part, sum[back]);
      }
      left[back] -= part;
    }
  }
  for (int back = 0; back < 2; ++back) {
    for (int m = 0; m < NEARS; ++m) {
      d->squares[m] += (double)sum[back][m] * (double)sum[back][m];
    }
    d->pixels += left[back] < 1.0f;
  }
}

/* Adds the differences between pictures of a layer, as they are seen from two of its sides and, of some nodes, from the light. */
static void compare_layer(drawing* d, int face, int layer)
{
  const int *n = d->nodes.count, layers = d->map->size[2];
  const bool column = d->column;
  for (int line = 0; line < n[1 - column] && layer % (layers / LAYERS + 1) == 0; ++line) {
    look_along(d, face, layer, line, column);
  }
  const int stride = d->nodes.step[1 - column];
  for (int y = 0; y < n[1]; y += column ? stride : 1) {
    for (int x = 0; x < n[0]; x += column ? 1 : stride) {
      const size_t node = (size_t)y * (size_t)n[0] + (size_t)x;
      float* along = d->along + NEARS * node;
      const float part = d->passed[node] * opacity_at(d->rgba, node);
      if (part > FAINT) {
        add_difference(d, face, x, y, layer, part, along);
      }
      for (int m = 0; m < NEARS && layer + 1 == layers; ++m) {
        d->squares[m] += (double)along[m] * (double)along[m];
      }
      d->pixels += layer + 1 == layers && d->passed[node] < 1.0f;
    }
  }
}

/* Words of a face, a row of nodes after the other. */
typedef struct face_words {
  const uint16_t* planes;
  const int* size;
  int32_t* words;
} face_words;

#define BLOCK 32 /* nodes of a row that are turned together: as many as are in a line of the cache */

static void fill_row(const void* data, int y, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const face_words* f = data;
  const size_t width = (size_t)f->size[0], nodes = width * (size_t)f->size[1], layers = (size_t)f->size[2], row = (size_t)y * width;
  (void)counts;
  for (size_t from = 0; from < width; from += BLOCK) {
    const size_t beyond = from + BLOCK < width ? from + BLOCK : width;
    for (size_t layer = 0; layer < layers; ++layer) {
      const uint16_t *near = f->planes + layer * nodes + row, *far = near + nodes;
      for (size_t x = from; x < beyond; ++x) {
        f->words[(row + x) * layers + layer] = (int32_t)((uint32_t)near[x] | (uint32_t)far[x] << 16);
      }
    }
  }
}

/* Multiplies the light that passes to the nodes from..beyond - 1 of `count` layers, whose pictures follow one another, by the part that
 * passes each. */
static void pass_layers(const drawing* d, const float* pictures, int first, int count, size_t from, size_t beyond)
{
  const size_t nodes = drawn_nodes(d);
  for (int layer = first; layer < first + count; ++layer) {
    const float* rgba = pictures + 4 * (size_t)(layer - first) * nodes;
    uint16_t* plane = d->planes + (size_t)(layer + 1) * nodes;
    for (size_t i = from; i < beyond; ++i) {
      d->passed[i] *= passes(d, rgba, i);
      float light = d->passed[i];
      if (d->depths) {
        const float depth = d->depths[(size_t)layer * nodes + i] + depth_of_layer(d, rgba, i);
        d->depths[(size_t)(layer + 1) * nodes + i] = depth;
        light = passes_within_reach(d, i, depth, layer + 1.0);
      }
      plane[i] = (uint16_t)(light * 65535.0f + 0.5f);
    }
  }
}

/* Draws some rows of a face's nodes, `together` layers at a time, and compares them, or fills their words. */
static stratus_status draw_rows(drawing* d, int face, int from, int rows, int together)
{
  const map* m = d->map;
  const lattice all = d->nodes;
  const int layers = m->size[2];
  const double near = m->frame.lo[2], layer_depth = (m->frame.hi[2] - near) / layers;
  stratus_camera camera;
  stratus_status status = STRATUS_OK;
  d->nodes.first[1] += from * all.step[1];
  d->nodes.count[1] = rows;
  const size_t nodes = drawn_nodes(d);
  const bool sees = face_camera(m, face, d->matter->bounds, &d->nodes, &camera);
  for (size_t i = 0; i < nodes; ++i) {
    d->passed[i] = 1.0f;
    d->planes[i] = 65535;
    if (d->depths) {
      d->depths[i] = 0.0f;
    }
  }
  if (!sees && d->words) { /* all light passes */
    memset(d->planes, 255, ((size_t)layers + 1) * nodes * sizeof *d->planes);
  }
  for (int first = 0; sees && first < layers; first += together) {
    const int count = together < layers - first ? together : layers - first;
    const stratus_image image = { .width = d->nodes.count[0], .height = rows, .rgba = d->pictures };
    camera.near_k = near + first * layer_depth;
    camera.far_k = near + (first + count) * layer_depth;
    TRY_CLEANUP(d->matter->draw(d->matter->of, &camera, count, &image, false));
    if (d->words) {
#pragma omp parallel for num_threads(d->context->threads)
      for (size_t i = 0; i < nodes; i += NODES_A_BLOCK) {
        pass_layers(d, d->pictures, first, count, i, i + NODES_A_BLOCK < nodes ? i + NODES_A_BLOCK : nodes);
      }
      continue;
    }
    for (int layer = 0; layer < count; ++layer) {
      d->rgba = d->pictures + 4 * (size_t)layer * nodes;
      compare_layer(d, face, first + layer);
      pass_layers(d, d->rgba, first + layer, 1, 0, nodes);
    }
  }
  if (d->words) {
    uint64_t counts[STRATUS_TILE_COUNTS];
    const size_t words_before = ((size_t)face * (size_t)m->size[1] + (size_t)from) * (size_t)m->size[0] * (size_t)layers;
    const int size[3] = { m->size[0], rows, layers };
    const face_words some = { d->planes, size, d->words + words_before };
    TRY_CLEANUP(stratus_each_tile(d->context, "light", rows, fill_row, &some, counts));
  }
cleanup:
  d->nodes = all;
  return status;
}

static stratus_status draw_faces(drawing* d)
{
  const int *n = d->nodes.count, layers = d->map->size[2];
  const int together = d->matter->together ? layers : 1;
  const size_t row_pictures = (size_t)n[0] * (size_t)together * 4 * sizeof(float);
  /* lines that are compared are drawn as a whole, because they are looked at along columns, too */
  const int some = (int)(PICTURES_BYTES / row_pictures) / ROWS * ROWS;
  const int rows = !d->matter->together || !d->words || some >= n[1] ? n[1] : some > ROWS ? some : ROWS;
  const size_t nodes = (size_t)n[0] * (size_t)rows;
  void *picture = NULL, *sums = NULL, *planes = NULL, *depths = NULL;
  stratus_status status;
  TRY_CLEANUP(stratus_allocate(d->context, nodes, 4 * sizeof(float) * (size_t)together, &picture));
  TRY_CLEANUP(stratus_allocate(d->context, nodes, (d->words ? 1 : 1 + NEARS) * sizeof(float), &sums));
  TRY_CLEANUP(stratus_allocate(d->context, nodes, ((size_t)layers + 1) * sizeof(uint16_t), &planes));
  if (d->matter->reach > 0.0) {
    TRY_CLEANUP(stratus_allocate(d->context, nodes, ((size_t)layers + 1) * sizeof(float), &depths));
  }
  d->depths = depths;
  d->pictures = picture;
  d->passed = sums;
  d->along = d->passed + nodes;
  d->planes = planes;
  for (int face = 0; face < (int)stratus_light_faces(&d->map->frame); ++face) {
    if (!d->words) {
      memset(d->along, 0, NEARS * nodes * sizeof(float));
    }
    for (int from = 0; from < n[1]; from += rows) {
      TRY_CLEANUP(draw_rows(d, face, from, rows < n[1] - from ? rows : n[1] - from, together));
    }
  }
cleanup:
  stratus_release(d->context, picture);
  stratus_release(d->context, sums);
  stratus_release(d->context, planes);
  stratus_release(d->context, depths);
  return status;
}

/* Draws a map. words: receives its memory. */
static stratus_status draw_map(stratus_context* context, const stratus_light_matter* matter, double goes_on, const map* m, int32_t** words)
{
  void* memory = NULL;
  TRY(stratus_allocate(context, map_words(m), sizeof(int32_t), &memory));
  drawing d = { .context = context, .matter = matter, .goes_on = goes_on, .map = m, .nodes = all_nodes(m), .words = memory };
  const stratus_status status = draw_faces(&d);
  if (status != STRATUS_OK) {
    stratus_release(context, memory);
    return status;
  }
  *words = memory;
  return STRATUS_OK;
}

/* Sets which of the map's rows or columns are drawn to compare a coarser one with: every so many, from the one on with which they pass the
 * most matter, so that small things count. */
static lattice some_lines(const map* m, const map* coarse, const int32_t* coarse_words, bool column)
{
  const int across = 1 - column, *c = coarse->size;
  const size_t layers = (size_t)c[2], face_nodes = (size_t)c[0] * (size_t)c[1], faces = stratus_light_faces(&coarse->frame);
  lattice l = all_nodes(m);
  double most = -1.0;
  l.step[across] = m->size[across] / LINES + 1;
  for (int first = 0; first < l.step[across] && first < m->size[across]; ++first) {
    double absorbed = 0.0;
    for (int line = first; line < m->size[across]; line += l.step[across]) {
      const int near = (int)((double)line / (m->size[across] - 1) * (c[across] - 1) + 0.5);
      for (size_t face = 0; face < faces; ++face) {
        for (int i = 0; i < c[column]; ++i) {
          const int x = column ? near : i, y = column ? i : near;
          const size_t node = face * face_nodes + (size_t)y * (size_t)c[0] + (size_t)x;
          absorbed += 65535.0 - (double)((uint32_t)coarse_words[node * layers + layers - 1] >> 16);
        }
      }
    }
    if (absorbed > most) {
      most = absorbed;
      l.first[across] = first;
    }
  }
  l.count[across] = (m->size[across] - l.first[across] + l.step[across] - 1) / l.step[across];
  return l;
}

/* Draws some rows and columns of a map, and compares a coarser one with them. */
static stratus_status compare_map(stratus_context* context, const stratus_light_matter* matter, double goes_on, const map* m,
  const map* coarse, const int32_t* coarse_words, double near_layers, double differences[NEARS])
{
  double squares[NEARS] = { 0.0 }, pixels = 0.0;
  for (int column = 0; column < 2; ++column) {
    drawing d = { .context = context,
      .matter = matter,
      .goes_on = goes_on,
      .map = m,
      .nodes = some_lines(m, coarse, coarse_words, column),
      .column = column,
      .coarse = coarse,
      .coarse_words = coarse_words,
      .near_layers = near_layers };
    TRY(draw_faces(&d));
    pixels += d.pixels;
    for (int i = 0; i < NEARS; ++i) {
      squares[i] += d.squares[i];
    }
  }
  for (int i = 0; i < NEARS; ++i) {
    differences[i] = pixels > 0.0 ? sqrt(squares[i] / pixels) : 0.0;
  }
  return STRATUS_OK;
}

static double near_length(const stratus_light_matter* matter, const map* m, double side)
{
  return fmax(side / m->size[2], NEAR_STEPS_LEAST * matter->step);
}

/* Draws maps of a light, each finer than the one before, until the error that is expected of one is at most `most`: of the map by itself,
 * or of it where near matter is passed by rays. A map's error is measured at nodes of a finer one, where that is exact. Of the finer one
 * only some lines are drawn before it is known that it is wanted, and its own error is expected to fall as errors fell from map to map
 * before. words: receives the map's memory, also if a finer one fails. */
static stratus_status build_map(stratus_context* context, const stratus_light_matter* matter, double goes_on, const stratus_light* light,
  double most, map* m, int32_t** words)
{
  double sides[3], last[NEARS] = { 0.0 }, near = 0.0, error = 0.0;
  const int nears = matter->step > 0.0 ? NEARS : 1;
  bool kept = false;
  m->light = *light;
  stratus_light_frame_place(light, matter->bounds, &m->frame, sides);
  (void)size_map(m, sides, NODES_FIRST);
  TRY(draw_map(context, matter, goes_on, m, words));
  for (int nodes = 2 * NODES_FIRST; nodes <= NODES_LAST && !kept; nodes *= 2) {
    map finer = *m;
    double differences[NEARS];
    bool finer_wanted = false;
    const bool fits = size_map(&finer, sides, nodes);
    const double near_layers = near_length(matter, m, sides[2]) * finer.size[2] / sides[2];
    TRY(compare_map(context, matter, goes_on, &finer, m, *words, near_layers, differences));
    for (int of_finer = 0; of_finer < (fits ? 2 : 1) && !kept; ++of_finer) {
      double least = INFINITY;
      for (int i = 0; i < nears && !kept; ++i) {
        const double fall = last[i] > 0.0 ? fmin(fmax(differences[i] / last[i], FALL_LEAST), 1.0) : 1.0;
        const double expected = matter->reflectance * (of_finer ? differences[i] * fall : differences[i]);
        const double length = near_lengths[i] * near_length(matter, of_finer ? &finer : m, sides[2]);
        if (i > 0 && length > NEAR_STEPS_MOST * matter->step) {
          break;
        }
        kept = expected <= most;
        if (kept || expected < least) {
          least = error = expected;
          near = length;
          finer_wanted = of_finer;
        }
      }
    }
    memcpy(last, differences, sizeof last);
    if (!fits) {
      break;
    }
    if (finer_wanted) {
      stratus_release(context, *words);
      *words = NULL;
      *m = finer;
      TRY(draw_map(context, matter, goes_on, m, words));
    }
  }
  m->error = error;
  m->finest = !kept;
  m->near = near;
  m->near_steps = near > 0.0 ? (int)ceil(near / matter->step) : 0;
  return STRATUS_OK;
}

/* ---- all maps */

/* How bright lights are together: each is as bright as its largest channel, and errors of lights add by their squares. */
static double brightness_of(const stratus_light* lights, int count)
{
  double squares = 0.0;
  for (int i = 0; i < count; ++i) {
    const double largest = fmax(fmax(lights[i].color[0], lights[i].color[1]), lights[i].color[2]);
    squares += largest * largest;
  }
  return sqrt(squares);
}

stratus_status stratus_light_maps_build(stratus_context* context, const stratus_light_matter* given, const stratus_shading* shading,
  const stratus_light* lights, int count, stratus_light_maps** maps)
{
  stratus_light_matter limited = *given;
  const stratus_light_matter* matter = &limited;
  int32_t* words[STRATUS_LIGHTS_MAX] = { NULL };
  void *memory = NULL, *all = NULL, *slot = NULL;
  stratus_light_maps* made = NULL;
  stratus_status status;
  limited.reach = shading->shadow_length;
  limited.step = limited.reach > 0.0 ? 0.0 : given->step; /* near rays would add to the reach */
  TRY_CLEANUP(stratus_allocate_zero(context, 1, sizeof *made, &memory));
  made = memory;
  made->context = context;
  made->count = count;
  made->most = SHARE * matter->tolerance;
  made->brightness = brightness_of(lights, count);
  made->reflectance = matter->reflectance;
  if (shading->multiple) {
    TRY_CLEANUP(stratus_light_scatter_build(
      context, matter->draw, matter->of, matter->bounds, matter->detail, shading, lights, count, matter->tolerance, &made->scatter));
    made->goes_on = stratus_light_forward(&made->scatter, shading);
    made->scatter_error = made->scatter.error;
  }
  for (int i = 0; i < count; ++i) {
    const double most = made->most / fmax(made->brightness, 1e-30);
    TRY_CLEANUP(build_map(context, matter, made->goes_on, &lights[i], most, &made->of[i], &words[i]));
    made->of[i].at = made->words_count;
    made->words_count += map_words(&made->of[i]);
    TRY_CLEANUP(stratus_progress(context, "light", (i + 1.0) / count));
  }
  TRY_CLEANUP(stratus_allocate_zero(context, 1, sizeof *made->slot, &slot));
  made->scatter_at = made->words_count;
  made->scatter_words = stratus_light_scatter_words(&made->scatter);
  made->words_count += made->scatter_words;
  TRY_CLEANUP(stratus_allocate(context, made->words_count, sizeof(int32_t), &all));
  made->slot = slot;
  made->words = all;
  made->own_count = made->words_count;
  if (made->scatter.words) {
    memcpy(made->words + made->scatter_at, made->scatter.words, made->scatter_words * sizeof(int32_t));
    stratus_light_scatter_release(context, &made->scatter);
  }
  for (int i = 0; i < count; ++i) {
    memcpy(made->words + made->of[i].at, words[i], map_words(&made->of[i]) * sizeof(int32_t));
  }
  stratus_light_maps_destroy(*maps);
  *maps = made;
  memory = slot = NULL;
cleanup:
  if (memory) {
    stratus_light_scatter_release(context, &made->scatter);
  }
  for (int i = 0; i < count; ++i) {
    stratus_release(context, words[i]);
  }
  stratus_release(context, slot);
  stratus_release(context, memory);
  return status;
}

/* ---- surfaces */

static size_t surface_words(const map* m)
{
  return stratus_light_faces(&m->frame) * (size_t)m->surface_size[0] * (size_t)m->surface_size[1];
}

static void finer_nodes(const map* m, int step, int size[2])
{
  for (int axis = 0; axis < 2; ++axis) {
    size[axis] = (m->size[axis] - 1) * step + 1;
  }
}

/* Finds the surfaces that hide a map's light, at the least of nodes whose expected error is at most `most`. An edge between two nodes errs
 * on a part of the picture that is proportional to their distance, so that the error falls by its root. depths: receives them in layers.
 */
static stratus_status find_surfaces(
  const stratus_light_maps* maps, const stratus_surfaces* surfaces, double most, map* m, stratus_light_depths* depths)
{
  stratus_light_depths fine;
  int step = SURFACE_STEPS, size[2];
  stratus_status status = STRATUS_OK;
  finer_nodes(m, step, size);
  while (step > 1 && stratus_light_faces(&m->frame) * (size_t)size[0] * (size_t)size[1] > SURFACE_WORDS) {
    step /= 2;
    finer_nodes(m, step, size);
  }
  TRY(stratus_light_surfaces_draw(maps->context, &m->frame, surfaces, size, &fine));
  double error = 0.0;
  for (bool kept = false; !kept; step /= kept ? 1 : 2) {
    error =
      step > 1 ? maps->reflectance * stratus_light_surfaces_error(&m->frame, &fine, step, m->size, maps->words + m->at) : error * sqrt(0.5);
    kept = step == 1 || error <= most;
    if (kept) {
      TRY_CLEANUP(stratus_light_surfaces_coarsen(maps->context, &m->frame, &fine, step, depths));
    }
  }
  m->surface_error = error;
  memcpy(m->surface_size, depths->size, sizeof m->surface_size);
  const float layers = (float)(m->size[2] / (m->frame.hi[2] - m->frame.lo[2])), near = (float)m->frame.lo[2];
  for (size_t i = 0; i < surface_words(m); ++i) {
    depths->depth[i] = depths->depth[i] < STRATUS_LIGHT_FREE ? (depths->depth[i] - near) * layers : STRATUS_LIGHT_FREE;
  }
cleanup:
  stratus_release(maps->context, fine.depth);
  return status;
}

static uint64_t surfaces_key(const stratus_surfaces* surfaces)
{
  if (!surfaces || surfaces->triangle_count == 0) {
    return 0;
  }
  const uint64_t numbers[3] = { (uint64_t)(uintptr_t)surfaces->points, surfaces->triangle_count, surfaces->revision };
  return stratus_light_key(0, numbers, sizeof numbers);
}

stratus_status stratus_light_maps_hide(stratus_light_maps* maps, const stratus_surfaces* surfaces)
{
  const uint64_t key = surfaces_key(surfaces);
  map of[STRATUS_LIGHTS_MAX];
  stratus_light_depths depths[STRATUS_LIGHTS_MAX] = { { .depth = NULL } };
  size_t count = maps->own_count;
  void* all = NULL;
  stratus_status status = STRATUS_OK;
  if (key == maps->surfaces_key) {
    return STRATUS_OK;
  }
  TRY(stratus_surfaces_check(maps->context, surfaces));
  memcpy(of, maps->of, sizeof of);
  for (int i = 0; i < maps->count; ++i) {
    memset(of[i].surface_size, 0, sizeof of[i].surface_size);
    of[i].surface_error = 0.0;
    if (key) {
      const double most = SURFACE_SHARE / SHARE * maps->most / fmax(maps->brightness, 1e-30);
      TRY_CLEANUP(find_surfaces(maps, surfaces, most, &of[i], &depths[i]));
      of[i].surface_at = count;
      count += surface_words(&of[i]);
    }
  }
  TRY_CLEANUP(stratus_allocate(maps->context, count, sizeof(int32_t), &all));
  memcpy(all, maps->words, maps->own_count * sizeof(int32_t));
  for (int i = 0; key && i < maps->count; ++i) {
    memcpy((int32_t*)all + of[i].surface_at, depths[i].depth, surface_words(&of[i]) * sizeof(int32_t));
  }
  stratus_slot_drop(maps->slot); /* the device may read the words in place */
  stratus_release(maps->context, maps->words);
  maps->words = all;
  maps->words_count = count;
  maps->surfaces_key = key;
  memcpy(maps->of, of, sizeof of);
cleanup:
  for (int i = 0; i < maps->count; ++i) {
    stratus_release(maps->context, depths[i].depth);
  }
  return status;
}

void stratus_light_maps_destroy(stratus_light_maps* maps)
{
  if (maps) {
    stratus_slot_drop(maps->slot); /* the device may read the words in place */
    stratus_release(maps->context, maps->slot);
    stratus_release(maps->context, maps->words);
    stratus_release(maps->context, maps);
  }
}

uint64_t stratus_light_key(uint64_t key, const void* bytes, size_t count)
{
  key = key ? key : UINT64_C(0xcbf29ce484222325); /* FNV-1a (Fowler, Noll & Vo) */
  for (size_t i = 0; i < count; ++i) {
    key = (key ^ ((const unsigned char*)bytes)[i]) * UINT64_C(0x100000001b3);
  }
  return key;
}

uint64_t stratus_light_key_of_transfers(uint64_t key, const stratus_transfer* transfers, int count)
{
  for (int i = 0; i < count; ++i) {
    const stratus_transfer* t = transfers + i;
    const double numbers[3] = { t->unit_distance, t->weight, t->clamp };
    key = stratus_light_key(key, numbers, sizeof numbers);
    key = stratus_light_key(key, t->opacity, 2 * t->opacity_count * sizeof *t->opacity);
    key = stratus_light_key(key, t->gradient, 2 * t->gradient_count * sizeof *t->gradient);
  }
  return key;
}

uint64_t stratus_light_key_of_scattering(uint64_t key, const stratus_shading* shading, const stratus_light* lights, int count)
{
  key = shading->shadow_length > 0.0 ? stratus_light_key(key, &shading->shadow_length, sizeof shading->shadow_length) : key;
  if (!shading->multiple) {
    return key;
  }
  const uint64_t surfaces = surfaces_key(shading->surfaces);
  key = surfaces ? stratus_light_key(key, &surfaces, sizeof surfaces) : key;
  key = stratus_light_key(key, &shading->diffuse, sizeof shading->diffuse);
  key = stratus_light_key(key, &shading->anisotropy, sizeof shading->anisotropy);
  key = stratus_light_key(key, shading->sky_zenith, sizeof shading->sky_zenith);
  key = stratus_light_key(key, shading->sky_horizon, sizeof shading->sky_horizon);
  key = stratus_light_key(key, shading->up, sizeof shading->up);
  for (int i = 0; i < count; ++i) {
    const double numbers[2] = { lights[i].cone_angle, lights[i].cone_exponent };
    key = stratus_light_key(key, lights[i].color, sizeof lights[i].color);
    key = stratus_light_key(key, lights[i].attenuation, sizeof lights[i].attenuation);
    key = stratus_light_key(key, lights[i].axis, sizeof lights[i].axis);
    key = stratus_light_key(key, numbers, sizeof numbers);
  }
  return key;
}

uint64_t stratus_light_key_of_albedo(
  uint64_t key, const stratus_transfer* transfers, int count, const stratus_material* materials, int components)
{
  for (int i = 0; i < count; ++i) {
    key = stratus_light_key(key, transfers[i].color, 4 * transfers[i].color_count * sizeof *transfers[i].color);
  }
  for (int c = 0; materials && c < components; ++c) {
    const double numbers[2] = { materials[c].shade, materials[c].diffuse };
    key = stratus_light_key(key, numbers, sizeof numbers);
  }
  return key;
}

void stratus_light_state_drop(stratus_light_state* state)
{
  stratus_light_maps_destroy(state->maps);
  state->maps = NULL;
}

static bool same_way(const stratus_light* a, const stratus_light* b)
{
  return a->positional == b->positional && memcmp(a->vector, b->vector, sizeof a->vector) == 0;
}

bool stratus_light_state_serves(stratus_light_state* state, uint64_t key, const stratus_light* lights, int count)
{
  stratus_light_maps* maps = state->maps;
  bool serves = state->key == key && maps && maps->count == count, finest = true;
  for (int i = 0; serves && i < count; ++i) {
    serves = same_way(&maps->of[i].light, &lights[i]);
  }
  for (int i = 0; serves && i < count; ++i) {
    memcpy(maps->of[i].light.color, lights[i].color, sizeof lights[i].color);
    finest = finest && maps->of[i].finest;
  }
  return serves && (finest || brightness_of(lights, count) <= maps->brightness || stratus_light_maps_error(maps) <= maps->most);
}

stratus_status stratus_light_state_build(stratus_context* context, const stratus_light_matter* matter, const stratus_shading* shading,
  const stratus_light* lights, int count, stratus_light_state* state)
{
  TRY(stratus_light_maps_build(context, matter, shading, lights, count, &state->maps));
  state->key = 0;
  ++state->builds;
  return STRATUS_OK;
}

/* Sets how near matter is passed on the way to light i. */
static void near_arguments(
  const map* m, int i, const double to_places[16], double unit, double sample_distance, double goes_on, stratus_light_arguments* a)
{
  double way[3], world[3];
  memcpy(way, m->light.vector, sizeof way);
  (void)stratus_vector_normalize(way);
  for (int axis = 0; axis < 3; ++axis) {
    world[axis] = a->positional[i] ? m->light.vector[axis] : way[axis] * m->near;
  }
  for (int row = 0; row < 3; ++row) {
    double sum = a->positional[i] ? to_places[4 * row + 3] : 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      sum += to_places[4 * row + axis] * world[axis];
    }
    a->near_way[i][row] = (float)sum;
  }
  a->near = 1;
  a->near_steps[i] = m->near_steps;
  a->near_length[i] = (float)(m->near / m->near_steps / sample_distance * (1.0 - goes_on));
  a->near_reach[i] = (float)(m->near / unit);
}

void stratus_light_maps_arguments(const stratus_light_maps* maps, const stratus_light* lights, const double to_world[16], double unit,
  double sample_distance, stratus_light_arguments* a)
{
  double to_places[16];
  const bool near = maps && sample_distance > 0.0 && stratus_matrix_invert_affine(to_world, to_places);
  a->near = 0;
  stratus_light_scatter_arguments(maps && maps->scatter_words > 0 ? &maps->scatter : NULL, maps ? maps->scatter_at : 0, to_world, a);
  for (int i = 0; i < a->count; ++i) {
    const map* m = maps && i < maps->count ? &maps->of[i] : NULL;
    a->map_at[i] = a->surface_at[i] = -1;
    a->near_steps[i] = 0;
    if (!m || !same_way(&m->light, &lights[i])) { /* a light that moves with a probe's rays has no map there */
      continue;
    }
    if (near && m->near_steps > 0) {
      near_arguments(m, i, to_places, unit, sample_distance, maps->goes_on, a);
    }
    const stratus_light_frame* f = &m->frame;
    double scale[3], shift[3];
    for (int axis = 0; axis < 3; ++axis) {
      scale[axis] = (axis < 2 ? m->size[axis] - 1 : m->size[2]) / (f->hi[axis] - f->lo[axis]);
      shift[axis] = -f->lo[axis] * scale[axis];
    }
    a->map_at[i] = (int)m->at;
    a->map_faces[i] = m->frame.faces;
    for (int axis = 0; m->surface_size[0] > 0 && axis < 2; ++axis) {
      a->surface_at[i] = (int)m->surface_at;
      a->surface_size[i][axis] = m->surface_size[axis];
      a->surface_scale[i][axis] = (float)((m->surface_size[axis] - 1.0) / (m->size[axis] - 1.0));
    }
    for (int row = 0; row < 3; ++row) {
      double from[4] = { 0.0, 0.0, 0.0, 0.0 };
      for (int axis = 0; axis < 3; ++axis) {
        for (int column = 0; column < 4; ++column) {
          from[column] += f->basis[row][axis] * to_world[4 * axis + column];
        }
        from[3] -= f->basis[row][axis] * f->origin[axis];
      }
      for (int column = 0; column < 4; ++column) {
        const double whole = m->frame.faces > 0 ? from[column] : from[column] * scale[row] + (column == 3 ? shift[row] : 0.0);
        a->map_from[i][4 * row + column] = (float)whole;
      }
      a->map_size[i][row] = m->size[row];
      a->map_scale[i][2 * row] = (float)scale[row];
      a->map_scale[i][2 * row + 1] = (float)shift[row];
    }
  }
}

double stratus_light_maps_passing(const stratus_light_maps* maps, const stratus_light* light, int i, const double world[3])
{
  const map* m = maps && i < maps->count ? &maps->of[i] : NULL;
  double q[3];
  if (!m || !same_way(&m->light, light)) {
    return 1.0;
  }
  const stratus_light_frame* f = &m->frame;
  const int face = stratus_light_frame_coordinates(f, world, q);
  bool beside = f->perspective && q[2] <= 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    beside = beside || (axis < 2 && (q[axis] < f->lo[axis] || q[axis] > f->hi[axis]));
    q[axis] = (q[axis] - f->lo[axis]) / (f->hi[axis] - f->lo[axis]) * (axis < 2 ? m->size[axis] - 1 : m->size[2]);
  }
  return beside ? 1.0 : (double)stratus_light_passing(m->size, maps->words + m->at, face, q);
}

const int32_t* stratus_light_maps_words(const stratus_light_maps* maps)
{
  return maps ? maps->words : NULL;
}

size_t stratus_light_maps_bytes(const stratus_light_maps* maps)
{
  return maps ? maps->words_count * sizeof(int32_t) : 0;
}

double stratus_light_maps_error(const stratus_light_maps* maps)
{
  double squares = maps ? maps->scatter_error * maps->scatter_error : 0.0;
  for (int i = 0; maps && i < maps->count; ++i) {
    const map* m = &maps->of[i];
    const double error = sqrt(m->error * m->error + m->surface_error * m->surface_error) * brightness_of(&m->light, 1);
    squares += error * error;
  }
  return sqrt(squares);
}

double stratus_light_maps_near(const stratus_light_maps* maps)
{
  double most = 0.0;
  for (int i = 0; maps && i < maps->count; ++i) {
    most = fmax(most, maps->of[i].near);
  }
  return most;
}

stratus_status stratus_light_maps_on_device(const stratus_light_maps* maps, struct _cl_mem** memory, bool* sent)
{
  *sent = !maps->slot->memory;
  if (*sent) {
    TRY(stratus_slot_keep(maps->context, maps->slot, maps->words, stratus_light_maps_bytes(maps)));
  }
  *memory = maps->slot->memory;
  return STRATUS_OK;
}
