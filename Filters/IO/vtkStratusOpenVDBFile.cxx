// SPDX-License-Identifier: BSD-3-Clause
// Grids of a .vdb file, by OpenVDB. The box of a grid's active voxels is in its head, so that its values are read once it is known which
// are wanted. OpenVDB passes over the leaves that are outside of a box; it reads all nodes above them.
#include "vtkStratusSparseGrid.h"

#include <openvdb/openvdb.h>

#include <exception>
#include <new>
#include <type_traits>

namespace {

// Of a kind of values: the type of a component, how many there are, and where they lie.
template <class V> struct Traits {
  using Type = V;
  static constexpr int Components = 1;
  static const Type* Get(const V& value) { return &value; }
};
template <> struct Traits<bool> {
  using Type = uint8_t;
  static constexpr int Components = 1;
  static const Type* Get(bool value)
  {
    static constexpr uint8_t values[] = { 0, 1 };
    return &values[value ? 1 : 0];
  }
};
template <class T> struct Traits<openvdb::math::Vec3<T>> {
  using Type = T;
  static constexpr int Components = 3;
  static const Type* Get(const openvdb::math::Vec3<T>& value) { return value.asV(); }
};

template <class Grid> class SparseGrid : public vtkStratusSparseGrid
{
public:
  using Value = typename Grid::ValueType;
  using Component = typename Traits<Value>::Type;

  SparseGrid(openvdb::GridBase::ConstPtr owner, const Grid& grid) : Owner(owner), Source(grid)
  {
    this->Type = vtkStratusTypeOf(Component());
    this->Components = Traits<Value>::Components;
  }

  void Write(void* values, const int64_t low[3], const int64_t high[3]) const override
  {
    vtkStratusDenseBox<Component> box(values, low, high, this->Components);
    const auto& tree = this->Source.constTree();
    const Value background = tree.background();
    box.SetBackground(Traits<Value>::Get(background));
    const auto accessor = this->Source.getConstAccessor();
    int64_t first[3]; // of a leaf, or of as many voxels of a tile
    for (first[2] = low[2] & ~int64_t(7); first[2] <= high[2]; first[2] += 8) {
      for (first[1] = low[1] & ~int64_t(7); first[1] <= high[1]; first[1] += 8) {
        for (first[0] = low[0] & ~int64_t(7); first[0] <= high[0]; first[0] += 8) {
          const openvdb::Coord origin(static_cast<int>(first[0]), static_cast<int>(first[1]), static_cast<int>(first[2]));
          Value value;
          if (const auto* leaf = accessor.probeConstLeaf(origin)) {
            box.Fill(first, 8, [&](int64_t x, int64_t y, int64_t z) {
              value = leaf->getValue(static_cast<openvdb::Index>((x * 8 + y) * 8 + z));
              return Traits<Value>::Get(value);
            });
          } else {
            value = accessor.getValue(origin);
            box.SetCube(first, 8, Traits<Value>::Get(value));
          }
        }
      }
    }
  }

  std::vector<vtkStratusCellBox> ListActive() const override
  {
    std::vector<vtkStratusCellBox> boxes;
    const auto& tree = this->Source.constTree();
    auto tile = tree.cbeginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1); // only tiles: leaves follow below
    for (; tile; ++tile) {
      openvdb::CoordBBox place;
      tile.getBoundingBox(place);
      const int64_t first[3] = { place.min().x(), place.min().y(), place.min().z() };
      boxes.push_back(vtkStratusCellsAt(first, static_cast<int64_t>(place.max().x()) - first[0] + 1));
    }
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
      const int64_t first[3] = { leaf->origin().x(), leaf->origin().y(), leaf->origin().z() };
      if (leaf->onVoxelCount() > 0) {
        boxes.push_back(vtkStratusCellsAt(first, 8));
      }
    }
    return boxes;
  }

private:
  openvdb::GridBase::ConstPtr Owner;
  const Grid& Source;
};

// A grid of which only the head was read.
class Head : public vtkStratusSparseGrid
{
public:
  explicit Head(const std::string& path, const std::string& name) : Path(path), Name(name) {}

  void Write(void* values, const int64_t low[3], const int64_t high[3]) const override;
  std::vector<vtkStratusCellBox> ListActive() const override;

private:
  std::string Path, Name;
  mutable std::unique_ptr<vtkStratusSparseGrid> Whole; // once the places of all leaves were wanted
};

class File : public vtkStratusSparseFile
{
public:
  explicit File(const std::string& path) : Path(path), Source(path)
  {
    this->Guard([this] {
      openvdb::initialize();
      this->Source.open(false);
      for (auto name = this->Source.beginName(); name != this->Source.endName(); ++name) {
        const openvdb::GridBase::Ptr head = this->Source.readGridMetadata(name.gridName());
        const bool known = head->apply<Every>([](const auto&) {});
        this->Entries.push_back({ name.gridName(), known ? head->valueType() : head->type(), known });
      }
    });
  }

  // Reads the head, if it says where the active voxels are; else all.
  std::unique_ptr<vtkStratusSparseGrid> Read(const std::string& name) override
  {
    std::unique_ptr<vtkStratusSparseGrid> result;
    this->Guard([&] {
      const openvdb::GridBase::Ptr head = this->Source.readGridMetadata(name);
      const auto low = head->getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MIN),
                 high = head->getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MAX);
      const auto active = head->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT),
                 bytes = head->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_MEM_BYTES);
      if (low && high && active && bytes && active->value() >= 0 && bytes->value() >= 0) {
        result = std::make_unique<Head>(this->Path, name);
        head->apply<Every>([&](const auto& one) {
          using Value = typename std::decay_t<decltype(one)>::ValueType;
          result->Type = vtkStratusTypeOf(typename Traits<Value>::Type());
          result->Components = Traits<Value>::Components;
        });
        openvdb::CoordBBox box;
        if (active->value() > 0) {
          box.reset(openvdb::Coord(low->value()), openvdb::Coord(high->value()));
        }
        result->Active = static_cast<uint64_t>(active->value());
        result->Bytes = static_cast<uint64_t>(bytes->value());
        this->Describe(*head, name, box, *result);
      }
    });
    return result ? std::move(result) : this->ReadAll(name);
  }

  std::unique_ptr<vtkStratusSparseGrid> ReadAll(const std::string& name)
  {
    std::unique_ptr<vtkStratusSparseGrid> result;
    this->Guard([&] { result = this->Take(this->Source.readGrid(name), name); });
    return result;
  }

  // Reads a grid without the leaves that are outside of a box of voxels. The library wants the box in the grid's coordinates.
  std::unique_ptr<vtkStratusSparseGrid> ReadPart(const std::string& name, const int64_t low[3], const int64_t high[3])
  {
    std::unique_ptr<vtkStratusSparseGrid> result;
    this->Guard([&] {
      const auto voxel = [](const int64_t at[3]) { return openvdb::Vec3d(double(at[0]), double(at[1]), double(at[2])); };
      const openvdb::GridBase::Ptr head = this->Source.readGridMetadata(name);
      const openvdb::math::Transform& map = head->transform();
      const openvdb::BBoxd wanted(voxel(low) - 2.0, voxel(high) + 2.0), box = map.indexToWorld(wanted), again = map.worldToIndex(box);
      bool holds = true; // coordinates far from 0 may be too coarse
      for (int a = 0; a < 3; ++a) {
        holds = holds && again.min()[a] <= wanted.min()[a] + 1.0 && again.max()[a] >= wanted.max()[a] - 1.0;
      }
      result = this->Take(holds ? this->Source.readGrid(name, box) : this->Source.readGrid(name), name);
    });
    return result;
  }

private:
  using Every = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid, openvdb::Int64Grid, openvdb::BoolGrid,
    openvdb::Vec3SGrid, openvdb::Vec3DGrid, openvdb::Vec3IGrid>;

  std::unique_ptr<vtkStratusSparseGrid> Take(const openvdb::GridBase::Ptr& grid, const std::string& name) const
  {
    std::unique_ptr<vtkStratusSparseGrid> result;
    grid->apply<Every>([&](const auto& one) { result = std::make_unique<SparseGrid<std::decay_t<decltype(one)>>>(grid, one); });
    result->Active = grid->activeVoxelCount();
    result->Bytes = grid->memUsage();
    this->Describe(*grid, name, grid->evalActiveVoxelBoundingBox(), *result);
    return result;
  }

  void Describe(const openvdb::GridBase& grid, const std::string& name, const openvdb::CoordBBox& box, vtkStratusSparseGrid& to) const
  {
    if (!grid.transform().isLinear()) {
      throw vtkStratusReadError{ this->Path + ": the grid '" + name + "' has a " + grid.transform().mapType() +
        ", whose voxels differ in size; its map must be linear" };
    }
    const openvdb::math::Mat4d map = grid.transform().baseMap()->getAffineMap()->getMat4(); // rows are the images of the axes
    to.Empty = box.empty();
    for (int a = 0; a < 3; ++a) {
      to.Low[a] = to.Empty ? 0 : box.min()[a];
      to.High[a] = to.Empty ? 0 : box.max()[a];
      to.Offset[static_cast<size_t>(a)] = map[3][a];
      for (int b = 0; b < 3; ++b) {
        to.Matrix[static_cast<size_t>(3 * a + b)] = map[b][a];
      }
    }
    to.Kind = (grid.getGridClass() == openvdb::GRID_UNKNOWN ? "grid" : openvdb::GridBase::gridClassToString(grid.getGridClass())) + " of " +
      grid.valueType() + (grid.saveFloatAsHalf() ? ", kept in halves" : "");
  }

  template <class Work> void Guard(const Work& work) const
  {
    try {
      work();
    } catch (const std::bad_alloc&) { // also of a size that was read from a damaged file
      throw vtkStratusReadError{ this->Path + ": OpenVDB wants more memory than there is: the file is large, cut short or damaged" };
    } catch (const std::exception& error) {
      throw vtkStratusReadError{ this->Path + ": OpenVDB says: " + error.what() };
    }
  }

  std::string Path;
  openvdb::io::File Source;
};

void Head::Write(void* values, const int64_t low[3], const int64_t high[3]) const
{
  bool all = true;
  for (int a = 0; a < 3; ++a) {
    all = all && low[a] <= this->Low[a] && high[a] >= this->High[a];
  }
  if (this->Whole) {
    this->Whole->Write(values, low, high);
  } else if (all) {
    File(this->Path).ReadAll(this->Name)->Write(values, low, high);
  } else {
    File(this->Path).ReadPart(this->Name, low, high)->Write(values, low, high);
  }
}

std::vector<vtkStratusCellBox> Head::ListActive() const
{
  if (!this->Whole) {
    this->Whole = File(this->Path).ReadAll(this->Name);
  }
  return this->Whole->ListActive();
}
} // namespace

std::unique_ptr<vtkStratusSparseFile> vtkStratusOpenVDBFile(const std::string& path)
{
  return std::make_unique<File>(path);
}
