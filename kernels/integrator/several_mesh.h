/* SPDX-License-Identifier: BSD-3-Clause
 * A mesh of tetrahedra among several volumes: its rays march from cell to cell, and hand out one stretch after the other on which the field
 * is linear and shows anything. */
#ifndef STRATUS_SEVERAL_MESH_H
#define STRATUS_SEVERAL_MESH_H

#include "several_way.h"

/* Places of a packet's rays on the lattice. The segment before the one in which a ray enters is whole[0] + whole[1], exactly; from there on
 * z is at base + scale z segments. first: that segment, for depth. */
typedef struct several_mesh_start {
  float whole[2][STRATUS_WIDTH], base[STRATUS_WIDTH], scale[STRATUS_WIDTH], first[STRATUS_WIDTH];
} several_mesh_start;

/* Finds the places of REAL_WIDTH rays of the packet, from ray number `part` on. x, y: their pixels (whole numbers); w: their jitter;
 * enters: the z where they enter. */
INLINE void several_mesh_start_part(
  const several_source* from, const float* x, const float* y, const float* w, const float* enters, int part, several_mesh_start* start)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  CONSTANT stratus_several_places* places = from->mesh->places;
  const real half_one = r_number(0.5f), one = r_number(1.0f), two = r_number(2.0f), farthest = r_number(SEVERAL_FARTHEST);
  real origin[3], direction[3], per_k, unit;
  (void)ray_line(a, x + part, y + part, origin, direction, &per_k, &unit);
  const real u = r_sub(r_mul(r_mul(r_add(r_load(x + part), half_one), two), r_of(a->camera.pixel[0])), one);
  const real v = r_sub(r_mul(r_mul(r_add(r_load(y + part), half_one), two), r_of(a->camera.pixel[1])), one);
  const real lean = r_add(r_mul(r_of(places->lean[0]), u), r_mul(r_of(places->lean[1]), v)), shift = r_load(w + part);
  const real base = r_add(r_mul(per_k, r_sub(r_of(places->middle), lean)), shift), scale = r_mul(per_k, r_of(places->per_z));
  const real enter = r_sub(r_floor(r_add(base, r_mul(scale, r_load(enters + part)))), one);
  const real number = r_max(r_min(enter, farthest), r_neg(farthest));
  r_store(start->base + part, r_sub(base, number));
  r_store(start->scale + part, scale);
  r_store(start->first + part, r_sub(number, shift));
  r_store(start->whole[0] + part, number);
  r_store(start->whole[1] + part, r_sub(number, r_load(start->whole[0] + part)));
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
  vmask shown = seen & v_lt(lo, hi);
  if (!several_mesh_is_mixed(m)) {
    shown = shown & v_lt(v_min(place, last_place), v_set(t->shown_beyond)) & v_le(v_set(t->shown_first), v_max(place, last_place));
  }
#if SEVERAL_LIT_MESHES
  if (from->lit) {
    const several_cell_part part = { begin, end, lo, hi, first, last };
    shown = several_mesh_cut(m, &v->mesh, &passage, &part, shown);
    several_mesh_piece(m, &v->mesh, shown, next);
    v->mesh.reached = v_select(shown, hi, v->mesh.reached);
    return shown;
  }
#endif
  v->mesh.reached = v_select(shown, hi, v->mesh.reached);
  next->lo = v_select(shown, lo, next->lo);
  next->hi = v_select(shown, hi, next->hi);
  next->front = v_select(shown, first, next->front);
  next->rise = v_select(shown, last - first, next->rise);
  return shown;
}

/* Gives the rays of the mask their next stretch, or one beyond everything where none is left. */
OUTLINE void several_mesh_next(const several_source* from, several_volume* v, vmask mask)
{
  const vfloat zero = v_set(0.0f), beyond = v_set(SEVERAL_BEYOND);
  several_way* next = &v->ways[1 - v->now];
  vmask left = mask, found = m_none();
  next->lo = next->hi = beyond;
  next->front = next->rise = next->entries = next->wall[0] = next->wall[1] = next->wall[2] = zero;
  next->rate[0] = next->rate[1] = next->rate[2] = next->rate[3] = zero;
  next->stops = m_none();
#if SEVERAL_LIT_MESHES
  vmask walls = m_none();
  if (from->lit) {
    walls = several_mesh_wall(&v->mesh, left, next);
    left = m_andnot(left, walls);
    found = left & v_lt(v->mesh.piece, v->mesh.pieces);
    several_mesh_piece(from->mesh, &v->mesh, found, next);
    left = m_andnot(left, found);
  }
#endif
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
  if (!several_mesh_is_mixed(from->mesh)) {
    several_shade(from, v, found);
  }
#if SEVERAL_LIT_MESHES
  for (int c = 0; m_any(walls) && c < 4; ++c) {
    next->rate[c] = v_select(walls, v->mesh.wall_rate[c], next->rate[c]);
    next->entries = v_select(walls, zero, next->entries);
  }
#endif
  v->comes = -1; /* nothing is due of a mesh */
  several_take(v, mask);
#if SEVERAL_LIT_MESHES
  if (from->lit) {
    several_take_light(v, mask);
  }
#endif
}

/* Makes the rays of the packet at pixel (x, y) ready, at their first stretch. whole: the segment before the one in which each enters. */
INLINE void several_mesh_load(const several_source* from, several_volume* v, int x, int y, several_number_t whole[STRATUS_WIDTH])
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  const several_mesh* m = from->mesh;
  stratus_tetra_walk* walk = &v->mesh.walk;
  stratus_tetra_lanes* lanes = &v->mesh.lanes;
  const vint px = (vi_lanes() & vi_set(PACKET_X - 1)) + vi_set(x), py = (vi_lanes() >> vi_set(PACKET_X_LOG2)) + vi_set(y);
  const vmask inside = vi_lt(px, vi_set(a->picture.width)) & vi_lt(py, vi_set(a->picture.height));
  walk->view = &m->view;
  walk->arguments = m->a;
  walk->x0 = x / TETRA_TILE * TETRA_TILE;
  walk->y0 = y / TETRA_TILE * TETRA_TILE;
  walk->tile = y / TETRA_TILE * m->a->columns + x / TETRA_TILE;
  walk->next = walk->count = 0;
  walk->found = (stratus_tetra_found){ 0, 0, 0, 0 };
  lanes_clear(lanes);
  lanes_take(walk, lanes, inside, ((py - vi_set(walk->y0)) << vi_set(TETRA_TILE_LOG2)) + (px - vi_set(walk->x0)));
  if (from->piece) {
    lanes->piece = vi_set(from->piece);
    lanes_load(walk, lanes, inside);
  }
  vfloat z;
  vmask meets = several_mesh_entry(v, inside, &z);
  z = v_max(z, lanes->ray.begin);
  meets = meets & v_lt(z, lanes->ray.end);
  float fx[STRATUS_WIDTH], fy[STRATUS_WIDTH], fw[STRATUS_WIDTH], enters[STRATUS_WIDTH];
  int met[STRATUS_WIDTH];
  several_mesh_start start;
  v_store(fx, v_from_int(px));
  v_store(fy, v_from_int(py));
  v_store(enters, v_select(meets, z, v_set(0.0f)));
  vi_store(met, vi_select(meets, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    fw[lane] = a->lattice.jitter ? ray_jitter(x + (lane & (PACKET_X - 1)), y + (lane >> PACKET_X_LOG2), a->lattice.seed) : 0.0f;
  }
  for (int part = 0; part < STRATUS_WIDTH; part += REAL_WIDTH) {
    several_mesh_start_part(from, fx, fy, fw, enters, part, &start);
  }
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    whole[lane] = met[lane] ? (several_number_t)start.whole[0][lane] + (several_number_t)start.whole[1][lane] : 0;
  }
  packet_nothing(&v->k);
  v->k.first = v_load(start.first);
  v->k.i = v->k.last = vi_set(0);
  v->k.hits = meets;
  v->mesh.base = v_load(start.base);
  v->mesh.scale = v_load(start.scale);
  v->mesh.reached = v_set(-SEVERAL_BEYOND);
  v->ways[0].stops = m_none();
#if SEVERAL_LIT_MESHES
  several_mesh_light_load(v);
#endif
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
