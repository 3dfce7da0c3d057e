/* SPDX-License-Identifier: BSD-3-Clause
 * Marches the rays of a tile. A lane whose ray has ended takes the next pixel, so that packets stay full. A ray's result depends on
 * nothing but the ray. */
#ifndef STRATUS_TETRA_TILE_H
#define STRATUS_TETRA_TILE_H

#include "crop.h"
#include "slice.h"
#include "tetra_entry.h"

/* How many lanes wait before new rays are loaded: loading costs as much for one lane as for all. */
#define TETRA_REFILL (STRATUS_WIDTH / 4 > 0 ? STRATUS_WIDTH / 4 : 1)

typedef struct stratus_tetra_found {
  uint rays, entries, segments, stuck;
} stratus_tetra_found;

/* ---- lanes */

typedef struct stratus_tetra_lanes {
  stratus_tetra_ray ray;
  stratus_tetra_light light;
  vint pixel, entry, beyond; /* the next entry of the ray, and the end of its entries */
  vint piece;                /* of the ray, where crop regions cut it */
  vint steps, segments;      /* cells passed since the last entry; cells passed in all */
  vint layer;                /* of the pictures of layers, the one that the ray is in */
  vfloat first, seen[2];     /* where the ray's first layer begins, and the part of the ray that is seen in all layers */
  vmask live, done;          /* done: the lane's way has ended; neither live nor done: there is no pixel for it */
} stratus_tetra_lanes;

typedef struct stratus_tetra_walk {
  const stratus_tetra_view* view;
  CONSTANT stratus_tetra_arguments* arguments;
  int tile, x0, y0, next, count; /* next, count: of `pixels` */
  stratus_tetra_found found;
  ushort pixels[STRATUS_WIDTH > 1 ? TETRA_PIXELS : 1]; /* pixels of the tile that have an entry */
} stratus_tetra_walk;

/* Finds where rays meet the slice, and ends them behind it. */
INLINE void lanes_meet_slice(CONSTANT stratus_tetra_arguments* a, stratus_tetra_ray* r, vmask mask)
{
  float line[4][STRATUS_WIDTH], at[2][STRATUS_WIDTH];
  v_store(line[0], r->us);
  v_store(line[1], r->uw);
  v_store(line[2], r->vs);
  v_store(line[3], r->vw);
  for (int part = 0; part < STRATUS_WIDTH; part += REAL_WIDTH) {
    const real steps[3] = { r_load(line[0] + part), r_load(line[2] + part), r_number(1.0f) };
    const real from[3] = { r_sub(r_load(line[1] + part), r_of(a->slice.center[0])), r_sub(r_load(line[3] + part), r_of(a->slice.center[1])),
      r_neg(r_of(a->slice.center[2])) };
    real degree[3], roots[2];
    slice_along(&a->slice, from, steps, degree);
    slice_roots(degree, roots);
    r_store(at[0] + part, roots[0]);
    r_store(at[1] + part, roots[1]);
  }
  const vfloat first = v_load(at[0]), second = v_load(at[1]), none = v_set(LARGEST_FLOAT);
  const vfloat last = v_select(v_lt(second, none), second, v_select(v_lt(first, none), first, v_set(-LARGEST_FLOAT)));
  r->slice[0] = v_select(mask, first, r->slice[0]);
  r->slice[1] = v_select(mask, second, r->slice[1]);
  /* a hair farther: the value at the end of a stretch belongs to the next */
  r->end = v_select(mask, v_min(r->end, v_fma(v_abs(last), v_set(1e-6f), last) + v_set(1e-30f)), r->end);
}

/* Shortens the seen part of rays to the piece k->piece of those that crop regions leave. */
INLINE void lanes_crop(CONSTANT stratus_tetra_arguments* a, stratus_tetra_lanes* k, vmask mask)
{
  stratus_tetra_ray* r = &k->ray;
  float first[STRATUS_WIDTH], last[STRATUS_WIDTH], crossing[3][2][STRATUS_WIDTH], d[3][STRATUS_WIDTH];
  float from[CROP_PIECES][STRATUS_WIDTH], to[CROP_PIECES][STRATUS_WIDTH];
  int piece[STRATUS_WIDTH];
  const vfloat zero = v_set(0.0f), far = v_set(LARGEST_FLOAT), u = a->shear > 0.0f ? r->us : r->uw, v = a->shear > 0.0f ? r->vs : r->vw;
  for (int axis = 0; axis < 3; ++axis) {
    vfloat start[2], slope[2];
    tetra_plane(a->crop[axis][0], u, v, start, slope);
    tetra_plane(a->crop[axis][1], u, v, start + 1, slope + 1);
    const vfloat up = slope[0] + slope[1]; /* a plane at infinity has no slope */
    for (int side = 0; side < 2; ++side) {
      const vfloat at =
        v_select(v_lt(slope[side], zero), start[side], zero - start[side]) * v_reciprocal(v_max(v_abs(slope[side]), v_set(1e-30f)));
      /* a ray that does not meet the plane is always above or below it */
      const vfloat beyond = v_select(v_lt(zero, start[side]), far, zero - far), never = v_select(v_lt(zero, up), zero - beyond, beyond);
      v_store(crossing[axis][side], v_select(v_le(v_abs(slope[side]), zero), never, at));
    }
    v_store(d[axis], up);
  }
  v_store(first, r->begin);
  v_store(last, r->end);
  vi_store(piece, k->piece);
  crop_pieces(a->regions, first, last, (const float(*)[2][STRATUS_WIDTH])crossing, (const float(*)[STRATUS_WIDTH])d, from, to);
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    first[lane] = from[piece[lane]][lane];
    last[lane] = to[piece[lane]][lane];
  }
  r->begin = v_select(mask, v_load(first), r->begin);
  r->end = v_select(mask, v_load(last), r->end);
}

/* Cuts the seen part of rays to their layer. */
INLINE void lanes_cut_to_layer(CONSTANT stratus_tetra_arguments* a, stratus_tetra_lanes* k, vmask mask)
{
  const vfloat depth = v_set(a->layer_depth), number = v_from_int(k->layer);
  const vfloat begin = v_fma(number, depth, k->first), end = v_fma(number + v_set(1.0f), depth, k->first);
  const vmask last = vi_ge(k->layer, vi_set(a->layers - 1));
  k->ray.begin = v_select(mask, v_max(k->seen[0], begin), k->ray.begin);
  k->ray.end = v_select(mask, v_select(last, k->seen[1], v_min(k->seen[1], end)), k->ray.end);
}

/* Loads the rays of lanes, or the next of their pieces, and their entries. */
INLINE void lanes_load(stratus_tetra_walk* t, stratus_tetra_lanes* k, vmask mask)
{
  const stratus_tetra_view* v = t->view;
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  stratus_tetra_ray* r = &k->ray;
  const vint row = k->pixel >> vi_set(TETRA_TILE_LOG2);
  const vint x = k->pixel - (row << vi_set(TETRA_TILE_LOG2)) + vi_set(t->x0), y = row + vi_set(t->y0);
  GLOBAL const float* rows = v->lines + 2 * (a->picture.width + TETRA_PADDING);
  r->us = v_select(mask, gather_float(v->lines, x, mask), r->us);
  r->uw = v_select(mask, gather_float(v->lines + a->picture.width + TETRA_PADDING, x, mask), r->uw);
  r->vs = v_select(mask, gather_float(rows, y, mask), r->vs);
  r->vw = v_select(mask, gather_float(rows + a->picture.height + TETRA_PADDING, y, mask), r->vw);
  const stratus_tetra_sight sight = tetra_sight(a, v->ends, r->us, r->uw, r->vs, r->vw, x, y, mask);
  r->length = v_select(mask, sight.length, r->length);
  r->offset = v_select(mask, sight.offset, r->offset);
  r->begin = v_select(mask, sight.begin, r->begin);
  r->end = v_select(mask, sight.end, r->end);
  if (a->regions) {
    lanes_crop(a, k, mask);
  }
  if (a->mode == TETRA_SLICE) {
    lanes_meet_slice(a, r, mask);
  }
  if (a->layers) {
    const vfloat lean = v_fma(r->uw, v_set(a->lean[0]), r->vw * v_set(a->lean[1]));
    k->first = v_select(mask, lean + v_set(a->begin), k->first);
    k->seen[0] = v_select(mask, r->begin, k->seen[0]);
    k->seen[1] = v_select(mask, r->end, k->seen[1]);
    k->layer = vi_select(mask, vi_set(0), k->layer);
    lanes_cut_to_layer(a, k, mask);
  }
  const vint place = k->pixel + vi_set(TETRA_PIXELS * t->tile);
  k->entry = vi_select(mask, v_gather_ints((GLOBAL const int*)v->first, place, mask), k->entry);
  k->beyond = vi_select(mask, v_gather_ints((GLOBAL const int*)v->first, place + vi_set(1), mask), k->beyond);
}

/* Makes rays gather anew. */
INLINE void lanes_forget(CONSTANT stratus_tetra_arguments* a, stratus_tetra_light* light, vmask mask)
{
  const vfloat none = v_set(0.0f);
  const int surfaces = a->mode == TETRA_SURFACES || a->mode == TETRA_SLICE;
  light->red = v_select(mask, none, light->red);
  light->green = v_select(mask, none, light->green);
  light->blue = v_select(mask, none, light->blue);
  light->transparency = v_select(mask, v_set(1.0f), light->transparency);
  light->depth = v_select(mask, v_set(LARGEST_FLOAT), light->depth);
  light->most = v_select(mask, v_set(surfaces ? 0.0f : -LARGEST_FLOAT), light->most);
}

/* Begins the rays of lanes that have a new pixel. */
INLINE void lanes_take(stratus_tetra_walk* t, stratus_tetra_lanes* k, vmask mask, vint pixel)
{
  k->pixel = vi_select(mask, pixel, k->pixel);
  k->piece = vi_select(mask, vi_set(0), k->piece);
  lanes_load(t, k, mask);
  k->segments = vi_select(mask, vi_set(0), k->segments);
  lanes_forget(t->arguments, &k->light, mask);
}

/* Moves rays that have ended to the next of their pieces in which they meet the mesh. Returns those that have one. */
INLINE vmask lanes_next_piece(stratus_tetra_walk* t, stratus_tetra_lanes* k, vmask mask)
{
  vmask found = m_none();
  mask = m_andnot(mask, v_lt(k->light.transparency, v_set(t->arguments->termination)));
  for (int turn = 1; turn < CROP_PIECES; ++turn) {
    vint entry[2];
    mask = mask & vi_lt(k->piece, vi_set(CROP_PIECES - 1));
    if (!m_any(mask)) {
      break;
    }
    k->piece = vi_select(mask, k->piece + vi_set(1), k->piece);
    lanes_load(t, k, mask);
    gather_pair(t->view->entries, k->entry + k->entry, mask, entry);
    const vmask meets = mask & v_lt(k->ray.begin, k->ray.end) & v_lt(v_from_bits(entry[0]), k->ray.end);
    found = found | meets;
    mask = m_andnot(mask, meets);
  }
  return found;
}

/* Starts rays at their next entry. */
INLINE void lanes_enter(stratus_tetra_walk* t, stratus_tetra_lanes* k, vmask mask)
{
  const stratus_tetra_view* v = t->view;
  stratus_tetra_ray* r = &k->ray;
  vint entry[2], name[4], cell[2];
  gather_pair(v->entries, k->entry + k->entry, mask, entry);
  k->entry = vi_select(mask, k->entry + vi_set(1), k->entry);
  gather_four_ints(v->faces, entry[1] + entry[1], mask, name);
  gather_pair(v->faces + 4, entry[1] << vi_set(3), mask, cell);
  for (int i = 0; i < 3; ++i) {
    vfloat p[4];
    gather_four(v->scene.points, name[i], mask, p);
    r->x[i] = v_select(mask, v_fma(-r->us, p[2], p[0] - r->uw), r->x[i]);
    r->y[i] = v_select(mask, v_fma(-r->vs, p[2], p[1] - r->vw), r->y[i]);
    r->z[i] = v_select(mask, p[2], r->z[i]);
    r->s[i] = v_select(mask, p[3], r->s[i]);
    r->name[i] = vi_select(mask, name[i], r->name[i]);
  }
  r->fourth = vi_select(mask, name[3], r->fourth);
  r->cell = vi_select(mask, cell[0], r->cell);
  tetra_enter(t->arguments, &v->scene, r, mask);
  k->steps = vi_select(mask, vi_set(0), k->steps);
  t->found.entries += (uint)m_count(mask);
}

INLINE void store_ray(const stratus_tetra_walk* t, int pixel, const float rgba[4], float depth, int segments)
{
  tetra_store_pixel(&t->view->picture, t->arguments, t->x0 + pixel % TETRA_TILE, t->y0 + pixel / TETRA_TILE, rgba, depth, (uint)segments);
}

/* Stores the pixels of lanes whose ray has ended. */
INLINE void lanes_store(stratus_tetra_walk* t, const stratus_tetra_lanes* k, vmask mask)
{
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  float channel[4][STRATUS_WIDTH], depth[STRATUS_WIDTH], largest[STRATUS_WIDTH];
  int pixel[STRATUS_WIDTH], segments[STRATUS_WIDTH], entry[STRATUS_WIDTH];
  /* rounding may take a sum above 1; light and quantities go beyond */
  const vfloat one = v_set(1.0f), most = v_set(TETRA_LIT || a->mode == TETRA_QUANTITIES ? LARGEST_FLOAT : 1.0f);
  v_store(channel[0], v_min(k->light.red, most));
  v_store(channel[1], v_min(k->light.green, most));
  v_store(channel[2], v_min(k->light.blue, most));
  v_store(channel[3], one - k->light.transparency);
  v_store(depth, k->light.depth);
  v_store(largest, k->light.most);
  vi_store(pixel, vi_select(mask, k->pixel, vi_set(-1)));
  vi_store(segments, k->segments);
  if (a->mode == TETRA_EXTREMES) {
    vi_store(entry, table_entry(&a->table, t->view->scene.colors, v_set(a->sign) * k->light.most));
  }
  if (a->mode == TETRA_ADD) { /* grey and opaque wherever something was added */
    const vmask counts = v_lt(v_set(0.0f), k->light.green);
    const vfloat scale = a->grey > 0.0f ? v_set(a->grey) : v_reciprocal(v_max(k->light.green, v_set(1e-30f)));
    const vfloat grey = v_select(counts, v_min(k->light.red * scale, one), v_set(0.0f));
    v_store(channel[0], grey);
    v_store(channel[1], grey);
    v_store(channel[2], grey);
    v_store(channel[3], v_select(counts, one, v_set(0.0f)));
    if (a->kept > 0.0f) {
      v_store(channel[0], k->light.red * v_set(a->kept));
      v_store(channel[1], k->light.green * v_set(a->kept));
    }
  }
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    float rgba[4];
    if (pixel[lane] < 0) {
      continue;
    }
    for (int c = 0; c < 4; ++c) {
      rgba[c] = channel[c][lane];
      if (a->mode == TETRA_EXTREMES) {
        rgba[c] = largest[lane] > -LARGEST_FLOAT ? t->view->scene.colors[4 * entry[lane] + c] : 0.0f;
      }
    }
    for (int c = 0; TETRA_LIT && a->mode == TETRA_EXTREMES && c < 3; ++c) { /* of dependent components */
      rgba[c] = channel[c][lane] * rgba[3];
    }
    if (a->mode == TETRA_HITS) {
      rgba[3] = rgba[3] > 0.0f ? largest[lane] : 0.0f;
    }
    if (a->mode == TETRA_EXTREMES && a->kept > 0.0f) {
      const int found = largest[lane] > -LARGEST_FLOAT;
      rgba[0] = found ? a->sign * largest[lane] : 0.0f;
      rgba[3] = found ? 1.0f : 0.0f;
      if (TETRA_LIT && found) { /* the colour of dependent components, as ray_modes.h stores it */
        rgba[1] = channel[0][lane];
        rgba[2] = channel[1][lane];
        rgba[3] = 1.0f + channel[2][lane];
      }
    }
    int taken = segments[lane];
    if (a->mode == TETRA_QUANTITIES) {
      taken = (int)rgba[2];
      rgba[2] = rgba[1];
      rgba[1] = rgba[0];
      rgba[0] = taken > 0 ? largest[lane] : 0.0f;
      rgba[3] = taken > 0 ? 1.0f : 0.0f;
    }
    store_ray(t, pixel[lane], rgba, depth[lane], taken);
    t->found.segments += (uint)segments[lane];
  }
}

/* Stores the layers of lanes that show something there, and makes the lanes gather anew. */
OUTLINE void lanes_store_layer(stratus_tetra_walk* t, stratus_tetra_lanes* k, vmask mask)
{
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  const vmask shown = mask & v_lt(k->light.transparency, v_set(1.0f));
  if (m_any(shown)) {
    float channel[4][STRATUS_WIDTH];
    int pixel[STRATUS_WIDTH], layer[STRATUS_WIDTH];
    v_store(channel[0], k->light.red);
    v_store(channel[1], k->light.green);
    v_store(channel[2], k->light.blue);
    v_store(channel[3], v_set(1.0f) - k->light.transparency);
    vi_store(pixel, vi_select(shown, k->pixel, vi_set(-1)));
    vi_store(layer, k->layer);
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      if (pixel[lane] >= 0) {
        const size_t x = (size_t)(t->x0 + pixel[lane] % TETRA_TILE), y = (size_t)(t->y0 + pixel[lane] / TETRA_TILE);
        const size_t width = (size_t)a->picture.width, height = (size_t)a->picture.height;
        GLOBAL float* rgba = t->view->picture.rgba + 4 * (((size_t)layer[lane] * height + y) * width + x);
        for (int c = 0; c < 4; ++c) {
          rgba[c] = channel[c][lane];
        }
      }
    }
  }
  lanes_forget(a, &k->light, mask);
}

/* Shades a cell that was passed, as tetra_shade(), layer by layer. */
INLINE vmask lanes_shade_layers(stratus_tetra_walk* t, stratus_tetra_lanes* k, stratus_tetra_passage* passage)
{
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  const vmask seen = passage->seen;
  const stratus_tetra_place entered = k->ray.place;
  vmask done = tetra_shade(a, &t->view->scene, &k->ray, &k->light, passage, k->live);
  const stratus_tetra_place left = k->ray.place;
  vmask over = k->live & v_le(k->ray.end, passage->to) & v_lt(k->ray.end, k->seen[1]);
  while (m_any(over)) {
    lanes_store_layer(t, k, over);
    k->layer = vi_select(over, k->layer + vi_set(1), k->layer);
    lanes_cut_to_layer(a, k, over);
    passage->seen = seen & over;
    k->ray.place = entered;
    done = m_andnot(done, over) | (over & tetra_shade(a, &t->view->scene, &k->ray, &k->light, passage, over));
    over = over & v_le(k->ray.end, passage->to) & v_lt(k->ray.end, k->seen[1]);
  }
  k->ray.place = left;
  return done;
}

/* Lanes whose way has ended start their ray at its next entry if it can still see that; else they store the pixel and take another. */
INLINE void lanes_go_on(stratus_tetra_walk* t, stratus_tetra_lanes* k)
{
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  vint entry[2];
  const vint none = vi_set(0);
  const vmask stuck = k->done & (vi_lt(k->ray.cell, vi_set(-1)) | (vi_ge(k->ray.cell, none) & vi_ge(k->steps, vi_set(a->steps_most))));
  t->found.stuck += (uint)m_count(stuck);
  k->segments = vi_select(k->done, k->segments + k->steps, k->segments);
  vmask again = m_andnot(k->done & vi_lt(k->entry, k->beyond), v_lt(k->light.transparency, v_set(a->termination)));
  if (m_any(again)) {
    gather_pair(t->view->entries, k->entry + k->entry, again, entry);
    again = again & v_lt(v_from_bits(entry[0]), a->layers ? k->seen[1] : k->ray.end);
  }
  if (a->regions) {
    again = again | lanes_next_piece(t, k, m_andnot(k->done & vi_ge(k->pixel, none), again));
  }
  const vmask ended = m_andnot(k->done, again);
  vmask taken = m_none();
  if (m_any(ended)) {
    int pixel[STRATUS_WIDTH];
    if (a->layers) {
      lanes_store_layer(t, k, ended & vi_ge(k->pixel, none));
    } else {
      lanes_store(t, k, ended);
    }
    vi_store(pixel, vi_select(ended, none, vi_set(-1)));
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      pixel[lane] = pixel[lane] < 0 || t->next >= t->count ? -1 : (int)t->pixels[t->next++];
    }
    const vint next = vi_load(pixel);
    taken = vi_ge(next, none);
    if (m_any(taken)) {
      lanes_take(t, k, taken, next);
    }
  }
  const vmask entering = again | taken;
  k->live = k->live | entering;
  k->done = m_none();
  if (m_any(entering)) {
    lanes_enter(t, k, entering);
  }
}

/* Makes lanes that have no ray. */
INLINE void lanes_clear(stratus_tetra_lanes* k)
{
  const vfloat zero = v_set(0.0f);
  const vint none = vi_set(0), outside = vi_set(-1);
  stratus_tetra_ray* r = &k->ray;
  r->us = r->uw = r->vs = r->vw = r->begin = r->end = r->length = r->offset = r->at = r->value = r->slice[0] = r->slice[1] = zero;
  for (int i = 0; i < 3; ++i) {
    r->x[i] = r->y[i] = r->z[i] = r->s[i] = r->edge[i] = zero;
    r->name[i] = none;
  }
  r->fourth = r->place.entry = r->place.sum[0] = r->place.sum[1] = r->place.sum[2] = r->place.sum[3] = none;
  r->cell = k->pixel = outside;
  k->light.red = k->light.green = k->light.blue = k->light.transparency = k->light.depth = k->light.most = zero;
  k->first = k->seen[0] = k->seen[1] = zero;
  k->entry = k->beyond = k->steps = k->segments = k->piece = k->layer = none;
  k->live = k->done = m_none();
}

INLINE void lanes_begin(stratus_tetra_walk* t, stratus_tetra_lanes* k)
{
  lanes_clear(k);
  k->done = vi_ge(k->entry, k->entry);
  lanes_go_on(t, k);
}

INLINE int lanes_ready(const stratus_tetra_lanes* k) { return m_any(k->done) && (m_count(k->done) >= TETRA_REFILL || !m_any(k->live)); }

/* Ends ways that have passed as many cells as there are: no way can. Returns the number of steps after which another may have. */
INLINE int lanes_give_up(stratus_tetra_lanes* k, int most)
{
  int steps[STRATUS_WIDTH], least = most;
  const vmask lost = k->live & vi_ge(k->steps, vi_set(most));
  k->done = k->done | lost;
  k->live = m_andnot(k->live, lost);
  vi_store(steps, vi_select(k->live, k->steps, vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    least = most - steps[lane] < least ? most - steps[lane] : least;
  }
  return least;
}

/* Marches all rays of `t`. */
INLINE void march_lanes(stratus_tetra_walk* t)
{
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  const stratus_tetra_scene* scene = &t->view->scene;
  stratus_tetra_lanes k[PACKETS_TOGETHER];
  int check = a->steps_most, any = 0;
  for (int i = 0; i < PACKETS_TOGETHER; ++i) {
    lanes_begin(t, k + i);
    any |= m_any(k[i].live);
  }
  while (any) {
    int ready = 0;
    do {
      stratus_tetra_passage passage[PACKETS_TOGETHER];
      for (int i = 0; i < PACKETS_TOGETHER; ++i) {
        passage[i] = tetra_pass(a, scene, &k[i].ray, k[i].live);
      }
      for (int i = 0; i < PACKETS_TOGETHER; ++i) {
        const vmask done =
          a->layers ? lanes_shade_layers(t, k + i, passage + i) : tetra_shade(a, scene, &k[i].ray, &k[i].light, passage + i, k[i].live);
        k[i].steps = vi_select(k[i].live, k[i].steps + vi_set(1), k[i].steps);
        k[i].done = k[i].done | done;
        k[i].live = m_andnot(k[i].live, done);
      }
      if (--check <= 0) {
        check = a->steps_most;
        for (int i = 0; i < PACKETS_TOGETHER; ++i) {
          const int left = lanes_give_up(k + i, a->steps_most);
          check = left < check ? left : check;
        }
      }
      for (int i = 0; i < PACKETS_TOGETHER; ++i) {
        ready |= lanes_ready(k + i);
      }
    } while (!ready);
    any = 0;
    for (int i = 0; i < PACKETS_TOGETHER; ++i) {
      if (lanes_ready(k + i)) {
        lanes_go_on(t, k + i);
      }
      any |= m_any(k[i].live) || m_any(k[i].done);
    }
  }
}

/* Draws the tile's pixels from..beyond-1. */
INLINE stratus_tetra_found draw_tile(
  const stratus_tetra_view* view, CONSTANT stratus_tetra_arguments* arguments, int tile, int from, int beyond)
{
  const float nothing[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
  stratus_tetra_walk t;
  t.view = view;
  t.arguments = arguments;
  t.tile = tile;
  t.x0 = tile % arguments->columns * TETRA_TILE;
  t.y0 = tile / arguments->columns * TETRA_TILE;
  t.next = t.count = 0;
  t.found.entries = t.found.segments = t.found.stuck = 0;
  for (int pixel = from; pixel < beyond; ++pixel) {
    const int place = TETRA_PIXELS * tile + pixel;
    if (t.x0 + pixel % TETRA_TILE >= arguments->picture.width || t.y0 + pixel / TETRA_TILE >= arguments->picture.height) {
      continue;
    }
    if (view->first[place] < view->first[place + 1]) {
      t.pixels[t.count++] = (ushort)pixel;
    } else if (!arguments->layers) {
      store_ray(&t, pixel, nothing, LARGEST_FLOAT, 0);
    }
  }
  t.found.rays = (uint)t.count;
  if (t.count > 0) {
    march_lanes(&t);
  }
  return t.found;
}

#endif
