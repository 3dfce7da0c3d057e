// SPDX-License-Identifier: BSD-3-Clause
// Grids of a .nvdb file, by NanoVDB. A file's grid is used in its memory layout, pointers and all, so no node is read before it is known to
// be within the grid's bytes.
#include "vtkStratusSparseGrid.h"

#include <nanovdb/util/IO.h>

#include <exception>
#include <fstream>
#include <new>
#include <type_traits>

namespace {

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
template <class T> struct Traits<nanovdb::Vec3<T>> {
  using Type = T;
  static constexpr int Components = 3;
  static const Type* Get(const nanovdb::Vec3<T>& value) { return &value[0]; }
};

// The bytes of a grid, and its nodes.
class GridBytes
{
public:
  GridBytes(nanovdb::GridHandle<>&& handle, const std::string& name) : Handle(std::move(handle)), Name(name) {}

  // Returns what lies `offset` bytes behind `from`. Fails where that is not within the grid, or not aligned.
  template <class T> const T& At(const void* from, int64_t offset, uint64_t size = sizeof(T)) const
  {
    const int64_t place = reinterpret_cast<const uint8_t*>(from) - this->Handle.data();
    const uint64_t to = static_cast<uint64_t>(place) + static_cast<uint64_t>(offset); // of two's complement, so that -1 is huge
    if (to > this->Handle.size() || size > this->Handle.size() - to || to % NANOVDB_DATA_ALIGNMENT != 0) {
      throw vtkStratusReadError{ this->Name + ": the grid is damaged: a node lies outside of its " + std::to_string(this->Handle.size()) +
        " bytes" };
    }
    return *reinterpret_cast<const T*>(this->Handle.data() + to);
  }
  const uint8_t* Begin() const { return this->Handle.data(); }
  uint64_t Size() const { return this->Handle.size(); }

private:
  nanovdb::GridHandle<> Handle;
  std::string Name;
};

template <class Build> class SparseGrid : public vtkStratusSparseGrid
{
public:
  using Root = nanovdb::RootData<nanovdb::NanoUpper<Build>>;
  using Upper = typename nanovdb::NanoUpper<Build>::DataType;
  using Lower = typename nanovdb::NanoLower<Build>::DataType;
  using Leaf = typename nanovdb::NanoLeaf<Build>::DataType;
  using Tree = typename nanovdb::NanoTree<Build>::DataType;
  using Value = typename nanovdb::NanoLeaf<Build>::ValueType;
  using Component = typename Traits<Value>::Type;

  explicit SparseGrid(GridBytes&& bytes) : Source(std::move(bytes))
  {
    const Tree& tree = this->Source.template At<Tree>(this->Source.Begin(), sizeof(nanovdb::GridData));
    this->Top = &this->Source.template At<Root>(&tree, tree.mNodeOffset[3]);
    this->Type = vtkStratusTypeOf(Component());
    this->Components = Traits<Value>::Components;
    this->Active = tree.mVoxelCount;
    this->Leaves = tree.mNodeCount[0];
    this->Bytes = this->Source.Size();
    this->Empty = this->Active == 0;
    for (int a = 0; a < 3; ++a) {
      this->Low[a] = this->Empty ? 0 : this->Top->mBBox.min()[a];
      this->High[a] = this->Empty ? 0 : this->Top->mBBox.max()[a];
    }
  }

  void Write(void* values, const int64_t low[3], const int64_t high[3]) const override
  {
    vtkStratusDenseBox<Component> box(values, low, high, this->Components);
    box.SetBackground(Traits<Value>::Get(this->Top->mBackground));
    this->Visit([&box](const int64_t first[3], int64_t size) { return !box.Misses(first, size); },
      [&box](const int64_t first[3], int64_t size, const Value& value, bool) { box.SetCube(first, size, Traits<Value>::Get(value)); },
      [&box](const int64_t first[3], const Leaf& leaf) {
        Value value;
        box.Fill(first, 8, [&](int64_t x, int64_t y, int64_t z) {
          value = leaf.getValue(static_cast<uint32_t>((x * 8 + y) * 8 + z));
          return Traits<Value>::Get(value);
        });
      });
  }

  std::vector<vtkStratusCellBox> ListActive() const override
  {
    std::vector<vtkStratusCellBox> boxes;
    this->Visit([](const int64_t*, int64_t) { return true; },
      [&boxes](const int64_t first[3], int64_t size, const Value&, bool active) {
        if (active) {
          boxes.push_back(vtkStratusCellsAt(first, size));
        }
      },
      [&boxes](const int64_t first[3], const Leaf& leaf) {
        if (!leaf.mValueMask.isOff()) {
          boxes.push_back(vtkStratusCellsAt(first, 8));
        }
      });
    return boxes;
  }

private:
  // Where a node's entry lies: entries are counted with z fastest.
  template <class Node> static void Place(const int64_t first[3], uint32_t n, int64_t place[3])
  {
    constexpr uint32_t side = 1u << Node::LOG2DIM;
    const int64_t step = Node::DIM / side;
    place[0] = first[0] + step * static_cast<int64_t>(n / (side * side));
    place[1] = first[1] + step * static_cast<int64_t>(n / side % side);
    place[2] = first[2] + step * static_cast<int64_t>(n % side);
  }

  // Calls tile(first, size, value, active) or leaf(first, leaf) for each of the tree's cubes for which wanted(first, size) and wanted() of
  // all cubes around it return true.
  template <class Wanted, class OnTile, class OnLeaf> void Visit(const Wanted& wanted, const OnTile& tile, const OnLeaf& leaf) const
  {
    this->Source.template At<Root>(this->Top, 0, sizeof(Root) + this->Top->mTableSize * sizeof(typename Root::Tile));
    for (uint32_t n = 0; n < this->Top->mTableSize; ++n) {
      const typename Root::Tile& entry = *this->Top->tile(n);
      const nanovdb::Coord origin = entry.origin();
      const int64_t first[3] = { origin[0], origin[1], origin[2] };
      if (!wanted(first, nanovdb::NanoUpper<Build>::DIM)) {
        continue;
      }
      if (entry.child != 0) {
        const Upper& node = this->Source.template At<Upper>(this->Top, entry.child);
        this->template VisitNode<nanovdb::NanoUpper<Build>, nanovdb::NanoLower<Build>>(
          node, first, wanted, tile, [&](const int64_t place[3], uint64_t child) {
            const Lower& inner = this->Source.template At<Lower>(&node, child);
            this->template VisitNode<nanovdb::NanoLower<Build>, nanovdb::NanoLeaf<Build>>(
              inner, place, wanted, tile, [&](const int64_t at[3], uint64_t last) {
                const Leaf& one = this->Source.template At<Leaf>(&inner, last);
                this->Source.template At<Leaf>(&one, 0, static_cast<uint64_t>(one.memUsage())); // some leaves' size depends on their flags
                leaf(at, one);
              });
          });
      } else {
        tile(first, nanovdb::NanoUpper<Build>::DIM, entry.value, entry.state != 0);
      }
    }
  }

  template <class Node, class Child, class Data, class Wanted, class OnTile, class OnChild>
  static void VisitNode(const Data& node, const int64_t first[3], const Wanted& wanted, const OnTile& tile, const OnChild& child)
  {
    for (uint32_t n = 0; n < Node::SIZE; ++n) {
      int64_t place[3];
      Place<Node>(first, n, place);
      if (!wanted(place, Child::DIM)) {
        continue;
      }
      if (node.mChildMask.isOn(n)) {
        child(place, node.mTable[n].child);
      } else {
        tile(place, Child::DIM, node.mTable[n].value, node.mValueMask.isOn(n));
      }
    }
  }

  GridBytes Source;
  const Root* Top;
};

constexpr struct {
  nanovdb::GridType type;
  const char* name;
  std::unique_ptr<vtkStratusSparseGrid> (*make)(GridBytes&& bytes);
} kinds[] = {
#define KIND(type, build)                                                                                                                  \
  {                                                                                                                                        \
    nanovdb::GridType::type, #type,                                                                                                        \
      [](GridBytes&& bytes) -> std::unique_ptr<vtkStratusSparseGrid> { return std::make_unique<SparseGrid<build>>(std::move(bytes)); }     \
  }
  KIND(Float, float),
  KIND(Double, double),
  KIND(Int16, int16_t),
  KIND(Int32, int32_t),
  KIND(Int64, int64_t),
  KIND(UInt32, uint32_t),
  KIND(Boolean, bool),
  KIND(Vec3f, nanovdb::Vec3f),
  KIND(Vec3d, nanovdb::Vec3d),
  KIND(Fp4, nanovdb::Fp4),
  KIND(Fp8, nanovdb::Fp8),
  KIND(Fp16, nanovdb::Fp16),
  KIND(FpN, nanovdb::FpN),
#undef KIND
};

class File : public vtkStratusSparseFile
{
public:
  explicit File(const std::string& path) : Path(path)
  {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const auto length = static_cast<uint64_t>(std::max<std::streamoff>(file.tellg(), 0));
    this->Guard([&] { this->Grids = nanovdb::io::readGridMetaData(path); });
    uint64_t needed = 0;
    for (const nanovdb::io::GridMetaData& one : this->Grids) {
      needed += one.fileSize;
      if (one.fileSize > length || needed > length) {
        throw vtkStratusReadError{ path + ": the file is cut short: it has " + std::to_string(length) + " bytes, the grid '" +
          one.gridName + "' needs " + std::to_string(one.fileSize) };
      }
      const auto* kind = FindKind(one.gridType);
      this->Entries.push_back({ this->Distinct(one.gridName),
        kind ? kind->name : "type " + std::to_string(static_cast<uint32_t>(one.gridType)), kind != nullptr });
    }
  }

  std::unique_ptr<vtkStratusSparseGrid> Read(const std::string& name) override
  {
    std::unique_ptr<vtkStratusSparseGrid> result;
    size_t number = 0;
    while (number + 1 < this->Entries.size() && this->Entries[number].Name != name) {
      ++number;
    }
    this->Guard([&] {
      GridBytes bytes(nanovdb::io::readGrid(this->Path, number), this->Path);
      const nanovdb::GridData head = bytes.At<nanovdb::GridData>(bytes.Begin(), 0);
      const auto* kind = FindKind(head.mGridType);
      if (head.mMagic != NANOVDB_MAGIC_NUMBER || !kind || head.mGridType != this->Grids[number].gridType) {
        throw vtkStratusReadError{ this->Path + ": the grid '" + name + "' is damaged: its header has another type than the file's" };
      }
      result = kind->make(std::move(bytes));
      for (size_t i = 0; i < 9; ++i) {
        result->Matrix[i] = head.mMap.mMatD[i];
        result->Offset[i % 3] = head.mMap.mVecD[i % 3];
      }
      const auto what = static_cast<uint32_t>(head.mGridClass);
      result->Kind = std::string(what == 1 ? "level set"
                         : what == 2       ? "fog volume"
                         : what == 3       ? "staggered vectors"
                                           : "grid") +
        " of " + kind->name;
    });
    return result;
  }

private:
  static decltype(&kinds[0]) FindKind(nanovdb::GridType type)
  {
    for (const auto& kind : kinds) {
      if (kind.type == type) {
        return &kind;
      }
    }
    return nullptr;
  }

  // "density", the second of that name "density[1]", as OpenVDB counts.
  std::string Distinct(const std::string& name) const
  {
    const std::string plain = name.empty() ? "(unnamed)" : name;
    std::string result = plain;
    for (int n = 1; std::any_of(this->Entries.begin(), this->Entries.end(), [&](const Entry& one) { return one.Name == result; }); ++n) {
      result = plain + "[" + std::to_string(n) + "]";
    }
    return result;
  }

  template <class Work> void Guard(const Work& work) const
  {
    try {
      work();
    } catch (const std::bad_alloc&) { // also of a size that was read from a damaged file
      throw vtkStratusReadError{ this->Path + ": NanoVDB wants more memory than there is: the file is large, cut short or damaged" };
    } catch (const std::exception& error) {
      throw vtkStratusReadError{ this->Path + ": NanoVDB says: " + error.what() };
    }
  }

  std::string Path;
  std::vector<nanovdb::io::GridMetaData> Grids;
};
} // namespace

std::unique_ptr<vtkStratusSparseFile> vtkStratusNanoVDBFile(const std::string& path)
{
  return std::make_unique<File>(path);
}
