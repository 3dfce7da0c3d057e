// SPDX-License-Identifier: BSD-3-Clause
// Picks by vtkStratusVolumePicker: the place where a known field reaches an opacity, its cell, points and place in the cell; on every kind
// of grid, compared with VTK's own picker if that can, and through several volumes.
#include "mapper_testing.h"

#include "vtkCamera.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkMinimalStandardRandomSequence.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStratusMultiVolume.h"
#include "vtkStratusTetrahedraMapper.h"
#include "vtkStratusVolumeMapper.h"
#include "vtkStratusVolumePicker.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"
#include "vtkAppendFilter.h"
#include "vtkVolume.h"
#include "vtkVolumePicker.h"
#include "vtkVolumeProperty.h"

#include <cmath>
#include <functional>

namespace {
constexpr int N[3] = { 9, 8, 7 }, Width = 40, Height = 30;

// Where the points of the four kinds of grids lie: uneven, so that a cell's number is no rounding of its place.
double coordinate(int axis, int index)
{
  return index * (1.0 + 0.25 * axis) + 0.04 * index * index;
}

using Field = std::function<double(const double x[3])>;

double plane(const double x[3])
{
  return x[0] + 0.5 * x[1] - 0.25 * x[2];
}

vtkSmartPointer<vtkDoubleArray> values_of(vtkDataSet* grid, const Field& field, bool cells)
{
  const auto values = vtkSmartPointer<vtkDoubleArray>::New();
  values->SetName("field");
  for (vtkIdType i = 0; i < (cells ? grid->GetNumberOfCells() : grid->GetNumberOfPoints()); ++i) {
    double x[3];
    if (cells) {
      double b[6];
      grid->GetCellBounds(i, b);
      for (int a = 0; a < 3; ++a) {
        x[a] = 0.5 * (b[2 * a] + b[2 * a + 1]);
      }
    } else {
      grid->GetPoint(i, x);
    }
    values->InsertNextValue(field(x));
  }
  return values;
}

template <class Grid> vtkSmartPointer<Grid> filled(vtkSmartPointer<Grid> grid, const Field& field, bool cells)
{
  vtkDataSetAttributes* data = cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData();
  data->SetScalars(values_of(grid, field, cells));
  return grid;
}

vtkSmartPointer<vtkImageData> make_image(const Field& field, bool cells)
{
  const auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(2, 2 + N[0] - 1, -3, -3 + N[1] - 1, 0, N[2] - 1);
  image->SetSpacing(1.0, 1.25, 1.5);
  image->SetOrigin(-2.0, 3.75, 0.0);
  return filled(image, field, cells);
}

vtkSmartPointer<vtkRectilinearGrid> make_rectilinear(const Field& field, bool cells, bool decreasing)
{
  const auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  grid->SetDimensions(N[0], N[1], N[2]);
  for (int a = 0; a < 3; ++a) {
    const auto x = vtkSmartPointer<vtkDoubleArray>::New();
    for (int i = 0; i < N[a]; ++i) {
      x->InsertNextValue(coordinate(a, decreasing && a == 1 ? N[a] - 1 - i : i));
    }
    (a == 0 ? grid->SetXCoordinates(x) : a == 1 ? grid->SetYCoordinates(x) : grid->SetZCoordinates(x));
  }
  return filled(grid, field, cells);
}

vtkSmartPointer<vtkStructuredGrid> make_structured(const Field& field, bool cells)
{
  const auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  const auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  for (int k = 0; k < N[2]; ++k) {
    for (int j = 0; j < N[1]; ++j) {
      for (int i = 0; i < N[0]; ++i) {
        points->InsertNextPoint(coordinate(0, i), coordinate(1, j), coordinate(2, k) + 0.05 * i);
      }
    }
  }
  grid->SetDimensions(N[0], N[1], N[2]);
  grid->SetPoints(points);
  return filled(grid, field, cells);
}

vtkSmartPointer<vtkUnstructuredGrid> make_unstructured(const Field& field, bool cells)
{
  vtkNew<vtkAppendFilter> append;
  append->AddInputData(make_structured(field, cells));
  append->Update();
  vtkSmartPointer<vtkUnstructuredGrid> grid = append->GetOutput();
  return grid;
}

// A volume, a picker, and a line from outside to outside.
struct Stage {
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkStratusVolumePicker> Picker;
  vtkSmartPointer<vtkVolume> Volume = vtkSmartPointer<vtkVolume>::New();

  explicit Stage(vtkDataObject* data, vtkVolume* prop = nullptr)
  {
    if (data) {
      vtkSmartPointer<vtkAbstractVolumeMapper> mapper;
      if (vtkImageData::SafeDownCast(data) || vtkRectilinearGrid::SafeDownCast(data)) {
        mapper = vtkSmartPointer<vtkStratusVolumeMapper>::New();
      } else {
        mapper = vtkSmartPointer<vtkStratusTetrahedraMapper>::New();
      }
      mapper->SetInputDataObject(0, data);
      this->Volume->SetMapper(mapper);
    }
    this->Show(0.0, 100.0);
    this->Volume->GetProperty()->SetInterpolationTypeToLinear();
    this->Renderer->AddVolume(prop ? prop : this->Volume.Get());
    this->Window->AddRenderer(this->Renderer);
    this->Window->SetSize(Width, Height);
    this->Window->SetOffScreenRendering(1);
  }

  // Opacity rises from 0 to 1 between two values, so that it is the bound b at low + b (high - low).
  void Show(double low, double high)
  {
    vtkPiecewiseFunction* opacity = this->Volume->GetProperty()->GetScalarOpacity();
    opacity->RemoveAllPoints();
    opacity->AddPoint(low, 0.0);
    opacity->AddPoint(high, 1.0);
  }

  // Looks from one place to another, and picks in the middle of the window.
  bool Pick(vtkPicker* picker, const double from[3], const double to[3])
  {
    double along[3];
    vtkMath::Subtract(to, from, along);
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    const bool upright = std::fabs(along[2]) > std::fabs(along[0]);
    camera->SetPosition(from);
    camera->SetFocalPoint(to);
    camera->SetViewUp(upright ? 1 : 0, 0, upright ? 0 : 1);
    camera->SetClippingRange(1e-2, vtkMath::Norm(along));
    return picker->Pick(0.5 * Width, 0.5 * Height, 0.0, this->Renderer) == 1;
  }
};

// The cell and the parameter along the ray that a fine march by VTK's own cell search finds. It shares no code with the picker.
struct Found {
  double T = -1.0;
  vtkIdType Cell = -1;
};
constexpr int Steps = 20000;

Found March(vtkDataSet* data, const double from[3], const double to[3], const std::function<bool(vtkIdType cell, const double x[3])>& shows)
{
  Found found;
  double b[6], weights[64], pcoords[3];
  int sub = 0;
  data->GetBounds(b);
  for (int s = 0; s <= Steps && found.T < 0.0; ++s) {
    double x[3];
    for (int a = 0; a < 3; ++a) {
      x[a] = from[a] + (to[a] - from[a]) * s / Steps;
    }
    if (x[0] < b[0] || x[0] > b[1] || x[1] < b[2] || x[1] > b[3] || x[2] < b[4] || x[2] > b[5]) {
      continue;
    }
    const vtkIdType cell = data->FindCell(x, nullptr, -1, 1e-12, sub, pcoords, weights);
    if (cell >= 0 && shows(cell, x)) {
      found = { static_cast<double>(s) / Steps, cell };
    }
  }
  return found;
}

// A way through the grid that depends on a number.
void MakeRay(vtkDataSet* data, int seed, double from[3], double to[3])
{
  vtkNew<vtkMinimalStandardRandomSequence> random;
  random->SetSeed(seed + 17);
  for (int i = 0; i < 10; ++i) {
    random->Next();
  }
  double b[6];
  data->GetBounds(b);
  double direction[3];
  for (int a = 0; a < 3; ++a) {
    direction[a] = random->GetNextRangeValue(-1.0, 1.0);
  }
  vtkMath::Normalize(direction);
  for (int a = 0; a < 3; ++a) {
    const double inside = b[2 * a] + random->GetNextRangeValue(0.1, 0.9) * (b[2 * a + 1] - b[2 * a]);
    from[a] = inside - 30.0 * direction[a];
    to[a] = inside + 30.0 * direction[a];
  }
}

// Checks what the picker says of the cell and its points.
void CheckCell(vtkStratusVolumePicker* picker, vtkDataSet* data, const char* what)
{
  CHECK(picker->GetDataSet() == data && picker->GetCellId() >= 0, "%s: another data set", what);
  double place[3], near[3], pcoords[3], distance, weights[64];
  int sub = 0;
  picker->GetMapperPosition(place);
  vtkCell* cell = data->GetCell(picker->GetCellId());
  CHECK(cell->EvaluatePosition(place, near, sub, pcoords, distance, weights) != -1 && distance < 1e-12,
    "%s: the place is %g away from cell %lld", what, std::sqrt(distance), static_cast<long long>(picker->GetCellId()));
  vtkIdType nearest = -1;
  double best = VTK_DOUBLE_MAX;
  for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i) {
    double p[3];
    data->GetPoint(cell->GetPointId(i), p);
    if (vtkMath::Distance2BetweenPoints(p, place) < best) {
      best = vtkMath::Distance2BetweenPoints(p, place);
      nearest = cell->GetPointId(i);
    }
  }
  double p[3];
  data->GetPoint(picker->GetPointId(), p);
  const bool rounded = vtkImageData::SafeDownCast(data) || vtkRectilinearGrid::SafeDownCast(data); // along each axis, as VTK does
  CHECK(rounded ? cell->GetPointIds()->IsId(picker->GetPointId()) >= 0 : picker->GetPointId() == nearest,
    "%s: point %lld, the nearest is %lld", what, static_cast<long long>(picker->GetPointId()), static_cast<long long>(nearest));
  if (vtkImageData* image = vtkImageData::SafeDownCast(data)) {
    CHECK(image->ComputeCellId(picker->GetCellIJK()) == picker->GetCellId() &&
        image->ComputePointId(picker->GetPointIJK()) == picker->GetPointId(),
      "%s: ijk of another cell or point", what);
    CHECK(picker->GetPointId() == nearest, "%s: of an image the nearest point is picked", what);
  }
}

// Values of points: the field is linear, so that interpolation is exact in all grids.
void Points(vtkDataSet* data, const char* what)
{
  Stage stage(data);
  int hits = 0, misses = 0;
  for (int seed = 0; seed < 40; ++seed) {
    double from[3], to[3];
    MakeRay(data, seed, from, to);
    // every other ray looks for a peak that is narrower than any step
    const bool peak = seed % 2 == 1;
    if (peak) {
      vtkPiecewiseFunction* opacity = stage.Volume->GetProperty()->GetScalarOpacity();
      opacity->RemoveAllPoints();
      for (double node : { 4.9999, 5.0, 5.0001 }) {
        opacity->AddPoint(node, node == 5.0 ? 1.0 : 0.0);
      }
    } else {
      stage.Show(0.0, 100.0);
    }
    double before = 0.0;
    bool known = false;
    const Found found = March(data, from, to, [&](vtkIdType, const double x[3]) {
      const double now = plane(x);
      const bool crossed = peak ? known && (before - 5.0) * (now - 5.0) <= 0.0 : now >= 5.0;
      before = now;
      known = true;
      return crossed;
    });
    const bool picked = stage.Pick(stage.Picker, from, to);
    CHECK(picked == (found.T >= 0.0), "%s, ray %d: %s", what, seed, picked ? "picked where nothing is" : "not picked");
    ++(picked ? hits : misses);
    if (!picked || found.T < 0.0) {
      continue;
    }
    double place[3], along[3], to_place[3];
    stage.Picker->GetPickPosition(place);
    vtkMath::Subtract(to, from, along);
    vtkMath::Subtract(place, from, to_place);
    const double t = vtkMath::Dot(to_place, along) / vtkMath::Dot(along, along);
    CHECK(std::fabs(t - found.T) < 2.0 / Steps, "%s, ray %d: picked at %.9g, not %.9g", what, seed, t, found.T);
    double b[6];
    data->GetBounds(b);
    const bool entry = !peak && plane(place) > 5.0 + 1e-6;
    CHECK(
      entry || std::fabs(plane(place) - 5.0) < 2e-4 * (peak ? 1.0 : 1e-3), "%s, ray %d: the field there is %.9g", what, seed, plane(place));
    CheckCell(stage.Picker, data, what);
    const double* normal = stage.Picker->GetPickNormal();
    const double slope[3] = { 1.0, 0.5, -0.25 };
    CHECK(std::fabs(std::fabs(vtkMath::Dot(normal, slope)) - vtkMath::Norm(slope)) < 1e-2 && vtkMath::Dot(normal, along) <= 0.0,
      "%s, ray %d: the normal is %g %g %g", what, seed, normal[0], normal[1], normal[2]);
  }
  CHECK(hits >= 10 && misses >= 1, "%s: %d hits, %d misses", what, hits, misses);
}

// Values of cells, drawn as they are: the first cell that shows.
// VTK finds no cells where coordinates decrease, so `oracle` is the grid with y turned round there.
void Cells(vtkDataSet* data, const char* what, vtkDataSet* oracle = nullptr)
{
  Stage stage(data);
  stage.Volume->GetProperty()->SetInterpolationTypeToNearest();
  vtkDataArray* values = (oracle ? oracle : data)->GetCellData()->GetScalars();
  vtkAbstractVolumeMapper* mapper = stage.Volume->GetMapper();
  mapper->SetScalarModeToUseCellData();
  int hits = 0;
  for (int seed = 0; seed < 40; ++seed) {
    double from[3], to[3];
    MakeRay(data, seed, from, to);
    Found found =
      March(oracle ? oracle : data, from, to, [&](vtkIdType cell, const double*) { return values->GetComponent(cell, 0) >= 5.0; });
    if (oracle && found.Cell >= 0) {
      const vtkIdType row = N[0] - 1, j = found.Cell / row % (N[1] - 1);
      found.Cell += row * (N[1] - 2 - 2 * j);
    }
    const bool picked = stage.Pick(stage.Picker, from, to);
    CHECK(picked == (found.T >= 0.0) && (!picked || stage.Picker->GetCellId() == found.Cell), "%s, ray %d: cell %lld is picked, not %lld",
      what, seed, static_cast<long long>(picked ? stage.Picker->GetCellId() : -1), static_cast<long long>(found.Cell));
    if (picked) {
      ++hits;
      CheckCell(stage.Picker, data, what);
    }
  }
  CHECK(hits > 10, "%s: %d hits", what, hits);
}

// A field that bends within its cells, and cells that are hidden.
void BendsAndBlanks()
{
  const Field bent = [](const double x[3]) { return 0.4 * (x[0] - 4) * (x[1] - 4) * (x[2] - 4); };
  const auto image = make_image(bent, false);
  Stage stage(image);
  for (int round = 0; round < 2; ++round) {
    int hits = 0;
    for (int seed = 0; seed < 40; ++seed) {
      double from[3], to[3];
      MakeRay(image, seed, from, to);
      // trilinear in each cell, and so are the field's values
      const Found found =
        March(image, from, to, [&](vtkIdType cell, const double x[3]) { return image->IsCellVisible(cell) && bent(x) >= 5.0; });
      const bool picked = stage.Pick(stage.Picker, from, to);
      CHECK(picked == (found.T >= 0.0) && (!picked || stage.Picker->GetCellId() == found.Cell), "bent %d, ray %d: cell %lld, not %lld",
        round, seed, static_cast<long long>(picked ? stage.Picker->GetCellId() : -1), static_cast<long long>(found.Cell));
      hits += picked ? 1 : 0;
    }
    CHECK(hits > 10, "bent: %d hits", hits);
    vtkUnsignedCharArray* hidden = image->AllocateCellGhostArray();
    for (vtkIdType cell = 0; cell < image->GetNumberOfCells(); cell += 3) {
      hidden->SetValue(cell, vtkDataSetAttributes::HIDDENCELL);
    }
  }
}

// Crop regions and clip planes cut the volume, and so the pick.
void Cuts()
{
  const auto image = make_image([](const double*) { return 50.0; }, false);
  Stage stage(image);
  auto* mapper = vtkStratusVolumeMapper::SafeDownCast(stage.Volume->GetMapper());
  const double from[3] = { 4.1, 4.2, -20 }, to[3] = { 4.1, 4.2, 30 };
  CHECK(
    stage.Pick(stage.Picker, from, to) && std::fabs(stage.Picker->GetPickPosition()[2]) < 1e-9, "an even field is picked where it begins");
  mapper->SetCropping(1);
  mapper->SetCroppingRegionPlanes(1, 7, 1, 7, 2.25, 6);
  mapper->SetCroppingRegionFlagsToSubVolume();
  CHECK(stage.Pick(stage.Picker, from, to) && std::fabs(stage.Picker->GetPickPosition()[2] - 2.25) < 1e-9, "the box begins at 2.25, not %g",
    stage.Picker->GetPickPosition()[2]);
  CHECK(stage.Picker->GetCellIJK()[2] == 1 && std::fabs(stage.Picker->GetPCoords()[2] - 0.5) < 1e-9, "half way through the second cell");
  mapper->SetCroppingRegionFlags(1 << (1 + 3 + 18)); // only the region behind the box
  CHECK(stage.Pick(stage.Picker, from, to) && std::fabs(stage.Picker->GetPickPosition()[2] - 6) < 1e-9,
    "the region behind the box begins at 6");
  mapper->SetCropping(0);
  vtkNew<vtkPlane> clip;
  clip->SetOrigin(0, 0, 3.1);
  clip->SetNormal(0, 0, 1);
  mapper->AddClippingPlane(clip);
  CHECK(stage.Pick(stage.Picker, from, to) && std::fabs(stage.Picker->GetPickPosition()[2] - 3.1) < 1e-9, "the plane is at 3.1");
  const auto cells = make_unstructured([](const double*) { return 50.0; }, false);
  Stage mesh(cells);
  auto* march = vtkStratusTetrahedraMapper::SafeDownCast(mesh.Volume->GetMapper());
  march->SetCropping(1);
  march->SetCroppingRegionPlanes(1, 7, 1, 7, 2.25, 6);
  CHECK(mesh.Pick(mesh.Picker, from, to) && std::fabs(mesh.Picker->GetPickPosition()[2] - 2.25) < 1e-9, "the box of a mesh begins at 2.25");
}

// Props that are turned, blocks, several volumes, other props, and VTK's own picker.
void Props()
{
  const auto image = make_image(plane, false);
  Stage stage(image);
  vtkNew<vtkVolumePicker> own;
  own->SetVolumeOpacityIsovalue(0.05);
  int same = 0;
  for (int seed = 0; seed < 40; ++seed) {
    double from[3], to[3], theirs[3];
    MakeRay(image, seed, from, to);
    const bool picked = stage.Pick(own, from, to);
    own->GetPickPosition(theirs);
    CHECK(stage.Pick(stage.Picker, from, to) == picked, "ray %d: VTK's picker %s", seed, picked ? "picks" : "does not");
    if (picked) {
      const double off = std::sqrt(vtkMath::Distance2BetweenPoints(theirs, stage.Picker->GetPickPosition()));
      CHECK(off < 1e-3, "ray %d: %g from where VTK picks", seed, off);
      same += own->GetCellId() == stage.Picker->GetCellId();
    }
  }
  CHECK(same > 10, "%d cells equal those that VTK picks", same);
  const double from[3] = { 3.3, -20, 3.4 }, to[3] = { 3.3, 30, 3.4 };
  CHECK(stage.Pick(stage.Picker, from, to), "nothing is picked");
  const vtkIdType cell = stage.Picker->GetCellId();
  stage.Volume->SetPosition(100, 0, 0);
  stage.Volume->RotateZ(90);
  const double turned_from[3] = { 120, 3.3, 3.4 }, turned_to[3] = { 70, 3.3, 3.4 };
  CHECK(stage.Pick(stage.Picker, turned_from, turned_to) && stage.Picker->GetCellId() == cell, "a turned volume has another cell");
  CHECK(!stage.Pick(stage.Picker, from, to), "a volume that was moved is picked where it was");
  vtkNew<vtkMultiBlockDataSet> blocks;
  const auto near = make_structured(plane, false), far = make_structured(plane, false);
  for (vtkIdType i = 0; i < near->GetNumberOfPoints(); ++i) {
    double p[3];
    near->GetPoint(i, p);
    near->GetPoints()->SetPoint(i, p[0], p[1] - 40, p[2]);
  }
  near->GetPointData()->GetScalars()->FillComponent(0, 60.0);
  blocks->SetBlock(0, far);
  blocks->SetBlock(1, near);
  Stage both(blocks);
  const double before[3] = { 3.3, -60, 3.4 };
  CHECK(both.Pick(both.Picker, before, to) && both.Picker->GetDataSet() == near && both.Picker->GetFlatBlockIndex() == 2,
    "the second block is nearer");
}

void Several()
{
  const auto back = make_image(plane, false), front = make_image([](const double*) { return 80.0; }, false);
  Stage first(back), second(front);
  vtkNew<vtkStratusMultiVolume> several;
  several->SetVolume(first.Volume, 0);
  several->SetVolume(second.Volume, 1);
  second.Volume->SetPosition(0, -30, 0);
  Stage stage(nullptr, several);
  const double from[3] = { 3.3, -60, 3.4 }, to[3] = { 3.3, 30, 3.4 }, inside[3] = { 3.3, -10, 3.4 };
  CHECK(stage.Pick(stage.Picker, from, to) && stage.Picker->GetDataSet() == front &&
      stage.Picker->GetMapper() == second.Volume->GetMapper() && stage.Picker->GetProp3D() == several.Get(),
    "the volume in front is not picked");
  CHECK(std::fabs(stage.Picker->GetPickPosition()[1] + 30) < 1e-9, "the volume in front begins at -30, not %g",
    stage.Picker->GetPickPosition()[1]);
  CHECK(stage.Pick(stage.Picker, inside, to) && stage.Picker->GetDataSet() == back, "the volume behind is not picked from between them");
  const double place[3] = { 3.3, stage.Picker->GetPickPosition()[1], 3.4 };
  CHECK(std::fabs(plane(place) - 5.0) < 1e-6, "the field there is %g", plane(place));
  second.Volume->VisibilityOff();
  CHECK(stage.Pick(stage.Picker, from, to) && stage.Picker->GetDataSet() == back, "a volume that is not visible is picked");
}
} // namespace

int main()
{
  Points(make_image(plane, false), "image");
  Points(make_rectilinear(plane, false, false), "rectilinear");
  Points(make_rectilinear(plane, false, true), "rectilinear, decreasing");
  Points(make_structured(plane, false), "structured");
  Points(make_unstructured(plane, false), "unstructured");
  Cells(make_image(plane, true), "image");
  Cells(make_rectilinear(plane, true, false), "rectilinear");
  Cells(make_rectilinear(plane, true, true), "rectilinear, decreasing", make_rectilinear(plane, true, false));
  Cells(make_structured(plane, true), "structured");
  Cells(make_unstructured(plane, true), "unstructured");
  BendsAndBlanks();
  Cuts();
  Props();
  Several();
  return Failures == 0 ? 0 : 1;
}
