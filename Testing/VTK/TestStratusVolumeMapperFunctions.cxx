// SPDX-License-Identifier: BSD-3-Clause
// VTK's functions as the core's points, against VTK's own GetValue() and GetColor(): at random values, and at and on both sides of every
// node. And the count of translations: one a change, none else.
#include "mapper_testing.h"
#include "vtkStratusFunction.h"

#include "vtkDiscretizableColorTransferFunction.h"
#include "vtkMinimalStandardRandomSequence.h"

#include <limits>

namespace {
constexpr double Infinite = std::numeric_limits<double>::infinity();
using Color = std::array<double, 3>;

// The core's function, by the words of stratus_transfer: linear between points, at equal values the last one, the ends' beyond.
double At(const vtkStratusFunction& f, int width, int channel, double x)
{
  const double* points = f.GetPoints();
  const size_t stride = static_cast<size_t>(width) + 1;
  size_t low = 0, high = f.GetCount(); // points before `low` are <= x
  while (low < high) {
    const size_t middle = (low + high) / 2;
    (points[middle * stride] <= x ? low : high) = points[middle * stride] <= x ? middle + 1 : middle;
  }
  const size_t c = static_cast<size_t>(channel) + 1;
  if (low == 0) {
    return points[c];
  }
  const double* left = points + (low - 1) * stride;
  if (low == f.GetCount()) {
    return left[c];
  }
  const double t = (x - left[0]) / (left[stride] - left[0]);
  return left[c] + t * (left[stride + c] - left[c]);
}

class Values
{
public:
  double Next() // 0..1
  {
    this->Sequence->Next();
    return this->Sequence->GetValue();
  }
  double Next(double a, double b) { return a + (b - a) * this->Next(); }

private:
  vtkNew<vtkMinimalStandardRandomSequence> Sequence;
};

// Places to look at: both sides of every node, its midpoint, random ones between nodes and beyond the ends.
std::vector<double> Places(const std::vector<std::array<double, 2>>& nodes, bool logarithmic, int count)
{
  Values random;
  std::vector<double> places;
  const double low = nodes.front()[0], high = nodes.back()[0], range = high > low ? high - low : 1.0;
  for (size_t n = 0; n < nodes.size(); ++n) {
    const double x = nodes[n][0];
    for (double at : { x, std::nextafter(x, -Infinite), std::nextafter(x, Infinite), x - 1e-9 * range, x + 1e-9 * range }) {
      places.push_back(at);
    }
    if (n + 1 < nodes.size() && nodes[n + 1][0] > x) {
      const double next = nodes[n + 1][0], m = nodes[n][1];
      const double middle = logarithmic && x > 0.0 ? x * std::pow(next / x, m) : x + m * (next - x);
      for (int side = -3; side <= 3; ++side) {
        places.push_back(middle + side * 1e-6 * (next - x));
      }
      for (int r = 0; r < count; ++r) {
        places.push_back(random.Next(x, next));
      }
    }
  }
  places.insert(places.end(), { low - range, high + range, random.Next(low - range, low), random.Next(high, high + range) });
  return places;
}

size_t CheckOpacity(const char* what, vtkPiecewiseFunction* f, int count = 2000)
{
  std::vector<std::array<double, 2>> nodes;
  for (int n = 0; n < f->GetSize(); ++n) {
    double node[4];
    f->GetNodeValue(n, node);
    nodes.push_back({ node[0], node[2] });
  }
  vtkStratusFunction ours;
  CHECK(ours.Set(f, 1) && ours.GetCount() >= 1, "%s: no points", what);
  double worst = 0.0, where = 0.0;
  for (double x : Places(nodes, f->GetUseLogScale(), count)) {
    const double error = std::fabs(At(ours, 1, 0, x) - f->GetValue(x));
    if (!(error <= worst)) {
      worst = error;
      where = x;
    }
  }
  CHECK(worst <= vtkStratusFunction::Error, "%s at %.17g: %.9g, VTK says %.9g", what, where, At(ours, 1, 0, where), f->GetValue(where));
  for (size_t n = 1; n < ours.GetCount(); ++n) {
    CHECK(ours.GetPoints()[2 * n] >= ours.GetPoints()[2 * n - 2], "%s: point %zu is before its predecessor", what, n);
  }
  printf("%s: %d nodes, %zu points, error %.2g\n", what, f->GetSize(), ours.GetCount(), worst);
  return ours.GetCount();
}

size_t CheckColor(const char* what, vtkColorTransferFunction* f, int count = 2000, double share = 0.0)
{
  std::vector<std::array<double, 2>> nodes;
  for (int n = 0; n < f->GetSize(); ++n) {
    double node[6];
    f->GetNodeValue(n, node);
    nodes.push_back({ node[0], node[4] });
  }
  vtkStratusFunction ours;
  CHECK(ours.Set(f) && ours.GetCount() >= 1, "%s: no points", what);
  double worst = 0.0;
  int wrong = 0, all = 0;
  for (double x : Places(nodes, f->GetScale() == VTK_CTF_LOG10, count)) {
    Color theirs;
    f->GetColor(x, theirs.data());
    if (f->GetScale() == VTK_CTF_LOG10 && nodes.front()[0] > 0.0 && x < 0.0) { // VTK takes the logarithm of x
      continue;
    }
    double error = 0.0;
    for (int c = 0; c < 3; ++c) {
      // Colour spaces overshoot, and the core takes colours in 0..1.
      error = std::max(error, std::fabs(At(ours, 3, c, x) - std::min(1.0, std::max(0.0, theirs[c]))));
    }
    worst = std::max(worst, error);
    wrong += !(error <= vtkStratusFunction::Error);
    ++all;
    CHECK(error <= vtkStratusFunction::Error || share > 0.0, "%s at %.17g: error %g", what, x, error);
  }
  CHECK(wrong <= share * all, "%s: %d of %d values are wrong", what, wrong, all);
  printf("%s: %d nodes, %zu points, error %.2g\n", what, f->GetSize(), ours.GetCount(), worst);
  return ours.GetCount();
}

void Opacities()
{
  vtkNew<vtkPiecewiseFunction> f;
  f->AddPoint(3, 0.5);
  CheckOpacity("one node", f);
  f->ClampingOff();
  CheckOpacity("one node, not clamped", f);
  f->AddPoint(0, 0.25);
  f->AddPoint(7, 0.75);
  CheckOpacity("not clamped", f);
  f->ClampingOn();
  CHECK(CheckOpacity("linear", f) == 3, "linear pieces are more than two points each");
  f->RemoveAllPoints();
  f->AllowDuplicateScalarsOn();
  for (int k = 0; k < 10; ++k) { // plateaus between steps, at 0 and negative, too
    f->AddPoint(k - 4, 0.1 * ((k * 3) % 10));
    f->AddPoint(k - 4, 0.1 * ((k * 7) % 10));
  }
  CheckOpacity("steps at integers", f);
  f->AddPoint(2.5, 0.1);
  f->AddPoint(2.5, 1.0);
  f->AddPoint(2.5, 0.3);
  CheckOpacity("three nodes at a value", f);
  f->AllowDuplicateScalarsOff();
  for (double sharpness : { 0.0, 0.005, 0.02, 0.3, 0.7, 0.95, 0.985, 0.995, 1.0 }) {
    for (double midpoint : { 0.0, 1e-4, 0.2, 0.5, 0.83, 1.0 }) {
      for (bool logarithmic : { false, true }) {
        char what[64];
        snprintf(what, sizeof what, "midpoint %g, sharpness %g%s", midpoint, sharpness, logarithmic ? ", logarithmic" : "");
        f->RemoveAllPoints();
        f->SetUseLogScale(logarithmic);
        f->AddPoint(0.01, 0.0, midpoint, sharpness);
        f->AddPoint(2, 1.0, midpoint, sharpness);
        f->AddPoint(2.0002, 0.4, midpoint, sharpness);
        f->AddPoint(90, 0.9);
        CHECK(CheckOpacity(what, f) < 10000, "%s: too many points", what);
      }
    }
  }
  f->SetUseLogScale(false);
  f->RemoveAllPoints();
  f->AddPoint(0, 0);
  for (double x : { 100.0, 500.0, 900.0 }) { // features of 1e-6 of the range
    f->AddPoint(x, 0);
    f->AddPoint(x + 0.0003, 1);
    f->AddPoint(x + 0.0007, 1);
    f->AddPoint(x + 0.001, 0);
  }
  f->AddPoint(1000, 0);
  CHECK(CheckOpacity("features of a millionth", f) == 14, "linear pieces are more than two points each");
  Values random;
  f->RemoveAllPoints();
  std::vector<double> table(5000);
  for (double& y : table) {
    y = random.Next();
  }
  f->BuildFunctionFromTable(-3, 11, static_cast<int>(table.size()), table.data());
  CHECK(CheckOpacity("5000 nodes", f, 2) == 5000, "linear pieces are more than two points each");
  f->RemoveAllPoints();
  for (int n = 0; n < 200; ++n) {
    f->AddPoint(n + random.Next(), random.Next(), random.Next(), random.Next());
  }
  CheckOpacity("200 bent nodes", f, 100);
}

void Colors()
{
  using Set = void (vtkColorTransferFunction::*)();
  const std::pair<const char*, Set> spaces[] = { { "RGB", &vtkColorTransferFunction::SetColorSpaceToRGB },
    { "HSV", &vtkColorTransferFunction::SetColorSpaceToHSV }, { "HSV, not wrapped", &vtkColorTransferFunction::SetColorSpaceToHSV },
    { "Lab", &vtkColorTransferFunction::SetColorSpaceToLab }, { "diverging", &vtkColorTransferFunction::SetColorSpaceToDiverging },
    { "step", &vtkColorTransferFunction::SetColorSpaceToStep } };
  for (const auto& space : spaces) {
    for (bool logarithmic : { false, true }) {
      for (bool bent : { false, true }) {
        const std::string what = std::string(space.first) + (logarithmic ? ", logarithmic" : "") + (bent ? ", bent" : "");
        vtkNew<vtkColorTransferFunction> f;
        ((*f).*space.second)();
        f->SetHSVWrap(std::string(space.first) != "HSV, not wrapped");
        f->SetScale(logarithmic ? VTK_CTF_LOG10 : VTK_CTF_LINEAR);
        f->AddRGBPoint(0.05, 1, 0, 0.1, bent ? 0.3 : 0.5, bent ? 0.4 : 0.0);
        f->AddRGBPoint(1, 0, 0.2, 1, bent ? 0.6 : 0.5, bent ? 1.0 : 0.0);
        f->AddRGBPoint(1.5, 0.9, 0.8, 0.1, bent ? 0.8 : 0.5, 0.0);
        f->AddRGBPoint(1.50001, 0.2, 0.9, 0.3, 0.5, bent ? 0.9 : 0.0);
        f->AddRGBPoint(70, 0.2, 0.2, 0.2);
        const size_t points = CheckColor(what.c_str(), f);
        CHECK(points < 10000, "%s: %zu points", what.c_str(), points);
        CHECK(points == 5 || space.second != spaces[0].second || logarithmic || bent, "linear pieces are more than two points each");
      }
    }
  }
  vtkNew<vtkColorTransferFunction> f;
  f->SetScaleToLog10(); // which VTK ignores from 0 down
  f->AddRGBPoint(-1, 1, 0, 0);
  f->AddRGBPoint(5, 0, 1, 0);
  CheckColor("logarithmic below 0", f);
  f->SetBelowRangeColor(0.1, 0.2, 0.3);
  f->SetAboveRangeColor(0.4, 0.5, 0.6);
  f->UseBelowRangeColorOn();
  f->UseAboveRangeColorOn();
  CheckColor("colours beyond the range", f);
  f->AddRGBPoint(-1, 1, 0, 0);
  f->RemovePoint(-1);
  f->AddRGBPoint(0.3, 1, 0, 0);
  CheckColor("colours beyond a logarithmic range", f);
  f->ClampingOff();
  CheckColor("not clamped", f);
  f->AllowDuplicateScalarsOn();
  f->AddRGBPoint(2, 0, 0, 1);
  f->AddRGBPoint(2, 1, 1, 0);
  CheckColor("a step", f);
  vtkNew<vtkColorTransferFunction> cie; // VTK takes 40 ms a value, rounds to 8 bits, and the steps are found to 2^-20 of a piece
  cie->SetColorSpaceToLabCIEDE2000();
  cie->AddRGBPoint(0, 1, 0, 0);
  cie->AddRGBPoint(1, 0, 0.2, 1);
  CheckColor("LabCIEDE2000", cie, 60, 0.05);
  for (bool logarithmic : { false, true }) {
    vtkNew<vtkDiscretizableColorTransferFunction> discrete;
    discrete->SetUseLogScale(logarithmic);
    discrete->AddRGBPoint(0.03, 1, 0.2, 0.1);
    discrete->AddRGBPoint(3, 0.2, 0.9, 0.3);
    discrete->AddRGBPoint(9, 0.1, 0.3, 1);
    discrete->SetNumberOfValues(7);
    CheckColor("to be discretised", discrete);
    discrete->DiscretizeOn();
    discrete->Build();
    CheckColor("discretised", discrete);
    discrete->SetNumberOfValues(256);
    discrete->Build();
    CheckColor("discretised as by ParaView", discrete);
  }
  vtkNew<vtkDiscretizableColorTransferFunction> indexed;
  indexed->IndexedLookupOn();
  indexed->AddRGBPoint(0, 1, 0, 0);
  indexed->AddRGBPoint(1, 0, 1, 0);
  indexed->SetNumberOfIndexedColors(2);
  indexed->SetIndexedColor(0, 1, 0.5, 0);
  indexed->SetIndexedColor(1, 0, 0.25, 1);
  indexed->SetAnnotation(vtkVariant(0), "none");
  indexed->SetAnnotation(vtkVariant(1), "one");
  indexed->Build();
  CheckColor("labels' own colours", indexed);
}

void Builds()
{
  vtkStratusFunction ours;
  vtkNew<vtkPiecewiseFunction> f, g;
  f->AddPoint(0, 0.1, 0.3, 0.4);
  f->AddPoint(1, 0.9);
  g->DeepCopy(f);
  ours.Set(f, 1);
  ours.Set(f, 1);
  CHECK(ours.GetBuilds() == 1, "a function that did not change was translated again");
  f->AddPoint(2, 0.5);
  ours.Set(f, 1);
  CHECK(ours.GetBuilds() == 2 && At(ours, 1, 0, 2.0) == 0.5, "an edit was not seen");
  ours.Set(g, 1);
  CHECK(ours.GetBuilds() == 3 && At(ours, 1, 0, 2.0) == 0.9, "another function was not seen");
  ours.Set(g, 3);
  CHECK(ours.GetBuilds() == 4 && At(ours, 3, 2, 2.0) == 0.9, "grey was taken for opacity");
}

vtkTypeUInt64 FunctionsOf(Scene& scene)
{
  scene.Render();
  return scene.Mapper->GetFunctionBuilds();
}

// A still picture, a turn and a change that concerns no function translate nothing; an edit translates the function that was edited.
void Pictures()
{
  Scene scene(32, 24);
  vtkTypeUInt64 before = FunctionsOf(scene);
  CHECK(before == 2, "the first picture translated %llu functions, not 2", static_cast<unsigned long long>(before));
  const auto expect = [&](const char* what, vtkTypeUInt64 functions) {
    const vtkTypeUInt64 now = FunctionsOf(scene) - before;
    CHECK(now == functions, "%s: %llu functions were translated, not %llu", what, static_cast<unsigned long long>(now),
      static_cast<unsigned long long>(functions));
    before += now;
  };
  expect("a still picture", 0);
  scene.Renderer->GetActiveCamera()->Azimuth(20);
  expect("a turn", 0);
  scene.Volume->GetProperty()->SetScalarOpacityUnitDistance(0.7);
  expect("a unit distance", 0);
  scene.Image->Modified();
  expect("data", 0);
  scene.Opacity->AddPoint(0.3, 0.4);
  expect("an edit of the opacity", 1);
  scene.Color->SetColorSpaceToLab();
  expect("a colour space", 1);
  scene.Color->AddRGBPoint(0.4, 0, 1, 0);
  scene.Opacity->AddPoint(0.3, 0.5);
  expect("an edit of both", 2);
  vtkNew<vtkPiecewiseFunction> other;
  other->AddPoint(0.5, 0.2);
  scene.Volume->GetProperty()->SetScalarOpacity(other);
  expect("another function", 1);
  expect("a still picture", 0);
}
} // namespace

int main()
{
  Opacities();
  Colors();
  Builds();
  Pictures();
  return Failures == 0 ? 0 : 1;
}
