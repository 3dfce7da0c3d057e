/* SPDX-License-Identifier: BSD-3-Clause
 * Heights of the borders of layers, from the numbers that files have. */
#include "faces.h"

static stratus_status check(stratus_context* context, int64_t node_count, int64_t layer_count)
{
  if (node_count < 1 || layer_count < 1 || layer_count > INT32_MAX / node_count - 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%lld nodes and %lld layers, must be at least 1 each and at most %d points",
      (long long)node_count, (long long)layer_count, INT32_MAX);
  }
  return STRATUS_OK;
}

stratus_status stratus_layers_between(stratus_context* context, int64_t layer_count, const double* middles, double* borders)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!middles || !borders) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "middles or borders is NULL");
  }
  TRY(check(context, 1, layer_count));
  for (int64_t i = 0; i < layer_count; ++i) {
    if (!isfinite(middles[i]) || (i > 0 && middles[i] < middles[i - 1])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the middle of layer %lld is at %.9g, must be finite%s", (long long)i,
        middles[i], i > 0 ? " and at or above the layer below" : "");
    }
  }
  const double low = middles[0], high = middles[layer_count - 1];
  for (int64_t i = 1; i < layer_count; ++i) {
    borders[i] = 0.5 * (middles[i - 1] + middles[i]);
  }
  borders[0] = layer_count > 1 ? 2.0 * low - borders[1] : low - 0.5;
  borders[layer_count] = layer_count > 1 ? 2.0 * high - borders[layer_count - 1] : high + 0.5;
  if (high < 0.0) {
    borders[layer_count] = fmin(borders[layer_count], 0.0);
  }
  if (low > 0.0) {
    borders[0] = fmax(borders[0], 0.0);
  }
  return STRATUS_OK;
}

stratus_status stratus_layers_from_borders(stratus_context* context, const stratus_layer_borders* from, double* z, uint8_t* none)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!from || !from->borders || !z || !none) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "from, its borders, z or none is NULL");
  }
  TRY(check(context, from->node_count, from->layer_count));
  if (from->sigma && (!from->bottom || !from->surface)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "borders of sigma need a bottom and a surface");
  }
  const int64_t nodes = from->node_count, layers = from->layer_count;
  for (int64_t node = 0; node < nodes; ++node) {
    const double bottom = from->bottom ? from->bottom[node] : -INFINITY, surface = from->surface ? from->surface[node] : INFINITY;
    const double low = !isnan(bottom) ? bottom : isfinite(surface) ? surface : 0.0;
    none[node] = isnan(surface) || isnan(bottom) || surface <= bottom;
    for (int64_t b = 0; b <= layers; ++b) {
      const double border = from->borders[from->of_nodes ? b * nodes + node : b];
      const double height = from->sigma ? surface + border * (surface - low) : fmin(fmax(border, low), surface);
      z[b * nodes + node] = none[node] ? low : height;
    }
    if (!from->sigma && !none[node]) {
      if (from->stretched && isfinite(low)) {
        z[node] = low;
      }
      if (isfinite(surface)) {
        z[layers * nodes + node] = surface;
      }
    }
  }
  return STRATUS_OK;
}

/* Returns the height of a border from the heights of the middles of `layers` layers. */
static double border_of(const double* middles, int64_t layers, int64_t border)
{
  if (border > 0 && border < layers) {
    return 0.5 * (middles[border - 1] + middles[border]);
  }
  if (layers == 1) {
    return middles[0] + (border == 0 ? -0.5 : 0.5);
  }
  const int64_t near = border == 0 ? 0 : layers - 1, next = border == 0 ? 1 : layers - 2;
  return 1.5 * middles[near] - 0.5 * middles[next];
}

stratus_status stratus_layers_from_heights(
  stratus_context* context, int64_t node_count, int64_t layer_count, int of_borders, const double* heights, double* z, uint8_t* none)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!heights || !z || !none) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "heights, z or none is NULL");
  }
  TRY(check(context, node_count, layer_count));
  const int64_t given = of_borders ? layer_count + 1 : layer_count;
  void* memory; /* a node's heights without gaps */
  TRY(stratus_allocate(context, (size_t)given, sizeof(double), &memory));
  double* const own = memory;
  stratus_status status = STRATUS_OK;
  for (int64_t node = 0; node < node_count && status == STRATUS_OK; ++node) {
    double above = NAN;
    for (int64_t i = given; i-- > 0;) {
      const double height = heights[i * node_count + node];
      own[i] = isfinite(height) ? height : above;
      if (own[i] > above) {
        status = stratus_fail(
          context, STRATUS_INVALID_ARGUMENT, "layers are upside down: %.9g is below %.9g at node %lld", own[i], above, (long long)node);
        break;
      }
      above = own[i];
    }
    none[node] = !isfinite(own[0]) || !isfinite(own[given - 1]);
    for (int64_t b = 0; b <= layer_count; ++b) {
      z[b * node_count + node] = none[node] ? 0.0 : of_borders ? own[b] : border_of(own, layer_count, b);
    }
  }
  stratus_release(context, memory);
  return status;
}

stratus_status stratus_layers_from_thicknesses(stratus_context* context, int64_t node_count, int64_t layer_count, const double* thicknesses,
  const double* bottom, const double* present, double* z, uint8_t* none)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!thicknesses || !bottom || !z || !none) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "thicknesses, bottom, z or none is NULL");
  }
  TRY(check(context, node_count, layer_count));
  for (int64_t node = 0; node < node_count; ++node) {
    const double foot = isfinite(bottom[node]) ? bottom[node] : 0.0;
    double height = foot;
    z[node] = foot;
    for (int64_t layer = 0; layer < layer_count; ++layer) {
      const double thickness = thicknesses[layer * node_count + node];
      const bool there =
        isfinite(thickness) && thickness > 0.0 && (!present || (double)(layer_count - 1 - layer) < present[node]); /* from the top */
      height += there ? thickness : 0.0;
      z[(layer + 1) * node_count + node] = height;
    }
    none[node] = !isfinite(bottom[node]) || !(height > foot);
  }
  return STRATUS_OK;
}

stratus_status stratus_layers_to_borders(
  stratus_context* context, int64_t node_count, int64_t layer_count, const double* z, const double* values, double* at_borders)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!z || !values || !at_borders) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "z, values or at_borders is NULL");
  }
  TRY(check(context, node_count, layer_count));
  for (int64_t b = 0; b <= layer_count; ++b) {
    for (int64_t node = 0; node < node_count; ++node) {
      const int64_t at = b * node_count + node; /* the value above, and the height */
      double* const to = at_borders + at;
      if (b == 0 || b == layer_count) {
        *to = values[b == 0 ? node : at - node_count];
        continue;
      }
      const double low = values[at - node_count], high = values[at], under = z[at] - z[at - node_count], over = z[at + node_count] - z[at];
      const double weight =
        under + over > 0.0 ? over / (under + over) : 0.5; /* of the layer below: it is nearer if the one above is thicker */
      if ((under <= 0.0 && over > 0.0) || isnan(low)) {   /* the layer below is under the bottom */
        *to = high;
      } else {
        *to = isnan(high) ? low : weight * low + (1.0 - weight) * high;
      }
    }
  }
  return STRATUS_OK;
}
