// SPDX-License-Identifier: BSD-3-Clause
// A file of sparse grids, and one of its grids, whichever library reads it. Private to the module.
#ifndef vtkStratusSparseGrid_h
#define vtkStratusSparseGrid_h

#include "vtkStratusReadError.h"
#include "vtkStratusSparseBlocks.h"

#include "vtkType.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

// VTK's number of the type of a grid's components.
constexpr int vtkStratusTypeOf(float)
{
  return VTK_FLOAT;
}
constexpr int vtkStratusTypeOf(double)
{
  return VTK_DOUBLE;
}
constexpr int vtkStratusTypeOf(int16_t)
{
  return VTK_SHORT;
}
constexpr int vtkStratusTypeOf(int32_t)
{
  return VTK_INT;
}
constexpr int vtkStratusTypeOf(uint32_t)
{
  return VTK_UNSIGNED_INT;
}
constexpr int vtkStratusTypeOf(int64_t)
{
  return VTK_LONG_LONG;
}
constexpr int vtkStratusTypeOf(uint8_t)
{
  return VTK_UNSIGNED_CHAR;
}

// The part of a grid that becomes an image: values of voxels low to high, ends included, x fastest, in memory initialized to zeros. Writes
// are clipped to the box. A value that the memory has already is not written, so that pages of zeros stay untouched.
template <class T> class vtkStratusDenseBox
{
public:
  vtkStratusDenseBox(void* values, const int64_t low[3], const int64_t high[3], int components)
      : Values(static_cast<T*>(values)), Components(components)
  {
    std::copy(low, low + 3, this->Low);
    std::copy(high, high + 3, this->High);
  }

  // Sets every voxel, before any other is written.
  void SetBackground(const T* value)
  {
    std::fill_n(this->Background, 3, T(0));
    const int64_t side = std::max({ this->High[0] - this->Low[0], this->High[1] - this->Low[1], this->High[2] - this->Low[2] }) + 1;
    this->SetCube(this->Low, side, value);
    for (int c = 0; c < this->Components; ++c) { // gcc 14 takes a copy of one component for one of three
      this->Background[c] = value[c];
    }
  }

  // Sets the cube of `size` voxels a side at `first` to one value.
  void SetCube(const int64_t first[3], int64_t size, const T* value)
  {
    if (!std::equal(value, value + this->Components, this->Background)) {
      this->Fill(first, size, [value](int64_t, int64_t, int64_t) { return value; });
    }
  }

  // Sets the cube of voxels by a function of the place within it, which returns a pointer to the voxel's components.
  template <class At> void Fill(const int64_t first[3], int64_t size, const At& at)
  {
    int64_t from[3], to[3];
    for (int a = 0; a < 3; ++a) {
      from[a] = std::max(first[a], this->Low[a]);
      to[a] = std::min(first[a] + size - 1, this->High[a]);
    }
    const int64_t nx = this->High[0] - this->Low[0] + 1, ny = this->High[1] - this->Low[1] + 1;
    for (int64_t z = from[2]; z <= to[2]; ++z) {
      for (int64_t y = from[1]; y <= to[1]; ++y) {
        T* row = this->Values + this->Components * (nx * (y - this->Low[1] + ny * (z - this->Low[2])) - this->Low[0]);
        for (int64_t x = from[0]; x <= to[0]; ++x) {
          this->Set(row + this->Components * x, at(x - first[0], y - first[1], z - first[2]));
        }
      }
    }
  }

private:
  void Set(T* to, const T* value)
  {
    for (int c = 0; c < this->Components; ++c) {
      if (!(to[c] == value[c])) {
        to[c] = value[c];
      }
    }
  }

  T* Values;
  T Background[3];
  int64_t Components, Low[3], High[3];
};

// The cells that have a corner in a cube of voxels.
inline vtkStratusCellBox vtkStratusCellsAt(const int64_t first[3], int64_t size)
{
  vtkStratusCellBox box;
  for (int a = 0; a < 3; ++a) {
    box.Low[a] = first[a] - 1;
    box.High[a] = first[a] + size;
  }
  return box;
}

// A grid's description, and its values on request. All members throw vtkStratusReadError.
class vtkStratusSparseGrid
{
public:
  virtual ~vtkStratusSparseGrid() = default;

  // Writes all voxels of the box, active and inactive ones, into memory that holds zeros: values of Type, Components a voxel. If InFile,
  // several threads may do so at once.
  virtual void Write(void* values, const int64_t low[3], const int64_t high[3]) const = 0;

  // Lists for each cube of `side` voxels (a power of 2) at multiples of that, clipped to the box, x fastest, the one value that Write()
  // gives all of its voxels, or NaN where it has leaves. Empty where that is not known.
  virtual std::vector<float> ListOnly(const int64_t[3], const int64_t[3], int64_t) const { return {}; }

  // Lists the cells with an active voxel at a corner: the cells of each leaf that has one, and the cells of each active tile.
  virtual std::vector<vtkStratusCellBox> ListActive() const = 0;

  int Type = VTK_FLOAT; // of VTK's numbers
  int Components = 1;
  bool Empty = true;                       // no voxel is active
  int64_t Low[3] = { 0, 0, 0 };            // the box of the active voxels, ends included
  int64_t High[3] = { 0, 0, 0 };           //
  std::array<double, 9> Matrix{ { 0.0 } }; // row-major: world = Matrix * index + Offset
  std::array<double, 3> Offset{ { 0.0 } }; //
  uint64_t Active = 0, Bytes = 0;          // voxels; memory of the sparse grid
  bool InFile = false;                     // any Write() reads its own leaves, and nothing else
  std::string Kind;                        // "fog volume of float", for people
};

class vtkStratusSparseFile
{
public:
  virtual ~vtkStratusSparseFile() = default;

  struct Entry {
    std::string Name; // that no other grid of the file has
    std::string Kind; // "float", "vec3s", ...
    bool Known;       // its values can be drawn
  };
  const std::vector<Entry>& GetEntries() const { return this->Entries; }
  // Reads a grid of those that are Known, or as much of it as its description needs: Write() then reads the rest.
  virtual std::unique_ptr<vtkStratusSparseGrid> Read(const std::string& name) = 0;

  // Opens a file by its first bytes.
  static std::unique_ptr<vtkStratusSparseFile> Open(const std::string& path);

protected:
  std::vector<Entry> Entries;
};

// Those that Open() chooses from, each where the library was there to build with.
std::unique_ptr<vtkStratusSparseFile> vtkStratusOpenVDBFile(const std::string& path);
std::unique_ptr<vtkStratusSparseFile> vtkStratusNanoVDBFile(const std::string& path);

#endif
