// SPDX-License-Identifier: BSD-3-Clause
// Files of sparse grids for tests, written by OpenVDB and NanoVDB themselves: a cloud of leaves, a tile and a lone voxel.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <type_traits>

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/openvdb.h>

namespace vdb {

constexpr double background = -2.5;

// The voxels of the cloud: a ball and one separate voxel.
inline bool in_cloud(int x, int y, int z)
{
  return (x - 6) * (x - 6) + (y - 4) * (y - 4) + (z - 2) * (z - 2) <= 49 || (x == -9 && y == 20 && z == 31);
}
inline double cloud(int x, int y, int z)
{
  return 10 + x + 2 * y + 4 * z;
}
// The tile is a whole leaf of one value, where no voxel is stored: its corner is (24, 8, 16).
inline bool in_tile(int x, int y, int z)
{
  return x >= 24 && x < 32 && y >= 8 && y < 16 && z >= 16 && z < 24;
}
constexpr double tile = 7;
// Returns a grid's value at a voxel, for types with a sign.
inline double value(int x, int y, int z)
{
  return in_cloud(x, y, z) ? cloud(x, y, z) : in_tile(x, y, z) ? tile : background;
}
constexpr int low[3] = { -9, -3, -5 }, high[3] = { 31, 20, 31 }; // of active voxels

template <class Value> Value of(double number)
{
  if constexpr (std::is_same_v<Value, bool>) {
    return number > 0;
  } else if constexpr (std::is_arithmetic_v<Value>) {
    return static_cast<Value>(number);
  } else { // a vector of three different components
    using T = typename Value::ValueType;
    return Value(static_cast<T>(number), static_cast<T>(2 * number), static_cast<T>(-2 * number));
  }
}

template <class Grid> typename Grid::Ptr make_grid(const std::string& name)
{
  using Value = typename Grid::ValueType;
  typename Grid::Ptr grid = Grid::create(of<Value>(background));
  grid->setName(name);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  auto to = grid->getAccessor();
  grid->tree().addTile(1, openvdb::Coord(24, 8, 16), of<Value>(tile), true);
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) {
        if (in_cloud(x, y, z)) {
          to.setValue(openvdb::Coord(x, y, z), of<Value>(cloud(x, y, z)));
        }
      }
    }
  }
  return grid;
}

// Voxels of .5 x 2 x 1, turned about z by 30 degrees, shifted.
inline openvdb::math::Transform::Ptr turned()
{
  auto map = openvdb::math::Transform::createLinearTransform();
  map->preScale(openvdb::Vec3d(.5, 2, 1));
  map->postRotate(std::acos(-1.0) / 6, openvdb::math::Z_AXIS);
  map->postTranslate(openvdb::Vec3d(100, -50, 7));
  return map;
}

template <class Grid, class Build = void> nanovdb::GridHandle<> to_nano(const std::shared_ptr<Grid>& grid)
{
  using Value = typename Grid::ValueType;
  nanovdb::OpenToNanoVDB<Value, std::conditional_t<std::is_void_v<Build>, typename nanovdb::OpenToNanoType<Value>::Type, Build>> convert;
  return convert(*grid);
}

inline void write_vdb(const std::string& path, const openvdb::GridCPtrVec& grids)
{
  openvdb::io::File file(path);
  file.write(grids);
  file.close();
}
} // namespace vdb
