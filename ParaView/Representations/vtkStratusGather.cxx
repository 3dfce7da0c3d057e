// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusGather.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkMultiProcessController.h"
#include "vtkOverlappingAMR.h"
#include "vtkPointData.h"
#include "vtkUniformGrid.h"

#include <cstring>
#include <string>
#include <vector>

namespace {

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
  bool IsLeft() const { return this->At < this->All.size(); }

  std::vector<char> All;

private:
  size_t At = 0;
};

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
    std::string name(bytes.Take<size_t>(), ' ');
    bytes.Take(&name[0], name.size());
    array->SetName(name.c_str());
    bytes.Take(array->GetVoidPointer(0), static_cast<size_t>(array->GetNumberOfValues()) * static_cast<size_t>(array->GetDataTypeSize()));
    data->AddArray(array);
  }
}
} // namespace

vtkSmartPointer<vtkOverlappingAMR> stratus::gather(vtkMultiProcessController* ranks, vtkOverlappingAMR* mine)
{
  Bytes own;
  for (unsigned int level = 0; level < mine->GetNumberOfLevels(); ++level) {
    for (unsigned int id = 0; id < mine->GetNumberOfDataSets(level); ++id) {
      vtkUniformGrid* grid = mine->GetDataSet(level, id);
      if (!grid || grid->GetNumberOfPoints() == 0) {
        continue;
      }
      own.Put(level);
      own.Put(id);
      own.Put(grid->GetOrigin(), 3 * sizeof(double));
      own.Put(grid->GetSpacing(), 3 * sizeof(double));
      own.Put(grid->GetExtent(), 6 * sizeof(int));
      PutArrays(grid->GetPointData(), own);
      PutArrays(grid->GetCellData(), own);
    }
  }
  auto all = vtkSmartPointer<vtkOverlappingAMR>::New();
  all->ShallowCopy(mine);
  for (int rank = 0; rank < ranks->GetNumberOfProcesses(); ++rank) {
    const bool sends = rank == ranks->GetLocalProcessId();
    vtkIdType count = sends ? static_cast<vtkIdType>(own.All.size()) : 0;
    ranks->Broadcast(&count, 1, rank);
    Bytes heard;
    heard.All.resize(sends ? 0 : static_cast<size_t>(count));
    if (count > 0) {
      ranks->Broadcast(sends ? own.All.data() : heard.All.data(), count, rank);
    }
    while (heard.IsLeft()) {
      const auto level = heard.Take<unsigned int>(), id = heard.Take<unsigned int>();
      double place[6];
      int extent[6];
      auto grid = vtkSmartPointer<vtkUniformGrid>::New();
      heard.Take(place, sizeof place);
      heard.Take(extent, sizeof extent);
      grid->SetOrigin(place);
      grid->SetSpacing(place + 3);
      grid->SetExtent(extent);
      TakeArrays(heard, grid->GetPointData());
      TakeArrays(heard, grid->GetCellData());
      if (level < all->GetNumberOfLevels() && id < all->GetNumberOfDataSets(level)) {
        all->SetDataSet(level, id, grid);
      }
    }
  }
  return all;
}
