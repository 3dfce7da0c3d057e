// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusBricks.h"

#include "stratus/bricks.h"
#include "stratus/skipping.h"

#include "vtkStratusCoreType.h"
#include "vtkStratusIdentity.h"
#include "vtkStratusMapped.h"

#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkShortArray.h"
#include "vtkSignedCharArray.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnsignedShortArray.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace {

// The pool of the process. It stays until the process ends, because arrays may.
struct Pool {
  stratus_context* Context = nullptr;
  stratus_brick_pool* Bricks = nullptr;
  bool HasMemory = false; // the limit was set
  std::mutex Lock;        // of the map, and of the context
  std::map<void*, stratus_bricks*> Arrays;

  Pool()
  {
    stratus_context_options options = stratus_context_options_default();
    options.device = "host";
    if (stratus_context_create(&options, &this->Context, nullptr, 0) == STRATUS_OK) {
      stratus_brick_pool_options memory = stratus_brick_pool_options_default();
      memory.whole_process = 1;
      stratus_brick_pool_create(this->Context, &memory, &this->Bricks);
    }
  }

  stratus_brick_pool_report Report()
  {
    stratus_brick_pool_report report = {};
    stratus_brick_pool_get_report(this->Bricks, &report);
    return report;
  }
};

Pool& ThePool()
{
  static Pool* const pool = new Pool;
  return *pool;
}

int ReadBox(void* user, const int64_t lo[3], const int64_t size[3], void* values)
{
  const vtkStratusBrickSource& source = *static_cast<const vtkStratusBrickSource*>(user);
  const int64_t components = source.Components; // which the core sees as more values along x
  const int64_t first[3] = { lo[0] / components, lo[1], lo[2] }, count[3] = { size[0] / components, size[1], size[2] };
  return source.Read(first, count, values) ? 0 : 1;
}

void Release(void* user)
{
  delete static_cast<vtkStratusBrickSource*>(user);
}

// Frees the values of an array that is deleted.
void Free(void* values)
{
  Pool& pool = ThePool();
  stratus_bricks* bricks = nullptr;
  {
    const std::lock_guard<std::mutex> lock(pool.Lock);
    const auto found = pool.Arrays.find(values);
    if (found != pool.Arrays.end()) {
      bricks = found->second;
      pool.Arrays.erase(found);
    }
  }
  stratus_bricks_destroy(bricks); // a source may take a lock of its own, with which others make arrays
}

// Finds the range of an array's finite values by the core, which reads each part once, or knows the ranges of the file. Returns false where
// the array has other values now, and where not all of them are finite but all count. The pool's context has a lock, which a source that
// reads may need itself: this makes another context.
bool FindRange(vtkDataArray* array, const std::array<int64_t, 3>& dimensions, bool finite, double range[2])
{
  stratus_volume volume = stratus_volume_default();
  volume.values = array->GetVoidPointer(0);
  std::copy(dimensions.begin(), dimensions.end(), volume.dimensions);
  const bool known = vtkStratusCoreType(array->GetDataType(), volume.type);
  vtkStratusSetSource(array, 0, volume);
  stratus_context* context = nullptr;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  stratus_value_range* ranges = nullptr;
  if (!known || !volume.parts || stratus_context_create(&options, &context, nullptr, 0) != STRATUS_OK) {
    return false;
  }
  bool found = stratus_value_range_create(context, &volume, 0, &ranges) == STRATUS_OK;
  int64_t blocks[3] = { 0, 0, 0 };
  stratus_value_range_blocks(ranges, blocks, nullptr);
  for (int64_t b = 0; found && !finite && b < blocks[0] * blocks[1] * blocks[2]; ++b) {
    int gaps = 0;
    stratus_value_range_block(ranges, b % blocks[0], b / blocks[0] % blocks[1], b / blocks[0] / blocks[1], nullptr, nullptr, &gaps);
    found = gaps == 0;
  }
  found = found && stratus_value_range_whole(ranges, &range[0], &range[1]) == STRATUS_OK;
  stratus_value_range_destroy(ranges);
  stratus_context_destroy(context);
  return found;
}

// An array of bricks, of one component. VTK and ParaView ask arrays for their range before anything is drawn, and would read all values,
// one by one. Copies are plain arrays.
template <class Base> class BrickArray : public Base
{
public:
  static vtkDataArray* New(const std::array<int64_t, 3>& dimensions)
  {
    auto* const array = new BrickArray;
    array->InitializeObjectBase();
    array->Dimensions = dimensions;
    return array;
  }

protected:
  using Base::ComputeFiniteScalarRange;
  using Base::ComputeScalarRange;
  bool ComputeScalarRange(double* range) override
  {
    return FindRange(this, this->Dimensions, false, range) || Base::ComputeScalarRange(range);
  }
  bool ComputeFiniteScalarRange(double* range) override
  {
    return FindRange(this, this->Dimensions, true, range) || Base::ComputeFiniteScalarRange(range);
  }

private:
  std::array<int64_t, 3> Dimensions = { { 0, 0, 0 } };
};

// Makes an array whose values the core has as they are. Ranges of others are VTK's.
vtkDataArray* NewArray(const vtkStratusBrickSource& source)
{
  switch (source.Components == 1 ? source.Type : VTK_VOID) {
    case VTK_FLOAT:
      return BrickArray<vtkFloatArray>::New(source.Dimensions);
    case VTK_CHAR:
      return BrickArray<vtkCharArray>::New(source.Dimensions);
    case VTK_SIGNED_CHAR:
      return BrickArray<vtkSignedCharArray>::New(source.Dimensions);
    case VTK_UNSIGNED_CHAR:
      return BrickArray<vtkUnsignedCharArray>::New(source.Dimensions);
    case VTK_SHORT:
      return BrickArray<vtkShortArray>::New(source.Dimensions);
    case VTK_UNSIGNED_SHORT:
      return BrickArray<vtkUnsignedShortArray>::New(source.Dimensions);
    default:
      return vtkDataArray::CreateDataArray(source.Type);
  }
}
} // namespace

void vtkStratusCutSource(vtkStratusBrickSource& source, const std::array<int64_t, 3>& lo, const std::array<int64_t, 3>& size)
{
  if (size == source.Dimensions) {
    return;
  }
  std::vector<uint64_t> numbers(lo.begin(), lo.end());
  numbers.insert(numbers.end(), size.begin(), size.end());
  source.Identity = vtkStratusIdentityOfPart(source.Identity, "", numbers);
  source.Dimensions = size;
  source.Only.clear();
  for (size_t a = 0; a < 3; ++a) {
    source.Before[a] = (source.Before[a] + lo[a]) % source.Brick[a];
  }
  source.Read = [lo, read = source.Read](const int64_t from[3], const int64_t count[3], void* values) {
    const int64_t first[3] = { lo[0] + from[0], lo[1] + from[1], lo[2] + from[2] };
    return read(first, count, values);
  };
}

bool vtkStratusHasBricks()
{
  return ThePool().Bricks && ThePool().Report().paged;
}

vtkSmartPointer<vtkDataArray> vtkStratusMakeBricks(const vtkStratusBrickSource& source)
{
  Pool& pool = ThePool();
  stratus_brick_source core = {};
  if (!vtkStratusHasBricks() || !vtkStratusCoreType(source.Type, core.type)) {
    return nullptr;
  }
  for (int a = 0; a < 3; ++a) {
    core.dimensions[a] = source.Dimensions[a] * (a == 0 ? source.Components : 1);
    core.brick[a] = source.Brick[a] * (a == 0 ? source.Components : 1);
    core.before[a] = source.Before[a] * (a == 0 ? source.Components : 1);
  }
  core.components = source.Components;
  core.identity = source.Identity;
  core.only = source.Only.empty() ? nullptr : source.Only.data();
  core.read = &ReadBox;
  core.release = &Release;
  auto* const user = new vtkStratusBrickSource(source);
  user->Only.clear(); // which the core copies
  user->Only.shrink_to_fit();
  core.user = user;
  stratus_bricks* bricks = nullptr;
  const std::lock_guard<std::mutex> lock(pool.Lock);
  if (stratus_bricks_create(pool.Context, pool.Bricks, &core, &bricks) != STRATUS_OK) {
    return nullptr;
  }
  void* const values = const_cast<void*>(stratus_bricks_values(bricks));
  pool.Arrays[values] = bricks;
  auto array = vtkSmartPointer<vtkDataArray>::Take(NewArray(source));
  array->SetName(source.Name.c_str());
  array->SetNumberOfComponents(source.Components);
  array->SetVoidArray(
    values, core.dimensions[0] * core.dimensions[1] * core.dimensions[2], 0, vtkAbstractArray::VTK_DATA_ARRAY_USER_DEFINED);
  array->SetArrayFreeFunction(&Free);
  vtkStratusSetMapped(array, source.Identity, stratus_bricks_missing(bricks), stratus_bricks_reads(bricks), stratus_bricks_tiles(bricks),
    stratus_bricks_parts(bricks));
  return array;
}

void vtkStratusReadAhead(vtkDataArray* array, vtkDataArray* like)
{
  Pool& pool = ThePool();
  const std::lock_guard<std::mutex> lock(pool.Lock);
  const auto found = pool.Arrays.find(array->GetVoidPointer(0));
  const auto other = like ? pool.Arrays.find(like->GetVoidPointer(0)) : pool.Arrays.end();
  if (found != pool.Arrays.end() && found != other) {
    stratus_bricks_read_ahead(found->second, other == pool.Arrays.end() ? nullptr : other->second);
  }
}

void vtkStratusSetBrickMemory(vtkTypeInt64 bytes)
{
  ThePool().HasMemory = bytes > 0;
  stratus_brick_pool_set_memory(ThePool().Bricks, static_cast<uint64_t>(std::max<vtkTypeInt64>(bytes, 0)));
}

bool vtkStratusHasBrickMemory()
{
  return ThePool().HasMemory;
}

vtkTypeInt64 vtkStratusGetBrickMemory()
{
  return static_cast<vtkTypeInt64>(ThePool().Report().memory);
}

vtkTypeInt64 vtkStratusGetBrickMemoryUsed()
{
  return static_cast<vtkTypeInt64>(ThePool().Report().resident);
}

vtkTypeInt64 vtkStratusGetBrickBytesRead()
{
  return static_cast<vtkTypeInt64>(ThePool().Report().bytes_read);
}
