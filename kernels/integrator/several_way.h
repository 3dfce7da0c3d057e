/* SPDX-License-Identifier: BSD-3-Clause
 * The colour and optical depth of one of several volumes on a sample's path. */
#ifndef STRATUS_SEVERAL_WAY_H
#define STRATUS_SEVERAL_WAY_H

#include "several_state.h"
#if SEVERAL_LIT_MESHES
#include "several_mesh_light.h"
#endif

/* Cuts off what lies beyond the table, where the volume is transparent. */
INLINE void several_cut(CONSTANT stratus_table_arguments* t, vmask mask, several_way* way)
{
  const vfloat scale = v_set(t->scale), offset = v_set(t->offset), length = way->hi - way->lo;
  const vfloat from = v_clamp(v_fma(way->front, scale, offset), -1e30f, 1e30f),
               to = v_clamp(v_fma(way->front + way->rise, scale, offset), -1e30f, 1e30f);
  const vmask cut = mask & (v_lt(v_min(from, to), v_set(0.0f)) | v_lt(v_set(t->last + 1.0f), v_max(from, to)));
  if (m_any(cut)) {
    vfloat before, part;
    part_within(t, from, to, &before, &part);
    way->front = v_select(cut, v_fma(way->rise, before, way->front), way->front);
    way->rise = v_select(cut, way->rise * part, way->rise);
    way->lo = v_select(cut, v_fma(length, before, way->lo), way->lo);
    way->hi = v_select(cut, v_fma(length, part, way->lo), way->hi);
  }
}

/* End the path before an entry of opacity 1. Returns the lanes whose path has no other entries before it. */
INLINE vmask several_stop(
  CONSTANT stratus_table_arguments* t, GLOBAL const int* sums, vmask mask, vint front, vint* entry, several_way* way)
{
  vint first;
  const vmask stops = opaque_on_the_way(t, sums + 4 * (t->entries + 1), front, *entry, mask & v_lt(way->lo, way->hi), &first);
  if (!m_any(stops)) {
    return stops;
  }
  const vint one = vi_set(1), low = vi_min(*entry, front), beyond = vi_max(*entry, front) + one;
  const vmask rises = vi_ge(first, front), at_once = stops & vi_zero(first - front);
  const vfloat before =
    width_between(t, sums, vi_select(rises, front, first + one), vi_select(rises, first, front + one), m_andnot(stops, at_once));
  const vfloat part = before * v_reciprocal(v_max(width_between(t, sums, low, beyond, stops), v_set(1.0f)));
  vfloat sum[4];
  sums_between(sums, first, first + one, stops, sum);
  const vfloat per_tau = v_reciprocal(v_max(sum[3], v_set(1.0f)));
  for (int c = 0; c < 3; ++c) {
    way->wall[c] = sum[c] * per_tau;
  }
  way->stops = stops;
  way->hi = v_select(stops, v_fma(way->hi - way->lo, part, way->lo), way->hi);
  way->rise = v_select(stops, way->rise * part, way->rise);
  *entry = vi_select(stops, vi_select(rises, first - one, first + one), *entry);
  return at_once;
}

/* Compute how light and gradient opacity change the path, by the gradient in its middle. */
OUTLINE void several_light(const several_source* from, several_volume* v, vmask mask, several_way* way)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  const stratus_packet* k = &v->k;
#if SEVERAL_LIT_MESHES
  if (from->mesh) {
    several_mesh_light(from->mesh, &v->mesh, mask, way);
    return;
  }
#endif
  vfloat s = v_set(0.5f) * (way->lo + way->hi);
#if SEVERAL_CELLS
  if (from->cells) {
    s = v_select(way->stops, way->hi, s);
  }
#endif
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  vfloat g[3] = { v_set(0.0f), v_set(0.0f), v_set(0.0f) };
  if (light_reflects(&a->light) || a->media.factor_first[0] >= 0) {
    several_gradient_at(from, x, mask, g);
  }
  way->lighting.factor = v_set(1.0f);
  if (a->media.factor_first[0] >= 0) {
    way->lighting.factor = gradient_opacity(a, from->besides, vi_set(a->media.factor_first[0]), v_set(a->media.factor_scale[0]), g, mask);
    if (a->media.factor_reach > 0.0f) { /* samples are not pre-integrated, and the path's rate is known */
      way->lighting.factor = factor_of_way(way->lighting.factor, way->rate[3] * v_set(a->media.factor_reach / from->segment));
    }
  }
  for (int c = 0; c < 3; ++c) {
    way->lighting.diffuse[c] = v_set(1.0f);
    way->lighting.specular[c] = v_set(0.0f);
  }
  if (a->light.on) {
    light_at(&a->light, k->lights, 0, 0, x, k->d, g, way->lighting.diffuse, way->lighting.specular, 0);
  }
}

/* Apply light and gradient opacity to a path's colour and optical depth of one segment. */
INLINE void several_light_rate(const several_way* way, vmask mask, vfloat rate[4])
{
  light_layer(&way->lighting, rate);
  for (int c = 0; c < 4; ++c) {
    rate[c] = v_select(mask, rate[c] * way->lighting.factor, v_set(0.0f));
  }
}

/* A value, and its entry in the table. */
typedef struct several_end {
  vfloat value;
  vint entry;
} several_end;

/* Compute the colour and optical depth of one segment's length of a path between two values. across: the width of the entries that its
 * colour may pass through. */
INLINE vmask several_rate(const several_source* from, const several_way* way, const several_end* begin, const several_end* end, vmask mask,
  vfloat rate[4], vfloat* across)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  GLOBAL const int* sums = (GLOBAL const int*)from->table;
  const vint low = vi_min(begin->entry, end->entry), beyond = vi_max(begin->entry, end->entry) + vi_set(1);
  sums_between(sums, low, beyond, mask, rate);
  mask = mask & v_lt(v_set(0.0f), rate[3]);
  vfloat width = v_max(width_between(&a->table, sums, low, beyond, mask), v_set(1.0f));
  *across = width;
#if SEVERAL_CELLS
  if (from->cells && RAY_RARE(RAY_JUMPS, a->table.jumps)) { /* whole entries at the ends count too much of one side */
    const vmask parts = m_andnot(mask, way->stops);
    table_end first, last;
    vfloat sum[4];
    table_end_at(&a->table, sums, begin->value, begin->entry, parts, &first);
    table_end_at(&a->table, sums, end->value, end->entry, parts, &last);
    width = v_select(parts, sums_from_to(&a->table, &first, &last, sum), width);
    for (int c = 0; c < 4; ++c) {
      rate[c] = v_select(parts, sum[c], rate[c]);
    }
    *across = v_max(width, v_select(parts, first.width + last.width, width)); /* a colour may jump between neighbours */
    mask = mask & v_lt(v_set(0.0f), rate[3]);
  }
#endif
  const vfloat scale = v_select(mask, v_set(a->table.tau_scale) * v_reciprocal(width), v_set(0.0f));
  for (int c = 0; c < 4; ++c) {
    rate[c] = rate[c] * scale;
  }
  if (from->lit) {
    several_light_rate(way, mask, rate);
  }
  return mask;
}

#if SEVERAL_MEDIA
/* Make the coming path from several media, sampled in its middle. */
INLINE void several_shade_media(const several_source* from, several_volume* v, vmask mask)
{
  several_way* way = &v->ways[1 - v->now];
  stratus_packet k = v->k;
  stratus_sample sample;
  k.live = mask;
  sample.value = way->front;
  sample.lo = way->lo;
  sample.length = sample.weight = way->hi - way->lo;
  sample.values = from->values;
  sample.hidden = from->hidden;
  several_media_at(from, &k, &sample, way->rate);
  way->stops = m_none();
  way->entries = v_set(0.0f);
  v->comes = m_any(v_lt(v_set(0.0f), way->rate[3])) != 0;
}
#endif

/* Make the coming path from the value in its middle. */
INLINE void several_shade_middle(const several_source* from, several_volume* v, vmask mask)
{
  several_way* way = &v->ways[1 - v->now];
  gather_four((GLOBAL const float*)from->table, table_entry(&from->a->table, from->besides, way->front), mask, way->rate);
  const vmask shown = mask & v_lt(v_set(0.0f), way->rate[3]);
  way->stops = m_none();
  way->entries = v_set(0.0f);
  v->comes = m_any(shown) != 0;
  if (from->lit && v->comes) {
    several_light(from, v, shown, way);
    several_light_rate(way, shown, way->rate);
  }
}

/* Move the rays of the mask to the coming path. */
INLINE void several_take(several_volume* v, vmask mask)
{
  several_way* way = &v->ways[v->now];
  const several_way* next = &v->ways[1 - v->now];
  way->lo = v_select(mask, next->lo, way->lo);
  way->hi = v_select(mask, next->hi, way->hi);
  way->front = v_select(mask, next->front, way->front);
  way->rise = v_select(mask, next->rise, way->rise);
  way->entries = v_select(mask, next->entries, way->entries);
  for (int c = 0; c < 4; ++c) {
    way->rate[c] = v_select(mask, next->rate[c], way->rate[c]);
  }
  for (int c = 0; c < 3; ++c) {
    way->wall[c] = v_select(mask, next->wall[c], way->wall[c]);
  }
  way->stops = m_andnot(way->stops, mask) | (next->stops & mask);
}

/* Moves the light of the rays of the mask from the coming path to the present one. */
INLINE void several_take_light(several_volume* v, vmask mask)
{
  stratus_lit_sample* to = &v->ways[v->now].lighting;
  const stratus_lit_sample* from = &v->ways[1 - v->now].lighting;
  to->factor = v_select(mask, from->factor, to->factor);
  for (int c = 0; c < 3; ++c) {
    to->diffuse[c] = v_select(mask, from->diffuse[c], to->diffuse[c]);
    to->specular[c] = v_select(mask, from->specular[c], to->specular[c]);
  }
}

/* Make the coming path from the field's values at its ends, in the lanes of the mask. */
INLINE void several_shade(const several_source* from, several_volume* v, vmask mask)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  GLOBAL const int* sums = (GLOBAL const int*)from->table;
  several_way* way = &v->ways[1 - v->now];
  const vfloat zero = v_set(0.0f), length = way->hi - way->lo;
  const vfloat front_place = table_place(&a->table, way->front), place = table_place(&a->table, way->front + way->rise);
  mask =
    mask & v_lt(v_min(place, front_place), v_set(a->table.shown_beyond)) & v_le(v_set(a->table.shown_first), v_max(place, front_place));
  v->comes = 0;
  way->stops = m_none();
  way->rate[0] = way->rate[1] = way->rate[2] = way->rate[3] = zero;
  if (!m_any(mask)) {
    return;
  }
  const vint front = entry_in_cell(&a->table, sums, v_to_int(front_place), way->front, mask);
  vint entry = entry_in_cell(&a->table, sums, v_to_int(place), way->front + way->rise, mask);
  vmask shown = mask;
  if (a->table.cut) {
    several_cut(&a->table, mask, way);
  }
  if (a->table.has_opaque) {
    shown = m_andnot(shown, several_stop(&a->table, sums, mask, front, &entry, way));
  }
  if (from->lit) {
    const vint low = vi_min(front, entry), beyond = vi_max(front, entry) + vi_set(1);
    const vmask lit = way->stops | (shown & v_lt(zero, tau_between(sums, low, beyond, shown)));
    if (!m_any(lit)) {
      return;
    }
    several_light(from, v, lit, way);
  }
  const several_end begin = { way->front, front }, end = { way->front + way->rise, entry };
  vfloat across;
  shown = several_rate(from, way, &begin, &end, shown, way->rate, &across);
  way->entries = across * v_reciprocal(v_max(length, v_set(1e-3f)));
  v->comes = m_any(shown | way->stops) != 0;
}

#endif
