// SPDX-License-Identifier: BSD-3-Clause
// Sparse grids become the images or blocks that they are: each voxel against the grid's own accessor, tiles and lone voxels among them,
// maps, kinds of values, and files that are wrong.
#include "vdb_testing.h"

#include "reading_testing.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLogger.h"
#include "vtkMatrix3x3.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPointData.h"
#include "vtkStratusVDBReader.h"

#include <openvdb/tools/LevelSetSphere.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <sys/resource.h>

namespace {

using reader = variable_reader<vtkStratusVDBReader>;

// Compares every value of the image with `at`, the voxel's expected value; returns how many differ.
int count_wrong(vtkDataSet* data, const std::function<double(int x, int y, int z, int component)>& at, double tolerance)
{
  vtkImageData* image = vtkImageData::SafeDownCast(data);
  vtkDataArray* values = image ? image->GetPointData()->GetArray(0) : nullptr;
  int wrong = values ? 0 : 1;
  const int* e = image ? image->GetExtent() : nullptr;
  vtkIdType n = 0;
  for (int z = e ? e[4] : 1; values && z <= e[5]; ++z) {
    for (int y = e[2]; y <= e[3]; ++y) {
      for (int x = e[0]; x <= e[1]; ++x, ++n) {
        for (int c = 0; c < values->GetNumberOfComponents(); ++c) {
          wrong += near(values->GetComponent(n, c), at(x, y, z, c), tolerance) ? 0 : 1;
        }
      }
    }
  }
  return wrong;
}

void check_extent(vtkDataSet* data, const std::string& what)
{
  vtkImageData* image = vtkImageData::SafeDownCast(data);
  for (int a = 0; a < 3; ++a) {
    check(image && image->GetExtent()[2 * a] == vdb::low[a] - 1 && image->GetExtent()[2 * a + 1] == vdb::high[a] + 1,
      what + ": the image is not the active box with a border of one");
  }
}

template <class Grid> double component_of(const Grid& grid, int x, int y, int z, int c)
{
  const auto value = grid.tree().getValue(openvdb::Coord(x, y, z));
  if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
    return static_cast<double>(value);
  } else {
    return static_cast<double>(value[c]);
  }
}

// A kind of grid, from both files.
template <class Grid, bool nano = false> void test_kind(const std::string& folder, const std::string& kind, int type)
{
  const auto grid = vdb::make_grid<Grid>("density");
  const int components = std::is_arithmetic_v<typename Grid::ValueType> ? 1 : 3;
  std::vector<std::string> files = { folder + "/" + kind + ".vdb" };
  vdb::write_vdb(files[0], { grid });
  if constexpr (nano) {
    files.push_back(folder + "/" + kind + ".nvdb");
    nanovdb::io::writeGrid(files[1], vdb::to_nano(grid));
  }
  for (const std::string& file : files) {
    reader r(file, nullptr);
    vtkDataSet* data = r.read();
    check(r.errors->heard.empty(), file + ": " + r.errors->heard);
    check_extent(data, file);
    vtkDataArray* values = data ? data->GetPointData()->GetArray("density") : nullptr;
    check(values && values->GetDataType() == type && values->GetNumberOfComponents() == components, file + ": another type of values");
    const int wrong = count_wrong(
      data, [&](int x, int y, int z, int c) { return component_of(*grid, x, y, z, c); }, 0.0);
    check(wrong == 0, file + ": " + std::to_string(wrong) + " values are not the grid's");
    check(count_wrong(
            data, [&](int x, int y, int z, int c) { return component_of(*grid, x + 1, y, z, c); }, 0.0) > 100,
      file + ": the comparison cannot fail");
  }
}

// Values packed into few bits differ by at most the packing's error.
template <class Build> void test_packed(const std::string& folder, const std::string& kind, double error)
{
  const auto grid = vdb::make_grid<openvdb::FloatGrid>("density");
  const std::string file = folder + "/" + kind + ".nvdb";
  nanovdb::io::writeGrid(file, vdb::to_nano<openvdb::FloatGrid, Build>(grid));
  reader r(file, nullptr);
  vtkDataSet* data = r.read();
  check(r.errors->heard.empty(), file + ": " + r.errors->heard);
  check_extent(data, file);
  // Leaves span 44 units of value at most.
  const int wrong = count_wrong(
    data, [&](int x, int y, int z, int) { return grid->tree().getValue(openvdb::Coord(x, y, z)); }, error);
  check(wrong == 0, file + ": " + std::to_string(wrong) + " values are farther from the grid's than packing takes them");
}

void test_half(const std::string& folder)
{
  const auto grid = vdb::make_grid<openvdb::FloatGrid>("density");
  grid->setSaveFloatAsHalf(true);
  vdb::write_vdb(folder + "/half.vdb", { grid });
  reader r(folder + "/half.vdb", nullptr);
  vtkDataSet* data = r.read();
  check(count_wrong(
          data, [&](int x, int y, int z, int) { return grid->tree().getValue(openvdb::Coord(x, y, z)); }, 0.0) == 0,
    "small integers are exact in halves");
  check(std::string(r.reader->GetDescription()).find("kept in halves") != std::string::npos, "the description names halves");
}

// Inner values of a level set are in inactive tiles, which are not background.
void test_level_set(const std::string& folder)
{
  const auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(30.0F, openvdb::Vec3f(0), 1.0F);
  sphere->setName("surface");
  vdb::write_vdb(folder + "/sphere.vdb", { sphere });
  nanovdb::io::writeGrid(folder + "/sphere.nvdb", vdb::to_nano(sphere), nanovdb::io::Codec::BLOSC);
  for (const char* name : { "/sphere.vdb", "/sphere.nvdb" }) {
    reader r(folder + name, "surface");
    vtkDataSet* data = r.read();
    check(r.errors->heard.empty() && data && data->GetNumberOfPoints() > 60 * 60 * 60, std::string(name) + ": " + r.errors->heard);
    check(count_wrong(
            data, [&](int x, int y, int z, int) { return sphere->tree().getValue(openvdb::Coord(x, y, z)); }, 0.0) == 0,
      std::string(name) + ": a level set has its inner values");
    check(std::string(r.reader->GetDescription()).find("level set of") != std::string::npos, r.reader->GetDescription());
  }
}

// Each voxel is where the grid's map puts it, turned and mirrored.
void test_maps(const std::string& folder)
{
  for (bool mirrored : { false, true }) {
    const auto grid = vdb::make_grid<openvdb::FloatGrid>("density");
    auto map = vdb::turned();
    if (mirrored) {
      map->preScale(openvdb::Vec3d(1, 1, -1));
    }
    grid->setTransform(map);
    vdb::write_vdb(folder + "/turned.vdb", { grid });
    nanovdb::io::writeGrid(folder + "/turned.nvdb", vdb::to_nano(grid), nanovdb::io::Codec::ZIP);
    for (const char* name : { "/turned.vdb", "/turned.nvdb" }) {
      reader r(folder + name, nullptr);
      vtkImageData* image = vtkImageData::SafeDownCast(r.read());
      check(image && r.errors->heard.empty(), std::string(name) + ": " + r.errors->heard);
      double worst = 0.0;
      for (int corner = 0; image && corner < 8; ++corner) {
        int ijk[3];
        double place[3];
        for (int a = 0; a < 3; ++a) {
          ijk[a] = image->GetExtent()[2 * a + (corner >> a & 1)];
        }
        image->TransformIndexToPhysicalPoint(ijk, place);
        const openvdb::Vec3d right = grid->transform().indexToWorld(openvdb::Vec3d(ijk[0], ijk[1], ijk[2]));
        worst = std::fmax(worst, (right - openvdb::Vec3d(place)).length());
      }
      check(worst < 1e-9, std::string(name) + ": a corner is off by " + std::to_string(worst));
      check(!image || near(image->GetSpacing()[1], 2), "the voxel's size is the spacing");
    }
  }
}

void test_several(const std::string& folder)
{
  const auto density = vdb::make_grid<openvdb::FloatGrid>("density"), again = vdb::make_grid<openvdb::FloatGrid>("density");
  const auto nothing = openvdb::FloatGrid::create(3.0F);
  const auto mask = openvdb::MaskGrid::create();
  again->tree().setValue(openvdb::Coord(0, 0, 0), 99);
  nothing->setName("nothing");
  mask->setName("where");
  const std::string file = folder + "/several.vdb";
  vdb::write_vdb(file, { density, again, nothing, vdb::make_grid<openvdb::Vec3SGrid>("wind"), mask });
  reader r(file, "wind");
  vtkDataSet* data = r.read();
  std::string names;
  for (int i = 0; i < r.reader->GetNumberOfVariables(); ++i) {
    names += std::string(r.reader->GetNameOfVariable(i)) + " (" + r.reader->GetLongNameOfVariable(i) + ") ";
  }
  check(names == "density[0] (float) density[1] (float) nothing (float) wind (vec3s) ", "the grids are: " + names);
  check(
    std::string(r.reader->GetDescription()).find("left out: 'where' of Tree_mask_5_4_3") != std::string::npos, r.reader->GetDescription());
  check(
    data && data->GetPointData()->GetVectors() && data->GetPointData()->GetVectors()->GetNumberOfComponents() == 3, "vectors are put out");
  r.reader->SetVariableName("density[1]");
  data = r.read();
  check(data && data->GetPointData()->GetScalars()->GetComponent(vtkImageData::SafeDownCast(data)->FindPoint(0, 0, 0), 0) == 99,
    "the second of two grids of a name: " + r.errors->heard);
  r.reader->SetVariableName("nothing");
  data = r.read();
  check(r.errors->heard.empty() && data->GetNumberOfPoints() == 27 && data->GetPointData()->GetScalars()->GetRange()[0] == 3,
    "a grid without active voxels is background: " + r.errors->heard);
  refuse<vtkStratusVDBReader>(file, "qi", "no variable 'qi' on the grid; those that are: density[0], density[1], nothing, wind");
  const auto one = vdb::to_nano(density), two = vdb::to_nano(again);
  std::ofstream both(folder + "/several.nvdb", std::ios::binary);
  nanovdb::io::writeGrid(both, one);
  nanovdb::io::writeGrid(both, two, nanovdb::io::Codec::ZIP);
  both.close();
  reader n(folder + "/several.nvdb", "density[1]");
  data = n.read();
  check(n.errors->heard.empty() && n.reader->GetNumberOfVariables() == 2, "two grids of NanoVDB: " + n.errors->heard);
  check(data && data->GetPointData()->GetScalars()->GetComponent(vtkImageData::SafeDownCast(data)->FindPoint(99.9, -50, 7), 0) != 5, "");
  check(count_wrong(
          data, [&](int x, int y, int z, int) { return again->tree().getValue(openvdb::Coord(x, y, z)); }, 0.0) == 0,
    "the second grid of NanoVDB");
}

// A grid that is large and nearly empty is no image: it becomes blocks, or is refused with its bytes.
void test_memory(const std::string& folder)
{
  const auto grid = openvdb::FloatGrid::create(0.0F);
  grid->setName("density");
  grid->tree().setValue(openvdb::Coord(-100, 0, 0), 1);
  grid->tree().setValue(openvdb::Coord(1899, 2047, 1999), 2);
  const std::string file = folder + "/wide.vdb";
  vdb::write_vdb(file, { grid });
  reader wide(file, nullptr);
  wide.read();
  check(wide.errors->heard.empty(), "blocks of a wide grid: " + wide.errors->heard);
  check(
    std::string(wide.reader->GetDescription()).find("2 blocks of 8000 bytes (0.007629 MiB) in place of an image of 32865632800 bytes") !=
      std::string::npos,
    std::string("the description lacks the blocks: ") + wide.reader->GetDescription());
  wide.reader->SetLayout(vtkStratusVDBReader::IMAGE_LAYOUT);
  wide.read();
  check(wide.errors->heard.find("'density' would take 32865632800 bytes") != std::string::npos &&
      wide.errors->heard.find("within -100..1899, 0..2047, 0..1999") != std::string::npos,
    "an image beyond the limit: " + wide.errors->heard);
  grid->tree().setValue(openvdb::Coord(1899, 2047, 1999), 0);
  grid->tree().setValueOff(openvdb::Coord(1899, 2047, 1999));
  grid->tree().setValue(openvdb::Coord(155, 255, 255), 2);
  vdb::write_vdb(file, { grid });
  reader r(file, nullptr);
  r.reader->SetLayout(vtkStratusVDBReader::IMAGE_LAYOUT);
  r.reader->SetMemoryLimit(60);
  r.read();
  check(r.errors->heard.find("68694048 bytes (65.51 MiB) as an image") != std::string::npos, "a limit of one's own: " + r.errors->heard);
  r.reader->SetMemoryLimit(66);
  vtkDataSet* data = r.read();
  check(r.errors->heard.empty() && data->GetPointData()->GetScalars()->GetRange()[1] == 2, "within the limit: " + r.errors->heard);

  const auto haze = openvdb::FloatGrid::create(0.0F);
  haze->fill(openvdb::CoordBBox(openvdb::Coord(0, 0, 0), openvdb::Coord(127, 127, 127)), 1.0F);
  vdb::write_vdb(folder + "/haze.vdb", { haze });
  reader full(folder + "/haze.vdb", nullptr);
  full.reader->SetMemoryLimit(1);
  full.read();
  check(full.errors->heard.find("as 1 blocks, and 8788000") != std::string::npos, "blocks beyond the limit: " + full.errors->heard);
}

// Blocks have the grid's values, meet without overlap, and cover every cell with an active corner; few hold more than is active.
void test_blocks(const std::string& folder)
{
  const auto grid = openvdb::FloatGrid::create(-0.5F);
  grid->setName("density");
  grid->tree().addTile(2, openvdb::Coord(256, 0, 128), 3.0F, true); // of 128 voxels a side
  for (int ball = 0; ball < 9; ++ball) {
    const int middle[3] = { 37 * ball, 300 - 61 * ball % 300, 83 * ball % 290 }, radius = 4 + ball;
    for (int x = -radius; x <= radius; ++x) {
      for (int y = -radius; y <= radius; ++y) {
        for (int z = -radius; z <= radius; ++z) {
          if (x * x + y * y + z * z <= radius * radius) {
            grid->tree().setValue(
              openvdb::Coord(middle[0] + x, middle[1] + y, middle[2] + z), static_cast<float>(ball + 0.1 * x + 0.01 * y + 0.001 * z));
          }
        }
      }
    }
  }
  const std::string files[] = { folder + "/blocks.vdb", folder + "/blocks.nvdb" };
  vdb::write_vdb(files[0], { grid });
  nanovdb::io::writeGrid(files[1], vdb::to_nano(grid));
  for (const std::string& file : files) {
    reader r(file, nullptr);
    r.reader->SetLayout(vtkStratusVDBReader::BLOCKS_LAYOUT);
    r.read();
    vtkPartitionedDataSet* parts = vtkPartitionedDataSet::SafeDownCast(r.reader->GetOutputDataObject(0));
    check(r.errors->heard.empty() && parts && parts->GetNumberOfPartitions() > 4, file + ": no blocks: " + r.errors->heard);
    std::vector<unsigned char> covered(400 * 400 * 400, 0); // cells from -20 on
    const auto cell = [](int x, int y, int z) {
      return static_cast<size_t>(x + 20) + 400 * (static_cast<size_t>(y + 20) + 400 * static_cast<size_t>(z + 20));
    };
    int twice = 0, bare = 0;
    double voxels = 0.0;
    for (unsigned int p = 0; parts && p < parts->GetNumberOfPartitions(); ++p) {
      vtkImageData* image = vtkImageData::SafeDownCast(parts->GetPartition(p));
      const int wrong = count_wrong(
        image, [&](int x, int y, int z, int) { return grid->tree().getValue(openvdb::Coord(x, y, z)); }, 0.0);
      check(wrong == 0, file + ": " + std::to_string(wrong) + " values of a block are not the grid's");
      const int* e = image->GetExtent();
      voxels += static_cast<double>(image->GetNumberOfPoints());
      for (int z = e[4]; z < e[5]; ++z) {
        for (int y = e[2]; y < e[3]; ++y) {
          for (int x = e[0]; x < e[1]; ++x) {
            twice += covered[cell(x, y, z)]++ > 0 ? 1 : 0;
          }
        }
      }
    }
    double active = 0.0;
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
      const openvdb::CoordBBox box = [&] {
        openvdb::CoordBBox b;
        voxel.getBoundingBox(b);
        return b;
      }();
      for (auto at = box.begin(); at; ++at) {
        ++active;
        for (int corner = 0; corner < 8; ++corner) {
          bare += covered[cell((*at).x() - (corner & 1), (*at).y() - (corner >> 1 & 1), (*at).z() - (corner >> 2))] > 0 ? 0 : 1;
        }
      }
    }
    check(twice == 0 && bare == 0,
      file + ": " + std::to_string(twice) + " cells are in two blocks, " + std::to_string(bare) + " with an active corner are in none");
    std::printf(
      "%s: %u blocks of %.0f voxels, %.0f of them active\n", file.c_str(), parts ? parts->GetNumberOfPartitions() : 0, voxels, active);
    check(voxels < 2.5 * active, file + ": the blocks hold many more voxels than are active");
  }
}

long resident_most()
{
  struct rusage used;
  return getrusage(RUSAGE_SELF, &used) == 0 ? used.ru_maxrss / 1024 : -1;
}

// Pages of an image that hold only the background 0 are never written: 512 MiB with two voxels need the memory of two voxels.
void test_pages(const std::string& folder)
{
  const auto grid = openvdb::FloatGrid::create(0.0F);
  grid->tree().setValue(openvdb::Coord(0, 0, 0), 1);
  grid->tree().setValue(openvdb::Coord(509, 509, 509), 2);
  vdb::write_vdb(folder + "/pages.vdb", { grid });
  const long before = resident_most();
  reader r(folder + "/pages.vdb", nullptr);
  vtkDataSet* data = r.read();
  const long after = resident_most();
  check(r.errors->heard.empty() && data->GetNumberOfPoints() == 512LL * 512 * 512, "512 voxels a side: " + r.errors->heard);
  check(before > 0 && after - before < 64, "two voxels take " + std::to_string(after - before) + " MiB");
  check(data->GetPointData()->GetArray(0)->GetRange()[1] == 2, "the far voxel is lost");
}

// Bricks have the bits of the values that are read as a whole: of all kinds, on both sides of 0, of a background that is not 0, of tiles.
template <class Grid, class Build = void> void test_bricks(const std::string& folder, const std::string& kind)
{
  const auto grid = vdb::make_grid<Grid>("density"), other = vdb::make_grid<Grid>("density");
  grid->tree().setValue(openvdb::Coord(-150, -140, 230), vdb::of<typename Grid::ValueType>(3));
  grid->tree().addTile(2, openvdb::Coord(-128, -128, 128), vdb::of<typename Grid::ValueType>(4), true);
  const std::string file = folder + "/bricks_" + kind + ".nvdb";
  std::ofstream both(file, std::ios::binary);
  nanovdb::io::writeGrid(both, vdb::to_nano<Grid, Build>(other), nanovdb::io::Codec::ZIP);
  nanovdb::io::writeGrid(both, vdb::to_nano<Grid, Build>(grid));
  both.close();
  reader whole(file, "density[1]"), bricks(file, "density[1]");
  vtkDataArray* expected = whole.read()->GetPointData()->GetArray(0);
  bricks.reader->MapFileOn();
  bricks.reader->SetMappedBytesLeast(1);
  vtkDataArray* values = bricks.read()->GetPointData()->GetArray(0);
  check(bricks.errors->heard.empty() && !whole.reader->GetMapped(), file + ": " + bricks.errors->heard);
  const auto bytes = static_cast<size_t>(expected->GetDataSize() * expected->GetDataTypeSize());
  check(values && values->GetDataSize() == expected->GetDataSize() &&
      std::memcmp(values->GetVoidPointer(0), expected->GetVoidPointer(0), bytes) == 0,
    file + ": bricks have other values than the whole");
  check(bricks.reader->GetMapped() || vtkStratusVDBReader::GetMemoryUsed() == 0, file + ": values do not stay in the file");
  bricks.reader->SetVariableName("density");
  bricks.read();
  check(bricks.errors->heard.empty() && !bricks.reader->GetMapped(), file + ": compressed values stay in the file");
}

// A grid of which neither image nor blocks fit becomes an image of bricks, of which little is read.
void test_limit(const std::string& folder)
{
  const auto grid = openvdb::FloatGrid::create(0.0F);
  const std::string file = folder + "/limit.nvdb";
  for (int x = 0; x < 2000; x += 8) {
    for (int y = 0; y < 2000; y += 200) {
      grid->tree().setValue(openvdb::Coord(x, y, (x + 3 * y) % 1000), 1.0F + static_cast<float>(x));
    }
  }
  nanovdb::io::writeGrid(file, vdb::to_nano(grid));
  reader r(file, nullptr);
  r.reader->SetMemoryLimit(4);
  r.read();
  check(r.errors->heard.find("the limit is 4 MiB") != std::string::npos, "without a place for it: " + r.errors->heard);
  r.reader->MapFileOn();
  vtkImageData* image = vtkImageData::SafeDownCast(r.read());
  if (!r.errors->heard.empty()) { // the system has no bricks
    check(r.errors->heard.find("the limit is 4 MiB") != std::string::npos, r.errors->heard);
    return;
  }
  int wrong = 0;
  const vtkTypeInt64 before = vtkStratusVDBReader::GetBytesRead();
  for (int x = 0; x < 16; x += 8) {
    const float* value = image ? static_cast<float*>(image->GetScalarPointer(x, 200, (x + 600) % 1000)) : nullptr;
    wrong += value && *value == 1.0F + static_cast<float>(x) ? 0 : 1;
  }
  check(wrong == 0 && r.reader->GetMapped(), "an image of bricks beyond the limit");
  check(vtkStratusVDBReader::GetBytesRead() - before < 64 << 20, "two values of a large image bring more than the bricks around them");
}

// A file that is cut after it was opened: its leaves cannot be read, which is counted.
void test_cut_later(const std::string& folder)
{
  const auto grid = vdb::make_grid<openvdb::FloatGrid>("density");
  const std::string file = folder + "/cut_later.nvdb";
  nanovdb::io::writeGrid(file, vdb::to_nano(grid));
  reader r(file, nullptr);
  r.reader->MapFileOn();
  r.reader->SetMappedBytesLeast(1);
  vtkDataArray* values = r.read()->GetPointData()->GetArray(0);
  check(r.errors->heard.empty(), file + ": " + r.errors->heard);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 512 * 8); // the last leaves
  if (r.reader->GetMapped()) {
    int missing = 0;
    for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
      missing += std::isnan(values->GetComponent(i, 0)) ? 1 : 0;
    }
    check(missing > 0, "leaves behind the file's end have values");
  }
}

void test_wrong(const std::string& folder)
{
  const auto grid = vdb::make_grid<openvdb::FloatGrid>("density");
  grid->setTransform(
    openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(20)), .5, 10.0, 1.0));
  vdb::write_vdb(folder + "/frustum.vdb", { grid });
  refuse<vtkStratusVDBReader>(folder + "/frustum.vdb", nullptr, "whose voxels differ in size");
  auto map = openvdb::math::Transform::createLinearTransform();
  map->preShear(.5, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
  grid->setTransform(map);
  vdb::write_vdb(folder + "/sheared.vdb", { grid });
  refuse<vtkStratusVDBReader>(folder + "/sheared.vdb", nullptr, "degrees, an image needs 90");
  const auto mask = openvdb::MaskGrid::create();
  mask->setName("where");
  vdb::write_vdb(folder + "/mask.vdb", { mask });
  refuse<vtkStratusVDBReader>(folder + "/mask.vdb", nullptr, "no grid of numbers or vectors; the file has: 'where' of Tree_mask_5_4_3");
  std::ofstream(folder + "/text.vdb") << "no grid at all";
  refuse<vtkStratusVDBReader>(folder + "/text.vdb", nullptr, "begins as neither a .vdb file");
  refuse<vtkStratusVDBReader>(folder + "/none.vdb", nullptr, "No such file");
  for (const char* name : { "/float.vdb", "/float.nvdb", "/sphere.vdb", "/sphere.nvdb", "/turned.nvdb" }) {
    for (double part : { .02, .3, .7, .999 }) {
      refuse<vtkStratusVDBReader>(cut(folder + name, folder + "/cut.vdb", part), nullptr, "cut.vdb: ");
      reader bricks(folder + "/cut.vdb", nullptr);
      bricks.reader->MapFileOn();
      bricks.read();
      check(bricks.errors->heard.find("cut.vdb: ") != std::string::npos, "bricks of a file that is cut: " + bricks.errors->heard);
    }
  }
}

// Nodes that the file has once, but which are at several places, as if there were many: a small file would take hours.
void test_repeated(const std::string& folder)
{
  const auto grid = openvdb::FloatGrid::create(0.0F);
  grid->tree().setValue(openvdb::Coord(1, 2, 3), 1);
  grid->tree().setValue(openvdb::Coord(5000, 2, 3), 2);
  for (const bool root : { true, false }) {
    auto handle = vdb::to_nano(grid);
    auto* top = reinterpret_cast<nanovdb::RootData<nanovdb::NanoUpper<float>>*>(&handle.grid<float>()->tree().root());
    if (root) {
      top->tile(1)->key = top->tile(0)->key;
    } else {
      auto* upper = reinterpret_cast<nanovdb::NanoUpper<float>::DataType*>(reinterpret_cast<char*>(top) + top->tile(0)->child);
      for (uint32_t n = 1; n < 32768; ++n) {
        upper->mTable[n].child = upper->mTable[0].child;
      }
      upper->mChildMask.setOn();
    }
    nanovdb::io::writeGrid(folder + "/repeated.nvdb", handle);
    refuse<vtkStratusVDBReader>(folder + "/repeated.nvdb", nullptr, root ? "its root has two entries at" : "more nodes than fit in its");
  }
}

// Whatever a byte of a grid becomes, the reader ends, with an image or an error.
void test_damaged(const std::string& folder)
{
  std::ifstream in(folder + "/float.nvdb", std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  int refused = 0, read = 0;
  double sum = 0.0;
  uint64_t random = 1;
  for (int i = 0; i < 300; ++i) {
    std::string text = all;
    for (int change = 0; change < 4; ++change) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      // half of the changes come to the heads, which have the offsets
      const size_t place = static_cast<size_t>(random >> 33) % (change % 2 ? text.size() : std::min<size_t>(text.size(), 1600));
      text[place] = static_cast<char>(random >> 20);
    }
    std::ofstream(folder + "/damaged.nvdb", std::ios::binary) << text;
    reader r(folder + "/damaged.nvdb", nullptr);
    r.reader->SetMemoryLimit(64);
    r.reader->SetMapFile(i % 2);
    r.reader->SetMappedBytesLeast(1);
    r.read();
    ++(r.errors->heard.empty() ? read : refused);
    vtkDataObject* data = r.reader->GetOutputDataObject(0);
    check(!r.errors->heard.empty() || (data && data->GetNumberOfElements(vtkDataObject::POINT) > 0), "neither an error nor an image");
    if (vtkImageData* image = r.reader->GetMapped() ? vtkImageData::SafeDownCast(data) : nullptr) {
      sum += image->GetNumberOfPoints() < 1 << 24 ? image->GetPointData()->GetScalars()->GetRange()[1] : 0.0; // reads all leaves
    }
  }
  std::printf("damaged: %d refused, %d read, %g\n", refused, read, sum);
  check(refused > 30 && read > 30, "of 300 damaged files " + std::to_string(refused) + " are refused, " + std::to_string(read) + " read");
}
} // namespace

int main(int argc, char* argv[])
{
  const std::string folder = argc > 1 ? argv[1] : ".";
  openvdb::initialize();
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF); // pipelines log each error that is expected here
  test_kind<openvdb::FloatGrid, true>(folder, "float", VTK_FLOAT);
  test_kind<openvdb::DoubleGrid>(folder, "double", VTK_DOUBLE);
  test_kind<openvdb::Int32Grid, true>(folder, "int32", VTK_INT);
  test_kind<openvdb::Int64Grid>(folder, "int64", VTK_LONG_LONG);
  test_kind<openvdb::BoolGrid>(folder, "bool", VTK_UNSIGNED_CHAR);
  test_kind<openvdb::Vec3SGrid, true>(folder, "vec3s", VTK_FLOAT);
  test_kind<openvdb::Vec3DGrid>(folder, "vec3d", VTK_DOUBLE);
  test_kind<openvdb::Vec3IGrid>(folder, "vec3i", VTK_INT);
  test_packed<nanovdb::Fp16>(folder, "fp16", 1e-2);
  test_packed<nanovdb::FpN>(folder, "fpn", .5);
  test_half(folder);
  test_level_set(folder);
  test_maps(folder);
  test_several(folder);
  test_memory(folder);
  test_blocks(folder);
  test_pages(folder);
  test_bricks<openvdb::FloatGrid>(folder, "float");
  test_bricks<openvdb::DoubleGrid>(folder, "double");
  test_bricks<openvdb::Int32Grid>(folder, "int32");
  test_bricks<openvdb::Int64Grid>(folder, "int64");
  test_bricks<openvdb::Vec3SGrid>(folder, "vec3s");
  test_bricks<openvdb::BoolGrid>(folder, "bool");
  test_bricks<openvdb::FloatGrid, nanovdb::Fp4>(folder, "fp4");
  test_bricks<openvdb::FloatGrid, nanovdb::Fp8>(folder, "fp8");
  test_bricks<openvdb::FloatGrid, nanovdb::Fp16>(folder, "fp16");
  test_bricks<openvdb::FloatGrid, nanovdb::FpN>(folder, "fpn");
  test_limit(folder);
  test_cut_later(folder);
  test_wrong(folder);
  test_repeated(folder);
  test_damaged(folder);
  return failures ? 1 : 0;
}
