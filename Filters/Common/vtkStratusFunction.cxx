// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusFunction.h"

#include "vtkColorTransferFunction.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkVariant.h"
#if __has_include("vtkDiscretizableColorTransferFunction.h") // which smaller builds of VTK leave out
#include "vtkDiscretizableColorTransferFunction.h"
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace {
// The bounds on the difference when a bent piece is divided, at the places that are examined, and when points on a line are dropped. Their
// sum is below vtkStratusFunction::Error by the largest possible difference between those places.
constexpr double NearEnough = 4e-6;
constexpr double OnALine = 2e-6;
// Opacities above are 1: VTK's tables of floats do not distinguish them either.
constexpr double Opaque = 1.0 - 1e-9;
// The halvings after which the place where an opacity becomes 1 is known well enough, and after which a piece is no longer divided.
constexpr int OpaqueDepth = 24;
constexpr int MostDepth = 110;
// Points of a piece at which no more are added. It ends the division of a function that changes everywhere, such as noise.
constexpr size_t MostPoints = 65536;
// Entries of VTK's table of a piece in the colour space LabCIEDE2000, whose single values cost VTK 40 ms each.
constexpr int CieEntries = 1 << 20;
// Difference between two neighbouring entries of that table that is a step: less than an 8-bit one, more than any slope's.
constexpr double CieStep = 1e-3;

using Color = std::array<double, 3>;
using Function = std::function<Color(double)>;

struct Point {
  double X;
  Color C;
};

struct Node {
  double X;
  Color C;
  double Midpoint;
  double Sharpness;
};

double Above(double x)
{
  return std::nextafter(x, std::numeric_limits<double>::infinity());
}

double Below(double x)
{
  return std::nextafter(x, -std::numeric_limits<double>::infinity());
}

// Returns the place `t` of 0..1 between a and b, both above 0 where the axis is logarithmic.
double Between(double a, double b, double t, bool logarithmic)
{
  return logarithmic ? a * std::pow(b / a, t) : a + t * (b - a);
}

Color Clamped(Color c)
{
  for (double& channel : c) {
    channel = std::min(1.0, std::max(0.0, channel)); // some colour spaces overshoot
  }
  return c;
}

// Collects points from left to right. They mean what the core takes them for: linear between two points, and the last of several points at
// equal x is the function there.
class Points
{
public:
  std::vector<Point> List;
  bool IsOpacity = false;

  void Add(double x, const Color& c)
  {
    if (this->List.empty() || this->List.back().X != x || this->List.back().C != c) {
      this->List.push_back({ x, c });
    }
  }

  // Adds the function around x, from the numbers just below, at and just above x. The one above may stand for the one at x, which then
  // differs by the slope over one number.
  void AddNode(double x, const Color& below, const Color& at, const Color& above)
  {
    const double same = 1e-12;
    bool steps = false;
    for (int c = 0; c < 3; ++c) {
      steps = steps || !(std::fabs(above[c] - at[c]) <= same);
    }
    if (below != at) {
      this->Add(x, below);
    }
    if (steps) {
      if (below != at) {
        this->Add(x, at);
      }
      this->Add(Above(x), at);
      this->Add(Above(x), above);
    } else {
      this->Add(x, at);
    }
  }

  // Adds a function between the last point and b, which is on it. `breaks` are places between, ascending, at which to divide it first.
  void AddBent(const Function& function, const std::vector<double>& breaks, double b)
  {
    const size_t start = this->List.size() - 1;
    for (size_t n = 0; n <= breaks.size(); ++n) {
      const double x = n < breaks.size() ? breaks[n] : b;
      const Point from = this->List.back();
      if (x > from.X && std::isfinite(x - from.X)) {
        this->Most = this->List.size() + MostPoints;
        this->Divide(function, from, { x, function(x) }, 0);
      }
    }
    this->Straighten(start);
  }

  // Drops points from `start` on that are on a line between their neighbours. The cone of slopes from the last point kept holds all lines
  // that pass near every point since.
  void Straighten(size_t start)
  {
    std::vector<Point> all(this->List.begin() + static_cast<std::ptrdiff_t>(start), this->List.end());
    this->List.resize(start);
    this->List.push_back(all[0]);
    Color low, high;
    const double infinite = std::numeric_limits<double>::infinity();
    low.fill(-infinite);
    high.fill(infinite);
    for (size_t n = 1; n < all.size(); ++n) {
      if (!this->IsInCone(all[n], low, high)) {
        this->List.push_back(all[n - 1]);
        low.fill(-infinite);
        high.fill(infinite);
      }
      const Point& from = this->List.back();
      const double dx = all[n].X - from.X;
      const bool step = !(dx > 0.0) || (n + 1 < all.size() && all[n + 1].X == all[n].X);
      const bool turns = this->IsOpacity && n + 1 < all.size() && (all[n].C[0] == 1.0) != (all[n + 1].C[0] == 1.0);
      const bool turned = this->IsOpacity && (all[n].C[0] == 1.0) != (all[n - 1].C[0] == 1.0);
      if (step || turns || turned || n + 1 == all.size()) {
        this->List.push_back(all[n]);
        low.fill(-infinite);
        high.fill(infinite);
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        low[c] = std::max(low[c], (all[n].C[c] - OnALine - from.C[c]) / dx);
        high[c] = std::min(high[c], (all[n].C[c] + OnALine - from.C[c]) / dx);
      }
    }
  }

private:
  size_t Most = MostPoints;

  bool IsInCone(const Point& p, const Color& low, const Color& high) const
  {
    const Point& from = this->List.back();
    const double dx = p.X - from.X;
    bool inside = true;
    for (int c = 0; c < 3 && dx > 0.0; ++c) {
      const double slope = (p.C[c] - from.C[c]) / dx;
      inside = inside && slope >= low[c] && slope <= high[c];
    }
    return inside;
  }

  bool IsChord(const Function& function, const Point& a, const Point& b, int depth) const
  {
    for (double t : { 0.5, 0.25, 0.75, 0.1, 0.9 }) {
      const Color value = function(a.X + t * (b.X - a.X));
      for (int c = 0; c < 3; ++c) {
        const double chord = a.C[c] + t * (b.C[c] - a.C[c]);
        if (std::fabs(value[c] - chord) > NearEnough) { // not so of NaN, which the core refuses
          return false;
        }
      }
      if (this->IsOpacity && depth < OpaqueDepth && (value[0] == 1.0) != (a.C[0] == 1.0 && b.C[0] == 1.0)) {
        return false;
      }
    }
    return true;
  }

  void Divide(const Function& function, const Point& a, const Point& b, int depth)
  {
    const double x = a.X + 0.5 * (b.X - a.X);
    const bool whole = !(a.X < x && x < b.X) || depth >= MostDepth; // a and b are neighbours
    if (!whole && (this->List.size() > this->Most || this->IsChord(function, a, b, depth))) {
      this->Add(b.X, b.C);
    } else if (whole) {
      this->Add(b.X, a.C);
      this->Add(b.X, b.C);
    } else {
      const Point middle = { x, function(x) };
      this->Divide(function, a, middle, depth + 1);
      this->Divide(function, middle, b, depth + 1);
    }
  }
};

// The data that a function is translated from. The value between two nodes depends only on these two. It is evaluated by a function of two
// nodes, because VTK searches all nodes of a function each time.
struct Source {
  std::vector<Node> Nodes;
  bool Straight = true; // linear between nodes of midpoint .5 and sharpness 0
  bool Logarithmic = false;
  bool TakesLast = false; // of several nodes at a place, else the first one
  Function Whole;
  std::function<Function(const Node&, const Node&)> Piece;
  // Adds the points between two nodes instead of Piece, if set.
  std::function<void(Points&, const Node&, const Node&)> AddPiece;
};

// Returns where a bent piece has its midpoint: its slope jumps there, or its value.
std::vector<double> MidpointOf(const Node& a, const Node& b, bool logarithmic)
{
  const double x = Between(a.X, b.X, std::min(0.99999, std::max(0.00001, a.Midpoint)), logarithmic);
  return x > a.X && x < b.X ? std::vector<double>{ x } : std::vector<double>();
}

void Translate(const Source& source, Points& points)
{
  const std::vector<Node>& nodes = source.Nodes;
  Color below = source.Whole(Below(nodes[0].X)), at = source.Whole(nodes[0].X);
  for (size_t first = 0; first < nodes.size();) {
    const double x = nodes[first].X;
    size_t last = first;
    while (last + 1 < nodes.size() && nodes[last + 1].X <= x) {
      ++last;
    }
    if (last > first && source.TakesLast) {
      at = nodes[last].C;
    }
    first = last + 1;
    if (first == nodes.size()) { // VTK may round a logarithmic end to beyond the range
      points.AddNode(x, below, source.Whole(x), source.Whole(Above(x)));
      return;
    }
    const Node &left = nodes[last], &right = nodes[first];
    if (source.Straight && left.Midpoint == 0.5 && left.Sharpness == 0.0) {
      points.AddNode(x, below, at, left.C);
      at = right.C;
    } else if (source.AddPiece) {
      points.AddNode(x, below, at, at);
      source.AddPiece(points, left, right);
      at = points.List.back().C;
    } else {
      const Function piece = source.Piece(left, right);
      points.AddNode(x, below, at, piece(Above(x)));
      points.AddBent(piece, MidpointOf(left, right, source.Logarithmic), right.X);
      at = piece(right.X);
    }
    below = at;
  }
}

// Asks VTK which of several nodes at a place an opacity is taken from: in 9.1 the first one, in 9.3 the last.
bool TakesLast()
{
  static const bool last = [] {
    vtkNew<vtkPiecewiseFunction> steps;
    steps->AllowDuplicateScalarsOn();
    for (const double y : { 0.0, 1.0 }) {
      steps->AddPoint(0.0, y);
      steps->AddPoint(2.0 * y - 1.0, y);
    }
    return steps->GetValue(0.0) > 0.5;
  }();
  return last;
}

Source SourceOf(vtkPiecewiseFunction* function)
{
  Source source;
  for (int n = 0; n < function->GetSize(); ++n) {
    double node[4];
    function->GetNodeValue(n, node);
    source.Nodes.push_back({ node[0], { node[1], node[1], node[1] }, node[2], node[3] });
  }
  source.Logarithmic = function->GetUseLogScale();
  source.Straight = !source.Logarithmic;
  source.TakesLast = TakesLast();
  source.Whole = [function](double x) {
    const double y = function->GetValue(x);
    return Color{ y, y, y };
  };
  vtkNew<vtkPiecewiseFunction> two;
  two->SetUseLogScale(function->GetUseLogScale());
  vtkSmartPointer<vtkPiecewiseFunction> kept = two.Get();
  source.Piece = [kept](const Node& a, const Node& b) -> Function {
    kept->RemoveAllPoints();
    kept->AddPoint(a.X, a.C[0], a.Midpoint, a.Sharpness);
    kept->AddPoint(b.X, b.C[0]);
    const double low = std::min(a.C[0], b.C[0]), high = std::max(a.C[0], b.C[0]);
    return [=](double x) {
      double y = kept->GetValue(x);
      y = y < low ? low : y > high ? high : y; // but for rounding, VTK does so; NaN stays
      y = y > Opaque && y < 1.0 ? 1.0 : y;
      return Color{ y, y, y };
    };
  };
  return source;
}

void SetColorNode(vtkColorTransferFunction* function, const Node& n)
{
  function->AddRGBPoint(n.X, n.C[0], n.C[1], n.C[2], n.Midpoint, n.Sharpness);
}

// Adds the points of VTK's table between two nodes: its entries, but a step where neighbours differ by more than a slope can make.
void AddTable(vtkColorTransferFunction* two, Points& points, const Node& a, const Node& b, bool logarithmic)
{
  two->RemoveAllPoints();
  SetColorNode(two, a);
  SetColorNode(two, b);
  std::vector<double> table(3 * (CieEntries + 1));
  two->GetTable(a.X, b.X, CieEntries + 1, table.data());
  const size_t start = points.List.size() - 1;
  for (int e = 1; e <= CieEntries; ++e) {
    const double* entry = &table[3 * static_cast<size_t>(e)];
    const Color c = Clamped({ entry[0], entry[1], entry[2] }), before = points.List.back().C;
    const double x = e == CieEntries ? b.X : Between(a.X, b.X, static_cast<double>(e) / CieEntries, logarithmic);
    if (std::fabs(c[0] - before[0]) + std::fabs(c[1] - before[1]) + std::fabs(c[2] - before[2]) > CieStep) {
      points.Add(x, before);
    }
    points.Add(x, c);
  }
  points.Straighten(start);
}

Source SourceOf(vtkColorTransferFunction* function)
{
  Source source;
  for (int n = 0; n < function->GetSize(); ++n) {
    double node[6];
    function->GetNodeValue(n, node);
    source.Nodes.push_back({ node[0], { node[1], node[2], node[3] }, node[4], node[5] });
  }
  const bool logarithmic = function->GetScale() == VTK_CTF_LOG10 && !source.Nodes.empty() && source.Nodes[0].X > 0.0; // as VTK decides
  source.Logarithmic = logarithmic;
  source.Straight = !logarithmic && function->GetColorSpace() == VTK_CTF_RGB;
  source.Whole = [function](double x) {
    Color c;
    function->GetColor(x, c.data());
    return c;
  };
  vtkSmartPointer<vtkColorTransferFunction> two = vtkSmartPointer<vtkColorTransferFunction>::New();
  two->SetColorSpace(function->GetColorSpace());
  two->SetHSVWrap(function->GetHSVWrap());
  two->SetScale(logarithmic ? VTK_CTF_LOG10 : VTK_CTF_LINEAR);
  if (function->GetColorSpace() == VTK_CTF_LAB_CIEDE2000) {
    source.AddPiece = [=](Points& points, const Node& a, const Node& b) { AddTable(two, points, a, b, logarithmic); };
  }
  source.Piece = [two](const Node& a, const Node& b) -> Function {
    two->RemoveAllPoints();
    SetColorNode(two, a);
    SetColorNode(two, b);
    return [two](double x) {
      Color c;
      two->GetColor(x, c.data());
      return Clamped(c);
    };
  };
  return source;
}

// Adds a function that colours a few values by themselves, and all others as "none of these".
void TranslateIndexed(vtkColorTransferFunction* function, const Function& whole, Points& points)
{
  std::vector<double> values;
  for (vtkIdType n = 0; n < function->GetNumberOfAnnotatedValues(); ++n) {
    bool valid = false;
    const double value = function->GetAnnotatedValue(n).ToDouble(&valid);
    if (valid && std::isfinite(value)) {
      values.push_back(value);
    }
  }
  values.push_back(values.empty() ? 0.0 : values[0]);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  for (double x : values) {
    points.AddNode(x, whole(Below(x)), whole(x), whole(Above(x)));
  }
}

// The number of colours that a function which may be discretised is divided into, 0 for none; -1: it cannot be discretised.
int StepsOf(vtkColorTransferFunction* function)
{
  int steps = -1;
#ifdef vtkDiscretizableColorTransferFunction_h
  auto* discrete = vtkDiscretizableColorTransferFunction::SafeDownCast(function);
  steps = !discrete ? -1 : discrete->GetDiscretize() ? static_cast<int>(discrete->GetNumberOfValues()) : 0;
#else
  (void)function;
#endif
  return steps;
}

// Adds a function of a derived class, of which only GetColor() is known. Discretised functions change once between the middles of two of
// their colours. Others are divided at their nodes and 64 times between two, then where they bend.
void TranslateDerived(vtkColorTransferFunction* function, const Source& source, Points& points)
{
  const Function whole = [&](double x) { return Clamped(source.Whole(x)); };
  const int colors = StepsOf(function);
  const bool bins = colors > 0;
  const int parts = bins ? colors : 64;
  const bool logarithmic = function->UsingLogScale() && source.Nodes[0].X > 0.0;
  std::vector<double> ends;
  for (const Node& node : source.Nodes) {
    if ((!bins || ends.size() < 2) && (ends.empty() || node.X > ends.back())) {
      ends.push_back(node.X);
    } else if (bins) {
      ends.back() = std::max(ends.back(), node.X);
    }
  }
  points.AddNode(ends[0], whole(Below(ends[0])), whole(ends[0]), whole(Above(ends[0])));
  for (size_t n = 0; n + 1 < ends.size(); ++n) {
    std::vector<double> breaks;
    for (int p = 0; p < parts; ++p) {
      breaks.push_back(Between(ends[n], ends[n + 1], (p + 0.5) / parts, logarithmic));
    }
    points.AddBent(whole, breaks, ends[n + 1]);
    const Color at = whole(ends[n + 1]);
    points.AddNode(ends[n + 1], at, at, whole(Above(ends[n + 1])));
  }
}

void Store(const Points& points, int width, std::vector<double>& result)
{
  result.clear();
  result.reserve(points.List.size() * static_cast<size_t>(width + 1));
  for (const Point& point : points.List) {
    result.push_back(point.X);
    result.insert(result.end(), point.C.begin(), point.C.begin() + width);
  }
}
} // namespace

bool vtkStratusFunction::IsCurrent(vtkObject* function, int width)
{
  const vtkMTimeType time = function->GetMTime();
  if (this->Source == function && this->Time == time && this->Width == width) {
    return true;
  }
  this->Source = function;
  this->Time = time;
  this->Width = width;
  ++this->Builds;
  return false;
}

bool vtkStratusFunction::Set(vtkPiecewiseFunction* function, int width)
{
  if (!this->IsCurrent(function, width)) {
    ::Points points;
    points.IsOpacity = true;
    if (function->GetSize() > 0) {
      Translate(SourceOf(function), points);
    }
    Store(points, width, this->Points);
  }
  return !this->Points.empty();
}

bool vtkStratusFunction::Set(vtkColorTransferFunction* function)
{
  const int steps = StepsOf(function);
  if (steps >= 0) {
    function->Build(); // its GetColor() reads what this builds
  }
  if (this->IsCurrent(function, 3)) {
    return !this->Points.empty();
  }
  ::Points points;
  const ::Source source = SourceOf(function);
  const bool plain = steps >= 0 ? steps == 0 : std::string(function->GetClassName()) == "vtkColorTransferFunction";
  if (function->GetIndexedLookup()) {
    TranslateIndexed(function, source.Whole, points);
  } else if (!source.Nodes.empty() && plain) {
    Translate(source, points);
  } else if (!source.Nodes.empty()) {
    TranslateDerived(function, source, points);
  }
  Store(points, 3, this->Points);
  return !this->Points.empty();
}
