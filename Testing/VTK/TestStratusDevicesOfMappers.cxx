// SPDX-License-Identifier: BSD-3-Clause
// The mappers' build reports list the stages of the last picture that built anything. A named device runs kernels for the stages that have
// one, and a structure that a picture reuses is no stage.
#include "tetrahedra_scene.h"

#include "vtkIdTypeArray.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <cstring>

namespace {
using Names = std::vector<std::string>;

struct Row {
  std::string Stage, Where;
  double Milliseconds;
  vtkIdType Bytes, Kernels;
  bool operator==(const Row& other) const
  {
    return this->Stage == other.Stage && this->Where == other.Where && this->Milliseconds == other.Milliseconds &&
      this->Bytes == other.Bytes && this->Kernels == other.Kernels;
  }
};

std::vector<Row> Rows(vtkTable* report)
{
  std::vector<Row> rows;
  for (vtkIdType i = 0; i < report->GetNumberOfRows(); ++i) {
    rows.push_back({ report->GetValueByName(i, "Stage").ToString(), report->GetValueByName(i, "Where").ToString(),
      report->GetValueByName(i, "Milliseconds").ToDouble(), report->GetValueByName(i, "Bytes").ToLongLong(),
      report->GetValueByName(i, "Kernels").ToLongLong() });
  }
  return rows;
}

// The report has these stages, each on the host or on the device by whether it has kernels.
template <class Mapper> std::vector<Row> CheckStages(Mapper* mapper, const char* what, const Names& stages)
{
  const std::vector<Row> rows = Rows(mapper->GetBuildReport());
  Names names;
  for (const Row& row : rows) {
    names.push_back(row.Stage);
    const std::string place = row.Kernels > 0 ? mapper->GetDeviceName() : "host";
    CHECK(row.Where == place && row.Bytes > 0 && row.Milliseconds >= 0.0, "%s: %s is on %s, %lld kernels, %lld bytes", what,
      row.Stage.c_str(), row.Where.c_str(), static_cast<long long>(row.Kernels), static_cast<long long>(row.Bytes));
  }
  std::string all;
  for (const std::string& name : names) {
    all += name + ", ";
  }
  CHECK(names == stages, "%s: stages %s", what, all.c_str());
  return rows;
}

vtkIdType Kernels(const std::vector<Row>& rows, const char* stage)
{
  vtkIdType kernels = 0;
  for (const Row& row : rows) {
    kernels += row.Stage == stage ? row.Kernels : 0;
  }
  return kernels;
}

// A device that is named, even a processor's, runs kernels for the stages of a map; the picture is the host's.
void TestVolume(const std::string& device)
{
  const Names all = { "value ranges", "occupancy", "distance map" };
  Scene scene(64, 48);
  CHECK(scene.Mapper->GetBuildReport()->GetNumberOfRows() == 0, "a report of nothing");
  scene.Mapper->SetStructureToDistance();
  scene.Mapper->SetDevice("host");
  const std::vector<float> expected = scene.Picture();
  for (const Row& row : CheckStages(scene.Mapper.Get(), "the host", all)) {
    CHECK(row.Kernels == 0, "%s has kernels on the host", row.Stage.c_str());
  }

  scene.Mapper->SetDevice(device.c_str());
  CHECK(scene.Picture() == expected, "another picture on %s", device.c_str());
  const std::vector<Row> built = CheckStages(scene.Mapper.Get(), device.c_str(), all);
  for (const std::string& stage : all) {
    CHECK(Kernels(built, stage.c_str()) > 0, "%s: no kernel for %s", device.c_str(), stage.c_str());
  }

  scene.Look(200, 30);
  scene.Render();
  CHECK(Rows(scene.Mapper->GetBuildReport()) == built, "a picture that builds nothing changed the report");
  scene.Opacity->AddPoint(0.3, 0.4);
  scene.Render();
  CheckStages(scene.Mapper.Get(), "a new opacity", { "occupancy", "distance map" });
  scene.Mapper->SetStructureToOctant();
  scene.Render();
  const std::vector<Row> octants = CheckStages(scene.Mapper.Get(), "another structure", { "distance map" });
  CHECK(Kernels(octants, "distance map") > 0, "no kernel for the octants");
  scene.Mapper->SetRenderModeToFirstHit();
  scene.Render();
  CHECK(Rows(scene.Mapper->GetBuildReport()) != octants, "first hits built nothing");
  const std::vector<Row> last = Rows(scene.Mapper->GetBuildReport());
  scene.Mapper->SetNormalsToGradient();
  scene.Mapper->SetBlendModeToMaximumIntensity(); // first hits refuse it
  scene.Render();
  CHECK(scene.Errors->Count == 1 && Rows(scene.Mapper->GetBuildReport()) == last, "a refused picture changed the report");
}

void TestTetrahedra(const std::string& device)
{
  GridScene scene;
  CHECK(scene.Tetrahedra->GetBuildReport()->GetNumberOfRows() == 0, "a report of nothing");
  scene.Tetrahedra->SetDevice(device.c_str());
  scene.Tetrahedra->SetMethodToMarch();
  scene.GridPicture();
  const std::vector<Row> built = CheckStages(scene.Tetrahedra.Get(), "march", { "cells and border" });
  scene.Look(200, 30);
  scene.GridPicture();
  CHECK(Rows(scene.Tetrahedra->GetBuildReport()) == built, "a march that builds nothing changed the report");
  scene.Tetrahedra->SetMethodToProject();
  scene.GridPicture();
  CheckStages(scene.Tetrahedra.Get(), "project", { "visibility order", "visibility signs", "visibility peeling" });
  scene.Look(100, -20);
  scene.GridPicture();
  CheckStages(scene.Tetrahedra.Get(), "another view", { "visibility signs", "visibility peeling" });
}
} // namespace

int main()
{
  char name[256] = "";
  const bool has_device = stratus_device_name(0, name, sizeof name) == STRATUS_OK;
  TestTetrahedra("host");
  if (has_device) {
    TestVolume(name);
    TestTetrahedra(name);
  }
  return Failures > 0 ? 1 : has_device ? 0 : 77; // 77: the cases on a device were skipped
}
