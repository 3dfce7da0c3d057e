// SPDX-License-Identifier: BSD-3-Clause
// Where pictures of tetrahedra may fail, in VTK's windows: rings, gaps, interleaved parts, folds, slivers, points that are there twice or
// for nothing, seams, views along faces, eyes on faces and points, places far away and tiny, values that are none, next to nothing to draw.
// Each case gives the reference's picture, by either method, or a clear error.
#include "tetrahedra_scene.h"

#include "vtkDoubleArray.h"
#include "vtkTransform.h"

namespace {
constexpr double Close = 0.02; // RMSE of 255: the tightest of the bars of record; the reference's own steps cost .006

// A scene to which cells are added one by one. Values follow a smooth function of place by default.
struct Case : GridScene {
  Case() : GridScene(48, 36)
  {
    this->Tetrahedra->SetTermination(1.0);
    this->Points->SetDataTypeToDouble();
    this->Values->SetName("values");
    this->Parts->SetPoints(this->Points);
    this->Parts->Allocate(100);
    this->Tetrahedra->SetInputData(this->Parts);
  }

  vtkIdType AddPoint(const Vector& p)
  {
    return this->AddPoint(p, 0.5 + 0.25 * std::sin(1.9 * p[0] + 0.7 * p[1]) + 0.25 * std::cos(1.3 * p[2] - 0.9 * p[1]));
  }
  vtkIdType AddPoint(const Vector& p, double value)
  {
    this->Values->InsertNextValue(value);
    return this->Points->InsertNextPoint(p.data());
  }
  void AddCell(vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType d)
  {
    const vtkIdType ids[4] = { a, b, c, d };
    this->Parts->InsertNextCell(VTK_TETRA, 4, ids);
  }
  // n^3 cubes of six cells each, points where `place` puts them.
  template <typename Place> void AddCubes(int n, Place&& place)
  {
    static const int path[6][2] = { { 0, 1 }, { 0, 2 }, { 1, 0 }, { 1, 2 }, { 2, 0 }, { 2, 1 } };
    const vtkIdType first = this->Points->GetNumberOfPoints(), step[3] = { 1, n + 1, (n + 1) * (n + 1) };
    for (int p = 0; p < (n + 1) * (n + 1) * (n + 1); ++p) {
      this->AddPoint(place(Vector{ double(p % (n + 1)), double(p / (n + 1) % (n + 1)), double(p / (n + 1) / (n + 1)) }));
    }
    for (int cube = 0; cube < n * n * n; ++cube) {
      const vtkIdType corner = first + cube % n + cube / n % n * step[1] + cube / n / n * step[2];
      for (const auto& way : path) {
        const vtkIdType a = corner + step[way[0]];
        this->AddCell(corner, a, a + step[way[1]], corner + step[0] + step[1] + step[2]);
      }
    }
  }

  // Several views, outside and in between, against the reference.
  void Agrees(const char* what, double close = Close, int views = 4)
  {
    this->Parts->GetPointData()->SetScalars(this->Values);
    for (int view = 0; view < views; ++view) {
      this->Look(35 + 97 * view, 20 - 23 * view);
      this->Renderer->GetActiveCamera()->SetParallelProjection(view & 1);
      this->Renderer->ResetCamera();
      this->AgreesNow(what, view, close);
    }
  }
  void AgreesNow(const char* what, int view, double close = Close)
  {
    this->Parts->GetPointData()->SetScalars(this->Values);
    std::vector<double> reference;
    for (int method : { vtkStratusTetrahedraMapper::PROJECT_METHOD, vtkStratusTetrahedraMapper::MARCH_METHOD }) {
      this->Tetrahedra->SetMethod(method);
      const std::vector<float> ours = this->GridPicture();
      reference = reference.empty() ? TetraReference(*this, this->Parts, this->Values, false) : reference;
      const double error = TetraError(ours, reference);
      CHECK(error <= close, "%s, view %d, %s: RMSE %.4f of 255, at most %g; %s", what, view, this->Tetrahedra->GetMethodAsString(), error,
        close, this->GridErrors->Text.c_str());
    }
  }

  vtkNew<vtkUnstructuredGrid> Parts;
  vtkNew<vtkPoints> Points;
  vtkNew<vtkDoubleArray> Values;
};

Vector AsItIs(const Vector& p)
{
  return p;
}

Vector Turned(const Vector& p, double degrees)
{
  const double c = std::cos(degrees * M_PI / 180.0), s = std::sin(degrees * M_PI / 180.0);
  return { c * p[0] - s * p[1], s * p[0] + c * p[1], p[2] };
}

// Three bars, each over the next and under the one before: no order of cells is right, each ray's own is.
void ThreeCellsInARing()
{
  Case scene;
  for (int bar = 0; bar < 3; ++bar) {
    vtkIdType ids[4];
    const Vector corners[4] = { { 0.35, -2, -0.5 }, { 0.85, -2, -0.5 }, { 0.6, 2, 0.3 }, { 0.6, 2, 0.8 } };
    for (int i = 0; i < 4; ++i) {
      ids[i] = scene.AddPoint(Turned(corners[i], 120 * bar), 0.3 + 0.3 * bar);
    }
    scene.AddCell(ids[0], ids[1], ids[2], ids[3]);
  }
  scene.Volume->GetProperty()->SetScalarOpacityUnitDistance(0.1); // nearly opaque
  scene.Agrees("a ring");
  scene.Look(0, 0); // along the axis
  scene.AgreesNow("a ring, along its axis", 0);
  const std::vector<float> picture = scene.GridPicture();
  std::vector<vtkIdType> order = { 0, 1, 2 };
  do {
    const double error = TetraError(picture, TetraReference(scene, scene.Parts, scene.Values, false, &order));
    CHECK(error > 10 * Close, "cells in the order %d %d %d are off by %g only", int(order[0]), int(order[1]), int(order[2]), error);
  } while (std::next_permutation(order.begin(), order.end()));
}

void PartsAndGaps()
{
  for (double gap : { 0.7, 0.0, 1e-9, 3.0 }) {
    Case scene;
    scene.AddCubes(2, AsItIs);
    scene.AddCubes(2, [&](const Vector& p) { return Vector{ p[0] + 2.0 + gap, p[1], p[2] }; });
    scene.AddCubes(1, [&](const Vector& p) { return Vector{ p[0] + 0.5, p[1] - 1.5 - gap, p[2] + 0.3 }; });
    scene.Agrees("a gap", Close, 3);
  }
}

// Columns of two parts by turns, like a chess board; and a small cube in the hollow of a large one.
void PartsThatInterleave()
{
  Case board;
  for (int i = 0; i < 9; ++i) {
    const double shrink = i % 2 ? 0.8 : 1.0;
    board.AddCubes(1, [&](const Vector& p) { return Vector{ i % 3 + shrink * p[0], i / 3 + shrink * p[1], 3.0 * p[2] - 0.3 * (i % 2) }; });
  }
  board.Agrees("a board");
  Case nested;
  for (int cube = 0; cube < 27; ++cube) {
    const Vector at = { double(cube % 3), double(cube / 3 % 3), double(cube / 9) };
    const double shrink = cube == 13 ? 0.5 : 1.0; // the middle one
    const double edge = (1 - shrink) / 2;
    nested.AddCubes(1, [&](const Vector& p) {
      return Vector{ at[0] + edge + shrink * p[0], at[1] + edge + shrink * p[1], at[2] + edge + shrink * p[2] };
    });
  }
  nested.Agrees("a cube in a hollow", Close, 2);
}

// In a mesh of 3072 cells one point is pulled through the cells behind it, which turns .05 % of the cells or more inside out. Overlaps are
// drawn twice; in one colour the order does not matter.
void InvertedCells()
{
  Case scene;
  scene.AddCubes(8, AsItIs);
  const vtkIdType pulled = 4 + 9 * (4 + 9 * 4);
  scene.Points->SetPoint(pulled, 5.2, 4.1, 4.05);
  int inverted = 0;
  for (vtkIdType c = 0; c < scene.Parts->GetNumberOfCells(); ++c) {
    const double volume = Volume(scene.Parts, c), usual = Volume(scene.Parts, c % 6);
    inverted += volume * usual < 0.0;
  }
  CHECK(inverted >= 2 && inverted < 24, "%d cells of 3072 are inside out", inverted);
  scene.Color->RemoveAllPoints();
  scene.Color->AddRGBPoint(0.0, 0.9, 0.6, 0.3);
  scene.Agrees("inverted", Close, 2);
}

void Slivers()
{
  for (double thickness : { 1e-6, 1e-12, 0.0 }) {
    Case scene;
    scene.AddCubes(3, [&](const Vector& p) { return Vector{ p[0], p[1], p[2] > 1.5 ? p[2] - 1.0 + thickness : p[2] }; });
    scene.Agrees("slivers", Close, 3);
  }
}

void PointsTwiceAndForNothing()
{
  Case twice; // every cell has its own points
  twice.AddCubes(2, AsItIs);
  Case apart;
  for (vtkIdType c = 0; c < twice.Parts->GetNumberOfCells(); ++c) {
    vtkIdType count;
    const vtkIdType* ids;
    vtkIdType own[4];
    twice.Parts->GetCellPoints(c, count, ids);
    for (int i = 0; i < 4; ++i) {
      own[i] = apart.AddPoint(PointOf(twice.Parts, ids[i]));
    }
    apart.AddCell(own[0], own[1], own[2], own[3]);
  }
  apart.Agrees("points twice");
  twice.Agrees("points once", Close, 1);
  const std::vector<float> without = twice.GridPicture();
  const double position[3] = { 3, 4, 5 };
  twice.AddPoint({ 1e5, -1e5, 0 });
  twice.Points->Modified();
  twice.Renderer->GetActiveCamera()->SetPosition(position); // keep the old clipping range: no reset to the point that nothing uses
  const std::vector<float> with = twice.GridPicture();
  twice.AgreesNow("an unused point far away", 0);
  CHECK(!with.empty() && !without.empty(), "an unused point is an error: %s", twice.GridErrors->Text.c_str());
  twice.AddPoint({ std::nan(""), 0, 0 }, 0.5);
  twice.Points->Modified();
  CHECK(twice.GridPicture().empty() && twice.GridErrors->Count == 1 && twice.GridErrors->Has("finite"), "a point of no place: '%s'",
    twice.GridErrors->Text.c_str());
}

// Two halves that meet in a plane, triangulated otherwise on both sides.
// Cells that name a point more than once have no volume, and no more than a number in the mapper.
void CellsThatNameAPointTwice()
{
  Case scene;
  scene.AddCubes(2, AsItIs);
  scene.AddCell(4, 4, 13, 22);
  scene.AddCell(4, 1, 1, 1);
  scene.AddCell(7, 7, 7, 7);
  scene.Agrees("points named twice");
  CHECK(scene.Tetrahedra->GetNumberOfBlankedTetrahedra() == 3, "%lld cells left out",
    static_cast<long long>(scene.Tetrahedra->GetNumberOfBlankedTetrahedra()));
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
}

void ASeam()
{
  Case scene;
  scene.AddCubes(2, AsItIs);
  scene.AddCubes(2, [](const Vector& p) { return Vector{ 4.0 - p[0], p[1], p[2] }; });
  scene.Agrees("a seam");
  Case finer; // three rows of cubes against two
  finer.AddCubes(2, AsItIs);
  finer.AddCubes(3, [](const Vector& p) { return Vector{ 2.0 + p[0] * 2 / 3, p[1] * 2 / 3, p[2] * 2 / 3 }; });
  finer.Agrees("a seam of other faces");
}

// Parallel views along the axes: pixels look along edges and within faces. The whole cube is two units thick everywhere.
void AlongFaces(int method)
{
  for (int axis = 0; axis < 3; ++axis) {
    Case scene;
    scene.Tetrahedra->SetMethod(method);
    scene.AddCubes(2, AsItIs);
    scene.Values->Fill(1.0);
    vtkCamera* camera = scene.Renderer->GetActiveCamera();
    double eye[3] = { 1, 1, 1 };
    eye[axis] += 5;
    camera->SetPosition(eye);
    camera->SetFocalPoint(1, 1, 1);
    camera->SetViewUp(axis == 1, axis == 2, axis == 0);
    camera->ParallelProjectionOn();
    camera->SetParallelScale(0.9); // 36 pixels are 1.8: each 1/20, so that points of the grid are on pixels' borders
    scene.Renderer->ResetCameraClippingRange();
    scene.Parts->GetPointData()->SetScalars(scene.Values);
    for (double shift : { 0.0, 0.025 }) { // and at pixels' middles
      double at[3] = { 1 + shift, 1 + shift, 1 + shift };
      at[axis] = 1;
      camera->SetFocalPoint(at);
      at[axis] = eye[axis];
      camera->SetPosition(at);
      const std::vector<float> picture = scene.GridPicture();
      const double alpha = 1.0 - std::pow(0.5, 2.0 / 1.5);
      double worst = picture.empty() ? 1.0 : 0.0;
      for (int row = 0; row < 36; ++row) {
        for (int column = 8; column < 40 && !picture.empty(); ++column) {
          worst = std::max(worst, std::fabs(static_cast<double>(picture[4 * (48 * row + column) + 3]) - alpha));
        }
      }
      CHECK(worst < 2e-6, "axis %d, shifted by %g, %s: alpha is off by %g", axis, shift, scene.Tetrahedra->GetMethodAsString(), worst);
    }
  }
}

void EyesInside()
{
  static const Vector eyes[4] = { { 1.3, 1.62, 1.45 }, { 1.5, 1.5, 1.0 }, { 1.0, 2.0, 1.0 },
    { 1.5, 1.0, 1.0 } }; // cell, face, vertex, edge
  for (int i = 0; i < 4; ++i) {
    Case scene;
    scene.AddCubes(3, AsItIs);
    vtkCamera* camera = scene.Renderer->GetActiveCamera();
    camera->SetPosition(eyes[i].data());
    camera->SetFocalPoint(3.1, 0.3 + i, 0.9);
    camera->SetViewAngle(80);
    for (double nearest : { 1e-3, 0.4 }) { // cells are cut by the near plane, not dropped
      camera->SetClippingRange(nearest, 10.0);
      scene.AgreesNow("inside", i);
    }
  }
}

void FarAwayAndTiny()
{
  for (int i = 0; i < 3; ++i) {
    Case scene;
    const double size = i == 1 ? 1e-6 : 1.0, offset = i == 0 ? 6e6 : i == 2 ? -5e5 : 0.0;
    scene.AddCubes(3, AsItIs);
    for (vtkIdType p = 0; p < scene.Points->GetNumberOfPoints(); ++p) {
      const Vector at = PointOf(scene.Parts, p);
      scene.Points->SetPoint(p, size * at[0] + offset, size * at[1] + offset, size * at[2]);
    }
    scene.Points->Modified();
    scene.Volume->GetProperty()->SetScalarOpacityUnitDistance(1.5 * size);
    scene.Agrees(i == 1 ? "1e-6" : "6e6", Close, 3);
  }
}

void AMatrix()
{
  Case scene;
  scene.AddCubes(3, AsItIs);
  vtkNew<vtkTransform> transform;
  transform->Translate(4, 5, -6);
  transform->RotateWXYZ(40, 1, 2, 3);
  transform->Scale(1.5, -0.7, 0.9);
  scene.Volume->SetUserTransform(transform);
  scene.Agrees("a mirror that scales");
}

void ValuesThatAreNone()
{
  Case scene;
  scene.AddCubes(3, AsItIs);
  scene.Values->SetValue(21, std::nan(""));
  scene.Values->SetValue(42, INFINITY);
  scene.Agrees("values that are none");
  scene.Values->Fill(std::nan(""));
  scene.Values->Modified();
  for (float value : scene.GridPicture()) {
    CHECK(value == 0.0f, "%g where no value is", static_cast<double>(value));
  }
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
}

void NextToNothing()
{
  Case one;
  const vtkIdType a = one.AddPoint({ 0, 0, 0 }), b = one.AddPoint({ 2, 0, 0 }), c = one.AddPoint({ 0, 2, 0 }),
                  d = one.AddPoint({ 0, 0, 2 });
  one.AddCell(a, b, c, d);
  one.Agrees("one cell");
  Case flat;
  for (const Vector& p : { Vector{ 0, 0, 0 }, Vector{ 1, 0, 0 }, Vector{ 0, 1, 0 }, Vector{ 1, 1, 0 } }) {
    flat.AddPoint(p);
  }
  flat.AddCell(0, 1, 2, 3); // a tetrahedron without volume: nothing to see, and no error
  flat.Parts->GetPointData()->SetScalars(flat.Values);
  flat.Renderer->ResetCamera();
  for (float value : flat.GridPicture()) {
    CHECK(value == 0.0f, "%g of a flat cell", static_cast<double>(value));
  }
  Case empty;
  CHECK(empty.GridPicture().empty() && empty.GridErrors->Count == 0, "an empty grid: %s", empty.GridErrors->Text.c_str());
  Case bare;
  for (int i = 0; i < 3; ++i) {
    bare.AddPoint({ double(i), double(i * i), 1 });
  }
  const vtkIdType ids[3] = { 0, 1, 2 };
  bare.Parts->InsertNextCell(VTK_TRIANGLE, 3, ids);
  bare.Parts->GetPointData()->SetScalars(bare.Values);
  CHECK(
    bare.GridPicture().empty() && bare.GridErrors->Has("no cell with a volume: 1"), "no tetrahedron: '%s'", bare.GridErrors->Text.c_str());
}

// A tolerance that is none is refused by name, value and range, and the last one stays.
void TolerancesThatAreNone()
{
  vtkNew<vtkStratusTetrahedraMapper> mapper;
  vtkNew<ErrorObserver> errors;
  mapper->AddObserver(vtkCommand::ErrorEvent, errors);
  CHECK(mapper->GetImageErrorTolerance() == 0.001 && mapper->GetTermination() == 0.0, "other defaults");
  mapper->SetImageErrorTolerance(0.02);
  for (double tolerance : { -0.5, std::nan(""), HUGE_VAL }) {
    const int count = errors->Count;
    mapper->SetImageErrorTolerance(tolerance);
    CHECK(errors->Count == count + 1 && errors->Has("ImageErrorTolerance") && errors->Has("at least 0"), "%g: %s", tolerance,
      errors->Text.c_str());
    CHECK(errors->Has(tolerance == -0.5 ? "-0.5" : std::isnan(tolerance) ? "nan" : "inf"), "%g: %s", tolerance, errors->Text.c_str());
    CHECK(mapper->GetImageErrorTolerance() == 0.02, "the last tolerance does not stay");
  }
}
} // namespace

int main()
{
  TolerancesThatAreNone();
  ThreeCellsInARing();
  PartsAndGaps();
  PartsThatInterleave();
  InvertedCells();
  Slivers();
  PointsTwiceAndForNothing();
  CellsThatNameAPointTwice();
  ASeam();
  AlongFaces(vtkStratusTetrahedraMapper::MARCH_METHOD);
  AlongFaces(vtkStratusTetrahedraMapper::PROJECT_METHOD);
  EyesInside();
  FarAwayAndTiny();
  AMatrix();
  ValuesThatAreNone();
  NextToNothing();
  return Failures ? 1 : 0;
}
