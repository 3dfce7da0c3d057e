/* SPDX-License-Identifier: BSD-3-Clause
 * The contribution of a volume among several at a sample that is more than one value's colour and opacity: of several components, in the
 * colours of labels, or by a function of two variables. Included once for each STRATUS_TYPE, after ray_cast.h with light and gradients. */

/* Gives the rate, colour times optical depth and optical depth over a segment's length, of samples on the live rays of k. */
OUTLINE void RAY_NAME(several_media)(CONSTANT stratus_ray_cast_arguments* a, int media, float segment, GLOBAL const void* table,
  const stratus_packet* k, const stratus_sample* sample, vfloat rate[4])
{
  GLOBAL const float* floats = (GLOBAL const float*)table;
  const vfloat zero = v_set(0.0f);
  vmask shows = m_none();
  rate[0] = rate[1] = rate[2] = rate[3] = zero;
  if (media == SEVERAL_COMPONENTS) {
    vfloat sum[5];
    shows = RAY_NAME(components_at)(a, table, k, sample, sum);
    for (int c = 0; c < 4; ++c) {
      rate[c] = sum[c] * v_set(segment);
    }
  } else if (media == SEVERAL_LABELS) {
    stratus_label_sample shown;
    shows = RAY_NAME(labels_at)(a, table, k, sample, &shown);
    if (m_any(shows)) {
      vfloat depth[4];
      gather_four(floats, shown.entry + shown.depths, shows, depth);
      const vfloat tau = v_select(shows, depth[0] * v_set(segment), zero),
                   per_alpha = tau * v_reciprocal(v_select(shows, v_max(shown.layer[3], v_set(1e-30f)), v_set(1.0f)));
      for (int c = 0; c < 3; ++c) {
        rate[c] = shown.layer[c] * per_alpha;
      }
      rate[3] = tau;
      light_layer(&shown.lighting, rate);
      for (int c = 0; c < 4; ++c) {
        rate[c] = rate[c] * shown.lighting.factor;
      }
    }
  } else {
    const vmask valid = k->live & v_finite(sample->value);
    vfloat across;
    const vint column = entry_before(a, entry_place(a, 0, v_select(valid, sample->value, zero)), a->transfer_2d.columns, &across);
    shows = columns_show(a, floats, column, across, valid);
    if (m_any(shows)) {
      stratus_lit_sample lighting;
      shows = RAY_NAME(two_at)(a, floats, k, sample, column, across, shows, rate, &lighting);
      rate[3] = depth_of_entry(rate[3]) * v_set(a->transfer_2d.reach * segment);
      for (int c = 0; c < 3; ++c) {
        rate[c] = rate[c] * rate[3];
      }
      if (a->light.on) {
        light_layer(&lighting, rate);
      }
    }
  }
  for (int c = 0; c < 4; ++c) {
    rate[c] = v_select(shows, rate[c], zero);
  }
}
