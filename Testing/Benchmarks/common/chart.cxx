// SPDX-License-Identifier: BSD-3-Clause
#include "bench.h"

#include <vtkAxis.h>
#include <vtkChartLegend.h>
#include <vtkChartXY.h>
#include <vtkContextScene.h>
#include <vtkContextView.h>
#include <vtkFloatArray.h>
#include <vtkGL2PSExporter.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPlotPoints.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace bench {

namespace {

// Sizes in pixels: of a chart among others in one picture, and of one on a page.
constexpr int width = 720, height = 460;
constexpr int page_width = 560, page_height = 420, line_of_legend = 19;
// In SVG, by how much the vertical axis's title moves away from its labels, which other fonts than VTK's make wider, and the room it gets.
constexpr int title_moves = 12, title_room = 8;

// Blues and greens are ours, other colours are peers.
const unsigned char ours[][3] = { { 11, 79, 138 }, { 44, 160, 44 }, { 23, 190, 207 }, { 94, 60, 153 }, { 74, 155, 212 }, { 102, 166, 30 },
  { 27, 158, 119 }, { 128, 115, 172 }, { 65, 182, 196 }, { 120, 198, 121 } };
const unsigned char peers[][3] = { { 214, 39, 40 }, { 255, 127, 14 }, { 227, 119, 194 }, { 140, 86, 75 }, { 188, 189, 34 },
  { 127, 127, 127 }, { 165, 15, 21 }, { 253, 174, 97 } };

// Returns the family's number among ours or among peers, in the order of the first calls.
size_t number_of(const std::string& family)
{
  static std::vector<std::string> seen[2];
  std::vector<std::string>& list = seen[is_ours(family)];
  auto found = std::find(list.begin(), list.end(), family);
  found = found == list.end() ? list.insert(list.end(), family) : found;
  return static_cast<size_t>(found - list.begin());
}

const unsigned char* rgb_of(const std::string& family)
{
  const size_t number = number_of(family);
  return is_ours(family) ? ours[number % 10] : peers[number % 8];
}

void range(vtkAxis* axis, double low, double high, const std::string& title, int font)
{
  axis->LogScaleOn();
  axis->SetBehavior(vtkAxis::FIXED);
  axis->SetUnscaledRange(low, high);
  axis->SetTitle(title);
  axis->SetGridVisible(false); // in SVG it would be drawn over the marks
  axis->GetLabelProperties()->SetFontSize(font);
  axis->GetTitleProperties()->SetFontSize(font);
}

// Finds the ends of an axis, a little beyond the values. Where they lie close together, it still spans a factor of ten.
void ends(const std::vector<double>& values, double& low, double& high)
{
  low = *std::min_element(values.begin(), values.end()) / 1.3;
  high = *std::max_element(values.begin(), values.end()) * 1.3;
  const double room = std::max(std::sqrt(10.0 * low / high), 1.0);
  low /= room;
  high *= room;
}

// A line through a method's settings, with a mark at each.
void add_line(vtkChartXY* chart, const std::string& family, std::vector<const curve_point*> points)
{
  vtkNew<vtkTable> table;
  vtkNew<vtkFloatArray> x;
  vtkNew<vtkFloatArray> y;
  std::sort(points.begin(), points.end(), [](const curve_point* a, const curve_point* b) { return a->y > b->y; });
  x->SetName("x");
  y->SetName(family.c_str());
  for (const curve_point* p : points) {
    x->InsertNextValue(static_cast<float>(p->x));
    y->InsertNextValue(static_cast<float>(p->y));
  }
  table->AddColumn(x);
  table->AddColumn(y);
  auto* plot = vtkPlotPoints::SafeDownCast(chart->AddPlot(points.size() > 1 ? vtkChart::LINE : vtkChart::POINTS));
  const unsigned char* c = rgb_of(family);
  plot->SetInputData(table, 0, 1);
  plot->SetColor(c[0], c[1], c[2], 255);
  plot->SetWidth(is_ours(family) ? 2.5f : 1.5f);
  plot->SetMarkerStyle(is_ours(family) ? vtkPlotPoints::CIRCLE : number_of(family) % 2 ? vtkPlotPoints::DIAMOND : vtkPlotPoints::SQUARE);
  plot->SetMarkerSize(9.0f);
  // Marks of the line's own colour: VTK 9.3 writes none to SVG that have no colours of their own.
  vtkNew<vtkLookupTable> marks;
  marks->SetNumberOfTableValues(1);
  marks->SetTableValue(0, c[0] / 255.0, c[1] / 255.0, c[2] / 255.0, 1.0);
  plot->SetLookupTable(marks);
  plot->SelectColorArray("x");
  plot->ScalarVisibilityOn();
}

// Returns the number of lines.
int fill(vtkChartXY* chart, const curves& c, const std::string& scene, int font)
{
  std::vector<std::string> families;
  std::vector<double> x, y;
  for (const curve_point& p : c.points) {
    if (p.scene == scene) {
      x.push_back(p.x);
      y.push_back(p.y);
      if (std::find(families.begin(), families.end(), family_of(p.method)) == families.end()) {
        families.push_back(family_of(p.method));
      }
    }
  }
  for (const std::string& family : families) {
    std::vector<const curve_point*> points;
    for (const curve_point& p : c.points) {
      if (p.scene == scene && family_of(p.method) == family) {
        points.push_back(&p);
      }
    }
    add_line(chart, family, points);
  }
  double low;
  double high;
  ends(x, low, high);
  range(chart->GetAxis(vtkAxis::BOTTOM), low, high, c.x_title, font);
  ends(y, low, high);
  range(chart->GetAxis(vtkAxis::LEFT), low, high, c.y_title, font);
  chart->SetTitle(scene);
  chart->SetShowLegend(true);
  chart->GetLegend()->SetInline(false); // next to the plot, where it hides no mark
  chart->GetLegend()->SetLabelSize(font - 2);
  return static_cast<int>(families.size());
}

void open(vtkContextView* view, int across, int down)
{
  view->GetRenderWindow()->SetOffScreenRendering(1);
  view->GetRenderWindow()->SetMultiSamples(4);
  view->GetRenderWindow()->SetSize(across, down);
  view->GetRenderer()->SetBackground(1, 1, 1);
}

void write_png(vtkContextView* view, const std::string& path)
{
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(view->GetRenderWindow());
  grab->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputConnection(grab->GetOutputPort());
  writer->Write();
  if (writer->GetErrorCode() != 0) {
    throw failure("cannot write " + path);
  }
}

// Sends the standard error nowhere while it lives.
struct silence {
  silence() : kept(dup(STDERR_FILENO))
  {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
  }
  ~silence()
  {
    dup2(kept, STDERR_FILENO);
    close(kept);
  }
  silence(const silence&) = delete;
  silence& operator=(const silence&) = delete;
  int kept;
};

void replace(std::string& line, const std::string& from, const std::string& to)
{
  const size_t at = line.find(from);
  if (at != std::string::npos) {
    line.replace(at, from.size(), to);
  }
}

// The exporter writes the time of day and sizes in points. This function removes both, so that equal tables give equal files. It also adds
// fonts to fall back on.
void write_svg(vtkContextView* view, const std::string& stem)
{
  vtkNew<vtkGL2PSExporter> exporter;
  exporter->SetRenderWindow(view->GetRenderWindow());
  exporter->SetFileFormatToSVG();
  exporter->CompressOff();
  exporter->SetFilePrefix(stem.c_str());
  {
    const silence quiet; // GL2PS reports for each chart that it embeds no image; no chart has one
    exporter->Write();
  }
  std::ostringstream text;
  std::ifstream in(stem + ".svg");
  for (std::string line; std::getline(in, line);) {
    if (line.find("     width=\"") == 0) {
      const std::string width = std::to_string(page_width), wider = std::to_string(page_width + title_room);
      replace(line, "width=\"" + width + "pt\"", "width=\"" + wider + "\"");
      replace(line, "pt\"", "\"");
      replace(line, "\"0 0 " + width, "\"-" + std::to_string(title_room) + " 0 " + wider);
    }
    if (line.find("rotate(-90") != std::string::npos) {
      replace(line, " dy=\"0\"", " dy=\"-" + std::to_string(title_moves) + "\"");
    }
    replace(line, "\"Helvetica\"", "\"Helvetica, Arial, sans-serif\"");
    if (line.compare(0, 13, "CreationDate:") != 0) {
      text << line << '\n';
    }
  }
  in.close();
  std::ofstream out(stem + ".svg");
  out << text.str();
  out.close();
  if (text.str().find("<svg") == std::string::npos || !out) {
    throw failure("cannot write " + stem + ".svg");
  }
}
} // namespace

std::string color_of(const std::string& family)
{
  const unsigned char* c = rgb_of(family);
  char text[16];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", c[0], c[1], c[2]);
  return text;
}

void write_chart(const std::string& path, const curves& c)
{
  const std::vector<std::string> scenes = scenes_of(c);
  if (scenes.empty()) {
    throw failure("nothing to chart: no method has both a time and an error");
  }
  const int columns = scenes.size() > 1 ? 2 : 1;
  const int lines = (static_cast<int>(scenes.size()) + columns - 1) / columns;
  vtkNew<vtkContextView> view;
  open(view, columns * width, lines * height);
  for (size_t i = 0; i < scenes.size(); ++i) {
    const int column = static_cast<int>(i) % columns;
    const int line = lines - 1 - static_cast<int>(i) / columns;
    vtkNew<vtkChartXY> chart;
    fill(chart, c, scenes[i], 12);
    chart->GetLegend()->SetHorizontalAlignment(vtkChartLegend::RIGHT);
    chart->SetAutoSize(false);
    chart->SetSize(vtkRectf(static_cast<float>(column * width), static_cast<float>(line * height), width, height));
    view->GetScene()->AddItem(chart);
  }
  view->GetRenderWindow()->Render();
  write_png(view, path);
}

void write_scene_chart(const std::string& stem, const curves& c, const std::string& scene)
{
  vtkNew<vtkChartXY> chart;
  const int lines = fill(chart, c, scene, 14);
  chart->GetLegend()->SetHorizontalAlignment(vtkChartLegend::CENTER);
  chart->GetLegend()->SetVerticalAlignment(vtkChartLegend::BOTTOM);
  vtkNew<vtkContextView> view;
  open(view, page_width, page_height + lines * line_of_legend);
  view->GetScene()->AddItem(chart);
  view->GetRenderWindow()->Render();
  write_png(view, stem + ".png");
  write_svg(view, stem);
}
} // namespace bench
