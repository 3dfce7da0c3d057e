/* SPDX-License-Identifier: BSD-3-Clause
 * A tile of rays through tetrahedra, compiled for one instruction set, STRATUS_ISA. A lane whose ray has ended takes the next pixel, so that
 * packets stay full; what a ray does depends on nothing but the ray. */
#include "tetra_march.h"

#include "../kernels/tetra_march.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* the headers have more words than this file needs */
#endif

#define PIXELS (TETRA_TILE * TETRA_TILE)
#define WIDTH STRATUS_WIDTH

/* A packet and its shading, lane by lane, between its turns in registers. */
typedef struct lanes {
  float us[WIDTH], uw[WIDTH], vs[WIDTH], vw[WIDTH], begin[WIDTH], end[WIDTH], length[WIDTH], offset[WIDTH];
  float x[3][WIDTH], y[3][WIDTH], z[3][WIDTH], s[3][WIDTH], edge[3][WIDTH], at[WIDTH], value[WIDTH];
  int name[3][WIDTH], cell[WIDTH], steps[WIDTH], live[WIDTH], done[WIDTH];
  float red[WIDTH], green[WIDTH], blue[WIDTH], transparency[WIDTH], depth[WIDTH], front[WIDTH];
  uint32_t segments[WIDTH], entry[WIDTH], beyond[WIDTH];
  int pixel[WIDTH];
} lanes;

typedef struct tile_march {
  const stratus_tetra_frame* frame;
  const uint32_t* first;
  int x0, y0, next; /* pixel to be taken next */
  stratus_tetra_counts* counts;
  lanes lane;
} tile_march;

/* ---- where rays come in */

typedef struct face_packet {
  vfloat x[3], y[3], z[3], s[3], edge[3];
} face_packet;

static vmask meets(const stratus_tetra_frame* frame, const stratus_tetra_face* face, int x, int y, face_packet* p)
{
  const vfloat zero = v_set(0.0f), us = v_load(frame->us + x), uw = v_load(frame->uw + x), vs = v_set(frame->vs[y]), vw = v_set(frame->vw[y]);
  for (int i = 0; i < 3; ++i) {
    const float* point = frame->points + 4 * (size_t)face->point[i];
    p->z[i] = v_set(point[2]);
    p->s[i] = v_set(point[3]);
    p->x[i] = v_fma(zero - us, p->z[i], v_set(point[0]) - uw);
    p->y[i] = v_fma(zero - vs, p->z[i], v_set(point[1]) - vw);
  }
  vmask outside = m_none();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    p->edge[i] = tetra_edge(p->x[j], p->y[j], p->x[k], p->y[k]);
    outside = outside | tetra_negative(p->edge[i], p->x[j], p->y[j], p->x[k], p->y[k]);
  }
  /* three points in one count as no face */
  const vfloat wide = v_max(v_max(v_abs(p->x[1] - p->x[0]), v_abs(p->x[2] - p->x[0])), v_max(v_abs(p->y[1] - p->y[0]), v_abs(p->y[2] - p->y[0])));
  return m_andnot(v_lt(zero, wide), outside);
}

static void insert_entry(stratus_tetra_entry* entries, uint32_t count, stratus_tetra_entry entry)
{
  while (count > 0 && entries[count - 1].z > entry.z) {
    entries[count] = entries[count - 1];
    --count;
  }
  entries[count] = entry;
}

/* Each pixel's entries are counted, or put in order of depth, then of the face's number. */
static void find_entries(const stratus_tetra_frame* frame, int tile, bool counting, uint32_t found[PIXELS])
{
  const int x0 = tile % frame->columns * TETRA_TILE, y0 = tile / frame->columns * TETRA_TILE;
  const int height = frame->image.height - y0 < TETRA_TILE ? frame->image.height - y0 : TETRA_TILE;
  const uint32_t* first = frame->first + (size_t)tile * PIXELS;
  memset(found, 0, PIXELS * sizeof *found);
  for (uint32_t b = frame->bin_begin[tile]; b < frame->bin_begin[tile + 1]; ++b) {
    const int32_t face = frame->bins[b];
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < TETRA_TILE; x += WIDTH) {
        face_packet p;
        vfloat at, value;
        int hit[WIDTH];
        float z[WIDTH];
        const vmask mask = meets(frame, frame->faces + face, x0 + x, y0 + y, &p);
        if (!m_any(mask)) {
          continue;
        }
        tetra_cross(p.edge, p.z, p.s, &at, &value);
        vi_store(hit, vi_select(mask, vi_set(1), vi_set(0)));
        v_store(z, at);
        for (int lane = 0; lane < WIDTH; ++lane) {
          const int pixel = y * TETRA_TILE + x + lane;
          if (hit[lane] && x0 + x + lane < frame->image.width) {
            if (!counting) {
              insert_entry(frame->entries + first[pixel], found[pixel], (stratus_tetra_entry){ z[lane], face });
            }
            ++found[pixel];
          }
        }
      }
    }
  }
}

/* ---- lanes */

/* The first point whose ray this is, of a face by which it comes in: the same operations as where entries were found. */
static void enter(tile_march* t, int l)
{
  const stratus_tetra_frame* frame = t->frame;
  lanes* k = &t->lane;
  const stratus_tetra_face* face = frame->faces + frame->entries[k->entry[l]++].face;
  float share = 0.0f, weight[3], at[3] = { 0.0f };
  for (int i = 0; i < 3; ++i) {
    const float* point = frame->points + 4 * (size_t)face->point[i];
    k->x[i][l] = fmaf(0.0f - k->us[l], point[2], point[0] - k->uw[l]);
    k->y[i][l] = fmaf(0.0f - k->vs[l], point[2], point[1] - k->vw[l]);
    k->z[i][l] = point[2];
    k->s[i][l] = point[3];
    k->name[i][l] = face->point[i];
  }
  for (int i = 0; i < 3; ++i) {
    const int p = (i + 1) % 3, q = (i + 2) % 3;
    const float product = k->y[p][l] * k->x[q][l], rounding = fmaf(k->y[p][l], k->x[q][l], 0.0f - product);
    k->edge[i][l] = fmaf(k->x[p][l], k->y[q][l], 0.0f - product) - rounding;
    weight[i] = (k->edge[i][l] > 0.0f ? k->edge[i][l] : 0.0f) + 1e-30f;
    at[0] += weight[i] * k->z[i][l];
    at[1] += weight[i] * k->s[i][l];
    share += weight[i];
  }
  k->cell[l] = face->cell;
  k->at[l] = at[0] / share;
  k->value[l] = at[1] / share;
  k->steps[l] = 0;
  ++t->counts->entries;
}

/* What is seen of the ray, in z: from the near plane to the far one, or to what is opaque. */
static void find_range(const stratus_tetra_frame* frame, int x, int y, lanes* k, int l)
{
  const stratus_camera* c = &frame->camera;
  const stratus_image* image = &frame->image;
  const double u = (2.0 * x + 1.0) / image->width - 1.0, v = (2.0 * y + 1.0) / image->height - 1.0;
  double end = c->far_k, square = 0.0;
  if (image->opaque_depth) {
    const double extent = (double)image->opaque_depth[(size_t)y * (size_t)image->width + (size_t)x] * (c->far_k - c->near_k);
    end = c->parallel ? c->near_k + extent : c->near_k * c->far_k / (c->far_k - extent);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double along = c->forward[axis] + (c->parallel ? 0.0 : u * c->right[axis] + v * c->up[axis]);
    square += along * along;
  }
  const double length = sqrt(square);
  k->begin[l] = (float)((c->near_k - frame->middle) / frame->per_z);
  k->end[l] = (float)fmin((end - frame->middle) / frame->per_z, 1e30);
  k->length[l] = (float)(length * frame->per_z);
  k->offset[l] = (float)(length * frame->middle);
}

/* The next pixel of the tile that any cell covers; false if there is none. */
static bool take_pixel(tile_march* t, int l)
{
  lanes* k = &t->lane;
  while (t->next < PIXELS && t->first[t->next] == t->first[t->next + 1]) {
    ++t->next;
  }
  if (t->next == PIXELS) {
    return false;
  }
  const int pixel = t->next++, x = t->x0 + pixel % TETRA_TILE, y = t->y0 + pixel / TETRA_TILE;
  k->pixel[l] = pixel;
  k->entry[l] = t->first[pixel];
  k->beyond[l] = t->first[pixel + 1];
  k->us[l] = t->frame->us[x];
  k->uw[l] = t->frame->uw[x];
  k->vs[l] = t->frame->vs[y];
  k->vw[l] = t->frame->vw[y];
  find_range(t->frame, x, y, k, l);
  k->red[l] = k->green[l] = k->blue[l] = 0.0f;
  k->transparency[l] = 1.0f;
  k->depth[l] = LARGEST_FLOAT;
  k->front[l] = -LARGEST_FLOAT;
  k->segments[l] = 0;
  ++t->counts->rays;
  enter(t, l);
  return true;
}

static void store_pixel(tile_march* t, int l)
{
  const stratus_tetra_frame* frame = t->frame;
  const lanes* k = &t->lane;
  const size_t x = (size_t)(t->x0 + k->pixel[l] % TETRA_TILE), y = (size_t)(t->y0 + k->pixel[l] / TETRA_TILE);
  const size_t pixel = y * (size_t)frame->image.width + x;
  float rgba[4] = { k->red[l], k->green[l], k->blue[l], 1.0f - k->transparency[l] };
  if (frame->arguments.maximum) {
    const float* entry = frame->table->rgba + 4 * (size_t)stratus_table_entry(frame->table, k->front[l]);
    for (int c = 0; c < 4; ++c) {
      rgba[c] = k->front[l] > -LARGEST_FLOAT ? entry[c] : 0.0f;
    }
  }
  memcpy(frame->image.rgba + 4 * pixel, rgba, sizeof rgba);
  if (frame->image.depth) {
    frame->image.depth[pixel] = rgba[3] > 0.0f && k->depth[l] < LARGEST_FLOAT ? k->depth[l] : INFINITY;
  }
  if (frame->image.samples) {
    frame->image.samples[pixel] = k->segments[l];
  }
}

/* ---- marching */

static void load(const lanes* k, stratus_tetra_ray* r, stratus_packet* p)
{
  r->us = v_load(k->us), r->uw = v_load(k->uw), r->vs = v_load(k->vs), r->vw = v_load(k->vw);
  r->begin = v_load(k->begin), r->end = v_load(k->end), r->length = v_load(k->length), r->offset = v_load(k->offset);
  for (int i = 0; i < 3; ++i) {
    r->x[i] = v_load(k->x[i]), r->y[i] = v_load(k->y[i]), r->z[i] = v_load(k->z[i]), r->s[i] = v_load(k->s[i]);
    r->edge[i] = v_load(k->edge[i]);
    r->name[i] = vi_load(k->name[i]);
  }
  r->cell = vi_load(k->cell), r->steps = vi_load(k->steps);
  r->at = v_load(k->at), r->value = v_load(k->value);
  p->red = v_load(k->red), p->green = v_load(k->green), p->blue = v_load(k->blue), p->transparency = v_load(k->transparency);
  p->depth = v_load(k->depth), p->front = v_load(k->front);
  p->first = v_set(0.0f);
}

static void store(lanes* k, const stratus_tetra_ray* r, const stratus_packet* p)
{
  for (int i = 0; i < 3; ++i) {
    v_store(k->x[i], r->x[i]), v_store(k->y[i], r->y[i]), v_store(k->z[i], r->z[i]), v_store(k->s[i], r->s[i]);
    v_store(k->edge[i], r->edge[i]);
    vi_store(k->name[i], r->name[i]);
  }
  vi_store(k->cell, r->cell), vi_store(k->steps, r->steps);
  v_store(k->at, r->at), v_store(k->value, r->value);
  v_store(k->red, p->red), v_store(k->green, p->green), v_store(k->blue, p->blue), v_store(k->transparency, p->transparency);
  v_store(k->depth, p->depth), v_store(k->front, p->front);
}

/* A lane whose way has ended: its next way if there is one that it can see, else the next pixel. */
static void go_on(tile_march* t, int l)
{
  const stratus_tetra_frame* frame = t->frame;
  lanes* k = &t->lane;
  const uint32_t passed = (uint32_t)k->steps[l];
  k->segments[l] += passed;
  t->counts->segments += passed;
  t->counts->stuck += k->cell[l] < -1 || (k->cell[l] >= 0 && k->steps[l] >= frame->arguments.steps_most);
  const bool ended = k->transparency[l] < frame->arguments.table.termination;
  if (!ended && k->entry[l] < k->beyond[l] && frame->entries[k->entry[l]].z < k->end[l]) {
    enter(t, l);
    return;
  }
  store_pixel(t, l);
  k->live[l] = take_pixel(t, l);
}

static void march(tile_march* t)
{
  const stratus_tetra_frame* frame = t->frame;
  lanes* k = &t->lane;
  int live = 0;
  memset(k, 0, sizeof *k);
  for (int l = 0; l < WIDTH; ++l) {
    k->live[l] = take_pixel(t, l);
    live += k->live[l];
  }
  while (live > 0) {
    stratus_tetra_ray r;
    stratus_packet p;
    vmask done;
    load(k, &r, &p);
    const vmask active = vi_lt(vi_set(0), vi_load(k->live));
    do {
      done = tetra_step(&frame->arguments, frame->cells, frame->points, frame->sums, &r, &p, active);
    } while (!m_any(done));
    store(k, &r, &p);
    vi_store(k->done, vi_select(done, vi_set(1), vi_set(0)));
    live = 0;
    for (int l = 0; l < WIDTH; ++l) {
      if (k->done[l]) {
        go_on(t, l);
      }
      live += k->live[l];
    }
  }
}

/* Pixels that no cell covers. */
static void clear(const stratus_tetra_frame* frame, int x0, int y0)
{
  const stratus_image* image = &frame->image;
  const size_t x1 = (size_t)(x0 + TETRA_TILE < image->width ? x0 + TETRA_TILE : image->width), count = x1 - (size_t)x0;
  for (int y = y0; y < y0 + TETRA_TILE && y < image->height; ++y) {
    const size_t begin = (size_t)y * (size_t)image->width + (size_t)x0;
    memset(image->rgba + 4 * begin, 0, 4 * count * sizeof *image->rgba);
    for (size_t i = 0; i < count; ++i) {
      if (image->depth) {
        image->depth[begin + i] = INFINITY;
      }
      if (image->samples) {
        image->samples[begin + i] = 0;
      }
    }
  }
}

#if STRATUS_ISA == 2
#define TILE_ISA stratus_tetra_tile_isa2
#elif STRATUS_ISA == 1
#define TILE_ISA stratus_tetra_tile_isa1
#else
#define TILE_ISA stratus_tetra_tile_isa0
#endif

void TILE_ISA(const stratus_tetra_frame* frame, int tile, bool counting, stratus_tetra_counts* counts)
{
  uint32_t found[PIXELS];
  uint32_t* first = frame->first + (size_t)tile * PIXELS;
  if (counting) {
    find_entries(frame, tile, true, first);
    return;
  }
  tile_march t = { .frame = frame,
    .first = first,
    .x0 = tile % frame->columns * TETRA_TILE,
    .y0 = tile / frame->columns * TETRA_TILE,
    .counts = counts };
  clear(frame, t.x0, t.y0);
  if (first[0] < first[PIXELS]) {
    find_entries(frame, tile, false, found);
    march(&t);
  }
}
