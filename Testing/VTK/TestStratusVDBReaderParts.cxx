// SPDX-License-Identifier: BSD-3-Clause
// Parts of sparse grids that ranks and filters request: values are those of the whole, to the bit, flags of ghosts are VTK's, and ranks
// together read little more of the file than one.
#include "vdb_testing.h"

#include "reading_testing.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPointData.h"
#include "vtkRTAnalyticSource.h"
#include "vtkStratusVDBReader.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>

namespace {

using reader = variable_reader<vtkStratusVDBReader>;

// A shell of noise about a ball, so that many leaves have values of their own. more: it is on both sides of 0, and there are a tile of 128
// voxels a side and a voxel far away; else few nodes are above the leaves.
openvdb::FloatGrid::Ptr make_shell(bool more)
{
  const auto grid = openvdb::FloatGrid::create(-1.0F);
  auto to = grid->getAccessor();
  const int away = more ? 0 : 300;
  uint32_t random = 1;
  for (int x = -60; x <= 60; ++x) {
    for (int y = -60; y <= 60; ++y) {
      for (int z = -60; z <= 60; ++z) {
        const int r = x * x + y * y + z * z;
        random = random * 1664525u + 1013904223u;
        if (r <= 3600 && r >= 1600) {
          to.setValue(openvdb::Coord(x + 5 + away, y + away, z - 7 + away), static_cast<float>(random >> 8) * 1e-7F);
        }
      }
    }
  }
  if (more) {
    grid->tree().addTile(2, openvdb::Coord(0, 128, 0), 0.5F, true);
    to.setValue(openvdb::Coord(-90, 30, 140), 2.0F);
  }
  grid->setName("density");
  grid->setTransform(vdb::turned());
  return grid;
}

struct kind {
  std::string name, file;
  bool map_file;
};

void set(reader& r, const kind& of)
{
  r.reader->SetMapFile(of.map_file);
  r.reader->SetMappedBytesLeast(1);
}

// Counts the values of a part that are not those of the whole image at their places.
vtkIdType count_other(vtkImageData* part, vtkImageData* whole)
{
  vtkDataArray* values = part->GetPointData()->GetScalars();
  vtkIdType wrong = values && values->GetNumberOfTuples() == part->GetNumberOfPoints() ? 0 : 1;
  const int* e = part->GetExtent();
  const auto row = static_cast<size_t>(e[1] - e[0] + 1) * sizeof(float);
  for (int z = e[4]; wrong == 0 && z <= e[5]; ++z) {
    for (int y = e[2]; y <= e[3]; ++y) {
      wrong += std::memcmp(part->GetScalarPointer(e[0], y, z), whole->GetScalarPointer(e[0], y, z), row) == 0 ? 0 : 1;
    }
  }
  return wrong;
}

bool same_flags(vtkDataSetAttributes* one, vtkDataSetAttributes* other)
{
  vtkDataArray *a = one->GetArray(vtkDataSetAttributes::GhostArrayName()), *b = other->GetArray(vtkDataSetAttributes::GhostArrayName());
  return !a || !b ? a == b
                  : a->GetNumberOfValues() == b->GetNumberOfValues() &&
      std::memcmp(a->GetVoidPointer(0), b->GetVoidPointer(0), static_cast<size_t>(a->GetNumberOfValues())) == 0;
}

// Pieces with layers of ghosts, and an extent of a filter.
void test_images(const kind& of, vtkImageData* whole)
{
  for (const auto& [pieces, ghosts] : std::map<int, int>{ { 2, 0 }, { 3, 1 }, { 4, 2 } }) {
    for (int piece = 0; piece < pieces; ++piece) {
      const std::string what = of.name + ", piece " + std::to_string(piece) + " of " + std::to_string(pieces);
      reader r(of.file, nullptr);
      set(r, of);
      vtkNew<vtkRTAnalyticSource> expected; // parts and flags of the pipeline
      const int* e = whole->GetExtent();
      expected->SetWholeExtent(e[0], e[1], e[2], e[3], e[4], e[5]);
      r.reader->UpdatePiece(piece, pieces, ghosts);
      expected->UpdatePiece(piece, pieces, ghosts);
      auto* part = vtkImageData::SafeDownCast(r.reader->GetOutputDataObject(0));
      check(r.errors->heard.empty() && part, what + ": " + r.errors->heard);
      check(bool(r.reader->GetMapped()) == of.map_file, what + ": values are not where they should be");
      check(part && std::equal(part->GetExtent(), part->GetExtent() + 6, expected->GetOutput()->GetExtent()), what + ": another extent");
      check(part && count_other(part, whole) == 0, what + ": values are not those of the whole");
      check(part && same_flags(part->GetPointData(), expected->GetOutput()->GetPointData()) &&
          same_flags(part->GetCellData(), expected->GetOutput()->GetCellData()),
        what + ": flags are not VTK's");
      double place[3], there[3];
      part->GetPoint(0, place);
      whole->TransformIndexToPhysicalPoint(part->GetExtent()[0], part->GetExtent()[2], part->GetExtent()[4], there);
      check(std::equal(place, place + 3, there), what + ": is at another place");
    }
  }
  reader r(of.file, nullptr);
  set(r, of);
  for (const int low : { -20, 7 }) { // one after another
    const int extent[6] = { low, low + 25, -11, 3, 2, 2 };
    r.reader->UpdateExtent(extent);
    auto* part = vtkImageData::SafeDownCast(r.reader->GetOutputDataObject(0));
    check(part && std::equal(extent, extent + 6, part->GetExtent()) && count_other(part, whole) == 0, of.name + ": an extent");
  }
}

// Pieces of blocks: all together have each cell of the blocks once, and the values of the whole.
void test_blocks(const kind& of, vtkImageData* whole)
{
  vtkIdType cells[2] = { 0, 0 };
  double most = 0.0;
  for (const int pieces : { 1, 3 }) {
    for (int piece = 0; piece < pieces; ++piece) {
      reader r(of.file, nullptr);
      r.reader->SetLayout(vtkStratusVDBReader::BLOCKS_LAYOUT);
      r.reader->UpdatePiece(piece, pieces, 1);
      auto* parts = vtkPartitionedDataSet::SafeDownCast(r.reader->GetOutputDataObject(0));
      check(r.errors->heard.empty() && parts && parts->GetNumberOfPartitions() > 0, of.name + ": no blocks: " + r.errors->heard);
      for (unsigned int p = 0; parts && p < parts->GetNumberOfPartitions(); ++p) {
        auto* block = vtkImageData::SafeDownCast(parts->GetPartition(p));
        check(count_other(block, whole) == 0, of.name + ": values of a block are not those of the whole");
        vtkUnsignedCharArray* flags = block->GetCellGhostArray();
        vtkIdType owned = 0;
        for (vtkIdType c = 0; c < block->GetNumberOfCells(); ++c) {
          owned += flags && flags->GetValue(c) & vtkDataSetAttributes::DUPLICATECELL ? 0 : 1;
        }
        check(owned > 0, of.name + ": a block has cells of other ranks only");
        cells[pieces > 1] += owned;
        most = std::max(most, pieces > 1 ? static_cast<double>(block->GetNumberOfCells()) : 0.0);
      }
    }
  }
  check(cells[0] == cells[1] && cells[0] > 0,
    of.name + ": three ranks have " + std::to_string(cells[1]) + " of the " + std::to_string(cells[0]) + " cells of blocks");
}

// Returns the bytes that the process has read from files so far; -1 where the system does not say.
double bytes_read()
{
  std::ifstream file("/proc/self/io");
  std::string word;
  double bytes = -1.0;
  file >> word >> bytes;
  return word == "rchar:" ? bytes : -1.0;
}

void test_bytes(const kind& of)
{
  double all = 0.0, largest = 0.0;
  const auto size = static_cast<double>(std::filesystem::file_size(of.file));
  for (int piece = 0; piece < 4; ++piece) {
    const double before = bytes_read();
    reader r(of.file, nullptr);
    set(r, of);
    r.reader->UpdatePiece(piece, 4, 1);
    vtkDataArray* values = vtkImageData::SafeDownCast(r.reader->GetOutputDataObject(0))->GetPointData()->GetScalars();
    volatile double sum = 0.0; // looks at all
    for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
      sum = sum + values->GetComponent(i, 0);
    }
    const double read = bytes_read() - before;
    all += read;
    largest = std::max(largest, read);
  }
  std::printf("%s: four pieces read %.2f of the file, the largest %.2f\n", of.name.c_str(), all / size, largest / size);
  check(bytes_read() < 0.0 || (largest < 0.5 * size && all < 2.2 * size), of.name + ": pieces read too much");
}
} // namespace

int main(int argc, char* argv[])
{
  const std::string folder = (argc > 1 ? argv[1] : std::string(".")) + "/parts_of_";
  openvdb::initialize();
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  vtkStratusVariableReader::SetMemoryLimit(vtkTypeInt64(1) << 30);
  const auto shell = make_shell(true);
  vdb::write_vdb(folder + "shell.vdb", { shell });
  const auto nano = vdb::to_nano(shell);
  nanovdb::io::writeGrid(folder + "shell.nvdb", nano);
  nanovdb::io::writeGrid(folder + "zip.nvdb", nano, nanovdb::io::Codec::ZIP);
  reader all(folder + "shell.vdb", nullptr);
  all.read();
  auto* whole = vtkImageData::SafeDownCast(all.reader->GetOutputDataObject(0));
  check(all.errors->heard.empty() && whole && whole->GetNumberOfPoints() > 1000000, "the whole: " + all.errors->heard);
  std::vector<kind> kinds = { { ".vdb", folder + "shell.vdb", false }, { ".nvdb", folder + "shell.nvdb", false },
    { "compressed .nvdb", folder + "zip.nvdb", false }, { ".nvdb in its file", folder + "shell.nvdb", true } };
  reader bricks(folder + "shell.nvdb", nullptr);
  set(bricks, kinds.back());
  bricks.read();
  if (!bricks.reader->GetMapped()) { // the system has no pages that stop their readers
    kinds.pop_back();
  }
  for (const kind& of : kinds) {
    test_images(of, whole);
    test_blocks(of, whole);
  }
  const std::string alone = folder + "alone.nvdb"; // the others are compressed or OpenVDB's, which passes over all bytes
  nanovdb::io::writeGrid(alone, vdb::to_nano(make_shell(false)));
  test_bytes({ kinds[1].name, alone, false });
  if (kinds.back().map_file) {
    test_bytes({ kinds.back().name, alone, true });
  }
  return failures ? 1 : 0;
}
