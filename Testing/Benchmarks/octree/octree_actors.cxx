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

double processor_ms(clockid_t clock)
{
  timespec t;
  clock_gettime(clock, &t);
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

// A method on one path.
struct runner {
  explicit runner(const std::string& method) : name(method), culler(make_culler(method)) {}

  std::string name;
  vtkSmartPointer<vtkCuller> culler;
  std::vector<double> cull_ms, frame_ms, frame_cpu_ms;
  double visible = 0.0;
  verdict judged;
};

// Calls `turn` for every runner. Each frame begins with another runner, so that none profits from its place.
template <class Turn> void take_turns(std::vector<runner>& runners, size_t frame, const Turn& turn)
{
  for (size_t i = 0; i < runners.size(); ++i) {
    turn(runners[(i + frame) % runners.size()]);
  }
}

void cull(stage& s, vtkCuller* culler, std::vector<vtkProp*>& list, int& length)
{
  int initialized = 0;
  list = s.props;
  length = static_cast<int>(list.size());
  culler->Cull(s.renderer, list.data(), length, initialized);
}

// The runners take turns frame by frame, so that a change in the machine's pace meets them all. Before a culler's first frame another one
// of its kind has a frame that is not timed, so that none finds colder props or code, or a heap in greater disorder, than the others.
void cull_path(stage& s, std::vector<runner>& runners, stratus_context* context, const std::vector<box_bounds>& boxes,
  const std::vector<stratus_camera>& cameras)
{
  const size_t frames = cameras.size(), every = std::max<size_t>(frames / 5, 1);
  for (size_t f = 0; f < frames; ++f) {
    s.show(cameras[f]);
    take_turns(runners, f, [&](runner& r) {
      std::vector<vtkProp*> list;
      int length = 0;
      if (f == 0) {
        cull(s, make_culler(r.name), list, length);
      }
      const double start = processor_ms(CLOCK_THREAD_CPUTIME_ID);
      cull(s, r.culler, list, length);
      r.cull_ms.push_back(processor_ms(CLOCK_THREAD_CPUTIME_ID) - start);
      r.visible += static_cast<double>(length) / static_cast<double>(frames);
      if (f % every == every - 1) {
        stratus_frustum frustum;
        if (stratus_frustum_from_camera(context, &cameras[f], &frustum) != STRATUS_OK) {
          throw failure(stratus_context_message(context));
        }
        std::vector<uint32_t> ids;
        std::for_each(list.begin(), list.begin() + length, [&](vtkProp* prop) { ids.push_back(s.numbers.at(prop)); });
        const verdict v = judge_culling(boxes, frustum, cameras[f], ids.data(), ids.size());
        r.judged.kept += v.kept;
        r.judged.wrong_culls += v.wrong_culls;
        r.judged.false_keeps += v.false_keeps;
      }
    });
  }
}

// Times every n-th camera, so that few frames cover the whole path. Each culler's first frame does not count.
void time_frames(stage& s, std::vector<runner>& runners, const std::vector<stratus_camera>& cameras)
{
  const size_t step = std::max<size_t>(cameras.size() / 24, 1);
  double spent = 0.0;
  for (size_t f = 0, frame = 0; f < cameras.size() && (spent < frames_for_ms || frame < 5); f += step, ++frame) {
    s.show(cameras[f]);
    take_turns(runners, frame, [&](runner& r) {
      s.renderer->AddCuller(r.culler);
      if (frame == 0) {
        s.window->Render();
      }
      const double start = now_ms(), processor = processor_ms(CLOCK_PROCESS_CPUTIME_ID);
      s.window->Render();
      s.window->WaitForCompletion();
      r.frame_ms.push_back(now_ms() - start);
      r.frame_cpu_ms.push_back(processor_ms(CLOCK_PROCESS_CPUTIME_ID) - processor);
      spent += r.frame_ms.back() / static_cast<double>(runners.size());
      s.renderer->RemoveCuller(r.culler);
    });
  }
}

double greatest(const std::vector<double>& values)
{
  return *std::max_element(values.begin(), values.end());
}

void add_rows(const std::string& scene, const runner& r, std::vector<row>& rows)
{
  const double kept = static_cast<double>(std::max<size_t>(r.judged.kept, 1));
  const double falsely = 100.0 * static_cast<double>(r.judged.false_keeps) / kept;
  const auto add = [&](const char* metric, double value, const char* unit) { rows.push_back({ scene, r.name, metric, unit, value }); };
  add("cull_ms", median(r.cull_ms), "ms");
  add_repeats(scene, r.name, "cull_ms", "ms", r.cull_ms, rows);
  add_repeats(scene, r.name, "frame_ms", "ms", r.frame_ms, rows);
  add("cull_first_ms", r.cull_ms.front(), "ms");
  add("cull_worst_ms", greatest(r.cull_ms), "ms");
  add("frame_ms", median(r.frame_ms), "ms");
  add("frame_best_ms", *std::min_element(r.frame_ms.begin(), r.frame_ms.end()), "ms");
  add("frame_worst_ms", greatest(r.frame_ms), "ms");
  add("frame_cpu_ms", median(r.frame_cpu_ms), "ms");
  add("frame_cpu_worst_ms", greatest(r.frame_cpu_ms), "ms");
  add("visible", r.visible, "1");
  add("false_keeps", falsely, "%");
  add("wrong_culls", static_cast<double>(r.judged.wrong_culls), "1");
  std::fprintf(stderr,
    "  %-26s cull %.3f first %.2f worst %.2f ms, frame %.2f ms, processor %.2f worst %.2f ms, visible %.0f, false %.2f %%, wrong %zu\n",
    r.name.c_str(), median(r.cull_ms), r.cull_ms.front(), greatest(r.cull_ms), median(r.frame_ms), median(r.frame_cpu_ms),
    greatest(r.frame_cpu_ms), r.visible, falsely, r.judged.wrong_culls);
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
    std::vector<runner> runners(methods.begin(), methods.end());
    cull_path(s, runners, context, boxes, cameras);
    time_frames(s, runners, cameras);
    for (const runner& r : runners) {
      add_rows(scene + '/' + path, r, rows);
    }
  }
}
} // namespace bench
