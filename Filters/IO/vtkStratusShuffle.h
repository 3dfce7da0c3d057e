// SPDX-License-Identifier: BSD-3-Clause
// The filter shuffle of HDF5 and Zarr. Private to the module.
#ifndef vtkStratusShuffle_h
#define vtkStratusShuffle_h

#include <cstddef>
#include <cstring>

template <size_t Bytes> inline void vtkStratusUnshuffleValues(const char* from, size_t count, char* to)
{
  for (size_t i = 0; i < count; ++i) {
    for (size_t b = 0; b < Bytes; ++b) {
      to[Bytes * i + b] = from[count * b + i];
    }
  }
}

// Puts the bytes of values together: `from` has the first byte of all values, then the second of all, and so on. Bytes behind the last
// whole value are copied.
inline void vtkStratusUnshuffle(const char* from, size_t bytes, size_t value_bytes, char* to)
{
  const size_t count = bytes / value_bytes, rest = bytes % value_bytes;
  switch (value_bytes) {
    case 2:
      vtkStratusUnshuffleValues<2>(from, count, to);
      break;
    case 4:
      vtkStratusUnshuffleValues<4>(from, count, to);
      break;
    case 8:
      vtkStratusUnshuffleValues<8>(from, count, to);
      break;
    default:
      for (size_t b = 0; b < value_bytes; ++b) {
        for (size_t i = 0; i < count; ++i) {
          to[value_bytes * i + b] = from[count * b + i];
        }
      }
  }
  std::memcpy(to + bytes - rest, from + bytes - rest, rest);
}

#endif
