// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper and Lagrange and Bezier cells of several orders. Curved cells that share faces leave no gap, so that a linear
// field gives the image mapper's picture. Bezier cells are where VTK places their points. Wrong numbers of nodes are refused.
#include "tetrahedra_scene.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkGenericCell.h"
#include "vtkHigherOrderHexahedron.h"
#include "vtkHigherOrderTetra.h"
#include "vtkHigherOrderWedge.h"

namespace {
constexpr int Cubes = 3;

// Nodes of a grid of cubes, each place once.
struct Nodes {
  vtkNew<vtkPoints> Points;
  std::map<std::array<long, 3>, vtkIdType> Known;
  Nodes() { this->Points->SetDataTypeToDouble(); }

  // Moves what lies inside the cube.
  vtkIdType Add(const double p[3])
  {
    std::array<long, 3> key;
    double x[3], inside = 1.0;
    for (size_t a = 0; a < 3; ++a) {
      key[a] = std::lround(p[a] * 3600.0);
      inside *= std::sin(M_PI * p[a] / Cubes);
    }
    const auto found = this->Known.insert({ key, this->Points->GetNumberOfPoints() });
    if (found.second) {
      for (int a = 0; a < 3; ++a) { // a cube as large as the scene's image
        x[a] = Boxes / Cubes * (p[a] + 0.05 * inside * std::sin(5.0 * p[(a + 1) % 3] + 3.0 * p[a]));
      }
      this->Points->InsertNextPoint(x);
    }
    return found.first->second;
  }
};

using Corner = std::array<double, 3>;

Corner Mix(const Corner& a, const Corner& b, double t)
{
  return { a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]) };
}

vtkIdType Add(Nodes& nodes, const Corner& at)
{
  return nodes.Add(at.data());
}

// The nodes of a cell whose corners are given, in VTK's order. shape: 0 a hexahedron, 1 a wedge, 2 a tetrahedron.
std::vector<vtkIdType> NodesOf(Nodes& nodes, int shape, const std::vector<Corner>& corner, const int order[4])
{
  std::vector<vtkIdType> ids(static_cast<size_t>(order[3]), -1);
  for (int k = 0; k <= order[2]; ++k) {
    for (int j = 0; j <= order[1]; ++j) {
      for (int i = 0; i <= order[0]; ++i) {
        const double u = static_cast<double>(i) / order[0], v = static_cast<double>(j) / order[1], w = static_cast<double>(k) / order[2];
        vtkIdType node = -1;
        Corner at = { 0, 0, 0 };
        if (shape == 0) {
          const Corner low = Mix(Mix(corner[0], corner[1], u), Mix(corner[3], corner[2], u), v);
          at = Mix(low, Mix(Mix(corner[4], corner[5], u), Mix(corner[7], corner[6], u), v), w);
          node = vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order);
        } else if (shape == 1 && i + j <= order[0]) {
          for (size_t a = 0; a < 3; ++a) {
            const double low = (1 - u - v) * corner[0][a] + u * corner[1][a] + v * corner[2][a];
            at[a] = (1 - w) * low + w * ((1 - u - v) * corner[3][a] + u * corner[4][a] + v * corner[5][a]);
          }
          node = vtkHigherOrderWedge::PointIndexFromIJK(i, j, k, order);
        } else if (shape == 2 && i + j + k <= order[0]) {
          for (size_t a = 0; a < 3; ++a) {
            at[a] = (1 - u - v - w) * corner[0][a] + u * corner[1][a] + v * corner[2][a] + w * corner[3][a];
          }
          const vtkIdType place[4] = { i, j, k, order[0] - i - j - k };
          node = vtkHigherOrderTetra::Index(place, order[0]);
        }
        if (node >= 0) {
          ids[static_cast<size_t>(node)] = Add(nodes, at);
        }
      }
    }
  }
  CHECK(std::find(ids.begin(), ids.end(), -1) == ids.end(), "shape %d: a node has no place", shape);
  return ids;
}

// Cubes of one shape: a hexahedron, two wedges or six tetrahedra each.
Grid Curved(int shape, int type, int a, int b, int c)
{
  static const int ways[6][2] = { { 1, 2 }, { 1, 5 }, { 3, 2 }, { 3, 7 }, { 4, 5 }, { 4, 7 } }, wedges[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };
  const int order[4] = { a, b, c,
    shape == 0     ? (a + 1) * (b + 1) * (c + 1)
      : shape == 1 ? (a + 1) * (a + 2) / 2 * (c + 1)
                   : (a + 1) * (a + 2) * (a + 3) / 6 };
  auto grid = Grid::New();
  Nodes nodes;
  const auto insert = [&](const std::vector<Corner>& corner) {
    const std::vector<vtkIdType> ids = NodesOf(nodes, shape, corner, order);
    grid->InsertNextCell(type, order[3], ids.data());
  };
  for (int cube = 0; cube < Cubes * Cubes * Cubes; ++cube) {
    std::vector<Corner> p;
    for (int n = 0; n < 8; ++n) {
      p.push_back({ static_cast<double>(cube % Cubes + ((n + 1) >> 1 & 1)), static_cast<double>(cube / Cubes % Cubes + (n >> 1 & 1)),
        static_cast<double>(cube / Cubes / Cubes + (n >> 2)) });
    }
    if (shape == 0) {
      insert(p);
    }
    for (size_t w = 0; shape == 1 && w < 2; ++w) {
      const size_t v[3] = { static_cast<size_t>(wedges[w][0]), static_cast<size_t>(wedges[w][1]), static_cast<size_t>(wedges[w][2]) };
      insert({ p[v[0]], p[v[1]], p[v[2]], p[v[0] + 4], p[v[1] + 4], p[v[2] + 4] });
    }
    for (size_t t = 0; shape == 2 && t < 6; ++t) {
      insert({ p[0], p[static_cast<size_t>(ways[t][0])], p[static_cast<size_t>(ways[t][1])], p[6] });
    }
  }
  grid->SetPoints(nodes.Points);
  if (a != b || b != c) {
    vtkNew<vtkDoubleArray> degrees;
    degrees->SetName("degrees");
    degrees->SetNumberOfComponents(3);
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
      degrees->InsertNextTuple3(a, b, c);
    }
    grid->GetCellData()->SetHigherOrderDegrees(degrees);
  }
  vtkNew<vtkFloatArray> values;
  values->SetName("density");
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    const Vector p = PointOf(grid, i);
    values->InsertNextValue(static_cast<float>(0.1 * p[0] + 0.05 * p[2]));
  }
  grid->GetPointData()->SetScalars(values);
  return grid;
}

const int Types[3][2] = { { VTK_LAGRANGE_HEXAHEDRON, VTK_BEZIER_HEXAHEDRON }, { VTK_LAGRANGE_WEDGE, VTK_BEZIER_WEDGE },
  { VTK_LAGRANGE_TETRAHEDRON, VTK_BEZIER_TETRAHEDRON } };

void EveryKind()
{
  static const int orders[3][3][3] = { { { 1, 1, 1 }, { 2, 2, 2 }, { 3, 2, 4 } }, { { 1, 1, 1 }, { 3, 3, 3 }, { 2, 2, 3 } },
    { { 1, 1, 1 }, { 2, 2, 2 }, { 4, 4, 4 } } };
  for (int shape = 0; shape < 3; ++shape) {
    for (int bezier = 0; bezier < 2; ++bezier) {
      for (const auto& order : orders[shape]) {
        GridScene scene(64, 48);
        const Grid grid = Curved(shape, Types[shape][bezier], order[0], order[1], order[2]);
        scene.Tetrahedra->SetInputData(grid);
        const double psnr = scene.Psnr();
        const int pieces = (shape == 0 ? 6 : shape == 1 ? 3 : 1) * order[0] * order[1] * order[2];
        CHECK(psnr > SamePicture, "type %d of order %d %d %d: %.1f dB", Types[shape][bezier], order[0], order[1], order[2], psnr);
        CHECK(scene.Tetrahedra->GetNumberOfTetrahedra() == pieces * grid->GetNumberOfCells(), "type %d: %lld tetrahedra",
          Types[shape][bezier], static_cast<long long>(scene.Tetrahedra->GetNumberOfTetrahedra()));
        CHECK(scene.GridErrors->Count == 0, "type %d: %s", Types[shape][bezier], scene.GridErrors->Text.c_str());
        scene.Tetrahedra->SetMethodToMarch();
        scene.GridPicture();
        const vtkIdType pixels = static_cast<vtkIdType>(scene.Pixels()); // a gap would let rays enter anew
        CHECK(scene.Tetrahedra->GetNumberOfEntries() <= pixels, "type %d: %lld entries by %lld rays", Types[shape][bezier],
          static_cast<long long>(scene.Tetrahedra->GetNumberOfEntries()), static_cast<long long>(pixels));
      }
    }
  }
}

// Bezier cells, rational ones, too, compared with Lagrange cells whose nodes are where VTK says that the points of the Bezier cells are.
void BezierCellsLieWhereVtkPlacesThem()
{
  for (int shape = 0; shape < 3; ++shape) {
    for (int rational = 0; rational < 2; ++rational) {
      GridScene scene(64, 48);
      const Grid bezier = Curved(shape, Types[shape][1], 2, 2, 2);
      Grid lagrange = Grid::New();
      vtkPoints* points = bezier->GetPoints();
      auto* values = vtkFloatArray::SafeDownCast(bezier->GetPointData()->GetScalars());
      vtkNew<vtkDoubleArray> weights;
      weights->SetName("weights");
      for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i) {
        Vector p = PointOf(bezier, i);
        for (double& x : p) { // round, also at the border
          x += 0.4 * std::sin(3.0 * static_cast<double>(i) + x);
        }
        points->SetPoint(i, p.data());
        values->SetValue(i, 0.3f + 0.3f * static_cast<float>(std::sin(static_cast<double>(7 * i))));
        weights->InsertNextValue(1.0 + 0.5 * std::sin(static_cast<double>(i)));
      }
      if (rational) {
        bezier->GetPointData()->SetRationalWeights(weights);
      }
      lagrange->DeepCopy(bezier);
      lagrange->GetPointData()->SetRationalWeights(nullptr);
      lagrange->GetPointData()->RemoveArray("weights");
      auto* moved = vtkFloatArray::SafeDownCast(lagrange->GetPointData()->GetArray("density"));
      lagrange->Allocate(bezier->GetNumberOfCells());
      for (vtkIdType c = 0; c < bezier->GetNumberOfCells(); ++c) {
        vtkNew<vtkGenericCell> cell;
        bezier->GetCell(c, cell);
        const double* nodes = cell->GetParametricCoords();
        std::vector<double> shapes(static_cast<size_t>(cell->GetNumberOfPoints()));
        for (vtkIdType n = 0; n < cell->GetNumberOfPoints(); ++n) {
          int part = 0;
          double x[3], value = 0.0;
          cell->EvaluateLocation(part, nodes + 3 * n, x, shapes.data());
          for (vtkIdType m = 0; m < cell->GetNumberOfPoints(); ++m) {
            value += shapes[static_cast<size_t>(m)] * values->GetValue(cell->GetPointId(m));
          }
          lagrange->GetPoints()->SetPoint(cell->GetPointId(n), x);
          moved->SetValue(cell->GetPointId(n), static_cast<float>(value));
        }
        lagrange->InsertNextCell(Types[shape][0], cell->GetNumberOfPoints(), cell->GetPointIds()->GetPointer(0));
      }
      scene.Tetrahedra->SetMethodToMarch();
      scene.Tetrahedra->SetInputData(lagrange);
      const std::vector<float> right = scene.GridPicture();
      scene.Tetrahedra->SetInputData(bezier);
      const std::vector<float> ours = scene.GridPicture();
      const double error = TetraError(ours, std::vector<double>(right.begin(), right.end()));
      CHECK(error < 0.05, "shape %d, rational %d: %.4f of 255", shape, rational, error);
      CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
    }
  }
}

void WhatIsRefused()
{
  GridScene scene(64, 48);
  const auto refuses = [&](vtkUnstructuredGrid* grid, const char* word) {
    scene.Tetrahedra->SetInputData(grid);
    CHECK(scene.GridPicture().empty() && scene.GridErrors->Has(word), "not \"%s\": %s", word, scene.GridErrors->Text.c_str());
  };
  const Grid cut = Curved(0, VTK_LAGRANGE_HEXAHEDRON, 2, 2, 2);
  vtkNew<vtkIdList> ids;
  cut->GetCellPoints(3, ids);
  cut->InsertNextCell(VTK_LAGRANGE_HEXAHEDRON, 26, ids->GetPointer(0));
  refuses(cut, "cell 27 is a vtkLagrangeHexahedron (72) of 26 points, no cell of an order 1..64 has so many");
  const Grid wrong = Curved(0, VTK_BEZIER_HEXAHEDRON, 3, 2, 4);
  wrong->GetCellData()->GetHigherOrderDegrees()->SetComponent(5, 1, 7);
  refuses(wrong, "and the grid's degrees");
  wrong->GetCellData()->GetHigherOrderDegrees()->SetNumberOfTuples(4);
  wrong->Modified();
  refuses(wrong, "have 4 and 0 tuples");
}
} // namespace

int main()
{
  EveryKind();
  BezierCellsLieWhereVtkPlacesThem();
  WhatIsRefused();
  return Failures ? 1 : 0;
}
