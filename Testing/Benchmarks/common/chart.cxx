// SPDX-License-Identifier: BSD-3-Clause
#include "bench.h"

#include <vtkAxis.h>
#include <vtkChartLegend.h>
#include <vtkChartXY.h>
#include <vtkContextScene.h>
#include <vtkContextView.h>
#include <vtkFloatArray.h>
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
#include <map>

namespace bench {

namespace {

constexpr int width = 720;
constexpr int height = 460;

void style(const std::string& method, vtkPlotPoints* plot)
{
  static const unsigned char colors[][3] = { { 31, 119, 180 }, { 214, 39, 40 }, { 44, 160, 44 }, { 148, 103, 189 }, { 255, 127, 14 },
    { 140, 86, 75 }, { 227, 119, 194 }, { 127, 127, 127 }, { 188, 189, 34 }, { 23, 190, 207 } };
  static std::vector<std::string> seen;
  auto found = std::find(seen.begin(), seen.end(), method);
  if (found == seen.end()) {
    found = seen.insert(seen.end(), method);
  }
  const size_t number = static_cast<size_t>(found - seen.begin());
  const unsigned char* c = colors[number % 10];
  const bool ours =
    method.rfind("stratus", 0) == 0 && number < 10; // from the tenth method on, colours repeat, so circles would be ambiguous
  plot->SetColor(c[0], c[1], c[2], 255);
  plot->SetMarkerStyle(ours ? vtkPlotPoints::CIRCLE : number % 2 ? vtkPlotPoints::DIAMOND : vtkPlotPoints::SQUARE);
  plot->SetMarkerSize(12.0f);
}

void range(vtkAxis* axis, double low, double high, const char* title)
{
  axis->LogScaleOn();
  axis->SetBehavior(vtkAxis::FIXED);
  axis->SetUnscaledRange(low, high);
  axis->SetTitle(title);
}

// Finds the whole decades that contain the marks.
void decades(std::vector<double> values, double& low, double& high)
{
  low = std::pow(10.0, std::floor(std::log10(*std::min_element(values.begin(), values.end())) - 0.05));
  high = std::pow(10.0, std::ceil(std::log10(*std::max_element(values.begin(), values.end())) + 0.05));
}

// titles: of the x and the y axis.
void add_chart(
  vtkContextScene* all, const std::string& title, const std::vector<chart_mark>& marks, const char* const titles[2], int column, int line)
{
  vtkNew<vtkChartXY> chart;
  std::vector<double> times;
  std::vector<double> errors;
  for (const chart_mark& m : marks) {
    vtkNew<vtkTable> table;
    vtkNew<vtkFloatArray> x;
    vtkNew<vtkFloatArray> y;
    x->SetName(titles[0]);
    y->SetName(m.method.c_str());
    x->InsertNextValue(static_cast<float>(m.x));
    y->InsertNextValue(static_cast<float>(m.y));
    table->AddColumn(x);
    table->AddColumn(y);
    auto* plot = vtkPlotPoints::SafeDownCast(chart->AddPlot(vtkChart::POINTS));
    plot->SetInputData(table, 0, 1);
    style(m.method, plot);
    times.push_back(m.x);
    errors.push_back(m.y);
  }
  double low;
  double high;
  decades(times, low, high);
  range(chart->GetAxis(vtkAxis::BOTTOM), low, high, titles[0]);
  decades(errors, low, high);
  range(chart->GetAxis(vtkAxis::LEFT), low, high, titles[1]);
  chart->SetTitle(title);
  chart->SetShowLegend(true);
  chart->GetLegend()->SetInline(false); // beside the plot, where it hides no mark
  chart->GetLegend()->SetHorizontalAlignment(vtkChartLegend::RIGHT);
  chart->GetLegend()->SetLabelSize(10);
  chart->SetAutoSize(false);
  chart->SetSize(vtkRectf(static_cast<float>(column * width), static_cast<float>(line * height), width, height));
  all->AddItem(chart);
}
} // namespace

void write_chart(const std::string& path, const std::vector<row>& rows)
{
  std::vector<chart_mark> marks;
  std::map<std::string, double> frames;
  for (const row& r : rows) {
    if (r.metric == "frame_ms") {
      frames[r.scene + '\n' + r.method] = r.value;
    } else if (r.metric == "psnr8_db") {
      marks.push_back({ r.scene, r.method, frames[r.scene + '\n' + r.method], std::pow(10.0, -r.value / 20.0) });
    }
  }
  write_chart(path, marks, "whole frame, ms", "root mean square error of the window's pixels");
}

void write_chart(const std::string& path, const std::vector<chart_mark>& all, const char* x_title, const char* y_title)
{
  const char* const titles[2] = { x_title, y_title };
  std::vector<std::string> scenes;
  std::map<std::string, std::vector<chart_mark>> marks;
  for (const chart_mark& m : all) {
    if (marks[m.scene].empty()) {
      scenes.push_back(m.scene);
    }
    marks[m.scene].push_back(m);
  }
  if (scenes.empty()) {
    throw failure("nothing to chart: no method has both a time and an error");
  }
  const int columns = scenes.size() > 1 ? 2 : 1;
  const int lines = (static_cast<int>(scenes.size()) + columns - 1) / columns;
  vtkNew<vtkContextView> view;
  view->GetRenderWindow()->SetOffScreenRendering(1);
  view->GetRenderWindow()->SetMultiSamples(4);
  view->GetRenderWindow()->SetSize(columns * width, lines * height);
  view->GetRenderer()->SetBackground(1, 1, 1);
  for (size_t i = 0; i < scenes.size(); ++i) {
    const int column = static_cast<int>(i) % columns;
    const int line = lines - 1 - static_cast<int>(i) / columns;
    add_chart(view->GetScene(), scenes[i], marks[scenes[i]], titles, column, line);
  }
  view->GetRenderWindow()->Render();
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
} // namespace bench
