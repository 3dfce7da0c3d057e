// SPDX-License-Identifier: BSD-3-Clause
// The octree benchmark's boxes as actors of VTK. It times Cull(), including its check for changes, and whole frames.
#include "bench.h"
#include "octree_bench.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCubeSource.h>
#include <vtkCullerCollection.h>
#include <vtkFrustumCoverageCuller.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkPropCollection.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkStratusOctreeCuller.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <unordered_map>

namespace bench {

namespace {

constexpr double frames_for_ms = 15000.0; // of one method on one path; at least 5 frames

double processor_ms()
{
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

// A scene in which each box is an actor with its own mapper, a moved and scaled copy of one source.
struct stage {
  explicit stage(const std::vector<box_bounds>& boxes)
  {
    this->window->SetOffScreenRendering(1);
    this->window->SetMultiSamples(0);
    this->window->SetSize(512, 384);
    this->window->AddRenderer(this->renderer);
    this->renderer->GetCullers()->RemoveAllItems();
    for (size_t i = 0; i < boxes.size(); ++i) {
      const box_bounds& b = boxes[i];
      vtkNew<vtkPolyDataMapper> mapper;
      vtkNew<vtkActor> actor;
      mapper->SetInputConnection(this->cube->GetOutputPort());
      actor->SetMapper(mapper);
      actor->SetPosition(0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5]));
      actor->SetScale(b[1] - b[0], b[3] - b[2], b[5] - b[4]);
      actor->GetProperty()->SetColor(0.3 + 0.1 * static_cast<double>(i % 7), 0.3 + 0.1 * static_cast<double>(i % 5), 0.6);
      this->renderer->GetViewProps()->AddItem(actor); // AddActor() would search all actors
      actor->AddConsumer(this->renderer);
      this->numbers[actor.Get()] = static_cast<uint32_t>(i);
      this->props.push_back(actor.Get());
    }
  }

  void show(const stratus_camera& at)
  {
    vtkCamera* camera = this->renderer->GetActiveCamera();
    camera->SetPosition(at.eye);
    camera->SetFocalPoint(at.eye[0] + at.forward[0], at.eye[1] + at.forward[1], at.eye[2] + at.forward[2]);
    camera->SetViewUp(0, 0, 1);
    camera->SetViewAngle(30.0);
    camera->SetClippingRange(at.near_k, at.far_k);
  }

  vtkNew<vtkRenderWindow> window;
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkCubeSource> cube;
  std::vector<vtkProp*> props;
  std::unordered_map<vtkProp*, uint32_t> numbers;
};

vtkSmartPointer<vtkCuller> make_culler(const std::string& method)
{
  if (method == "vtk:coverage") {
    return vtkSmartPointer<vtkFrustumCoverageCuller>::New();
  }
  const auto culler = vtkSmartPointer<vtkStratusOctreeCuller>::New();
  culler->SetStaticProps(method == "stratus:culler-static");
  return culler;
}

struct culled {
  std::vector<double> ms;
  double visible = 0.0;
  verdict judged;
};

culled cull_path(
  stage& s, vtkCuller* culler, stratus_context* context, const std::vector<box_bounds>& boxes, const std::vector<stratus_camera>& cameras)
{
  culled result;
  const size_t frames = cameras.size(), every = std::max<size_t>(frames / 5, 1);
  for (size_t f = 0; f < frames; ++f) {
    s.show(cameras[f]);
    std::vector<vtkProp*> list = s.props;
    int length = static_cast<int>(list.size()), initialized = 0;
    const double start = processor_ms();
    culler->Cull(s.renderer, list.data(), length, initialized);
    result.ms.push_back(processor_ms() - start);
    result.visible += static_cast<double>(length) / static_cast<double>(frames);
    if (f % every == every - 1) {
      stratus_frustum frustum;
      if (stratus_frustum_from_camera(context, &cameras[f], &frustum) != STRATUS_OK) {
        throw failure(stratus_context_message(context));
      }
      std::vector<uint32_t> ids;
      std::for_each(list.begin(), list.begin() + length, [&](vtkProp* prop) { ids.push_back(s.numbers.at(prop)); });
      const verdict v = judge_culling(boxes, frustum, cameras[f], ids.data(), ids.size());
      result.judged.kept += v.kept;
      result.judged.wrong_culls += v.wrong_culls;
      result.judged.false_keeps += v.false_keeps;
    }
  }
  return result;
}

// Times every n-th camera, so that few frames cover the whole path. The culler's first frame does not count.
std::vector<double> frame_times(stage& s, vtkCuller* culler, const std::vector<stratus_camera>& cameras)
{
  std::vector<double> times;
  const size_t step = std::max<size_t>(cameras.size() / 24, 1);
  double spent = 0.0;
  s.renderer->AddCuller(culler);
  for (size_t f = 0; f < cameras.size() && (spent < frames_for_ms || times.size() < 5); f += step) {
    s.show(cameras[f]);
    if (f == 0) {
      s.window->Render();
    }
    const double start = now_ms();
    s.window->Render();
    s.window->WaitForCompletion();
    times.push_back(now_ms() - start);
    spent += times.back();
  }
  s.renderer->RemoveCuller(culler);
  return times;
}
} // namespace

const std::vector<std::string>& actor_methods()
{
  static const std::vector<std::string> names = { "stratus:culler", "stratus:culler-static", "vtk:coverage" };
  return names;
}

void run_actors(stratus_context* context, const std::string& scene, const std::vector<std::string>& paths, int frames,
  const std::vector<std::string>& methods, std::vector<row>& rows)
{
  const std::vector<box_bounds> boxes = make_boxes("boxes-" + scene.substr(scene.find('-') + 1));
  stage s(boxes);
  s.show(camera_path(context, "far", 1)[0]);
  s.window->Render(); // draws all actors, so that no method pays for one-time graphics set-up
  for (const std::string& path : paths) {
    std::fprintf(stderr, "%s/%s\n", scene.c_str(), path.c_str());
    const std::vector<stratus_camera> cameras = camera_path(context, path, frames);
    for (const std::string& method : methods) {
      const vtkSmartPointer<vtkCuller> culler = make_culler(method);
      const culled c = cull_path(s, culler, context, boxes, cameras);
      const std::vector<double> frames_ms = frame_times(s, culler, cameras);
      const double worst = *std::max_element(c.ms.begin(), c.ms.end()), frame = median(frames_ms);
      const double kept = static_cast<double>(std::max<size_t>(c.judged.kept, 1));
      const double falsely = 100.0 * static_cast<double>(c.judged.false_keeps) / kept;
      const auto add = [&](const char* metric, double value, const char* unit) {
        rows.push_back({ scene + '/' + path, method, metric, unit, value });
      };
      add("cull_ms", median(c.ms), "ms");
      add_repeats(scene + '/' + path, method, "cull_ms", "ms", c.ms, rows);
      add_repeats(scene + '/' + path, method, "frame_ms", "ms", frames_ms, rows);
      add("cull_worst_ms", worst, "ms");
      add("frame_ms", frame, "ms");
      add("frame_best_ms", *std::min_element(frames_ms.begin(), frames_ms.end()), "ms");
      add("frame_worst_ms", *std::max_element(frames_ms.begin(), frames_ms.end()), "ms");
      add("visible", c.visible, "1");
      add("false_keeps", falsely, "%");
      add("wrong_culls", static_cast<double>(c.judged.wrong_culls), "1");
      std::fprintf(stderr, "  %-26s cull %.3f worst %.2f ms, frame %.2f ms, visible %.0f, false %.2f %%, wrong %zu\n", method.c_str(),
        median(c.ms), worst, frame, c.visible, falsely, c.judged.wrong_culls);
    }
  }
}
} // namespace bench
