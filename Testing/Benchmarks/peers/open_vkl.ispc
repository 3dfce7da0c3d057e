// SPDX-License-Identifier: BSD-3-Clause
// Marches a packet of rays through an Open VKL volume. It is compiled once for each width of packets; MARCH is the function's name.
#include <openvkl/openvkl.isph>
#include <openvkl/device/openvkl.isph>

struct frame {
  float eye[3], forward[3], right[3], up[3];
  float bounds[6]; // of the volume: x, y, z of the lower corner, then of the upper one
  int width, height;
  float step;              // world length
  float least_left;        // a ray ends when its transparency is below this
  float low, scale;        // entry (value - low) * scale of the table
  int last;                // number of the table's last entry
  const float *table;      // red, green, blue (premultiplied) and opacity of a step
  float *rgba;             // out
};

// Draws the packet whose lower left pixel is (x, y): 4 pixels a row. Returns the number of samples. Samples are at (n + 1/2) steps from the
// eye, as in Stratus, so that an interval skipped moves no sample.
export uniform int64 MARCH(void *uniform sampler_, void *uniform context_, const uniform frame &f, uniform int x, uniform int y)
{
  const VKLSampler *uniform sampler = (const VKLSampler * uniform) sampler_;
  VKLIntervalIteratorContext *uniform context = (VKLIntervalIteratorContext * uniform) context_;
  const int i = x + (programIndex & 3), j = y + (programIndex >> 2);
  varying float left = 1, red = 0, green = 0, blue = 0;
  int count = 0;
  const float u = (2 * i + 1) / (float)f.width - 1, v = (2 * j + 1) / (float)f.height - 1;
  vkl_vec3f origin, direction;
  origin.x = f.eye[0];
  origin.y = f.eye[1];
  origin.z = f.eye[2];
  direction.x = f.forward[0] + u * f.right[0] + v * f.up[0];
  direction.y = f.forward[1] + u * f.right[1] + v * f.up[1];
  direction.z = f.forward[2] + u * f.right[2] + v * f.up[2];
  const float length = sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
  direction.x /= length;
  direction.y /= length;
  direction.z /= length;
  const float ax = (f.bounds[0] - origin.x) / direction.x, bx = (f.bounds[3] - origin.x) / direction.x;
  const float ay = (f.bounds[1] - origin.y) / direction.y, by = (f.bounds[4] - origin.y) / direction.y;
  const float az = (f.bounds[2] - origin.z) / direction.z, bz = (f.bounds[5] - origin.z) / direction.z;
  vkl_range1f range;
  range.lower = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), 0.0f));
  range.upper = min(min(max(ax, bx), max(ay, by)), max(az, bz));
  if (range.lower < range.upper) {
    varying float time = 0;
    uniform unsigned int8 buffer[VKL_MAX_INTERVAL_ITERATOR_SIZE];
    VKLIntervalIterator iterator = vklInitIntervalIteratorV(
      context, (varying vkl_vec3f * uniform) & origin, (varying vkl_vec3f * uniform) & direction, &range, &time, (void *uniform) buffer);
    VKLInterval interval;
    while (left >= f.least_left && vklIterateIntervalV(iterator, &interval)) {
      float n = ceil(interval.tRange.lower / f.step - 0.5f);
      for (float t = (n + 0.5f) * f.step; t < interval.tRange.upper && left >= f.least_left; n += 1, t = (n + 0.5f) * f.step) {
        vkl_vec3f place;
        place.x = origin.x + t * direction.x;
        place.y = origin.y + t * direction.y;
        place.z = origin.z + t * direction.z;
        const float value = vklComputeSampleV(sampler, &place, 0, &time);
        const float at = clamp((value - f.low) * f.scale, 0.0f, (uniform float)f.last);
        const int entry = min((int)at, f.last - 1);
        const float share = at - entry;
        const float *e = f.table + 4 * entry;
        const float alpha = e[3] + share * (e[7] - e[3]);
        red += left * (e[0] + share * (e[4] - e[0]));
        green += left * (e[1] + share * (e[5] - e[1]));
        blue += left * (e[2] + share * (e[6] - e[2]));
        left *= 1 - alpha;
        ++count;
      }
    }
  }
  if (i < f.width && j < f.height) {
    float *pixel = f.rgba + 4 * (j * f.width + i);
    pixel[0] = red;
    pixel[1] = green;
    pixel[2] = blue;
    pixel[3] = 1 - left;
  }
  return reduce_add(count);
}
