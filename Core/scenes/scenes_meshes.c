/* SPDX-License-Identifier: BSD-3-Clause
 * The meshes of record that are generated, not read. The first is water in layers over the bed of an estuary, wedges of three tetrahedra
 * each. The second is a lattice of tetrahedra, whose planes and edges are in line with one another. The third is a plate full of holes,
 * whose surface a mesher fills: a visibility order has to see across its many gaps. Tests and benchmarks share them. A scene is never
 * changed. */
#include "stratus/scenes.h"
#include "volume.h"

#include <math.h>
#include <string.h>

#define LATTICE 55 /* boxes along an axis, six tetrahedra each */

#define ESTUARY_X 96 /* squares of two wedges in a layer */
#define ESTUARY_Y 48
#define ESTUARY_LAYERS 12
#define ESTUARY_LENGTH 12.0 /* km; depths are tens of metres */
#define ESTUARY_WIDTH 6.0

#define HOLES_X 6
#define HOLES_Y 4
#define SIDE 8 /* pieces of each edge of a square; a square has one hole */
#define AROUND (4 * SIDE)
#define THICKNESS 0.4
#define RADIUS 0.3
#define ACROSS_X (HOLES_X * SIDE + 1)
#define ACROSS_Y (HOLES_Y * SIDE + 1)
#define MAXIMUM_VOLUME 2.05e-5 /* about 800 thousand tetrahedra */

typedef struct mesh_storage {
  stratus_mesh_scene scene; /* first member, so that stratus_mesh_scene_destroy() can cast the caller's pointer */
  void* points;
  void* vertices;
  void* values;
  void* quads;
} mesh_storage;

/* ---------------------------------------------------------------- fields */

/* A hump with waves of three lengths. */
static double wavelet_value(const double point[3])
{
  double p[3], square = 0.0;
  for (int a = 0; a < 3; ++a) {
    p[a] = 2.0 * point[a] / LATTICE - 1.0;
    square += p[a] * p[a];
  }
  return 150.0 * exp(-2.0 * square) + 20.0 * sin(12.0 * p[0]) + 36.0 * sin(6.0 * p[1]) + 10.0 * cos(16.0 * p[2]);
}

/* Return the speed of a plane flow along x around cylinders, each as if there were no other, times a wave along z. */
static double holes_value(const double point[3])
{
  double along = 1.0, across = 0.0;
  for (int h = 0; h < HOLES_X * HOLES_Y; ++h) {
    const double x = point[0] - (h % HOLES_X + 0.5), y = point[1] - (h / HOLES_X + 0.5), square = fmax(x * x + y * y, 1e-3);
    along -= RADIUS * RADIUS * (x * x - y * y) / (square * square);
    across -= 2.0 * RADIUS * RADIUS * x * y / (square * square);
  }
  return sqrt(along * along + across * across) * (1.0 + 0.25 * sin(2.0 * point[2] / THICKNESS));
}

/* The bed: a channel that winds between shoals with ripples. */
static double estuary_depth(double x, double y)
{
  const double across = (y - 0.5 * ESTUARY_WIDTH - 0.8 * sin(0.7 * x)) / 1.2;
  return 0.25 + 0.9 * exp(-across * across) + 0.05 * sin(9.0 * x) * cos(11.0 * y);
}

/* The surface: a tide on its way in from x = 0. */
static double estuary_surface(double x)
{
  return 0.15 * cos(0.5 * x);
}

/* The share of river water: a plume that spreads at the surface and mixes downwards and on its way to the sea. */
static double estuary_value(const double point[3])
{
  const double depth = estuary_depth(point[0], point[1]), surface = estuary_surface(point[0]);
  const double below = (surface - point[2]) / (depth + surface), from = (ESTUARY_LENGTH - point[0]) / ESTUARY_LENGTH;
  const double across = (point[1] - 0.5 * ESTUARY_WIDTH - 0.8 * sin(0.7 * point[0])) / (1.0 + 2.0 * from);
  return exp(-3.0 * from - across * across - below * (1.0 + 3.0 * from)) * (1.0 + 0.2 * sin(4.0 * point[0] + 3.0 * point[1]));
}

/* ---------------------------------------------------------------- the estuary */

/* Divides a wedge whose lower points are a, b and c, and whose upper ones have numbers greater by `up`. Side faces are cut from their
 * lowest point, so that neighbours cut them alike. */
static void add_wedge(int32_t** vertices, int32_t a, int32_t b, int32_t c, int32_t up)
{
  int32_t low[3] = { a, b, c };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 2; ++j) {
      const int32_t less = low[j] < low[j + 1] ? low[j] : low[j + 1], more = low[j] < low[j + 1] ? low[j + 1] : low[j];
      low[j] = less;
      low[j + 1] = more;
    }
  }
  for (int cut = 0; cut < 3; ++cut) { /* lower points up to `cut`, upper ones from there */
    for (int i = 0; i <= cut; ++i) {
      *(*vertices)++ = low[i];
    }
    for (int i = cut; i < 3; ++i) {
      *(*vertices)++ = low[i] + up;
    }
  }
}

static stratus_status make_estuary(stratus_context* context, mesh_storage* storage)
{
  const int32_t row = ESTUARY_X + 1, up = row * (ESTUARY_Y + 1);
  stratus_mesh* mesh = &storage->scene.mesh;
  mesh->point_count = (int64_t)up * (ESTUARY_LAYERS + 1);
  mesh->cell_count = (int64_t)6 * ESTUARY_X * ESTUARY_Y * ESTUARY_LAYERS;
  TRY(stratus_allocate(context, (size_t)mesh->point_count, 3 * sizeof(double), &storage->points));
  TRY(stratus_allocate(context, (size_t)mesh->cell_count, 4 * sizeof(int32_t), &storage->vertices));
  TRY(stratus_allocate(context, (size_t)mesh->point_count, sizeof(float), &storage->values));
  for (int32_t i = 0; i < mesh->point_count; ++i) {
    double* p = (double*)storage->points + 3 * (size_t)i;
    const double level = (double)(i / up) / ESTUARY_LAYERS;
    p[0] = ESTUARY_LENGTH * (i % row) / ESTUARY_X;
    p[1] = ESTUARY_WIDTH * (i % up / row) / ESTUARY_Y;
    const double depth = estuary_depth(p[0], p[1]), surface = estuary_surface(p[0]);
    p[2] = -depth + (depth + surface) * level * (1.5 - 0.5 * level); /* layers are thinner at the surface */
    ((float*)storage->values)[i] = (float)estuary_value(p);
  }
  int32_t* vertices = storage->vertices;
  for (int32_t square = 0; square < ESTUARY_X * ESTUARY_Y * ESTUARY_LAYERS; ++square) {
    const int32_t x = square % ESTUARY_X, y = square / ESTUARY_X % ESTUARY_Y;
    const int32_t a = square / (ESTUARY_X * ESTUARY_Y) * up + y * row + x, b = a + 1, c = a + row + 1, d = a + row;
    if ((x + y) % 2 == 0) {
      add_wedge(&vertices, a, b, c, up);
      add_wedge(&vertices, a, c, d, up);
    } else {
      add_wedge(&vertices, a, b, d, up);
      add_wedge(&vertices, b, c, d, up);
    }
  }
  mesh->vertices = storage->vertices;
  mesh->values = storage->values;
  mesh->type = STRATUS_FLOAT32;
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- the lattice */

static stratus_status make_wavelet(stratus_context* context, mesh_storage* storage)
{
  static const int path[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
  const int side = LATTICE + 1, step[3] = { 1, side, side * side };
  stratus_mesh* mesh = &storage->scene.mesh;
  mesh->point_count = (int64_t)side * side * side;
  mesh->cell_count = (int64_t)6 * LATTICE * LATTICE * LATTICE;
  TRY(stratus_allocate(context, (size_t)mesh->point_count, 3 * sizeof(double), &storage->points));
  TRY(stratus_allocate(context, (size_t)mesh->cell_count, 4 * sizeof(int32_t), &storage->vertices));
  TRY(stratus_allocate(context, (size_t)mesh->point_count, sizeof(float), &storage->values));
  double* points = storage->points;
  float* values = storage->values;
  int32_t* vertices = storage->vertices;
  for (int i = 0; i < mesh->point_count; ++i) {
    points[3 * i] = i % side;
    points[3 * i + 1] = i / side % side;
    points[3 * i + 2] = i / side / side;
    values[i] = (float)wavelet_value(points + 3 * i);
  }
  for (int box = 0; box < LATTICE * LATTICE * LATTICE; ++box) {
    for (int c = 0; c < 6; ++c) {
      int corner = box % LATTICE + box / LATTICE % LATTICE * step[1] + box / LATTICE / LATTICE * step[2];
      *vertices++ = corner;
      for (int v = 0; v < 3; ++v) {
        *vertices++ = corner += step[path[c][v]];
      }
    }
  }
  mesh->vertices = storage->vertices;
  mesh->values = values;
  mesh->type = STRATUS_FLOAT32;
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- the plate */

/* Gives the position of point s on a square's border, counted counterclockwise in pieces of its edge from the lower left corner. */
static void around_square(int s, int at[2])
{
  const int edge = s / SIDE, t = s % SIDE;
  at[0] = edge == 0 ? t : edge == 1 ? SIDE : edge == 2 ? SIDE - t : 0;
  at[1] = edge == 0 ? 0 : edge == 1 ? t : edge == 2 ? SIDE : SIDE - t;
}

typedef struct plate {
  double* points;
  int32_t* quads;
  int32_t layer; /* points of one face; the upper face's points follow them */
  int64_t quad_count;
  int32_t corner[ACROSS_Y][ACROSS_X]; /* points on the squares' edges; -1 inside squares */
} plate;

static int32_t add_point(plate* p, double x, double y)
{
  double* point = p->points + 3 * p->layer;
  point[0] = x;
  point[1] = y;
  point[2] = 0.0;
  return p->layer++;
}

static void add_quad(plate* p, int32_t a, int32_t b, int32_t c, int32_t d)
{
  const int32_t quad[4] = { a, b, c, d };
  memcpy(p->quads + 4 * p->quad_count++, quad, sizeof quad);
}

/* Add both faces around a hole, the hole's wall, and the plate's wall where the square is at its border. All quads are counterclockwise
 * seen from outside. */
static void add_square(plate* p, int column, int row, const int32_t* circle, int32_t top)
{
  for (int s = 0; s < AROUND; ++s) {
    int here[2], there[2];
    around_square(s, here);
    around_square((s + 1) % AROUND, there);
    const int32_t a = p->corner[row * SIDE + here[1]][column * SIDE + here[0]],
                  b = p->corner[row * SIDE + there[1]][column * SIDE + there[0]];
    const int32_t c = circle[(s + 1) % AROUND], d = circle[s];
    const int edge = s / SIDE;
    add_quad(p, top + a, top + b, top + c, top + d);
    add_quad(p, d, c, b, a);
    add_quad(p, top + d, top + c, c, d);
    if ((edge == 0 && row == 0) || (edge == 1 && column == HOLES_X - 1) || (edge == 2 && row == HOLES_Y - 1) ||
      (edge == 3 && column == 0)) {
      add_quad(p, top + b, top + a, a, b);
    }
  }
}

#define EDGE_POINTS (ACROSS_X * (HOLES_Y + 1) + ACROSS_Y * (HOLES_X + 1) - (HOLES_X + 1) * (HOLES_Y + 1))
#define LAYER_POINTS (EDGE_POINTS + HOLES_X * HOLES_Y * AROUND)
#define QUADS (3 * AROUND * HOLES_X * HOLES_Y + 2 * SIDE * (HOLES_X + HOLES_Y))

static stratus_status make_holes(stratus_context* context, mesh_storage* storage)
{
  const double pi = 3.14159265358979323846;
  plate p = { NULL, NULL, 0, 0, { { 0 } } };
  TRY(stratus_allocate(context, 2 * LAYER_POINTS, 3 * sizeof(double), &storage->points));
  TRY(stratus_allocate(context, QUADS, 4 * sizeof(int32_t), &storage->quads));
  p.points = storage->points;
  p.quads = storage->quads;
  for (int j = 0; j < ACROSS_Y; ++j) {
    for (int i = 0; i < ACROSS_X; ++i) {
      p.corner[j][i] = i % SIDE == 0 || j % SIDE == 0 ? add_point(&p, (double)i / SIDE, (double)j / SIDE) : -1;
    }
  }
  for (int h = 0; h < HOLES_X * HOLES_Y; ++h) {
    int32_t circle[AROUND];
    for (int s = 0; s < AROUND; ++s) {
      const double angle = 2.0 * pi * (s - 1.5 * SIDE) / AROUND; /* point 0 lies lower left, as on the square */
      circle[s] = add_point(&p, h % HOLES_X + 0.5 + RADIUS * cos(angle), h / HOLES_X + 0.5 + RADIUS * sin(angle));
    }
    add_square(&p, h % HOLES_X, h / HOLES_X, circle, LAYER_POINTS);
  }
  memcpy(p.points + 3 * LAYER_POINTS, p.points, 3 * LAYER_POINTS * sizeof(double));
  for (int i = LAYER_POINTS; i < 2 * LAYER_POINTS; ++i) {
    p.points[3 * i + 2] = THICKNESS;
  }
  storage->scene.mesh.point_count = 2 * LAYER_POINTS;
  storage->scene.quads = p.quads;
  storage->scene.quad_count = p.quad_count;
  storage->scene.maximum_volume = MAXIMUM_VOLUME;
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- public functions */

static const struct {
  const char* name;
  stratus_status (*make)(stratus_context* context, mesh_storage* storage);
  double (*value)(const double point[3]);
} recipes[] = { { "estuary", make_estuary, estuary_value }, { "holes", make_holes, holes_value },
  { "wavelet", make_wavelet, wavelet_value } };
#define RECIPES ((int)(sizeof recipes / sizeof recipes[0]))

int stratus_mesh_scene_count(void)
{
  return RECIPES;
}

const char* stratus_mesh_scene_name(int index)
{
  return index >= 0 && index < RECIPES ? recipes[index].name : NULL;
}

static int find_recipe(const char* name)
{
  for (int i = 0; i < RECIPES; ++i) {
    if (name && strcmp(name, recipes[i].name) == 0) {
      return i;
    }
  }
  return -1;
}

stratus_status stratus_mesh_scene_create(stratus_context* context, const char* name, stratus_mesh_scene** scene)
{
  const int index = find_recipe(name);
  void* memory = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!scene) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the scene's address is NULL");
  }
  if (index < 0) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "unknown mesh \"%.100s\"; there are: estuary, holes, wavelet", name ? name : "(null)");
  }
  TRY(stratus_allocate_zero(context, 1, sizeof(mesh_storage), &memory));
  mesh_storage* storage = memory;
  storage->scene.name = recipes[index].name;
  storage->scene.mesh = stratus_mesh_default();
  const stratus_status status = recipes[index].make(context, storage);
  if (status != STRATUS_OK) {
    stratus_mesh_scene_destroy(context, &storage->scene);
    return status;
  }
  storage->scene.mesh.points = storage->points;
  *scene = &storage->scene;
  return STRATUS_OK;
}

void stratus_mesh_scene_destroy(stratus_context* context, stratus_mesh_scene* scene)
{
  if (context && scene) {
    mesh_storage* storage = (mesh_storage*)scene;
    stratus_release(context, storage->points);
    stratus_release(context, storage->vertices);
    stratus_release(context, storage->values);
    stratus_release(context, storage->quads);
    stratus_release(context, storage);
  }
}

double stratus_mesh_scene_value(const char* name, const double point[3])
{
  const int index = find_recipe(name);
  return index < 0 || !point ? NAN : recipes[index].value(point);
}
