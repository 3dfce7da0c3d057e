/* SPDX-License-Identifier: BSD-3-Clause
 * A mesh of tetrahedra among several volumes: its rays march from cell to cell, and hand out one stretch after the other on which the field
 * is linear and shows anything. Host only. */
#ifndef STRATUS_SEVERAL_MESH_H
#define STRATUS_SEVERAL_MESH_H

#include "several_way.h"

/* The number of segments from the eye to z = 0 of the mesh's rays (base) and for each unit of z (scale), and by how much a ray's lattice
 * lies farther. */
INLINE void several_mesh_places(const several_mesh* m, int x, int y, double* base, double* scale, float* shift)
{
  const double u = (2.0 * x + 1.0) / m->width - 1.0, v = (2.0 * y + 1.0) / m->height - 1.0;
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = m->forward[axis] + (m->parallel ? 0.0 : u * m->right[axis] + v * m->up[axis]);
    square += along * along;
  }
  const double segments = sqrt(square) * m->per_step;
  *shift = m->jitter ? ray_jitter(x, y, m->seed) : 0.0f;
  *base = segments * (m->middle - (m->lean[0] * u + m->lean[1] * v)) + (double)*shift;
  *scale = segments * m->per_z;
}

/* The lanes that are at an entry into the mesh before the end of their visible part; z: the entry's place. */
INLINE vmask several_mesh_entry(const several_volume* v, vmask mask, vfloat* z)
{
  const stratus_tetra_lanes* lanes = &v->mesh.lanes;
  vint entry[2];
  mask = mask & vi_lt(lanes->entry, lanes->beyond);
  gather_pair(v->mesh.walk.view->entries, lanes->entry + lanes->entry, mask, entry);
  *z = v_from_bits(entry[0]);
  return mask & v_lt(*z, lanes->ray.end);
}

/* Pass a cell on the rays of the mask. Returns the rays that see a part of it on which the table shows anything, and sets `next` to it. */
INLINE vmask several_mesh_cell(const several_source* from, several_volume* v, vmask mask, several_way* next)
{
  const several_mesh* m = from->mesh;
  CONSTANT stratus_table_arguments* t = &from->a->table;
  stratus_tetra_lanes* lanes = &v->mesh.lanes;
  stratus_tetra_ray* r = &lanes->ray;
  const vint fourth = r->fourth;
  const vfloat at = r->at, value = r->value;
  const stratus_tetra_passage passage = tetra_pass(m->a, &m->view.scene, r, mask);
  r->fourth = vi_select(mask, r->fourth, fourth); /* the other rays wait in the midst of their ways */
  r->at = v_select(mask, r->at, at);
  r->value = v_select(mask, r->value, value);
  lanes->steps = vi_select(mask, lanes->steps + vi_set(1), lanes->steps);
  v->k.samples -= mask_int(mask);
  const vmask ended =
    vi_lt(r->cell, vi_set(0)) | v_le(r->end, passage.to) | vi_ge(lanes->steps, vi_set(m->a->steps_most)) | m_andnot(mask, passage.seen);
  lanes->live = m_andnot(lanes->live, mask & ended);
  const vfloat begin = v_max(passage.from, r->begin), end = v_min(passage.to, r->end);
  const vmask seen = mask & passage.seen & v_lt(begin, end), cut = seen & (v_lt(passage.from, begin) | v_lt(end, passage.to));
  vfloat first = passage.first, last = passage.last;
  if (m_any(cut)) {
    const vfloat slope = (last - first) * v_reciprocal(v_max(passage.to - passage.from, v_set(1e-30f))), start = first;
    first = v_select(cut, v_fma(slope, begin - passage.from, start), first);
    last = v_select(cut, v_fma(slope, end - passage.from, start), last);
  }
  /* where cells overlap, one counts behind the other */
  vfloat lo = v_fma(begin, v->mesh.scale, v->mesh.base), hi = v_fma(end, v->mesh.scale, v->mesh.base);
  const vfloat behind = v_max(v->mesh.reached - lo, v_set(0.0f)), place = table_place(t, first), last_place = table_place(t, last);
  lo = lo + behind;
  hi = hi + behind;
  const vmask shown =
    seen & v_lt(lo, hi) & v_lt(v_min(place, last_place), v_set(t->shown_beyond)) & v_le(v_set(t->shown_first), v_max(place, last_place));
  v->mesh.reached = v_select(shown, hi, v->mesh.reached);
  next->lo = v_select(shown, lo, next->lo);
  next->hi = v_select(shown, hi, next->hi);
  next->front = v_select(shown, first, next->front);
  next->rise = v_select(shown, last - first, next->rise);
  return shown;
}

/* Gives the rays of the mask their next stretch, or one beyond everything where none is left. */
INLINE void several_mesh_next(const several_source* from, several_volume* v, vmask mask)
{
  const vfloat zero = v_set(0.0f), beyond = v_set(SEVERAL_BEYOND);
  several_way* next = &v->ways[1 - v->now];
  vmask left = mask, found = m_none();
  next->lo = next->hi = beyond;
  next->front = next->rise = next->entries = next->wall[0] = next->wall[1] = next->wall[2] = zero;
  while (m_any(left)) {
    const vmask outside = m_andnot(left, v->mesh.lanes.live);
    if (m_any(outside)) {
      vfloat z;
      const vmask again = several_mesh_entry(v, outside, &z);
      if (m_any(again)) {
        lanes_enter(&v->mesh.walk, &v->mesh.lanes, again);
        v->mesh.lanes.live = v->mesh.lanes.live | again;
      }
      left = m_andnot(left, m_andnot(outside, again));
      if (!m_any(left)) {
        break;
      }
    }
    const vmask shown = several_mesh_cell(from, v, left, next);
    found = found | shown;
    left = m_andnot(left, shown);
  }
  several_shade(from, v, found);
  v->comes = -1; /* nothing is due of a mesh */
  several_take(v, mask);
}

/* Makes the rays of the packet at pixel (x, y) ready, at their first stretch. whole: the segment before the one in which each enters. */
INLINE void several_mesh_load(const several_source* from, several_volume* v, int x, int y, several_number_t whole[STRATUS_WIDTH])
{
  const several_mesh* m = from->mesh;
  stratus_tetra_walk* walk = &v->mesh.walk;
  stratus_tetra_lanes* lanes = &v->mesh.lanes;
  const vint px = (vi_lanes() & vi_set(PACKET_X - 1)) + vi_set(x), py = (vi_lanes() >> vi_set(PACKET_X_LOG2)) + vi_set(y);
  const vmask inside = vi_lt(px, vi_set(m->width)) & vi_lt(py, vi_set(m->height));
  walk->view = &m->view;
  walk->arguments = m->a;
  walk->x0 = x / TETRA_TILE * TETRA_TILE;
  walk->y0 = y / TETRA_TILE * TETRA_TILE;
  walk->tile = y / TETRA_TILE * m->a->columns + x / TETRA_TILE;
  walk->next = walk->count = 0;
  walk->found = (stratus_tetra_found){ 0, 0, 0, 0 };
  lanes_begin(walk, lanes);
  lanes_take(walk, lanes, inside, ((py - vi_set(walk->y0)) << vi_set(TETRA_TILE_LOG2)) + (px - vi_set(walk->x0)));
  lanes->live = lanes->done = m_none();
  vfloat z;
  vmask meets = several_mesh_entry(v, inside, &z);
  z = v_max(z, lanes->ray.begin);
  meets = meets & v_lt(z, lanes->ray.end);
  float enters[STRATUS_WIDTH], base[STRATUS_WIDTH], scale[STRATUS_WIDTH], first[STRATUS_WIDTH];
  int met[STRATUS_WIDTH];
  v_store(enters, z);
  vi_store(met, vi_select(meets, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    base[lane] = scale[lane] = first[lane] = 0.0f;
    whole[lane] = 0;
    if (met[lane]) {
      double from_eye, per_z;
      float shift;
      several_mesh_places(m, x + (lane & (PACKET_X - 1)), y + (lane >> PACKET_X_LOG2), &from_eye, &per_z, &shift);
      const double number = floor(from_eye + per_z * (double)enters[lane]) - 1.0;
      whole[lane] = (several_number_t)fmax(fmin(number, (double)SEVERAL_FARTHEST), -(double)SEVERAL_FARTHEST);
      base[lane] = (float)(from_eye - number);
      scale[lane] = (float)per_z;
      first[lane] = (float)(number - (double)shift);
    }
  }
  packet_nothing(&v->k);
  v->k.first = v_load(first);
  v->k.i = v->k.last = vi_set(0);
  v->k.hits = meets;
  v->mesh.base = v_load(base);
  v->mesh.scale = v_load(scale);
  v->mesh.reached = v_set(-SEVERAL_BEYOND);
  v->ways[0].stops = m_none();
  several_mesh_next(from, v, meets);
  v->ways[0].lo = v_select(meets, v->ways[0].lo, v_set(SEVERAL_BEYOND));
  v->ways[0].hi = v_select(meets, v->ways[0].hi, v_set(SEVERAL_BEYOND));
  v->k.live = meets & v_lt(v->ways[0].lo, v_set(SEVERAL_BEYOND));
  for (int c = 0; c < 4; ++c) {
    v->ways[0].rate[c] = v_select(v->k.live, v->ways[0].rate[c], v_set(0.0f));
  }
  v->shows = m_any(v->k.live) != 0;
}

#endif
