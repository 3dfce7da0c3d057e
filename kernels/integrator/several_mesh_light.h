/* SPDX-License-Identifier: BSD-3-Clause
 * Light, gradient opacity and several components of a mesh among several volumes. The part of a cell that a ray sees is cut into pieces as
 * kernels/tetrahedra/tetra_light.h and tetra_components.h cut it. Each is a stretch of its own, lit at the middle of its optical depth. */
#ifndef STRATUS_SEVERAL_MESH_LIGHT_H
#define STRATUS_SEVERAL_MESH_LIGHT_H

#include "several_state.h"

/* Replaces a stretch in the lanes of the mask. */
INLINE void several_stretch_select(vmask mask, const stratus_tetra_stretch* from, stratus_tetra_stretch* s)
{
  s->tau_scale = from->tau_scale; /* the same for all */
  s->factor_scale = from->factor_scale;
  s->lights = from->lights;
  s->us = from->us; /* of the ray */
  s->uw = from->uw;
  s->vs = from->vs;
  s->vw = from->vw;
  s->begin = v_select(mask, from->begin, s->begin);
  s->rise = v_select(mask, from->rise, s->rise);
  for (int axis = 0; axis < 3; ++axis) {
    s->gradient[axis] = v_select(mask, from->gradient[axis], s->gradient[axis]);
    s->turn[axis] = v_select(mask, from->turn[axis], s->turn[axis]);
  }
}

/* The part of a cell that rays see: from begin to end in z, from lo to hi in segments; of one component, the values at both. */
typedef struct several_cell_part {
  vfloat begin, end, lo, hi, front, back;
} several_cell_part;

/* Sets up several components on a part of a cell. Returns the rays on which they show; *pieces: into how many pieces it is cut. */
INLINE vmask several_mesh_mix(const several_mesh* m, several_mesh_rays* rays, const stratus_tetra_passage* passage,
  const several_cell_part* part, vmask mask, vfloat* pieces)
{
  const stratus_tetra_ray* r = &rays->lanes.ray;
  const stratus_tetra_scene* scene = &m->view.scene;
  stratus_tetra_values values;
  stratus_tetra_stretch stretches[TETRA_COMPONENTS];
  tetra_values_of(m->a, scene, r, passage, part->begin, part->end, mask, &values);
  tetra_component_stretches(m->a, scene, r, passage, part->begin, part->end, mask, stretches);
  const stratus_tetra_mixture mixture = { &values, stretches, scene->media, scene->factors, (part->end - part->begin) * r->length };
  mask = tetra_media_pieces(m->a, &mixture, mask, pieces);
  for (int c = 0; c < m->a->media.components; ++c) {
    rays->values.from[c] = v_select(mask, values.from[c], rays->values.from[c]);
    rays->values.to[c] = v_select(mask, values.to[c], rays->values.to[c]);
    if (component_has_gradient(m->a, c)) {
      several_stretch_select(mask, &stretches[c], &rays->stretches[c]);
    }
  }
  return mask;
}

/* Cuts a part of a cell into pieces. Returns the rays on which it may show. */
INLINE vmask several_mesh_cut(
  const several_mesh* m, several_mesh_rays* rays, const stratus_tetra_passage* passage, const several_cell_part* part, vmask mask)
{
  const stratus_tetra_scene* scene = &m->view.scene;
  vfloat pieces;
  if (!m_any(mask)) {
    return mask;
  }
  rays->length = v_select(mask, (part->end - part->begin) * rays->lanes.ray.length, rays->length);
  if (m->a->media.components) {
    mask = several_mesh_mix(m, rays, passage, part, mask, &pieces);
  } else {
    const stratus_tetra_stretch stretch = tetra_stretch(m->a, scene, 0, &rays->lanes.ray, passage, part->begin, part->end, mask);
    const stratus_tetra_place from = tetra_place(m->a, scene->sums, part->front, mask),
                              to = tetra_place(m->a, scene->sums, part->back, mask);
    pieces = tetra_stretch_pieces(m->a, scene->sums, scene->factors, &stretch, mask, &from, &to);
    several_stretch_select(mask, &stretch, &rays->stretches[0]);
  }
  rays->lo = v_select(mask, part->lo, rays->lo);
  rays->hi = v_select(mask, part->hi, rays->hi);
  rays->front = v_select(mask, part->front, rays->front);
  rays->back = v_select(mask, part->back, rays->back);
  rays->piece = v_select(mask, v_set(0.0f), rays->piece);
  rays->pieces = v_select(mask, pieces, rays->pieces);
  return mask;
}

/* Sets the colour and the optical depth of the piece `way`, from `begins` to `ends` of its cell, that several components have in it. */
INLINE void several_mesh_rate(
  const several_mesh* m, const several_mesh_rays* rays, vfloat begins, vfloat ends, vmask mask, several_way* way)
{
  const stratus_tetra_mixture mixture = { &rays->values, rays->stretches, m->view.scene.media, m->view.scene.factors, rays->length };
  vfloat glow[3], depth, from[TETRA_COMPONENTS], to[TETRA_COMPONENTS], own[TETRA_COMPONENTS];
  for (int c = 0; c < TETRA_COMPONENTS; ++c) {
    const vfloat rise = rays->values.to[c] - rays->values.from[c];
    from[c] = v_fma(rise, begins, rays->values.from[c]);
    to[c] = v_fma(rise, ends, rays->values.from[c]);
  }
  mix_components(m->a, &mixture, from, to, begins, ends - begins, mask, glow, &depth, own);
  const vfloat per_length = v_reciprocal(v_max(way->hi - way->lo, v_set(1e-6f)));
  for (int c = 0; c < 3; ++c) {
    way->rate[c] = v_select(mask, glow[c] * per_length, way->rate[c]);
  }
  way->rate[3] = v_select(mask, depth * per_length, way->rate[3]);
  way->front = way->rise = v_set(0.0f);
}

/* Set `way` to the next piece of the rays of the mask. */
INLINE void several_mesh_piece(const several_mesh* m, several_mesh_rays* rays, vmask mask, several_way* way)
{
  if (!m_any(mask)) {
    return;
  }
  const vfloat share = v_reciprocal(v_max(rays->pieces, v_set(1.0f))), after = rays->piece + v_set(1.0f);
  const vmask more = mask & v_lt(after, rays->pieces);
  const vfloat begins = rays->piece * share, ends = v_select(more, after * share, v_set(1.0f));
  const vfloat length = rays->hi - rays->lo, rise = rays->back - rays->front, front = v_fma(begins, rise, rays->front);
  way->lo = v_select(mask, v_fma(begins, length, rays->lo), way->lo);
  way->hi = v_select(mask, v_select(more, v_fma(ends, length, rays->lo), rays->hi), way->hi);
  rays->ends = v_select(mask, way->hi, rays->ends);
  way->front = v_select(mask, front, way->front);
  way->rise = v_select(mask, v_select(more, v_fma(ends, rise, rays->front), rays->back) - front, way->rise);
  rays->piece = v_select(mask, after, rays->piece);
  if (m->a->media.components) {
    several_mesh_rate(m, rays, begins, ends, mask, way);
  }
}

/* Turns the walls of the mask that gradient opacity over a length has thinned to matter behind them, up to the end of the piece `way`.
 * at: the walls' places on the rays' parts of their cells. */
OUTLINE void several_mesh_thin_walls(const several_mesh* m, several_mesh_rays* rays, vfloat at, vmask mask, several_way* way)
{
  CONSTANT stratus_tetra_arguments* a = m->a;
  const vfloat per_segment = v_reciprocal(v_max(rays->hi - rays->lo, v_set(1e-6f)));
  stratus_tetra_lit lit;
  tetra_light_at(a, m->view.scene.factors, 0, &rays->stretches[0], at, v_set(TETRA_WALL_WAY), mask, &lit);
  mask = mask & v_lt(lit.factor, v_set(TETRA_WALL));
  way->stops = m_andnot(way->stops, mask);
  rays->wall_lo = v_select(mask, way->hi, rays->wall_lo);
  rays->wall_hi = v_select(mask, rays->ends, rays->wall_hi);
  rays->wall_rate[3] = v_select(mask, tetra_wall_depth(a, &lit, rays->length * per_segment), rays->wall_rate[3]);
  for (int c = 0; c < 3; ++c) {
    const vfloat color = v_fma(way->wall[c], lit.diffuse[c], lit.specular[c]);
    rays->wall_rate[c] = v_select(mask, color * rays->wall_rate[3], rays->wall_rate[c]);
  }
}

/* Sets `way` to the rest of a piece behind a thinned wall. Returns the rays of the mask that have one. */
INLINE vmask several_mesh_wall(several_mesh_rays* rays, vmask mask, several_way* way)
{
  mask = mask & v_lt(rays->wall_lo, rays->wall_hi);
  way->lo = v_select(mask, rays->wall_lo, way->lo);
  way->hi = v_select(mask, rays->wall_hi, way->hi);
  rays->wall_lo = v_select(mask, rays->wall_hi, rays->wall_lo);
  return mask;
}

/* Lights the piece `way`: where it ends in a wall there. A wall is none where the gradient opacity is 0. */
INLINE void several_mesh_light(const several_mesh* m, several_mesh_rays* rays, vmask mask, several_way* way)
{
  CONSTANT stratus_tetra_arguments* a = m->a;
  const stratus_tetra_scene* scene = &m->view.scene;
  const vfloat per_length = v_reciprocal(v_max(rays->hi - rays->lo, v_set(1e-6f)));
  const vfloat begin = v_clamp((way->lo - rays->lo) * per_length, 0.0f, 1.0f), end = v_clamp((way->hi - rays->lo) * per_length, 0.0f, 1.0f);
  const stratus_tetra_place from = tetra_place(a, scene->sums, way->front, mask),
                            to = tetra_place(a, scene->sums, way->front + way->rise, mask);
  const vfloat tau = v_from_int(to.sum[3] - from.sum[3]);
  const vfloat middle = tetra_middle_of(scene->sums, (int)a->table.last + 1, from.entry, to.entry, tau, mask);
  vfloat over = v_set(0.0f);
  stratus_tetra_lit lit;
  if (a->thins && a->factor_way > 0.0f) {
    const vmask stops = mask & way->stops;
    if (m_any(stops)) {
      several_mesh_thin_walls(m, rays, end, stops, way);
    }
    over = v_select(way->stops, v_set(TETRA_WALL_WAY), tetra_way(a, scene->sums, &rays->stretches[0], from.entry, to.entry, tau, mask));
  }
  tetra_light_at(a, scene->factors, 0, &rays->stretches[0], v_select(way->stops, end, v_fma(middle, end - begin, begin)), over, mask, &lit);
  way->lighting.factor = lit.factor;
  way->stops = way->stops & v_lt(v_set(0.0f), lit.factor);
  for (int c = 0; c < 3; ++c) {
    way->lighting.diffuse[c] = lit.diffuse[c];
    way->lighting.specular[c] = lit.specular[c];
  }
}

/* Makes the rays ready, which have no piece. */
INLINE void several_mesh_light_load(several_volume* v)
{
  const vfloat zero = v_set(0.0f);
  several_mesh_rays* rays = &v->mesh;
  rays->lo = rays->hi = rays->front = rays->back = rays->length = rays->piece = rays->pieces = rays->ends = zero;
  rays->wall_lo = rays->wall_hi = rays->wall_rate[0] = rays->wall_rate[1] = rays->wall_rate[2] = rays->wall_rate[3] = zero;
  for (int c = 0; c < TETRA_COMPONENTS; ++c) {
    stratus_tetra_stretch* s = &rays->stretches[c];
    s->us = s->uw = s->vs = s->vw = s->begin = s->rise = s->length = s->tau_scale = s->factor_scale = zero;
    s->lights = 0;
    s->gradient[0] = s->gradient[1] = s->gradient[2] = s->turn[0] = s->turn[1] = s->turn[2] = zero;
    rays->values.from[c] = rays->values.to[c] = zero;
  }
  for (int n = 0; n < 2; ++n) {
    v->ways[n].lighting.factor = zero;
    for (int c = 0; c < 3; ++c) {
      v->ways[n].lighting.diffuse[c] = v->ways[n].lighting.specular[c] = zero;
    }
  }
}

#endif
