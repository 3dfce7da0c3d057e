// SPDX-License-Identifier: BSD-3-Clause
// Any change that brings a culled prop into sight, or takes one out of it, is right in the very next frame; and unchanged props are not
// queried.
#include "culler_testing.h"

#include "vtkAssembly.h"
#include "vtkDataSetMapper.h"
#include "vtkMatrix4x4.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTransform.h"
#include "vtkTransformFilter.h"
#include "vtkTrivialProducer.h"

#include <functional>
#include <memory>

namespace {
// A window with a few props in sight and one out of it, which `change` brings in and `back`, if there is one, takes out again.
struct Case {
  const char* Name;
  std::function<void()> Change, Back;
};

void Run(CulledWindow& w, const Case& c)
{
  for (int repeat = 0; repeat < 2; ++repeat) {
    const Pixels before = w.Compare(c.Name);
    const vtkIdType seen = w.Seen();
    w.Draw();
    c.Change();
    const Pixels after = w.Compare(c.Name);
    CHECK(after != before && w.Seen() == seen + 1, "%s: %d kept before, %d after", c.Name, int(seen), int(w.Seen()));
    if (!c.Back) {
      return;
    }
    c.Back();
    CHECK(w.Compare(c.Name) == before && w.Seen() == seen, "%s: %d kept before, %d after it went back", c.Name, int(seen), int(w.Seen()));
  }
}

void TestActor()
{
  CulledWindow w;
  w.AddLattice(2);
  w.LookAhead();
  vtkNew<vtkMatrix4x4> matrix;
  vtkNew<vtkTransform> transform;
  Part moved(20), scaled(20), turned(0, 20), pushed(20), carried(20), added(-1), hidden(-1, 1), origin(20), shown(-1, -1, 1);
  moved.Actor->SetScale(0.5);
  pushed.Actor->SetUserMatrix(matrix);
  carried.Actor->SetUserTransform(transform);
  for (Part* part : { &moved, &scaled, &turned, &pushed, &carried, &hidden, &origin }) {
    w.Renderer->AddActor(part->Actor);
  }
  hidden.Actor->VisibilityOff();
  Run(w, { "moved", [&] { moved.Actor->SetPosition(-1, 0, 0); }, [&] { moved.Actor->SetPosition(20, 0, 0); } });
  Run(w, { "scaled", [&] { scaled.Actor->SetScale(90); }, [&] { scaled.Actor->SetScale(1); } });
  Run(w,
    { "turned", [&] { turned.Actor->SetOrigin(0, -20, 0), turned.Actor->RotateZ(180), turned.Actor->SetPosition(0, 40.5, 3); },
      [&] { turned.Actor->SetOrigin(0, 0, 0), turned.Actor->SetOrientation(0, 0, 0), turned.Actor->SetPosition(0, 20, 0); } });
  Run(w, { "a user's matrix, edited", [&] { matrix->SetElement(0, 3, -21); }, [&] { matrix->SetElement(0, 3, 0); } });
  Run(w, { "a user's transform, edited", [&] { transform->Translate(-21, 1, 0); }, [&] { transform->Identity(); } });
  Run(w, { "shown", [&] { hidden.Actor->VisibilityOn(); }, [&] { hidden.Actor->VisibilityOff(); } });
  Run(w, { "added", [&] { w.Renderer->AddActor(added.Actor); }, [&] { w.Renderer->RemoveActor(added.Actor); } });
  Run(w,
    { "UseBounds off", [&] { shown.Actor->UseBoundsOff(), w.Renderer->AddActor(shown.Actor); },
      [&] { shown.Actor->UseBoundsOn(), w.Renderer->RemoveActor(shown.Actor); } });
}

void TestPipeline()
{
  CulledWindow w;
  w.AddLattice(2);
  w.LookAhead();
  Part far(20), fed(20), mapped(0, 20), edited, output, chained, shared;
  for (Part* part : { &far, &fed, &mapped, &edited, &output, &chained, &shared }) {
    w.Renderer->AddActor(part->Actor);
  }
  Run(w, { "a source's parameter", [&] { far.Source->SetCenter(-21, 0, 0); }, [&] { far.Source->SetCenter(0, 0, 0); } });
  vtkNew<vtkSphereSource> near;
  near->SetCenter(-21, 1, 0);
  Run(w,
    { "another source", [&] { fed.Mapper->SetInputConnection(near->GetOutputPort()); },
      [&] { fed.Mapper->SetInputConnection(fed.Source->GetOutputPort()); } });
  vtkNew<vtkPolyDataMapper> other;
  vtkNew<vtkSphereSource> low;
  low->SetCenter(-1, -21, 0);
  other->SetInputConnection(low->GetOutputPort());
  Run(w, { "another mapper", [&] { mapped.Actor->SetMapper(other); }, [&] { mapped.Actor->SetMapper(mapped.Mapper); } });

  // Data without a source, edited in place.
  vtkNew<vtkPolyData> data;
  edited.Source->SetCenter(20, 0, 0);
  edited.Source->Update();
  data->DeepCopy(edited.Source->GetOutput());
  edited.Mapper->SetInputData(data);
  const auto shift = [](vtkPolyData* of, double by) {
    for (vtkIdType i = 0; i < of->GetNumberOfPoints(); ++i) {
      double p[3];
      of->GetPoint(i, p);
      of->GetPoints()->SetPoint(i, p[0] + by, p[1], p[2]);
    }
    of->GetPoints()->Modified();
  };
  Run(w, { "points in place", [&] { shift(data, -21); }, [&] { shift(data, 21); } });
  // The output of a source, edited behind its back.
  output.Source->SetCenter(20, 1, 0);
  w.Draw();
  Run(w, { "a source's output in place", [&] { shift(output.Source->GetOutput(), -21); }, [&] { shift(output.Source->GetOutput(), 21); } });

  // Three filters deep, and a source that two chains share.
  vtkNew<vtkTransform> motion, still;
  std::vector<vtkSmartPointer<vtkTransformFilter>> filters;
  vtkAlgorithmOutput* port = shared.Source->GetOutputPort();
  still->Translate(0, 6, 0);
  for (int i = 0; i < 3; ++i) {
    filters.push_back(vtkSmartPointer<vtkTransformFilter>::New());
    filters.back()->SetInputConnection(port);
    filters.back()->SetTransform(i == 1 ? motion.Get() : still.Get());
    port = filters.back()->GetOutputPort();
  }
  chained.Mapper->SetInputConnection(port);
  shared.Actor->SetPosition(0, -30, 0);
  Run(w, { "a transform of a filter upstream", [&] { motion->Translate(-1, -12, 0); }, [&] { motion->Identity(); } });
  Run(w, { "a source far upstream", [&] { shared.Source->SetCenter(-1, -13, 0); }, [&] { shared.Source->SetCenter(0, 0, 0); } });
  Run(w,
    { "a filter taken out", [&] { filters[2]->SetInputConnection(near->GetOutputPort()), near->SetCenter(1, -7, 0); },
      [&] { filters[2]->SetInputConnection(filters[1]->GetOutputPort()); } });
}

void TestOtherProps()
{
  CulledWindow w;
  w.AddLattice(2);
  w.LookAhead();
  // A mapper of a kind that is watched, and one of a kind that is not: an assembly's parts.
  vtkNew<vtkDataSetMapper> mapper;
  vtkNew<vtkSphereSource> source;
  vtkNew<vtkActor> actor;
  mapper->SetInputConnection(source->GetOutputPort());
  actor->SetMapper(mapper);
  actor->SetPosition(20, 0, 0);
  w.Renderer->AddActor(actor);
  Run(w, { "a data set's source", [&] { source->SetCenter(-21, 0, 0); }, [&] { source->SetCenter(0, 0, 0); } });
  vtkNew<vtkAssembly> outer, inner;
  Part part(20, 1);
  inner->AddPart(part.Actor);
  outer->AddPart(inner);
  w.Renderer->AddViewProp(outer);
  Run(w, { "a part of a part", [&] { part.Actor->SetPosition(-1, 1, 0); }, [&] { part.Actor->SetPosition(20, 1, 0); } });
  Run(w, { "an inner assembly", [&] { inner->SetPosition(-21, 0, 0); }, [&] { inner->SetPosition(0, 0, 0); } });
  Run(w, { "a part's source", [&] { part.Source->SetCenter(-21, 0, 0); }, [&] { part.Source->SetCenter(0, 0, 0); } });
}

// The list in another order, parts of it gone, others new, some of them where others lay in memory.
void TestLists()
{
  CulledWindow w;
  w.LookAhead();
  std::vector<std::unique_ptr<Part>> parts(60);
  unsigned state = 1;
  const auto next = [&state](unsigned below) { return (state = state * 1664525u + 1013904223u) / 65536u % below; };
  for (int round = 0; round < 40; ++round) {
    for (unsigned change = 0; change < next(12); ++change) {
      std::unique_ptr<Part>& part = parts[next(60)];
      if (part) {
        w.Renderer->RemoveActor(part->Actor);
        part.reset();
      }
      if (next(3) > 0) {
        part.reset(new Part(0.1 * next(100) - 5, 0.1 * next(100) - 5, 0.1 * next(60) - 3, 0.05 + 0.01 * next(40)));
        w.Renderer->AddActor(part->Actor);
      }
      if (const std::unique_ptr<Part>& other = parts[next(60)]) {
        other->Actor->SetVisibility(next(2) == 0);
      }
    }
    w.Compare("lists");
    vtkIdType visible = 0;
    for (const auto& part : parts) {
      visible += part && part->Actor->GetVisibility();
    }
    if (visible > 0) { // else no culler is called
      CHECK(w.Culler->GetNumberOfProps() == visible, "%d props, not %d", int(w.Culler->GetNumberOfProps()), int(visible));
    }
  }
  w.Renderer->RemoveAllViewProps();
  w.Compare("an emptied list");
  parts.clear();
  w.AddLattice(2);
  CHECK(!Empty(w.Compare("a list begun anew")), "nothing is drawn");
}

// Frames without a change query no bounds. After a change, frames query only the bounds that it may concern.
void TestAsked()
{
  CulledWindow w;
  w.LookAhead();
  w.AddLattice(4);
  Part first(20), second(20);
  second.Mapper->SetInputConnection(first.Source->GetOutputPort());
  w.Renderer->AddActor(first.Actor);
  w.Renderer->AddActor(second.Actor);
  first.Actor->GetProperty()->SetColor(0, 1, 0); // an actor makes its property on the first call of GetProperty()
  w.Draw(), w.Draw(), w.Draw();
  CHECK(w.Culler->GetNumberOfPropsAsked() == 0, "%d asked without a change", int(w.Culler->GetNumberOfPropsAsked()));
  w.Renderer->GetActiveCamera()->Azimuth(3);
  first.Actor->GetProperty()->SetColor(1, 0, 0);
  w.Draw();
  CHECK(w.Culler->GetNumberOfPropsAsked() == 0, "%d asked after another colour", int(w.Culler->GetNumberOfPropsAsked()));
  first.Actor->SetPosition(21, 0, 0);
  w.Draw();
  CHECK(w.Culler->GetNumberOfPropsAsked() == 1, "%d asked after one moved", int(w.Culler->GetNumberOfPropsAsked()));
  w.Draw(), w.Draw();
  first.Source->SetRadius(0.4);
  w.Draw();
  CHECK(w.Culler->GetNumberOfPropsAsked() == 2, "%d asked after two grew", int(w.Culler->GetNumberOfPropsAsked()));
  w.Draw(), w.Draw();
  CHECK(w.Culler->GetNumberOfPropsAsked() == 0, "%d asked when all was still again", int(w.Culler->GetNumberOfPropsAsked()));
  w.Culler->Modified();
  w.Draw();
  CHECK(w.Culler->GetNumberOfPropsAsked() == 66, "%d asked after the culler was modified", int(w.Culler->GetNumberOfPropsAsked()));
}

void TestStatic()
{
  CulledWindow w;
  w.LookAhead();
  w.AddLattice(3);
  w.Culler->StaticPropsOn();
  Part moved(20), added(-1, -1), hidden(-1, 1);
  hidden.Actor->VisibilityOff();
  w.Renderer->AddActor(moved.Actor);
  w.Renderer->AddActor(hidden.Actor);
  w.Draw(), w.Draw();
  CHECK(w.Culler->GetNumberOfPropsAsked() == 0, "%d asked", int(w.Culler->GetNumberOfPropsAsked()));
  const vtkIdType before = w.Seen();
  moved.Actor->SetPosition(-1, 0, 0);
  w.Draw();
  CHECK(w.Culler->GetNumberOfPropsAsked() == 0 && w.Seen() == before, "%d asked, %d kept, not %d", int(w.Culler->GetNumberOfPropsAsked()),
    int(w.Seen()), int(before));
  w.Culler->Modified();
  w.Compare("static, modified after a move");
  CHECK(w.Seen() == before + 1, "%d kept, not %d", int(w.Seen()), int(before) + 1);
  Run(w, { "static, shown", [&] { hidden.Actor->VisibilityOn(); }, [&] { hidden.Actor->VisibilityOff(); } });
  Run(w, { "static, added", [&] { w.Renderer->AddActor(added.Actor); }, [&] { w.Renderer->RemoveActor(added.Actor); } });
  moved.Source->SetCenter(30, 0, 0);
  w.Culler->StaticPropsOff();
  w.Compare("static no more");
  CHECK(w.Seen() == before, "%d kept, not %d", int(w.Seen()), int(before));
  moved.Source->SetCenter(0, 0, 0);
  w.Compare("not static");
  CHECK(w.Seen() == before + 1, "%d kept, not %d", int(w.Seen()), int(before) + 1);
}
} // namespace

int main()
{
  TestActor();
  TestPipeline();
  TestOtherProps();
  TestLists();
  TestAsked();
  TestStatic();
  std::printf(Failures == 0 ? "all as expected\n" : "%d failures\n", Failures);
  return Failures == 0 ? 0 : 1;
}
