// SPDX-License-Identifier: BSD-3-Clause
// Writes into the folder that is named: cloud.vdb with a density and a wind, cloud.nvdb with the density, apart.vdb and apart.nvdb with two
// of its kind far apart, and wide.vdb, which has two voxels.
#include "Testing/VTK/vdb_testing.h"

int main(int argc, char* argv[])
{
  const std::string folder = argc > 1 ? argv[1] : ".";
  openvdb::initialize();
  const auto density = openvdb::FloatGrid::create(0.0F), wide = openvdb::FloatGrid::create(0.0F), apart = openvdb::FloatGrid::create(0.0F);
  const auto wind = openvdb::Vec3SGrid::create(openvdb::Vec3f(0));
  density->setName("density");
  density->setGridClass(openvdb::GRID_FOG_VOLUME);
  wind->setName("wind");
  wide->setName("density");
  apart->setName("density");
  for (int x = -20; x <= 20; ++x) {
    for (int y = -20; y <= 20; ++y) {
      for (int z = -12; z <= 12; ++z) {
        const float r = static_cast<float>(x * x + y * y) / 400 + static_cast<float>(z * z) / 144;
        if (r < 1) {
          density->tree().setValue(openvdb::Coord(x, y, z), 1 - r);
          apart->tree().setValue(openvdb::Coord(x - 50, y, z), 1 - r);
          apart->tree().setValue(openvdb::Coord(x + 125, y + 95, z + 125), 1 - r);
          wind->tree().setValue(openvdb::Coord(x, y, z), openvdb::Vec3f(3, -4, 0) * (1 - r));
        }
      }
    }
  }
  density->setTransform(vdb::turned());
  wind->setTransform(vdb::turned());
  wide->tree().setValue(openvdb::Coord(0, 0, 0), 1);
  wide->tree().setValue(openvdb::Coord(4000, 4000, 4000), 1);
  vdb::write_vdb(folder + "/cloud.vdb", { density, wind });
  vdb::write_vdb(folder + "/wide.vdb", { wide });
  nanovdb::io::writeGrid(folder + "/cloud.nvdb", vdb::to_nano(density), nanovdb::io::Codec::ZIP);
  vdb::write_vdb(folder + "/apart.vdb", { apart });
  nanovdb::io::writeGrid(folder + "/apart.nvdb", vdb::to_nano(apart));
  return 0;
}
