/* SPDX-License-Identifier: BSD-3-Clause
 * Light, gradient opacity, several components and labels of a mesh among several volumes. The part of a cell that a ray sees is cut into
 * pieces as kernels/tetrahedra/tetra_light.h and tetra_components.h cut it. Each is a stretch of its own, lit at the middle of its optical
 * depth. */
#ifndef STRATUS_SEVERAL_MESH_LIGHT_H
#define STRATUS_SEVERAL_MESH_LIGHT_H

#include "several_state.h"

/* Replaces a stretch in the lanes of the mask. */
INLINE void several_stretch_select(vmask mask, const stratus_tetra_stretch* from, stratus_tetra_stretch* s)
{
  s->tau_scale = v_select(mask, from->tau_scale, s->tau_scale); /* of labels each has its own */
  s->factor_scale = v_select(mask, from->factor_scale, s->factor_scale);
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

/* The function of a label. */
typedef struct several_label {
  GLOBAL const int* sums;
  GLOBAL const float* factors;
  vfloat tau_scale, factor_scale;
  vmask rays; /* those that have it */
} several_label;

/* Finds one of the labels of the rays of the mask, and its rays. Labels take turns, as in tetra_shade_labels(). */
INLINE several_label several_label_next(const several_mesh* m, const several_mesh_rays* rays, vmask mask)
{
  int of[STRATUS_WIDTH], turn = -1;
  several_label label;
  vi_store(of, vi_select(mask, rays->label, vi_set(-1)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    turn = of[lane] > turn ? of[lane] : turn;
  }
  GLOBAL const int* record = m->view.scene.media + TETRA_LABEL * turn;
  label.rays = mask & vi_zero(rays->label - vi_set(turn));
  label.sums = m->view.scene.media + record[0];
  label.factors = m->view.scene.factors + (size_t)record[3] * ((size_t)m->a->factor_last + 2);
  label.tau_scale = v_from_bits(vi_set(record[1]));
  label.factor_scale = v_from_bits(vi_set(record[2]));
  return label;
}

/* Sets up the functions of labels on a part of cells. Returns the rays on which it may show; *pieces: into how many pieces it is cut. */
INLINE vmask several_mesh_label(const several_mesh* m, several_mesh_rays* rays, const stratus_tetra_passage* passage,
  const several_cell_part* part, vmask mask, vfloat* pieces)
{
  CONSTANT stratus_tetra_arguments* a = m->a;
  const stratus_tetra_scene* scene = &m->view.scene;
  const int lit = a->light.on | a->thins;
  vmask left = mask, shown = m_none();
  stratus_tetra_stretch stretch = rays->stretches[0];
  rays->label = vi_select(mask, v_to_int(gather_float(scene->components, passage->cell >> vi_set(3), mask)), rays->label);
  if (lit) {
    stretch = tetra_stretch(a, scene, 0, &rays->lanes.ray, passage, part->begin, part->end, mask);
  }
  stretch.length = v_select(mask, rays->length, stretch.length);
  *pieces = v_set(1.0f);
  while (m_any(left)) {
    const several_label label = several_label_next(m, rays, left);
    const stratus_tetra_place from = tetra_place(a, label.sums, part->front, label.rays),
                              to = tetra_place(a, label.sums, part->back, label.rays);
    stratus_tetra_stretch own = stretch;
    own.tau_scale = label.tau_scale;
    own.factor_scale = stretch.factor_scale * label.factor_scale;
    const vmask some = tetra_may_show(a, &from, &to, label.rays);
    shown = shown | some;
    *pieces = v_select(some, tetra_stretch_pieces(a, label.sums, label.factors, &own, some, &from, &to), *pieces);
    several_stretch_select(some, &own, &rays->stretches[0]);
    left = m_andnot(left, label.rays);
  }
  return shown;
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
  } else if (m->a->media.labels) {
    mask = several_mesh_label(m, rays, passage, part, mask, &pieces);
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

/* Turns the walls of the mask that gradient opacity over a length has thinned to matter behind them, up to the end of the piece `way`.
 * at: the walls' places on the rays' parts of their cells. */
OUTLINE void several_mesh_thin_walls(
  const several_mesh* m, several_mesh_rays* rays, GLOBAL const float* factors, vfloat at, vmask mask, several_way* way)
{
  CONSTANT stratus_tetra_arguments* a = m->a;
  const vfloat per_segment = v_reciprocal(v_max(rays->hi - rays->lo, v_set(1e-6f)));
  stratus_tetra_lit lit;
  tetra_light_at(a, factors, 0, &rays->stretches[0], at, v_set(TETRA_WALL_WAY), mask, &lit);
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

/* Keeps light in the lanes of the mask. */
INLINE void several_lighting_select(vmask mask, const stratus_tetra_lit* lit, stratus_lit_sample* lighting)
{
  lighting->factor = v_select(mask, lit->factor, lighting->factor);
  for (int c = 0; c < 3; ++c) {
    lighting->diffuse[c] = v_select(mask, lit->diffuse[c], lighting->diffuse[c]);
    lighting->specular[c] = v_select(mask, lit->specular[c], lighting->specular[c]);
  }
}

/* Gives the light of the piece `way`, between two places of a function: where it ends in a wall there. A wall is none where the gradient
 * opacity is 0. */
INLINE void several_mesh_light_between(const several_mesh* m, several_mesh_rays* rays, GLOBAL const int* sums, GLOBAL const float* factors,
  const stratus_tetra_place* from, const stratus_tetra_place* to, vmask mask, several_way* way, stratus_tetra_lit* lit)
{
  CONSTANT stratus_tetra_arguments* a = m->a;
  const vfloat per_length = v_reciprocal(v_max(rays->hi - rays->lo, v_set(1e-6f)));
  const vfloat begin = v_clamp((way->lo - rays->lo) * per_length, 0.0f, 1.0f), end = v_clamp((way->hi - rays->lo) * per_length, 0.0f, 1.0f);
  const vfloat tau = v_from_int(to->sum[3] - from->sum[3]);
  const vfloat middle = tetra_middle_of(sums, (int)a->table.last + 1, from->entry, to->entry, tau, mask);
  vfloat over = v_set(0.0f);
  if (a->thins && a->factor_way > 0.0f) {
    const vmask stops = mask & way->stops;
    if (m_any(stops)) {
      several_mesh_thin_walls(m, rays, factors, end, stops, way);
    }
    over = v_select(way->stops, v_set(TETRA_WALL_WAY), tetra_way(a, sums, &rays->stretches[0], from->entry, to->entry, tau, mask));
  }
  tetra_light_at(a, factors, 0, &rays->stretches[0], v_select(way->stops, end, v_fma(middle, end - begin, begin)), over, mask, lit);
  way->stops = m_andnot(way->stops, m_andnot(mask, v_lt(v_set(0.0f), lit->factor)));
}

/* Lights the piece `way` of one function. */
INLINE void several_mesh_light(const several_mesh* m, several_mesh_rays* rays, vmask mask, several_way* way)
{
  GLOBAL const int* sums = m->view.scene.sums;
  const stratus_tetra_place from = tetra_place(m->a, sums, way->front, mask), to = tetra_place(m->a, sums, way->front + way->rise, mask);
  stratus_tetra_lit lit;
  several_mesh_light_between(m, rays, sums, m->view.scene.factors, &from, &to, mask, way, &lit);
  several_lighting_select(mask, &lit, &way->lighting);
}

/* Sets the colour and the optical depth of the piece `way` by the functions of labels, as tetra_composite() has them. */
OUTLINE void several_mesh_label_rate(const several_mesh* m, several_mesh_rays* rays, vmask mask, several_way* way)
{
  CONSTANT stratus_tetra_arguments* a = m->a;
  const vfloat zero = v_set(0.0f), one = v_set(1.0f), per_segment = rays->length * v_reciprocal(v_max(rays->hi - rays->lo, v_set(1e-6f)));
  const int entries = (int)a->table.last + 1;
  vfloat rate[4] = { zero, zero, zero, zero };
  vmask left = mask;
  way->stops = m_andnot(way->stops, mask);
  while (m_any(left)) {
    const several_label label = several_label_next(m, rays, left);
    const vmask mine = label.rays;
    const stratus_tetra_place from = tetra_place(a, label.sums, way->front, mine),
                              to = tetra_place(a, label.sums, way->front + way->rise, mine);
    stratus_tetra_place end = to;
    vmask shows = mine;
    if (a->table.has_opaque) {
      vint entry = to.entry;
      vfloat part = one;
      vmask before;
      const vmask opaque = tetra_before_opaque(a, label.sums, mine & v_lt(way->lo, way->hi), &from, &to, &entry, &end, &part, &before);
      if (m_any(opaque)) {
        vint own[4];
        gather_four_ints(label.sums, entry + vi_set(entries), opaque, own);
        const vfloat per_tau = v_reciprocal(v_max(v_from_int(own[3]), one));
        for (int c = 0; c < 3; ++c) {
          way->wall[c] = v_select(opaque, v_from_int(own[c]) * per_tau, way->wall[c]);
        }
        shows = m_andnot(mine, opaque) | before;
        part = v_select(before, part, zero);
        way->hi = v_select(opaque, v_fma(way->hi - way->lo, part, way->lo), way->hi);
        way->stops = way->stops | opaque;
      }
    }
    vint span[4];
    const vmask level = tetra_span(a, label.sums, &from, &end, shows, span);
    const vfloat per_entry = v_min(per_segment * label.tau_scale, v_set(OPAQUE_WEIGHT)) *
      v_reciprocal(v_abs(v_from_int(vi_select(level, vi_set(1), end.entry - from.entry))));
    for (int c = 0; c < 4; ++c) {
      rate[c] = v_select(shows, v_abs(v_from_int(span[c])) * per_entry, rate[c]);
    }
    stratus_tetra_lit lit;
    several_mesh_light_between(m, rays, label.sums, label.factors, &from, &end, mine, way, &lit);
    several_lighting_select(mine, &lit, &way->lighting);
    left = m_andnot(left, mine);
  }
  light_layer(&way->lighting, rate);
  for (int c = 0; c < 4; ++c) {
    way->rate[c] = v_select(mask, rate[c] * way->lighting.factor, way->rate[c]);
  }
  way->front = v_select(mask, zero, way->front);
  way->rise = v_select(mask, zero, way->rise);
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
  } else if (m->a->media.labels) {
    several_mesh_label_rate(m, rays, mask, way);
  }
}

/* Makes the rays ready, which have no piece. */
INLINE void several_mesh_light_load(several_volume* v)
{
  const vfloat zero = v_set(0.0f);
  several_mesh_rays* rays = &v->mesh;
  rays->lo = rays->hi = rays->front = rays->back = rays->length = rays->piece = rays->pieces = rays->ends = zero;
  rays->label = vi_set(0);
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
