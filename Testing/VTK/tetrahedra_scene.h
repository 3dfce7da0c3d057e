// SPDX-License-Identifier: BSD-3-Clause
// A scene of one grid for the tests of vtkStratusTetrahedraMapper, and a reference picture that does not use the core. The reference tests
// each ray against every tetrahedron in double precision, sorts the tetrahedra by where the ray enters, and integrates each stretch in many
// midpoint steps.
#ifndef tetrahedra_scene_h
#define tetrahedra_scene_h

#include "mapper_testing.h"
#include "tetrahedra_testing.h"
#include "vtkStratusTetrahedraMapper.h"

#include "vtkCellType.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

// A cube of 6^3 boxes, each divided into six tetrahedra about its diagonal. Values are linear in x and z, so that trilinear and linear
// interpolation agree.
constexpr int Boxes = 6;

inline float FieldAt(int i, int k)
{
  return static_cast<float>(0.1 * i + 0.05 * k);
}

inline void MakeGrid(vtkUnstructuredGrid* grid)
{
  static const int path[6][2] = { { 0, 1 }, { 0, 2 }, { 1, 0 }, { 1, 2 }, { 2, 0 }, { 2, 1 } };
  const vtkIdType side = Boxes + 1;
  const vtkIdType step[3] = { 1, side, side * side };
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> values;
  values->SetName("density");
  for (int k = 0; k < side; ++k) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        points->InsertNextPoint(i, j, k);
        values->InsertNextValue(FieldAt(i, k));
      }
    }
  }
  grid->SetPoints(points);
  grid->Allocate(6 * Boxes * Boxes * Boxes);
  for (vtkIdType k = 0; k < Boxes; ++k) {
    for (vtkIdType j = 0; j < Boxes; ++j) {
      for (vtkIdType i = 0; i < Boxes; ++i) {
        const vtkIdType corner = (k * side + j) * side + i;
        for (const auto& way : path) {
          const vtkIdType a = corner + step[way[0]], b = a + step[way[1]];
          const vtkIdType cell[4] = { corner, a, b, corner + step[0] + step[1] + step[2] };
          grid->InsertNextCell(VTK_TETRA, 4, cell);
        }
      }
    }
  }
  grid->GetPointData()->SetScalars(values);
}

// PSNR in dB of equal pictures. The image's samples, .02 apart, err by about 1e-4 at the function's bends, and in the length of the first
// and last sample.
constexpr double SamePicture = 62.0;

// A Scene with the grid in the place of the image.
struct GridScene : Scene {
  explicit GridScene(int width = 160, int height = 120) : Scene(width, height)
  {
    MakeGrid(this->Grid);
    this->Tetrahedra->SetInputData(this->Grid);
    this->Tetrahedra->AddObserver(vtkCommand::ErrorEvent, this->GridErrors);
    this->Image->SetDimensions(Boxes + 1, Boxes + 1, Boxes + 1);
    this->Image->SetSpacing(1, 1, 1);
    vtkNew<vtkFloatArray> values;
    values->DeepCopy(this->Grid->GetPointData()->GetScalars());
    this->Image->GetPointData()->SetScalars(values);
    this->Mapper->SetSampleDistance(0.02);
    this->Volume->SetMapper(this->Tetrahedra);
    this->Look(35, 20);
  }

  std::vector<float> GridPicture()
  {
    this->Render();
    vtkImageData* image = this->Tetrahedra->GetLastImage();
    const float* rgba = image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("RGBA"))->GetPointer(0) : nullptr;
    std::vector<float> picture; // gcc 14 takes one of two temporaries for no memory of its own
    if (rgba) {
      picture.assign(rgba, rgba + 4 * this->Pixels());
    }
    return picture;
  }
  double GridLight()
  {
    double sum = 0.0;
    for (float value : this->GridPicture()) {
      sum += value;
    }
    return sum;
  }
  // Returns the PSNR in dB of the image mapper's picture of the same scene against this mapper's.
  double Psnr()
  {
    const std::vector<float> ours = this->GridPicture();
    this->Volume->SetMapper(this->Mapper);
    const std::vector<float> theirs = this->Picture();
    this->Volume->SetMapper(this->Tetrahedra);
    CHECK(ours.size() == theirs.size() && !ours.empty(), "%zu and %zu values", ours.size(), theirs.size());
    return ours.size() == theirs.size() && !ours.empty() ? reference_psnr(ours.data(), theirs.data(), this->Pixels()) : 0.0;
  }

  vtkNew<vtkUnstructuredGrid> Grid;
  vtkNew<vtkStratusTetrahedraMapper> Tetrahedra;
  vtkNew<ErrorObserver> GridErrors;
};

// ---- the reference

struct Stretch {
  double From, To, First, Last; // From and To along the ray, the field's values there
  vtkIdType Cell;
};

inline double Determinant(const Vector& a, const Vector& b, const Vector& c, const Vector& d)
{
  return Dot(Minus(b, a), Cross(Minus(c, a), Minus(d, a)));
}

// Finds the part of a ray in the cell, t times `along` within from..to. Corners are relative to the ray's origin. Each barycentric
// coordinate is linear along the ray.
inline bool Meets(const Vector corners[4], const double values[4], const Vector& along, double from, double to, Stretch& stretch)
{
  const double whole = Determinant(corners[0], corners[1], corners[2], corners[3]);
  double start[4], rise[4];
  double reach = 0.0; // about the cell's t: another scale would drown it in rounding
  for (int i = 0; i < 4; ++i) {
    reach = std::max(reach, std::sqrt(Dot(corners[i], corners[i]) / Dot(along, along)));
  }
  for (int i = 0; i < 4 && whole != 0.0; ++i) {
    Vector of[4] = { corners[0], corners[1], corners[2], corners[3] };
    of[i] = { 0, 0, 0 };
    start[i] = Determinant(of[0], of[1], of[2], of[3]) / whole;
    of[i] = { along[0] * reach, along[1] * reach, along[2] * reach };
    rise[i] = (Determinant(of[0], of[1], of[2], of[3]) / whole - start[i]) / reach;
    if (rise[i] == 0.0 && start[i] < 0.0) {
      return false;
    }
    from = rise[i] > 0.0 ? std::max(from, -start[i] / rise[i]) : from;
    to = rise[i] < 0.0 ? std::min(to, -start[i] / rise[i]) : to;
  }
  if (whole == 0.0 || !(from < to)) {
    return false;
  }
  stretch = { from, to, 0.0, 0.0, 0 };
  for (int i = 0; i < 4; ++i) {
    stretch.First += values[i] * (start[i] + from * rise[i]);
    stretch.Last += values[i] * (start[i] + to * rise[i]);
  }
  return true;
}

// Draws a grid of tetrahedra in the scene's view. `values` are of its points or cells. `order` is a rank for each cell, in place of each
// ray's own order.
inline std::vector<double> TetraReference(
  Scene& scene, vtkUnstructuredGrid* grid, vtkDataArray* values, bool ofCells, const std::vector<vtkIdType>* order = nullptr)
{
  constexpr int steps = 100;
  const stratus_camera camera = ReferenceCamera(scene.Renderer);
  const int width = scene.Renderer->GetSize()[0], height = scene.Renderer->GetSize()[1];
  const double unit = scene.Volume->GetProperty()->GetScalarOpacityUnitDistance();
  std::vector<double> picture(4 * static_cast<size_t>(width) * height, 0.0);
  std::vector<Stretch> met;
  for (size_t pixel = 0; 4 * pixel < picture.size(); ++pixel) {
    const double u = (2.0 * (pixel % width) + 1.0) / width - 1.0, v = (2.0 * (pixel / width) + 1.0) / height - 1.0;
    Vector origin, along;
    for (size_t a = 0; a < 3; ++a) {
      const double side = u * camera.right[a] + v * camera.up[a];
      origin[a] = camera.eye[a] + (camera.parallel ? side : 0.0);
      along[a] = camera.forward[a] + (camera.parallel ? 0.0 : side);
    }
    met.clear();
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
      vtkIdType count;
      const vtkIdType* ids;
      grid->GetCellPoints(cell, count, ids);
      Vector corners[4];
      double field[4];
      bool finite = count == 4;
      for (int i = 0; i < 4 && finite; ++i) {
        double p[4] = { 0, 0, 0, 1 };
        grid->GetPoint(ids[i], p);
        scene.Volume->GetMatrix()->MultiplyPoint(p, p);
        corners[i] = Minus({ p[0], p[1], p[2] }, origin);
        field[i] = values->GetComponent(ofCells ? cell : ids[i], 0);
        finite = std::isfinite(field[i]);
      }
      Stretch stretch;
      if (finite && Meets(corners, field, along, camera.near_k, camera.far_k, stretch)) {
        stretch.Cell = cell;
        met.push_back(stretch);
      }
    }
    std::sort(met.begin(), met.end(), [&](const Stretch& a, const Stretch& b) {
      return order ? (*order)[static_cast<size_t>(a.Cell)] < (*order)[static_cast<size_t>(b.Cell)] : a.From < b.From;
    });
    double* rgba = &picture[4 * pixel];
    for (const Stretch& s : met) {
      for (int i = 0; i < steps; ++i) {
        const double x = s.First + (i + 0.5) / steps * (s.Last - s.First);
        const double alpha =
          -std::expm1(std::log1p(-scene.Opacity->GetValue(x)) * (s.To - s.From) * std::sqrt(Dot(along, along)) / steps / unit);
        double color[3];
        scene.Color->GetColor(x, color);
        for (int c = 0; c < 3; ++c) {
          rgba[c] += (1.0 - rgba[3]) * alpha * color[c];
        }
        rgba[3] += (1.0 - rgba[3]) * alpha;
      }
    }
  }
  return picture;
}

// Returns the root mean square difference of RGBA in 0..255 over the pixels that either picture shows. It is infinite where there are none,
// because empty pictures prove nothing.
inline double TetraError(const std::vector<float>& ours, const std::vector<double>& reference)
{
  double squares = 0.0, count = 0.0;
  for (size_t p = 0; ours.size() == reference.size() && 4 * p < ours.size(); ++p) {
    if (ours[4 * p + 3] > 0.0f || reference[4 * p + 3] > 0.0) {
      for (size_t c = 0; c < 4; ++c) {
        squares += std::pow(255.0 * (static_cast<double>(ours[4 * p + c]) - reference[4 * p + c]), 2.0);
      }
      count += 4.0;
    }
  }
  return count > 0.0 ? std::sqrt(squares / count) : INFINITY;
}

#endif
