// SPDX-License-Identifier: BSD-3-Clause
// Counters show what each change rebuilds: a camera nothing, a transfer function tables and structure, data everything. Pictures show the
// rebuilt parts.
#include "mapper_testing.h"

namespace {
struct Counts {
  explicit Counts(vtkStratusVolumeMapper* mapper)
      : Range(mapper->GetRangeBuilds()), Table(mapper->GetTableBuilds()), Occupancy(mapper->GetOccupancyBuilds()),
        Structure(mapper->GetStructureBuilds())
  {
  }
  vtkTypeUInt64 Range, Table, Occupancy, Structure;
};

void Expect(Scene& scene, Counts& counts, const char* what, bool range, bool rest)
{
  scene.Render();
  const Counts now(scene.Mapper);
  CHECK((now.Range > counts.Range) == range, "%s: value ranges built %llu times", what, static_cast<unsigned long long>(now.Range));
  CHECK((now.Table > counts.Table) == rest, "%s: tables built %llu times", what, static_cast<unsigned long long>(now.Table));
  CHECK((now.Occupancy > counts.Occupancy) == rest, "%s: occupancy built %llu times", what, static_cast<unsigned long long>(now.Occupancy));
  CHECK((now.Structure > counts.Structure) == rest, "%s: structure built %llu times", what, static_cast<unsigned long long>(now.Structure));
  counts = now;
}
} // namespace

int main()
{
  Scene scene(64, 48);
  scene.Mapper->SetStructureToDistance();
  scene.Render();
  Counts counts(scene.Mapper);
  CHECK(counts.Range == 1 && counts.Occupancy == 1 && counts.Structure == 1, "the first picture builds each once");
  CHECK(counts.Table >= 1 && scene.Mapper->GetProbeBuilds() == 1, "a probe builds a table for each setting that it tries");

  Expect(scene, counts, "the same again", false, false);
  for (int view = 0; view < 4; ++view) {
    scene.Renderer->GetActiveCamera()->Azimuth(31);
    scene.Renderer->ResetCameraClippingRange();
    Expect(scene, counts, "camera", false, false);
  }
  scene.Volume->RotateZ(20);
  Expect(scene, counts, "rotation of the volume", false, false);
  scene.Window->SetSize(80, 60);
  Expect(scene, counts, "size of the window", false, false);
  scene.Mapper->SetFinalColorLevel(0.4f);
  Expect(scene, counts, "final colour level", false, false);

  std::vector<float> before = scene.Picture();
  scene.Opacity->AddPoint(0.3, 0.4);
  Expect(scene, counts, "opacity", false, true);
  CHECK(scene.Picture() != before, "a new opacity changes nothing");
  before = scene.Picture();
  scene.Color->AddRGBPoint(0.4, 0, 1, 0);
  scene.Render();
  counts = Counts(scene.Mapper);
  CHECK(scene.Picture() != before, "a new colour changes nothing");
  CHECK(counts.Range == 1, "a colour built the value ranges");

  before = scene.Picture();
  vtkFloatArray* values = vtkFloatArray::SafeDownCast(scene.Image->GetPointData()->GetScalars());
  for (vtkIdType i = 0; i < values->GetNumberOfValues(); ++i) {
    values->SetValue(i, 1.0f - values->GetValue(i));
  }
  values->Modified();
  scene.Render();
  CHECK(scene.Mapper->GetRangeBuilds() == 2, "changed values: ranges built %llu times",
    static_cast<unsigned long long>(scene.Mapper->GetRangeBuilds()));
  CHECK(scene.Picture() != before, "changed values change nothing");
  scene.Image->Modified();
  scene.Render();
  CHECK(scene.Mapper->GetRangeBuilds() == 3, "an image after Modified() is not read again");

  before = scene.Picture();
  const std::vector<unsigned char> shown = scene.Bytes();
  size_t lit = 0;
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    lit += *std::max_element(&shown[4 * p], &shown[4 * p] + 3) > 20;
  }
  CHECK(lit > scene.Pixels() / 20, "the window shows %zu lit pixels before ReleaseGraphicsResources", lit);
  scene.Window->Finalize(); // releases the graphics resources; the next picture makes them again
  CHECK(scene.Picture() == before, "the picture after ReleaseGraphicsResources is another");
  CHECK(scene.Bytes() == shown, "the window shows something else after ReleaseGraphicsResources");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  return Failures == 0 ? 0 : 1;
}
