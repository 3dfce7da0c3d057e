/* SPDX-License-Identifier: BSD-3-Clause
 * Random numbers from a seed, and values for fields of structs that are mostly valid. */
#include "fuzz.h"

#include <float.h>

/* splitmix64, of the next two bytes if there are any: one choice changes where they do. */
uint64_t fuzz_next(fuzz* f)
{
  uint64_t z = f->random += 0x9e3779b97f4a7c15ull;
  if (f->bytes_left >= 2) {
    z = ((uint64_t)f->bytes[0] | (uint64_t)f->bytes[1] << 8) * 0x9e3779b97f4a7c15ull;
    f->bytes += 2;
    f->bytes_left -= 2;
  }
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

uint64_t fuzz_below(fuzz* f, uint64_t count)
{
  return fuzz_next(f) % count;
}

double fuzz_unit(fuzz* f)
{
  return (double)(fuzz_next(f) >> 11) * 0x1p-53;
}

double fuzz_between(fuzz* f, double low, double high)
{
  return low + fuzz_unit(f) * (high - low);
}

double fuzz_scale(fuzz* f, double low, double high)
{
  return exp(fuzz_between(f, log(low), log(high)));
}

bool fuzz_chance(fuzz* f, double chance)
{
  return fuzz_unit(f) < chance;
}

bool fuzz_odd(fuzz* f)
{
  const int field = f->fields++;
  return field == f->odd_at || (f->oddness > 0 && fuzz_below(f, 10000) < (uint64_t)f->oddness);
}

bool fuzz_is_tame(const fuzz* f)
{
  return f->oddness == 0 && f->odd_at < 0 && !f->driven; /* bytes may make any two numbers equal */
}

double fuzz_odd_real(fuzz* f)
{
  static const double odd[] = { 0.0, -0.0, 1.0, -1.0, 2.0, 0.5, -0.5, NAN, -NAN, INFINITY, -INFINITY, DBL_MAX, -DBL_MAX, 1e308, -1e308,
    DBL_MIN, -DBL_MIN, 4.9406564584124654e-324, 1e-310, 1e-300, 1e-160, 1e160, 1e-45, 1e-38, 3.4028234663852886e38, 3.5e38, -3.5e38, 1e31,
    1e30, 1e20, 1e15, -1e15, 9007199254740993.0, 2147483647.0, 2147483648.0, -2147483649.0, 9.3e18, -9.3e18, 4096.0, 65536.0, 1e-6, 1e6,
    DBL_EPSILON, 1.0 + DBL_EPSILON, 1.0 - DBL_EPSILON };
  const uint64_t which = fuzz_below(f, sizeof odd / sizeof *odd + 4);
  const uint64_t bits = fuzz_next(f);
  double any;
  memcpy(&any, &bits, sizeof any);
  any = which < sizeof odd / sizeof *odd ? odd[which] : any;
  fuzz_note(f, any);
  return any;
}

int64_t fuzz_odd_integer(fuzz* f)
{
  static const int64_t odd[] = { 0, 1, -1, 2, -2, 3, 5, 7, 8, 9, 16, 17, 33, 64, 65, 127, 128, 255, 256, 257, 1023, 1024, 1025, 32767,
    32768, 65535, 65536, 65537, INT32_MAX, INT32_MIN, INT32_MAX - 1, (int64_t)INT32_MAX + 1, UINT32_MAX, (int64_t)UINT32_MAX + 1,
    (int64_t)1 << 40, (int64_t)1 << 62, INT64_MAX, INT64_MIN, INT64_MAX - 1 };
  const uint64_t which = fuzz_below(f, sizeof odd / sizeof *odd + 2);
  const int64_t any = (int64_t)fuzz_next(f), value = which < sizeof odd / sizeof *odd ? odd[which] : any;
  fuzz_note(f, (double)value);
  return value;
}

double fuzz_real(fuzz* f, double low, double high)
{
  return fuzz_odd(f) ? fuzz_odd_real(f) : fuzz_between(f, low, high);
}

int fuzz_integer(fuzz* f, int low, int high)
{
  return fuzz_odd(f) ? (int)(uint32_t)(uint64_t)fuzz_odd_integer(f) : low + (int)fuzz_below(f, (uint64_t)(high - low) + 1);
}

int fuzz_choice(fuzz* f, int count)
{
  return fuzz_integer(f, 0, count - 1);
}

int fuzz_flag(fuzz* f)
{
  return fuzz_integer(f, 0, 1);
}

void fuzz_vector(fuzz* f, double low, double high, double v[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    v[axis] = fuzz_real(f, low, high);
  }
}

const void* fuzz_pointer(fuzz* f, const void* pointer)
{
  return fuzz_odd(f) ? NULL : pointer;
}
