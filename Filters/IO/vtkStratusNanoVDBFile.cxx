// SPDX-License-Identifier: BSD-3-Clause
// Grids of a .nvdb file, by NanoVDB. A file's grid is used in its memory layout, pointers and all, so no node is read before it is known to
// be within the grid's bytes. Of a grid that is not compressed, leaves can stay in the file: they come behind all other nodes, and are most
// of the grid. They are copied to where they are read from, because NanoVDB's alignment holds from the grid's first byte, not the file's.
#include "vtkStratusOpenFile.h"
#include "vtkStratusSparseGrid.h"

#include <nanovdb/util/IO.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <limits>
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

// The bytes of a grid, and its nodes: all bytes, or those before the leaves, which stay in the file.
class GridBytes
{
public:
  GridBytes(nanovdb::GridHandle<>&& handle, const std::string& name)
      : Held(std::move(handle.buffer())), Length(this->Held.size()), Name(name)
  {
  }
  // Reads the first `held` bytes of the grid of `length` bytes at `begin` of the file.
  GridBytes(std::shared_ptr<const vtkStratusOpenFile> file, uint64_t begin, uint64_t held, uint64_t length, const std::string& name)
      : Held(nanovdb::HostBuffer::create(held)), File(std::move(file)), FileBegin(begin), Length(length), Name(name)
  {
    if (!this->Held.data()) {
      throw std::bad_alloc();
    }
    this->Load(0, this->Held.data(), held);
  }

  // Returns what lies `offset` bytes behind `from`. Fails where that is not within the bytes that are held, or not aligned.
  template <class T> const T& At(const void* from, int64_t offset, uint64_t size = sizeof(T)) const
  {
    return *reinterpret_cast<const T*>(this->Begin() + this->Find(from, offset, size, this->Size()));
  }

  // A place that a leaf is read to, with the codes that follow leaves of FpN: at most 128 bits for each of 512 values.
  template <class Leaf> struct alignas(NANOVDB_DATA_ALIGNMENT) Room {
    uint8_t Bytes[sizeof(Leaf) + (Leaf::FIXED_SIZE ? 0 : 8192)];
  };
  // Returns a leaf, as At() does, from the room where leaves stay in the file.
  template <class Leaf> const Leaf& LeafAt(const void* from, int64_t offset, Room<Leaf>& room) const
  {
    if (!this->File) {
      const Leaf& one = this->At<Leaf>(from, offset);
      return this->At<Leaf>(&one, 0, static_cast<uint64_t>(one.memUsage())); // some leaves' size depends on their flags
    }
    const uint64_t place = this->Find(from, offset, sizeof(Leaf), this->Length);
    this->Load(place, room.Bytes, sizeof(Leaf));
    const Leaf& one = *reinterpret_cast<const Leaf*>(room.Bytes);
    const uint64_t all = static_cast<uint64_t>(one.memUsage());
    if (all > sizeof(Leaf)) {
      this->Find(from, offset, all, all <= sizeof room.Bytes ? this->Length : 0);
      this->Load(place + sizeof(Leaf), room.Bytes + sizeof(Leaf), all - sizeof(Leaf));
    }
    return one;
  }
  // Fails where there can be no leaf.
  template <class Leaf> void CheckLeaf(const void* from, int64_t offset) const { this->Find(from, offset, sizeof(Leaf), this->Length); }

  // Fails where so many nodes of a size take more bytes than there are: some of them are one node at several places.
  void CheckCount(uint64_t nodes, uint64_t size) const
  {
    if (nodes > this->Length / size) {
      throw vtkStratusReadError{ this->Name + ": the grid is damaged: it has more nodes than fit in its " + std::to_string(this->Length) +
        " bytes" };
    }
  }

  const uint8_t* Begin() const { return this->Held.data(); }
  uint64_t Size() const { return this->Held.size(); }
  uint64_t SizeOfAll() const { return this->Length; }
  bool LeavesStay() const { return this->File != nullptr; }
  const std::string& GetName() const { return this->Name; }

private:
  // Returns where `size` bytes are among the bytes of the grid, of which there are `end`.
  uint64_t Find(const void* from, int64_t offset, uint64_t size, uint64_t end) const
  {
    const int64_t place = reinterpret_cast<const uint8_t*>(from) - this->Begin();
    const uint64_t to = static_cast<uint64_t>(place) + static_cast<uint64_t>(offset); // of two's complement, so that -1 is huge
    if (to > end || size > end - to || to % NANOVDB_DATA_ALIGNMENT != 0) {
      throw vtkStratusReadError{ this->Name + ": the grid is damaged: a node lies outside of its " + std::to_string(end) + " bytes" };
    }
    return to;
  }

  void Load(uint64_t place, uint8_t* to, uint64_t bytes) const
  {
    if (!this->File->Read(static_cast<int64_t>(this->FileBegin + place), to, static_cast<size_t>(bytes))) {
      throw vtkStratusReadError{ this->Name + ": a node at byte " + std::to_string(this->FileBegin + place) +
        " cannot be read: the file is cut short, or the disk fails" };
    }
  }

  nanovdb::HostBuffer Held;
  std::shared_ptr<const vtkStratusOpenFile> File; // null: all bytes are held
  uint64_t FileBegin = 0, Length;
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
    this->CheckRoot();
    this->Type = vtkStratusTypeOf(Component());
    this->Components = Traits<Value>::Components;
    this->Active = tree.mVoxelCount;
    this->Bytes = this->Source.SizeOfAll();
    this->InFile = this->Source.LeavesStay();
    this->Empty = this->Active == 0;
    for (int a = 0; a < 3; ++a) {
      this->Low[a] = this->Empty ? 0 : this->Top->mBBox.min()[a];
      this->High[a] = this->Empty ? 0 : this->Top->mBBox.max()[a];
    }
    if (this->InFile) { // an image of a damaged grid is an error now, not once something looks at it
      const auto& low = this->Low;
      const auto& high = this->High;
      this->Visit(
        { { low[0] - 1, low[1] - 1, low[2] - 1 }, { high[0] + 1, high[1] + 1, high[2] + 1 } },
        [](const int64_t*, int64_t, const Value&, bool) {},
        [this](const int64_t*, const Lower& inner, int64_t child) { this->Source.template CheckLeaf<Leaf>(&inner, child); });
    }
  }

  void Write(void* values, const int64_t low[3], const int64_t high[3]) const override
  {
    vtkStratusDenseBox<Component> box(values, low, high, this->Components);
    box.SetBackground(Traits<Value>::Get(this->Top->mBackground));
    this->Visit(
      { { low[0], low[1], low[2] }, { high[0], high[1], high[2] } },
      [&box](const int64_t first[3], int64_t size, const Value& value, bool) { box.SetCube(first, size, Traits<Value>::Get(value)); },
      [this, &box](const int64_t first[3], const Lower& inner, int64_t child) {
        GridBytes::Room<Leaf> room;
        const Leaf& leaf = this->Source.LeafAt(&inner, child, room);
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
    this->Visit(
      Cube::All(),
      [&boxes](const int64_t first[3], int64_t size, const Value&, bool active) {
        if (active) {
          boxes.push_back(vtkStratusCellsAt(first, size));
        }
      },
      [this, &boxes](const int64_t first[3], const Lower& inner, int64_t child) {
        GridBytes::Room<Leaf> room;
        if (!this->Source.LeafAt(&inner, child, room).mValueMask.isOff()) {
          boxes.push_back(vtkStratusCellsAt(first, 8));
        }
      });
    return boxes;
  }

  std::vector<float> ListOnly(const int64_t low[3], const int64_t high[3], int64_t side) const override
  {
    std::vector<float> only;
    if constexpr (std::is_same_v<Component, float> || sizeof(Component) <= 2) {
      if (this->Components > 1) {
        return only;
      }
      int64_t across[3];
      for (int a = 0; a < 3; ++a) {
        across[a] = (high[a] & -side) / side - (low[a] & -side) / side + 1;
      }
      // A cube's voxels: `one` where it has whole bricks of the box, and unknown where it has a part of one.
      const auto set = [&](const int64_t first[3], int64_t size, float one) {
        int64_t from[3], to[3], i[3];
        for (int a = 0; a < 3; ++a) {
          from[a] = std::max((first[a] & -side) - (low[a] & -side), int64_t(0)) / side;
          to[a] = std::min(((first[a] + size - 1) & -side) - (low[a] & -side), (across[a] - 1) * side) / side;
        }
        for (i[2] = from[2]; i[2] <= to[2]; ++i[2]) {
          for (i[1] = from[1]; i[1] <= to[1]; ++i[1]) {
            for (i[0] = from[0]; i[0] <= to[0]; ++i[0]) {
              bool whole = true;
              for (int a = 0; a < 3; ++a) {
                const int64_t begin = (low[a] & -side) + i[a] * side;
                whole = whole && first[a] <= std::max(begin, low[a]) && first[a] + size > std::min(begin + side - 1, high[a]);
              }
              only[static_cast<size_t>((i[2] * across[1] + i[1]) * across[0] + i[0])] =
                whole ? one : std::numeric_limits<float>::quiet_NaN();
            }
          }
        }
      };
      const Component background = *Traits<Value>::Get(this->Top->mBackground);
      only.resize(static_cast<size_t>(across[0] * across[1] * across[2]),
        std::isfinite(static_cast<float>(background)) ? static_cast<float>(background) + 0.0F
                                                      : NAN); // of zeros, Write() leaves the memory's
      this->Visit(
        { { low[0], low[1], low[2] }, { high[0], high[1], high[2] } },
        [&](const int64_t first[3], int64_t size, const Value& value, bool) {
          const Component one = *Traits<Value>::Get(value);
          const auto number = static_cast<float>(one);
          if (!(one == background)) {
            set(first, size, std::isfinite(number) && !(number == 0.0F && std::signbit(number)) ? number : NAN);
          }
        },
        [&](const int64_t first[3], const Lower&, int64_t) { set(first, 8, NAN); });
    }
    return only;
  }

private:
  // Fails where the root's entries are not within the bytes, or two of them are at one place.
  void CheckRoot() const
  {
    const Root& root = this->Source.template At<Root>(this->Top, 0, sizeof(Root) + this->Top->mTableSize * sizeof(typename Root::Tile));
    std::vector<nanovdb::Coord> places;
    for (uint32_t n = 0; n < root.mTableSize; ++n) {
      places.push_back(root.tile(n)->origin());
    }
    std::sort(places.begin(), places.end());
    const auto twice = std::adjacent_find(places.begin(), places.end());
    if (twice != places.end()) {
      throw vtkStratusReadError{ this->Source.GetName() + ": the grid is damaged: its root has two entries at " +
        std::to_string((*twice)[0]) + ", " + std::to_string((*twice)[1]) + ", " + std::to_string((*twice)[2]) };
    }
  }

  // Voxels, ends included.
  struct Cube {
    int64_t Low[3], High[3];

    static Cube All()
    {
      constexpr int64_t least = std::numeric_limits<int32_t>::min(), most = std::numeric_limits<int32_t>::max();
      return { { least, least, least }, { most, most, most } };
    }
    // Whether none of the voxels of a node at `first` is in the cube.
    bool Misses(const int64_t first[3], int64_t size) const
    {
      bool misses = false;
      for (int a = 0; a < 3; ++a) {
        misses = misses || first[a] > this->High[a] || first[a] + size <= this->Low[a];
      }
      return misses;
    }
  };

  // Calls tile(first, size, value, active) or leaf(first, inner, child) for each of the tree's tiles and leaves that has voxels in the
  // cube; a leaf is `child` bytes behind its lower node `inner`.
  template <class OnTile, class OnLeaf> void Visit(const Cube& cube, const OnTile& tile, const OnLeaf& leaf) const
  {
    uint64_t inners = 0, leaves = 0;
    for (uint32_t n = 0; n < this->Top->mTableSize; ++n) {
      const typename Root::Tile& entry = *this->Top->tile(n);
      const nanovdb::Coord origin = entry.origin();
      const int64_t first[3] = { origin[0], origin[1], origin[2] };
      if (cube.Misses(first, nanovdb::NanoUpper<Build>::DIM)) {
        continue;
      }
      if (entry.child != 0) {
        const Upper& node = this->Source.template At<Upper>(this->Top, entry.child);
        VisitNode<nanovdb::NanoUpper<Build>, nanovdb::NanoLower<Build>>(
          node, first, cube, tile, [&](const int64_t place[3], int64_t child) {
            const Lower& inner = this->Source.template At<Lower>(&node, child);
            this->Source.CheckCount(++inners, sizeof(Lower));
            VisitNode<nanovdb::NanoLower<Build>, nanovdb::NanoLeaf<Build>>(
              inner, place, cube, tile, [&](const int64_t at[3], int64_t last) {
                this->Source.CheckCount(++leaves, sizeof(Leaf));
                leaf(at, inner, last);
              });
          });
      } else {
        tile(first, nanovdb::NanoUpper<Build>::DIM, entry.value, entry.state != 0);
      }
    }
  }

  // Visits the entries of a node that has voxels in the cube. Entries are counted with z fastest.
  template <class Node, class Child, class Data, class OnTile, class OnChild>
  static void VisitNode(const Data& node, const int64_t first[3], const Cube& cube, const OnTile& tile, const OnChild& child)
  {
    constexpr int64_t side = int64_t(1) << Node::LOG2DIM, step = Child::DIM;
    int64_t from[3], to[3], i[3];
    for (int a = 0; a < 3; ++a) {
      from[a] = std::max<int64_t>(cube.Low[a] - first[a], 0) / step;
      to[a] = std::min((cube.High[a] - first[a]) / step, side - 1);
    }
    for (i[0] = from[0]; i[0] <= to[0]; ++i[0]) {
      for (i[1] = from[1]; i[1] <= to[1]; ++i[1]) {
        for (i[2] = from[2]; i[2] <= to[2]; ++i[2]) {
          const auto n = static_cast<uint32_t>((i[0] * side + i[1]) * side + i[2]);
          const int64_t place[3] = { first[0] + step * i[0], first[1] + step * i[1], first[2] + step * i[2] };
          if (node.mChildMask.isOn(n)) {
            child(place, node.mTable[n].child);
          } else {
            tile(place, step, node.mTable[n].value, node.mValueMask.isOn(n));
          }
        }
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

// Reads what comes before the leaves of a grid that is not compressed. Null where that is not possible: there is no leaf, or it is not
// behind all other nodes.
std::unique_ptr<GridBytes> LeaveLeaves(const std::string& path, uint64_t begin, uint64_t length)
{
  constexpr uint64_t heads = sizeof(nanovdb::GridData) + sizeof(nanovdb::TreeData<>);
  const auto file = std::make_shared<const vtkStratusOpenFile>(path);
  if (!file->IsOpen() || length <= heads) {
    return nullptr;
  }
  const GridBytes first(file, begin, heads, length, path);
  const auto& tree = first.At<nanovdb::TreeData<>>(first.Begin(), sizeof(nanovdb::GridData));
  const uint64_t leaves = tree.mNodeOffset[0];
  bool last = tree.mNodeCount[0] > 0 && leaves < length - sizeof(nanovdb::GridData);
  for (int level = 1; level < 4; ++level) {
    last = last && tree.mNodeOffset[level] < leaves;
  }
  return last ? std::make_unique<GridBytes>(file, begin, sizeof(nanovdb::GridData) + leaves, length, path) : nullptr;
}

class File : public vtkStratusSparseFile
{
public:
  explicit File(const std::string& path) : Path(path)
  {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const auto length = static_cast<uint64_t>(std::max<std::streamoff>(file.tellg(), 0));
    this->Guard([&] { this->FindGrids(); });
    uint64_t needed = 0;
    for (const Place& place : this->Grids) {
      const nanovdb::io::GridMetaData& one = place.Head;
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
    const Place& place = this->Grids[number];
    this->Guard([&] {
      if (place.Codec == nanovdb::io::Codec::NONE && place.Head.fileSize == place.Head.gridSize) {
        try {
          std::unique_ptr<GridBytes> bytes = LeaveLeaves(this->Path, place.Begin, place.Head.gridSize);
          result = bytes ? this->Make(std::move(*bytes), number) : nullptr;
        } catch (const vtkStratusReadError&) { // reading all of it gives the error, if it is one
        }
      }
      if (!result) {
        result = this->Make(GridBytes(nanovdb::io::readGrid(this->Path, number), this->Path), number);
      }
    });
    return result;
  }

private:
  struct Place {
    nanovdb::io::GridMetaData Head;
    nanovdb::io::Codec Codec;
    uint64_t Begin; // in the file
  };

  void FindGrids()
  {
    std::ifstream file(this->Path, std::ios::binary);
    nanovdb::io::Segment segment;
    while (segment.read(file)) {
      uint64_t at = static_cast<uint64_t>(static_cast<std::streamoff>(file.tellg()));
      for (const nanovdb::io::GridMetaData& one : segment.meta) {
        this->Grids.push_back({ one, segment.header.codec, at });
        at += one.fileSize;
      }
      file.seekg(static_cast<std::streamoff>(at));
    }
  }

  std::unique_ptr<vtkStratusSparseGrid> Make(GridBytes&& bytes, size_t number) const
  {
    const nanovdb::GridData head = bytes.At<nanovdb::GridData>(bytes.Begin(), 0);
    const auto* kind = FindKind(head.mGridType);
    if (head.mMagic != NANOVDB_MAGIC_NUMBER || !kind || head.mGridType != this->Grids[number].Head.gridType) {
      throw vtkStratusReadError{ this->Path + ": the grid '" + this->Entries[number].Name +
        "' is damaged: its header has another type than the file's" };
    }
    std::unique_ptr<vtkStratusSparseGrid> result = kind->make(std::move(bytes));
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
    return result;
  }

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
  std::vector<Place> Grids;
};
} // namespace

std::unique_ptr<vtkStratusSparseFile> vtkStratusNanoVDBFile(const std::string& path)
{
  return std::make_unique<File>(path);
}
