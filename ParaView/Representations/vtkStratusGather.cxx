// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusGather.h"

#include "vtkStratusAMRParts.h"
#include "vtkStratusUncut.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkOverlappingAMR.h"
#include "vtkPointData.h"
#include "vtkUniformGrid.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace {
using Parts = vtkStratusAMRParts;

// Bytes that a rank sends to the others, in the order in which they are put.
class Bytes
{
public:
  void Put(const void* from, size_t count)
  {
    const char* bytes = static_cast<const char*>(from);
    this->All.insert(this->All.end(), bytes, bytes + count);
  }
  template <class T> void Put(const T& value) { this->Put(&value, sizeof value); }
  void Take(void* to, size_t count)
  {
    std::memcpy(to, this->All.data() + this->At, count);
    this->At += count;
  }
  template <class T> T Take()
  {
    T value;
    this->Take(&value, sizeof value);
    return value;
  }

  std::vector<char> All;

private:
  size_t At = 0;
};

// Returns which attribute of the data an array is; -1: none.
int attribute_of(vtkDataSetAttributes* data, vtkDataArray* array)
{
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    if (data->GetArray(i) == array) {
      return data->IsArrayAnAttribute(i);
    }
  }
  return -1;
}

void PutArrays(vtkDataSetAttributes* data, Bytes& bytes)
{
  std::vector<vtkDataArray*> arrays;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* array = data->GetArray(i);
    if (array && array->GetName() && array->GetDataType() != VTK_BIT) {
      arrays.push_back(array);
    }
  }
  bytes.Put(static_cast<int>(arrays.size()));
  for (vtkDataArray* array : arrays) {
    const std::string name = array->GetName();
    bytes.Put(array->GetDataType());
    bytes.Put(array->GetNumberOfComponents());
    bytes.Put(array->GetNumberOfTuples());
    bytes.Put(attribute_of(data, array));
    bytes.Put(name.size());
    bytes.Put(name.data(), name.size());
    const auto plain = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(array->GetDataType()));
    if (!array->HasStandardMemoryLayout()) {
      plain->DeepCopy(array);
    }
    bytes.Put((array->HasStandardMemoryLayout() ? array : plain.Get())->GetVoidPointer(0),
      static_cast<size_t>(array->GetNumberOfValues()) * static_cast<size_t>(array->GetDataTypeSize()));
  }
}

void TakeArrays(Bytes& bytes, vtkDataSetAttributes* data)
{
  for (int left = bytes.Take<int>(); left > 0; --left) {
    const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(bytes.Take<int>()));
    array->SetNumberOfComponents(bytes.Take<int>());
    array->SetNumberOfTuples(bytes.Take<vtkIdType>());
    const int attribute = bytes.Take<int>();
    std::string name(bytes.Take<size_t>(), ' ');
    bytes.Take(&name[0], name.size());
    array->SetName(name.c_str());
    bytes.Take(array->GetVoidPointer(0), static_cast<size_t>(array->GetNumberOfValues()) * static_cast<size_t>(array->GetDataTypeSize()));
    data->AddArray(array);
    if (attribute >= 0) {
      data->SetActiveAttribute(array->GetName(), attribute);
    }
  }
}

// A part of a box, in bytes.
void Put(unsigned int level, unsigned int id, vtkUniformGrid* grid, Bytes& bytes)
{
  bytes.Put(level);
  bytes.Put(id);
  bytes.Put(grid->GetOrigin(), 3 * sizeof(double));
  bytes.Put(grid->GetSpacing(), 3 * sizeof(double));
  bytes.Put(grid->GetExtent(), 6 * sizeof(int));
  bytes.Put(vtkStratusGetUncut(grid), 6 * sizeof(int));
  PutArrays(grid->GetPointData(), bytes);
  PutArrays(grid->GetCellData(), bytes);
}

void Take(Bytes& bytes, vtkOverlappingAMR* to)
{
  const auto level = bytes.Take<unsigned int>(), id = bytes.Take<unsigned int>();
  double place[6];
  int extent[6], uncut[6];
  vtkNew<vtkUniformGrid> grid;
  bytes.Take(place, sizeof place);
  bytes.Take(extent, sizeof extent);
  bytes.Take(uncut, sizeof uncut);
  grid->SetOrigin(place);
  grid->SetSpacing(place + 3);
  grid->SetExtent(extent);
  vtkStratusSetUncut(grid, uncut);
  TakeArrays(bytes, grid->GetPointData());
  TakeArrays(bytes, grid->GetCellData());
  if (level < to->GetNumberOfLevels() && id < to->GetNumberOfDataSets(level)) {
    to->SetDataSet(level, id, grid);
  }
}

// Gives the boxes of all ranks, rank after rank. Returns false if the boxes of a rank can't be cut.
bool Share(vtkMultiProcessController* ranks, const std::vector<Parts::Held>& mine, bool good, std::vector<Parts::Box>& all)
{
  constexpr vtkIdType numbers = 7; // of a box
  std::vector<vtkIdType> own, counts(static_cast<size_t>(ranks->GetNumberOfProcesses())), offsets = counts;
  for (const Parts::Held& held : mine) {
    const Parts::Box& box = held.Where;
    const vtkIdType tuple[numbers] = { box.Level, box.Lo[0], box.Lo[1], box.Lo[2], box.Hi[0], box.Hi[1], box.Hi[2] };
    own.insert(own.end(), tuple, tuple + numbers);
  }
  const vtkIdType count = good ? static_cast<vtkIdType>(own.size()) : -1;
  ranks->AllGather(&count, counts.data(), 1);
  if (*std::min_element(counts.begin(), counts.end()) < 0) {
    return false;
  }
  for (size_t rank = 1; rank < counts.size(); ++rank) {
    offsets[rank] = offsets[rank - 1] + counts[rank - 1];
  }
  std::vector<vtkIdType> every(static_cast<size_t>(offsets.back() + counts.back()) + 1); // one more, so that there is a place
  own.push_back(0);
  ranks->AllGatherV(own.data(), every.data(), count, counts.data(), offsets.data());
  for (size_t i = 0; i + numbers < every.size(); i += numbers) {
    const vtkIdType* n = &every[i];
    all.push_back({ static_cast<int>(n[0]), { n[1], n[2], n[3] }, { n[4], n[5], n[6] } });
  }
  return true;
}
} // namespace

vtkSmartPointer<vtkOverlappingAMR> stratus::gather(vtkMultiProcessController* ranks, vtkOverlappingAMR* mine)
{
  constexpr int tag = 74301;
  const int me = ranks->GetLocalProcessId(), count = ranks->GetNumberOfProcesses();
  std::vector<Parts::Held> boxes;
  std::vector<Parts::Box> every;
  Parts::Ratios ratios;
  std::string unused;
  const bool good = Parts::List(mine, boxes) && Parts::FindRatios(mine, ratios, unused);
  const bool cuts = Share(ranks, boxes, good, every); // else all ranks get all, and each reports why nothing is drawn
  auto result = vtkSmartPointer<vtkOverlappingAMR>::New();
  result->CopyStructure(mine);
  result->GetFieldData()->ShallowCopy(mine->GetFieldData());
  if (cuts) {
    Parts::SetAll(result, every);
  }
  // The parts of this rank's boxes that another needs.
  const auto parts_for = [&](int rank) {
    std::vector<std::pair<const Parts::Held*, Parts::Box>> parts;
    Parts::Place lo, hi, cell;
    const bool any = !cuts || Parts::FindPiece(ratios, every, rank, count, lo, hi, cell);
    for (const Parts::Held& box : boxes) {
      Parts::Box part = box.Where;
      if (any && (!cuts || Parts::FindNeeded(ratios, box.Where, lo, hi, cell, part))) {
        parts.emplace_back(&box, part);
      }
    }
    return parts;
  };
  for (const auto& [box, part] : parts_for(me)) {
    result->SetDataSet(box->Level, box->Id, Parts::Cut(*box, part));
  }
  for (int from = 0; from < count; ++from) {
    for (int to = 0; to < count; ++to) {
      if (from == to || (from != me && to != me)) {
        continue;
      }
      const auto parts = from == me ? parts_for(to) : decltype(parts_for(to))();
      auto left = static_cast<vtkIdType>(parts.size());
      from == me ? ranks->Send(&left, 1, to, tag) : ranks->Receive(&left, 1, from, tag);
      for (vtkIdType i = 0; i < left; ++i) { // one after another, which needs little memory
        Bytes bytes;
        if (from == me) {
          const auto& [box, part] = parts[static_cast<size_t>(i)];
          Put(box->Level, box->Id, Parts::Cut(*box, part), bytes);
        }
        auto size = static_cast<vtkIdType>(bytes.All.size());
        from == me ? ranks->Send(&size, 1, to, tag) : ranks->Receive(&size, 1, from, tag);
        bytes.All.resize(static_cast<size_t>(size));
        from == me ? ranks->Send(bytes.All.data(), size, to, tag) : ranks->Receive(bytes.All.data(), size, from, tag);
        if (to == me) {
          Take(bytes, result);
        }
      }
    }
  }
  return result;
}
