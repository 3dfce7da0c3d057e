// SPDX-License-Identifier: BSD-3-Clause
// Writes scenes and the path tracer's images of them, for peers in programs of their own (vtk_gpu.py).
#include "light_bench.h"

#include <vtkNew.h>
#include <vtkXMLImageDataWriter.h>

#include <cstdio>
#include <cstring>
#include <cerrno>

namespace bench {

namespace {

std::string number(double value)
{
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string numbers(const double* values, size_t count)
{
  std::string text;
  for (size_t i = 0; i < count; ++i) {
    text += (i ? ", " : "") + number(values[i]);
  }
  return "[" + text + "]";
}

// A list of tuples.
std::string points(const std::vector<double>& values, size_t width)
{
  std::string text;
  for (size_t i = 0; i < values.size(); i += width) {
    text += (i ? ", " : "") + numbers(values.data() + i, width);
  }
  return "[" + text + "]";
}

std::string camera_of(const light_subject& s, const stratus_camera& camera)
{
  const double* b = s.bounds;
  const double focal[3] = { 0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5]) };
  const double up[3] = { s.up_axis == 0 ? 1.0 : 0.0, s.up_axis == 1 ? 1.0 : 0.0, s.up_axis == 2 ? 1.0 : 0.0 };
  return "{\"eye\": " + numbers(camera.eye, 3) + ", \"focal\": " + numbers(focal, 3) + ", \"up\": " + numbers(up, 3) + ", \"angle\": 21.6}";
}
} // namespace

std::string export_scene(const light_subject& s, const light_images& paths, const std::string& folder)
{
  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetFileName((folder + "/" + s.name + ".vti").c_str());
  writer->SetInputData(s.volume->image);
  if (writer->Write() != 1) {
    throw failure("cannot write " + folder + "/" + s.name + ".vti");
  }
  std::string views_of, cameras;
  for (size_t v = 0; v < paths.size(); ++v) {
    const std::string name = s.name + "-" + std::to_string(judged_views[v]) + ".float32";
    save_picture(folder + "/" + name, paths[v]);
    views_of += (v ? ", \"" : "\"") + std::to_string(judged_views[v]) + "\": \"" + name + "\"";
  }
  for (const stratus_camera& camera : s.cameras) {
    cameras += (cameras.empty() ? "" : ",\n  ") + camera_of(s, camera);
  }
  const transfer& t = s.volume->first;
  return "{\"name\": \"" + s.name + "\", \"voxel\": " + number(s.volume->voxel) + ", \"unit_distance\": " + number(t.unit_distance) +
    ",\n \"opacity\": " + points(t.opacity, 2) + ",\n \"color\": " + points(t.color, 4) + ",\n \"sun\": " + numbers(sun_of(s).vector, 3) +
    ",\n \"paths\": {" + views_of + "},\n \"cameras\": [" + cameras + "]}";
}

void export_list(const std::vector<std::string>& scenes, const std::string& folder)
{
  const std::string path = folder + "/scenes.json";
  std::FILE* file = std::fopen(path.c_str(), "w");
  bool good = file != nullptr;
  for (size_t i = 0; good && i < scenes.size(); ++i) {
    good = std::fprintf(file, "%s%s", i ? ",\n" : "[", scenes[i].c_str()) > 0;
  }
  good = good && std::fputs("]\n", file) >= 0;
  if (!file || std::fclose(file) != 0 || !good) {
    throw failure("cannot write " + path + ": " + std::strerror(errno));
  }
}
} // namespace bench
