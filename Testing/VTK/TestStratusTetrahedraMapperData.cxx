// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper: on real meshes (../shared/data) the blend modes agree with one another. On each ray the mean is between the
// smallest and the largest value. A ray meets a surface only if its values reach the surface's, and almost always then. Light only darkens
// and brightens the surface.
#include "tetrahedra_scene.h"

#include "vtkContourValues.h"
#include "vtkXMLUnstructuredGridReader.h"

#include <fstream>

namespace {
using Pixels = std::vector<float>;

// Returns whether the mesh is there.
bool Agree(const std::string& path)
{
  if (!std::ifstream(path).good()) {
    std::printf("SKIPPED: %s is not there\n", path.c_str());
    return false;
  }
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  GridScene scene;
  vtkVolumeProperty* look = scene.Volume->GetProperty();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  if (!grid->GetPointData()->GetScalars()) {
    grid->GetPointData()->SetActiveScalars(grid->GetPointData()->GetArrayName(0));
  }
  double range[2];
  grid->GetPointData()->GetScalars()->GetRange(range);
  const double contour = range[0] + 0.3 * (range[1] - range[0]);
  scene.Tetrahedra->SetInputData(grid);
  scene.Opacity->RemoveAllPoints(); // values as greys, opaque
  scene.Opacity->AddPoint(range[0], 1.0);
  scene.Color->RemoveAllPoints();
  scene.Color->AddRGBPoint(range[0], 0, 0, 0);
  scene.Color->AddRGBPoint(range[1], 1, 1, 1);
  look->SetScalarOpacityUnitDistance(1e3 * grid->GetLength());
  look->GetIsoSurfaceValues()->SetValue(0, contour);
  scene.Look(35, 20);
  const auto draw = [&](int mode) {
    scene.Tetrahedra->SetBlendMode(mode);
    return scene.GridPicture();
  };
  const Pixels most = draw(vtkStratusTetrahedraMapper::MAXIMUM_INTENSITY_BLEND);
  const Pixels least = draw(vtkStratusTetrahedraMapper::MINIMUM_INTENSITY_BLEND);
  const Pixels mean = draw(vtkStratusTetrahedraMapper::AVERAGE_INTENSITY_BLEND);
  const Pixels sum = draw(vtkStratusTetrahedraMapper::ADDITIVE_BLEND);
  const Pixels surface = draw(vtkStratusTetrahedraMapper::ISOSURFACE_BLEND);
  look->ShadeOn();
  look->SetAmbient(0.3);
  look->SetDiffuse(0.7);
  look->SetSpecular(0.0);
  const Pixels lit = draw(vtkStratusTetrahedraMapper::ISOSURFACE_BLEND);
  CHECK(scene.GridErrors->Count == 0, "%s: %s", path.c_str(), scene.GridErrors->Text.c_str());
  const size_t values = 4 * scene.Pixels();
  for (const Pixels* p : { &most, &least, &mean, &sum, &surface, &lit }) {
    CHECK(p->size() == values, "%s: %zu of %zu values", path.c_str(), p->size(), values);
    if (p->size() != values) {
      return true;
    }
  }
  const float grey = 0.3f, eps = 2e-4f; // entries of tables
  size_t met = 0, between = 0, crossed = 0, wrong = 0, darker = 0;
  for (size_t i = 0; i < values; i += 4) {
    const bool shows = most[i + 3] > 0.0f;
    met += shows;
    wrong += shows && (mean[i] < least[i] - eps || mean[i] > most[i] + eps || least[i] > most[i] || !(sum[i] > 0.0f) != !(mean[i] > 0.0f));
    wrong += surface[i + 3] > 0.0f && !(least[i] <= grey + eps && most[i] >= grey - eps);
    wrong += (surface[i + 3] > 0.0f) != (lit[i + 3] > 0.0f);
    wrong += lit[i] > surface[i] + eps || lit[i] < 0.3f * surface[i] - eps;
    between += shows && least[i] < grey - eps && most[i] > grey + eps;
    crossed += surface[i + 3] > 0.0f;
    darker += lit[i] < 0.9f * surface[i];
  }
  CHECK(wrong == 0 && met > values / 100, "%s: %zu pixels are wrong, %zu rays met the mesh", path.c_str(), wrong, met);
  CHECK(crossed > 0.95 * between && darker > 0, "%s: %zu surfaces where %zu are due, %zu darker", path.c_str(), crossed, between, darker);
  return true;
}
} // namespace

int main()
{
  bool any = false;
  for (const char* name : { "bluntfin", "post" }) {
    any = Agree(std::string("../shared/data/") + name + ".vtu") || any;
  }
  return Failures ? 1 : any ? 0 : 77;
}
