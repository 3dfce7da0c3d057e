// SPDX-License-Identifier: BSD-3-Clause
// A frame of the culler visits no prop more often than vtkFrustumCoverageCuller does: once for its bounds, or once for their sources. And
// a change that falls between these two visits is right in the next frame.
#include "culler_testing.h"

#include "vtkFrustumCoverageCuller.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLActor.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkVersion.h"

#include <functional>
#include <memory>

namespace {
// Counts the visits. The factory puts it in vtkActor's place, so that the culler takes it for one.
class CountedActor : public vtkOpenGLActor
{
public:
  static CountedActor* New();
  vtkTypeMacro(CountedActor, vtkOpenGLActor);
  using Superclass::GetBounds;
  double* GetBounds() override
  {
    ++Asked;
    return this->Superclass::GetBounds();
  }
  vtkMapper* GetMapper() override
  {
    ++Resolved;
    return this->Superclass::GetMapper();
  }
  static int Asked, Resolved;
};
int CountedActor::Asked = 0;
int CountedActor::Resolved = 0;
vtkStandardNewMacro(CountedActor);

class Factory : public vtkObjectFactory
{
public:
  static Factory* New();
  vtkTypeMacro(Factory, vtkObjectFactory);
  const char* GetVTKSourceVersion() override { return VTK_SOURCE_VERSION; }
  const char* GetDescription() override { return "actors that count visits"; }

protected:
  Factory()
  {
    this->RegisterOverride("vtkActor", "CountedActor", "counts visits", 1, []() -> vtkObject* { return CountedActor::New(); });
  }
};
vtkStandardNewMacro(Factory);

// Calls Cull() on all props and checks how often it visits them.
void Expect(CulledWindow& w, vtkCuller* culler, const std::vector<vtkProp*>& props, int asked, int resolved, const char* what)
{
  std::vector<vtkProp*> list = props;
  int length = static_cast<int>(list.size()), initialized = 0;
  CountedActor::Asked = CountedActor::Resolved = 0;
  culler->Cull(w.Renderer, list.data(), length, initialized);
  CHECK(CountedActor::Asked == asked && CountedActor::Resolved == resolved, "%s: bounds %d times, not %d; sources %d times, not %d", what,
    CountedActor::Asked, asked, CountedActor::Resolved, resolved);
}

// `own`: each actor has its own source, which the first frame executes.
void TestVisits(bool own)
{
  vtkNew<Factory> factory;
  vtkObjectFactory::RegisterFactory(factory);
  vtkObjectFactory::SetAllEnableFlags(0, "vtkActor"); // else OpenGL's actor comes first
  factory->SetEnableFlag(1, "vtkActor", "CountedActor");
  CulledWindow w;
  w.LookAhead();
  w.Draw(); // the window's size counts
  constexpr int count = 200;
  std::vector<std::unique_ptr<Part>> parts;
  std::vector<vtkProp*> props;
  for (int i = 0; i < count; ++i) {
    parts.emplace_back(new Part(0.2 * (i % 20) - 2, 0.4 * (i / 20) - 2, -i % 7));
    if (!own) {
      parts.back()->Mapper->SetInputConnection(parts[0]->Source->GetOutputPort());
    }
    props.push_back(parts.back()->Actor);
  }
  vtkNew<vtkFrustumCoverageCuller> reference;
  vtkNew<vtkStratusOctreeCuller> culler;
  culler->SetLeafProps(4);
  Expect(w, culler, props, count, 0, "first frame");
  Expect(w, culler, props, 0, count, "second frame");
  Expect(w, culler, props, 0, 0, "third frame");
  parts[5]->Actor->SetPosition(0, 0, 1);
  Expect(w, culler, props, 1, 0, "one moved");
  parts[6]->Actor->SetPosition(0, 0, 1);
  Expect(w, culler, props, 1, 1, "another moved");
  Expect(w, culler, props, 0, 1, "the frame after");
  for (int frame = 0; frame < 3; ++frame) {
    for (const auto& part : parts) {
      part->Actor->AddPosition(0, 0, 0.01);
    }
    Expect(w, culler, props, count, 0, "all move");
  }
  Expect(w, culler, props, 0, count, "all have moved");
  parts[0]->Source->SetRadius(0.2);
  Expect(w, culler, props, own ? 1 : count, 0, "a source was modified");
  Expect(w, culler, props, 0, 0, "it is unmodified");
  culler->Modified();
  Expect(w, culler, props, count, 0, "the culler was modified");
  Expect(w, culler, props, 0, count, "the frame after");
  Expect(w, reference, props, count, 0, "VTK's culler");
  culler->StaticPropsOn(); // modifies it
  Expect(w, culler, props, count, 0, "static");
  Expect(w, culler, props, 0, 0, "static, second frame");
  vtkObjectFactory::UnRegisterFactory(factory);
  vtkObjectFactory::SetAllEnableFlags(1, "vtkActor");
}

// Makes one change after a single frame, which has queried all bounds and looked at no source, and checks the next frame.
struct Change {
  const char* Name;
  std::function<void(CulledWindow& w, std::unique_ptr<Part>& part)> Do;
};

void TestFreshlyAsked()
{
  const auto shift = [](vtkPolyData* data) {
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
      double p[3];
      data->GetPoint(i, p);
      data->GetPoints()->SetPoint(i, p[0] - 21, p[1], p[2]);
    }
    data->GetPoints()->Modified();
  };
  vtkNew<vtkMatrix4x4> matrix;
  vtkNew<vtkSphereSource> near;
  near->SetCenter(-21, 0, 0);
  near->Update(); // older than the first frame
  vtkNew<vtkPolyDataMapper> other;
  other->SetInputConnection(near->GetOutputPort());
  const std::vector<Change> changes = {
    { "moved", [](CulledWindow&, std::unique_ptr<Part>& part) { part->Actor->SetPosition(-1, 0, 0); } },
    { "a user's matrix, edited", [&](CulledWindow&, std::unique_ptr<Part>&) { matrix->SetElement(0, 3, -21); } },
    { "a source's parameter", [](CulledWindow&, std::unique_ptr<Part>& part) { part->Source->SetCenter(-21, 0, 0); } },
    { "a source's output in place", [&](CulledWindow&, std::unique_ptr<Part>& part) { shift(part->Source->GetOutput()); } },
    { "an older source", [&](CulledWindow&, std::unique_ptr<Part>& part) { part->Mapper->SetInputConnection(near->GetOutputPort()); } },
    { "older data", [&](CulledWindow&, std::unique_ptr<Part>& part) { part->Mapper->SetInputData(near->GetOutput()); } },
    { "an older mapper", [&](CulledWindow&, std::unique_ptr<Part>& part) { part->Actor->SetMapper(other); } },
    { "another prop in its place",
      [](CulledWindow& w, std::unique_ptr<Part>& part) {
        w.Renderer->RemoveActor(part->Actor);
        part.reset(); // its memory may be the next one's
        part.reset(new Part(-1));
        w.Renderer->AddActor(part->Actor);
      } },
  };
  for (const Change& change : changes) {
    CulledWindow w;
    w.AddLattice(2);
    w.LookAhead();
    std::unique_ptr<Part> part(new Part(20));
    matrix->Identity();
    part->Actor->SetUserMatrix(matrix);
    w.Renderer->AddActor(part->Actor);
    const Pixels before = w.Draw();
    const vtkIdType seen = w.Seen();
    change.Do(w, part);
    CHECK(w.Compare(change.Name) != before && w.Seen() == seen + 1, "%s: %d kept before, %d after", change.Name, int(seen), int(w.Seen()));
    w.Compare(change.Name);
    CHECK(w.Seen() == seen + 1, "%s: %d kept in the second frame after", change.Name, int(w.Seen()));
  }
}
} // namespace

int main()
{
  TestVisits(false);
  TestVisits(true);
  TestFreshlyAsked();
  std::printf(Failures == 0 ? "all as expected\n" : "%d failures\n", Failures);
  return Failures == 0 ? 0 : 1;
}
