// SPDX-License-Identifier: BSD-3-Clause
// Devices of the filters and of the visibility order. A device that does not exist is refused and changes nothing, every other device gives
// equal bytes, and the report lists the stages of the last output.
#include "vtkStratusDistanceMapFilter.h"
#include "vtkStratusHybridTreeFilter.h"
#include "vtkStratusPartitionFilter.h"
#include "vtkStratusVisibilitySort.h"

#include "tetrahedra_testing.h"

#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <cstring>

namespace {
using Bytes = std::vector<unsigned char>;
using Names = std::vector<std::string>;

void Append(vtkDataArray* array, Bytes& bytes)
{
  if (array) {
    const auto* begin = static_cast<const unsigned char*>(array->GetVoidPointer(0));
    bytes.insert(bytes.end(), begin, begin + array->GetDataTypeSize() * array->GetNumberOfValues());
  }
}

// Returns a filter's output as bytes.
Bytes Output(vtkStratusHybridTreeFilter* filter)
{
  Bytes bytes;
  Append(vtkDataArray::SafeDownCast(filter->GetOutput()->GetFieldData()->GetAbstractArray("StratusHybridTree")), bytes);
  if (filter->GetBoxes()->GetPoints()) {
    Append(filter->GetBoxes()->GetPoints()->GetData(), bytes);
  }
  return bytes;
}

Bytes Output(vtkStratusDistanceMapFilter* filter)
{
  Bytes bytes;
  Append(filter->GetOutput()->GetCellData()->GetArray("Distance"), bytes);
  return bytes;
}

Bytes Output(vtkStratusPartitionFilter* filter)
{
  Bytes bytes;
  if (filter->GetOutput()->GetPoints()) {
    Append(filter->GetOutput()->GetPoints()->GetData(), bytes);
    Append(filter->GetOutput()->GetCells()->GetConnectivityArray(), bytes);
  }
  return bytes;
}

Bytes Output(vtkStratusVisibilitySort* sort)
{
  Bytes bytes;
  while (vtkIdTypeArray* ids = sort->GetNextCells()) {
    Append(ids, bytes);
  }
  return bytes;
}

void Update(vtkAlgorithm* filter)
{
  filter->Update();
}

void Update(vtkStratusVisibilitySort* sort)
{
  sort->InitTraversal();
}

// The report has these stages. They are on the host where its kernels are 0, and on the device in use otherwise.
template <class Filter> void CheckReport(Filter* filter, const Names& expected, bool on_host)
{
  vtkTable* report = filter->GetBuildReport();
  auto* names = vtkStringArray::SafeDownCast(report->GetColumnByName("Stage"));
  auto* places = vtkStringArray::SafeDownCast(report->GetColumnByName("Where"));
  auto* milliseconds = vtkDataArray::SafeDownCast(report->GetColumnByName("Milliseconds"));
  auto* bytes = vtkIdTypeArray::SafeDownCast(report->GetColumnByName("Bytes"));
  auto* kernels = vtkIdTypeArray::SafeDownCast(report->GetColumnByName("Kernels"));
  const char* name = filter->GetClassName();
  CHECK(report->GetNumberOfColumns() == 5 && names && places && milliseconds && bytes && kernels, "%s: columns are missing", name);
  CHECK(report->GetNumberOfRows() == static_cast<vtkIdType>(expected.size()), "%s: %lld stages", name,
    static_cast<long long>(report->GetNumberOfRows()));
  if (!names || !places || !milliseconds || !bytes || !kernels || report->GetNumberOfRows() != static_cast<vtkIdType>(expected.size())) {
    return;
  }
  for (vtkIdType i = 0; i < report->GetNumberOfRows(); ++i) {
    const std::string place = kernels->GetValue(i) ? filter->GetDeviceName() : "host";
    CHECK(names->GetValue(i) == expected[static_cast<size_t>(i)], "%s: stage %s", name, names->GetValue(i).c_str());
    CHECK(places->GetValue(i) == place, "%s: %s is on %s", name, names->GetValue(i).c_str(), places->GetValue(i).c_str());
    CHECK(!on_host || kernels->GetValue(i) == 0, "%s: kernels on the host", name);
    CHECK(bytes->GetValue(i) > 0 && milliseconds->GetTuple1(i) >= 0.0, "%s: %s made nothing", name, names->GetValue(i).c_str());
  }
}

// stages: the stages of each output, as the report names them.
template <class Filter> void CheckDevices(Filter* filter, const Names& stages)
{
  const char* name = filter->GetClassName();
  vtkNew<ErrorObserver> errors;
  filter->AddObserver(vtkCommand::ErrorEvent, errors);
  CHECK(std::string(filter->GetDevice()) == "auto" && filter->GetNumberOfThreads() == 0, "%s: other defaults", name);
  CHECK(filter->GetBuildReport()->GetNumberOfRows() == 0, "%s: a report of nothing", name);
  filter->SetDevice("host");
  Update(filter);
  const Bytes expected = Output(filter);
  CHECK(!expected.empty(), "%s gives nothing", name);
  CHECK(std::strncmp(filter->GetDeviceName(), "host (", 6) == 0, "%s: on %s", name, filter->GetDeviceName());
  CheckReport(filter, stages, true);

  // The error names the refused device and lists the devices that there are. Device, output and report stay.
  const vtkMTimeType before = filter->GetMTime();
  filter->SetDevice("no such device");
  CHECK(
    errors->Count == 1 && errors->Has("no such device") && errors->Has("devices are: auto, host"), "%s: '%s'", name, errors->Text.c_str());
  CHECK(std::string(filter->GetDevice()) == "host" && filter->GetMTime() == before, "%s: the device that does not exist is kept", name);
  CheckReport(filter, stages, true);
  Update(filter);
  CHECK(Output(filter) == expected, "%s: the last output is gone", name);
  filter->SetDevice("host");
  CHECK(filter->GetMTime() == before, "%s: the same device is a change", name);

  filter->SetNumberOfThreads(3);
  CHECK(filter->GetMTime() > before && std::strstr(filter->GetDeviceName(), "3 threads"), "%s: %s", name, filter->GetDeviceName());
  Update(filter);
  CHECK(Output(filter) == expected, "%s: threads change the output", name);
  CheckReport(filter, stages, true);

  Names devices = { "", "auto" };
  for (int i = 0; i < stratus_device_count(); ++i) {
    devices.push_back(std::to_string(i));
  }
  for (const std::string& device : devices) {
    const vtkMTimeType last = filter->GetMTime();
    const std::string now = filter->GetDevice(), next = device.empty() ? "auto" : device;
    filter->SetDevice(device.empty() ? nullptr : device.c_str());
    CHECK(filter->GetDevice() == next && (filter->GetMTime() > last) == (now != next), "%s: device %s", name, next.c_str());
    Update(filter);
    CHECK(Output(filter) == expected, "%s: another output by device %s, %s", name, next.c_str(), filter->GetDeviceName());
    char label[256] = "";
    if (device.find_first_not_of("0123456789") == std::string::npos && !device.empty()) {
      stratus_device_name(std::stoi(device), label, sizeof label);
      CHECK(std::string(filter->GetDeviceName()) == label, "%s: on %s instead of %s", name, filter->GetDeviceName(), label);
    }
    if (now != next) {
      CheckReport(filter, stages, false);
    }
  }
  CHECK(errors->Count == 1, "%s: %s", name, errors->Text.c_str());
}

// Checks also that the report of a filter which is updated again in one context lists only the last output's stages.
template <class Filter> void CheckFilter(Filter* filter, const Names& stages)
{
  CheckDevices(filter, stages);
  const vtkVariant before = filter->GetBuildReport()->GetValueByName(0, "Bytes");
  filter->Modified();
  filter->Update();
  CheckReport(filter, stages, false);
  CHECK(filter->GetBuildReport()->GetValueByName(0, "Bytes") == before, "%s: two outputs in one report", filter->GetClassName());
}

void Filters()
{
  Scene scene;
  vtkNew<vtkStratusHybridTreeFilter> tree;
  tree->SetInputData(scene.Image);
  tree->ThresholdBetween(0.2, 2.0);
  CheckFilter(tree.Get(), { "value ranges", "occupancy", "effective voxels", "tree shape", "tree leaves" });
  vtkNew<vtkStratusHybridTreeFilter> hits;
  hits->SetInputData(scene.Image);
  hits->ThresholdBetween(0.2, 2.0);
  hits->SetPurposeToFirstHits();
  hits->SetMethodToLBVH();
  CheckFilter(hits.Get(), { "effective voxels", "hierarchy" });
  vtkNew<vtkStratusDistanceMapFilter> map;
  map->SetInputData(scene.Image);
  map->SetVolumeProperty(scene.Volume->GetProperty());
  CheckFilter(map.Get(), { "value ranges", "occupancy", "distance map" });
  vtkNew<vtkStratusPartitionFilter> partition;
  partition->SetInputData(MixedGrid(4));
  partition->SetLeafCells(5);
  CheckFilter(partition.Get(), { "partition" });
}

void Order()
{
  vtkNew<vtkStratusPartitionFilter> partition;
  partition->SetInputData(MixedGrid(15)); // more cells than a device leaves to the host
  partition->Update();
  vtkNew<vtkCamera> camera;
  camera->SetPosition(30, 20, 50);
  vtkNew<vtkMatrix4x4> matrix;
  vtkNew<vtkStratusVisibilitySort> sort;
  sort->SetInput(partition->GetOutput());
  sort->SetCamera(camera);
  sort->SetModelTransform(matrix);
  sort->SetMaxCellsReturned(1000);
  const Names stages = { "visibility order", "visibility signs", "visibility peeling" };
  CheckDevices(sort.Get(), stages);
  sort->InitTraversal();
  CHECK(sort->GetBuildReport()->GetNumberOfRows() == 0, "an order that is reused has stages");
  camera->SetPosition(-30, 25, 10);
  sort->InitTraversal();
  CheckReport(sort.Get(), { "visibility signs", "visibility peeling" }, false);
}
} // namespace

int main()
{
  Filters();
  Order();
  return Failures == 0 ? 0 : 1;
}
