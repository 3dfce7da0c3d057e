/* SPDX-License-Identifier: BSD-3-Clause
 * Draws maps of light: the matter is drawn layer by layer as the light sees it, and the light that passes a layer is 1 less its opacity. So
 * whatever can be drawn can cast shadows, and within a layer the picture's own integration holds. Only between nodes is anything
 * interpolated. */
#include "light_map_draw.h"

#include "tiles.h"

#include <string.h>

#define DEPTH_MOST 80.0f                 /* of a layer; behind it is no light */
#define FAINT 1e-4f                      /* nodes that add less than this to a picture are not compared */
#define LINES 16                         /* a map is compared with so many rows and columns of a finer one; only these are drawn of that */
#define LAYERS 32                        /* and so many of its layers are compared from the side */
#define PICTURES_BYTES ((size_t)1 << 24) /* of layers that are drawn together, which should be in the cache until they are summed */
#define ROWS 16                          /* of nodes are drawn at once at least */
#define NODES_A_BLOCK 512                /* of nodes that a thread sums at a time */

const int stratus_light_near_lengths[STRATUS_LIGHT_NEARS] = { 0, 1, 2, 4 };

size_t stratus_light_grid_words(const stratus_light_grid* grid)
{
  return stratus_light_faces(&grid->frame) * (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
}

/* The nodes of a face that are drawn: numbers first, first + step, ... across and up. */
typedef struct lattice {
  int first[2], step[2], count[2];
} lattice;

static lattice all_nodes(const stratus_light_grid* m)
{
  return (lattice){ { 0, 0 }, { 1, 1 }, { m->size[0], m->size[1] } };
}

/* The camera of a face of a map that looks from the light, whose pixels are nodes of the lattice. Returns whether the face may see any
 * matter. */
static bool face_camera(const stratus_light_grid* m, int face, const double bounds[6], const lattice* l, stratus_camera* camera)
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
 * on each of stratus_light_near_lengths before. */
typedef struct drawing {
  stratus_context* context;
  const stratus_light_matter* matter;
  double goes_on; /* the part of the extinction that light passes as if it were not there */
  const stratus_light_grid* grid;
  lattice nodes;
  /* of a face: the light that passes to each node at the layers' near sides, one layer after the other, and at the last's far side */
  uint16_t* planes;
  float* depths;                    /* of limited reach: the optical depth up to each layer, as planes; else NULL */
  float *pictures, *rgba, *passed;  /* rgba: of the layer that is looked at */
  int32_t* words;                   /* of the map; NULL: it is drawn to be compared */
  bool column;                      /* columns are drawn to compare, else rows */
  const stratus_light_grid* coarse; /* all that follows is set to compare */
  const int32_t* coarse_words;
  float* along;                                             /* of the view along the light's way, each node's differences so far */
  double near_layers, squares[STRATUS_LIGHT_NEARS], pixels; /* near_layers: of the finer map, in a near length of the coarser */
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
  const stratus_light_frame* f = &d->grid->frame;
  const size_t nodes = drawn_nodes(d), at[2] = { node % (size_t)d->nodes.count[0], node / (size_t)d->nodes.count[0] };
  double square = 1.0; /* of a way that goes through a layer of depth 1 */
  for (int axis = 0; axis < 2 && f->perspective; ++axis) {
    const double number = d->nodes.first[axis] + (double)at[axis] * d->nodes.step[axis];
    const double slope = f->lo[axis] + number * (f->hi[axis] - f->lo[axis]) / (d->grid->size[axis] - 1);
    square += slope * slope;
  }
  const double from = layers - d->matter->reach * d->grid->size[2] / ((f->hi[2] - f->lo[2]) * sqrt(square));
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
static void add_difference(const drawing* d, int face, int x, int y, int layer, float part, float sum[STRATUS_LIGHT_NEARS])
{
  const int *n = d->grid->size, *c = d->coarse->size, at[2] = { x, y };
  const size_t node = (size_t)y * (size_t)d->nodes.count[0] + (size_t)x;
  const float here = passes_to_middle(d, node, layer);
  part *= color_at(d, node);
  double place[3] = { 0.0, 0.0, 0.0 };
  for (int i = 0; i < 2; ++i) {
    place[i] = (double)(d->nodes.first[i] + d->nodes.step[i] * at[i]) / (n[i] - 1) * (c[i] - 1);
  }
  for (int m = 0; m < (d->matter->step > 0.0 ? STRATUS_LIGHT_NEARS : 1); ++m) {
    const double depth = layer + 0.5 - stratus_light_near_lengths[m] * d->near_layers;
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
  float left[2] = { 1.0f, 1.0f }, sum[2][STRATUS_LIGHT_NEARS] = { { 0.0f } };
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
    for (int m = 0; m < STRATUS_LIGHT_NEARS; ++m) {
      d->squares[m] += (double)sum[back][m] * (double)sum[back][m];
    }
    d->pixels += left[back] < 1.0f;
  }
}

/* Adds the differences between pictures of a layer, as they are seen from two of its sides and, of some nodes, from the light. */
static void compare_layer(drawing* d, int face, int layer)
{
  const int *n = d->nodes.count, layers = d->grid->size[2];
  const bool column = d->column;
  for (int line = 0; line < n[1 - column] && layer % (layers / LAYERS + 1) == 0; ++line) {
    look_along(d, face, layer, line, column);
  }
  const int stride = d->nodes.step[1 - column];
  for (int y = 0; y < n[1]; y += column ? stride : 1) {
    for (int x = 0; x < n[0]; x += column ? 1 : stride) {
      const size_t node = (size_t)y * (size_t)n[0] + (size_t)x;
      float* along = d->along + STRATUS_LIGHT_NEARS * node;
      const float part = d->passed[node] * opacity_at(d->rgba, node);
      if (part > FAINT) {
        add_difference(d, face, x, y, layer, part, along);
      }
      for (int m = 0; m < STRATUS_LIGHT_NEARS && layer + 1 == layers; ++m) {
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
  const stratus_light_grid* m = d->grid;
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
  const int *n = d->nodes.count, layers = d->grid->size[2];
  const int together = d->matter->together ? layers : 1;
  const size_t row_pictures = (size_t)n[0] * (size_t)together * 4 * sizeof(float);
  /* lines that are compared are drawn as a whole, because they are looked at along columns, too */
  const int some = (int)(PICTURES_BYTES / row_pictures) / ROWS * ROWS;
  const int rows = !d->matter->together || !d->words || some >= n[1] ? n[1] : some > ROWS ? some : ROWS;
  const size_t nodes = (size_t)n[0] * (size_t)rows;
  void *picture = NULL, *sums = NULL, *planes = NULL, *depths = NULL;
  stratus_status status;
  TRY_CLEANUP(stratus_allocate(d->context, nodes, 4 * sizeof(float) * (size_t)together, &picture));
  TRY_CLEANUP(stratus_allocate(d->context, nodes, (d->words ? 1 : 1 + STRATUS_LIGHT_NEARS) * sizeof(float), &sums));
  TRY_CLEANUP(stratus_allocate(d->context, nodes, ((size_t)layers + 1) * sizeof(uint16_t), &planes));
  if (d->matter->reach > 0.0) {
    TRY_CLEANUP(stratus_allocate(d->context, nodes, ((size_t)layers + 1) * sizeof(float), &depths));
  }
  d->depths = depths;
  d->pictures = picture;
  d->passed = sums;
  d->along = d->passed + nodes;
  d->planes = planes;
  for (int face = 0; face < (int)stratus_light_faces(&d->grid->frame); ++face) {
    if (!d->words) {
      memset(d->along, 0, STRATUS_LIGHT_NEARS * nodes * sizeof(float));
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

stratus_status stratus_light_grid_draw(
  stratus_context* context, const stratus_light_matter* matter, double goes_on, const stratus_light_grid* m, int32_t** words)
{
  void* memory = NULL;
  TRY(stratus_allocate(context, stratus_light_grid_words(m), sizeof(int32_t), &memory));
  drawing d = { .context = context, .matter = matter, .goes_on = goes_on, .grid = m, .nodes = all_nodes(m), .words = memory };
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
static lattice some_lines(const stratus_light_grid* m, const stratus_light_grid* coarse, const int32_t* coarse_words, bool column)
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

stratus_status stratus_light_grid_compare(stratus_context* context, const stratus_light_matter* matter, double goes_on,
  const stratus_light_grid* m, const stratus_light_grid* coarse, const int32_t* coarse_words, double near_layers,
  double differences[STRATUS_LIGHT_NEARS])
{
  double squares[STRATUS_LIGHT_NEARS] = { 0.0 }, pixels = 0.0;
  for (int column = 0; column < 2; ++column) {
    drawing d = { .context = context,
      .matter = matter,
      .goes_on = goes_on,
      .grid = m,
      .nodes = some_lines(m, coarse, coarse_words, column),
      .column = column,
      .coarse = coarse,
      .coarse_words = coarse_words,
      .near_layers = near_layers };
    TRY(draw_faces(&d));
    pixels += d.pixels;
    for (int i = 0; i < STRATUS_LIGHT_NEARS; ++i) {
      squares[i] += d.squares[i];
    }
  }
  for (int i = 0; i < STRATUS_LIGHT_NEARS; ++i) {
    differences[i] = pixels > 0.0 ? sqrt(squares[i] / pixels) : 0.0;
  }
  return STRATUS_OK;
}
