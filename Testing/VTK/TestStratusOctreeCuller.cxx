// SPDX-License-Identifier: BSD-3-Clause
// No camera makes the culler leave out a visible prop: every picture equals the one without a culler, although props are culled.
#include "culler_testing.h"

#include "vtkActor2D.h"
#include "vtkAssembly.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkFollower.h"
#include "vtkFrustumCoverageCuller.h"
#include "vtkLineSource.h"
#include "vtkMatrix4x4.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTextMapper.h"
#include "vtkTextProperty.h"

#include <functional>
#include <sstream>
#include <string>

namespace {
struct View {
  const char* Name;
  std::function<void(vtkCamera*)> Set;
};

std::vector<View> Views()
{
  return {
    { "inside", [](vtkCamera*) {} },
    { "turned", [](vtkCamera* c) { c->Yaw(22), c->Roll(33); } },
    { "narrow", [](vtkCamera* c) { c->SetViewAngle(3); } },
    { "wide", [](vtkCamera* c) { c->SetPosition(5.1, 4.9, 4.1), c->SetViewAngle(110); } },
    { "near plane moved in", [](vtkCamera* c) { c->SetClippingRange(6.3, 100); } },
    { "far plane moved in", [](vtkCamera* c) { c->SetClippingRange(0.1, 4.4); } },
    { "a thin slice", [](vtkCamera* c) { c->SetClippingRange(4.0, 4.2); } },
    { "off-centre window", [](vtkCamera* c) { c->SetWindowCenter(0.7, -0.4); } },
    { "parallel", [](vtkCamera* c) { c->ParallelProjectionOn(), c->SetParallelScale(2.2); } },
    { "parallel and off-centre", [](vtkCamera* c) { c->ParallelProjectionOn(), c->SetParallelScale(1.5), c->SetWindowCenter(-0.6, 0.5); } },
    { "parallel, near plane behind the eye",
      [](vtkCamera* c) { c->ParallelProjectionOn(), c->SetParallelScale(2.0), c->SetClippingRange(-5, 8); } },
    { "sheared", [](vtkCamera* c) { c->SetViewShear(0.3, -0.2, 1.0); } },
    { "horizontal angle", [](vtkCamera* c) { c->UseHorizontalViewAngleOn(), c->SetViewAngle(25); } },
    { "off-axis screen",
      [](vtkCamera* c) {
        // Before VTK 9.3 the screen is in the eye's coordinates, since then in the world's: here they are the same, and the lattice moves.
        const double move[16] = { 1, 0, 0, -5.1, 0, 1, 0, -4.9, 0, 0, 1, -14, 0, 0, 0, 1 };
        c->SetModelTransformMatrix(move);
        c->SetPosition(0, 0, 0), c->SetFocalPoint(0, 0, -1);
        c->SetScreenBottomLeft(-1.0, -2.0, -4.0);
        c->SetScreenBottomRight(1.0, -2.0, -4.0);
        c->SetScreenTopRight(1.0, -0.5, -4.0);
        c->SetUseOffAxisProjection(1);
      } },
    { "a projection matrix of its own",
      [](vtkCamera* c) {
        vtkNew<vtkMatrix4x4> matrix;
        matrix->DeepCopy(c->GetProjectionTransformMatrix(1.2, -1, 1));
        matrix->SetElement(0, 2, 0.4);
        c->SetExplicitProjectionTransformMatrix(matrix);
        c->UseExplicitProjectionTransformMatrixOn();
      } },
  };
}

void TestCameras(bool exact)
{
  CulledWindow w;
  w.AddLattice(6);
  w.Culler->SetExact(exact);
  for (const View& view : Views()) {
    vtkNew<vtkCamera> camera;
    camera->SetPosition(5.1, 4.9, 14.0);
    camera->SetFocalPoint(5.5, 5.2, 0.0);
    camera->SetViewAngle(25);
    camera->SetClippingRange(0.1, 100);
    w.Renderer->SetActiveCamera(camera);
    view.Set(camera);
    const Pixels first = w.Compare(view.Name);
    CHECK(!Empty(first), "%s shows nothing", view.Name);
    CHECK(w.Culler->GetNumberOfProps() == 216 && w.Seen() < 200, "%s: %d of %d are kept", view.Name, int(w.Seen()),
      int(w.Culler->GetNumberOfProps()));
    CHECK(w.Draw() == first, "%s: the second picture differs", view.Name);
  }
}

// Round and through the lattice: the tree that is split at one place is left for another.
void TestPath(int rule)
{
  CulledWindow w;
  w.AddLattice(6);
  w.Culler->SetStopRule(rule);
  vtkCamera* camera = w.Renderer->GetActiveCamera();
  camera->SetClippingRange(0.05, 60);
  vtkIdType most = 0, least = 216;
  for (int frame = 0; frame < 24; ++frame) {
    const double angle = 0.55 * frame;
    camera->SetPosition(5 + (12 - 0.5 * frame) * std::cos(angle), 5 + (12 - 0.5 * frame) * std::sin(angle), 2 + 0.3 * frame);
    camera->SetFocalPoint(5 + frame % 3, 5, 5);
    w.Compare(w.Culler->GetStopRuleAsString());
    most = std::max(most, w.Seen());
    least = std::min(least, w.Seen());
  }
  CHECK(most > 100 && least < 40, "between %d and %d props are kept", int(least), int(most));
  CHECK(w.Culler->GetNumberOfNodes(w.Renderer) > 8, "%d nodes", int(w.Culler->GetNumberOfNodes(w.Renderer)));
}

// Two windows go through the same frames, one without a culler: a camera learns only when it draws that the window is in stereo, or no
// more, and which eye it is, so a frame may depend on the one before.
void TestStereo()
{
  CulledWindow culled, whole;
  whole.Renderer->GetCullers()->RemoveAllItems();
  for (CulledWindow* w : { &culled, &whole }) {
    w->AddLattice(6);
    vtkCamera* camera = w->Renderer->GetActiveCamera();
    camera->SetPosition(5.1, 4.9, 14.0);
    camera->SetFocalPoint(5.5, 5.2, 0.0);
    camera->SetClippingRange(0.1, 100);
    camera->SetEyeAngle(20.0); // each eye sees what the other does not
  }
  const Pixels mono = culled.Compare("before stereo");
  whole.Draw();
  for (const int type : { VTK_STEREO_ANAGLYPH, VTK_STEREO_LEFT, VTK_STEREO_RIGHT, VTK_STEREO_INTERLACED, VTK_STEREO_LEFT, 0 }) {
    const char* name = "none";
    for (CulledWindow* w : { &culled, &whole }) {
      w->Window->SetStereoRender(type != 0);
      if (type != 0) {
        w->Window->SetStereoType(type);
        name = w->Window->GetStereoTypeAsString();
      }
    }
    for (int frame = 0; frame < 3; ++frame) {
      const Pixels drawn = culled.Draw();
      CHECK(drawn == whole.Draw(), "stereo %s, frame %d: another picture than without a culler", name, frame);
      CHECK(!Empty(drawn), "stereo %s, frame %d shows nothing", name, frame);
    }
    for (CulledWindow* w : { &culled, &whole }) {
      w->Renderer->GetActiveCamera()->Modified(); // else it may go on with the matrices that it has
      w->Draw();
    }
    CHECK(culled.Draw() == whole.Draw(), "stereo %s: another picture than without a culler", name);
    CHECK((culled.Draw() == mono) == (type == 0), "stereo %s: one eye's picture", name);
    CHECK(culled.Seen() < 200, "stereo %s: %d are kept", name, int(culled.Seen()));
  }
}

// Two cullers, one culler in two renderers, viewports of other shapes, and a prop that two renderers share.
void TestRenderers(bool shared)
{
  CulledWindow w;
  w.AddLattice(5);
  vtkNew<vtkRenderer> right, overlay;
  Part both(4, 4, 4, 1.0), farther(4, 4, 5.2, 0.2);
  w.Renderer->SetViewport(0, 0, 0.3, 1);
  right->SetViewport(0.3, 0, 1, 1);
  overlay->SetViewport(0.6, 0.6, 0.9, 0.9);
  overlay->SetLayer(1);
  w.Window->SetNumberOfLayers(2);
  for (vtkRenderer* renderer : { right.Get(), overlay.Get() }) {
    w.Window->AddRenderer(renderer);
    renderer->AddActor(both.Actor);
    renderer->AddActor(farther.Actor);
    renderer->GetCullers()->RemoveAllItems();
    if (shared) {
      renderer->AddCuller(w.Culler);
    } else {
      vtkStratusOctreeCuller::Install(renderer);
    }
  }
  w.Renderer->AddActor(both.Actor);
  const double positions[3][3] = { { 4, 4, 12 }, { 4.5, 4, 6.5 }, { 8, 4.5, 30 } };
  for (int turn = 0; turn < 6; ++turn) {
    int number = turn;
    for (vtkRenderer* renderer : { w.Renderer.Get(), right.Get(), overlay.Get() }) {
      vtkCamera* camera = renderer->GetActiveCamera();
      camera->SetPosition(positions[number % 3]);
      camera->SetFocalPoint(4 + 0.3 * turn, 4, 0);
      camera->SetViewAngle(20);
      camera->SetClippingRange(0.1, 100);
      ++number;
    }
    CHECK(!Empty(w.Compare(shared ? "renderers that share a culler" : "renderers")), "renderers show nothing");
  }
}

// Props that say little of where they are.
void TestKinds()
{
  CulledWindow w;
  w.LookAhead();
  w.Compare("no prop at all");
  Part far(50), unused(60), outer(0, 0, 0), turned(0.5, 0, 0);
  w.Renderer->AddActor(far.Actor);
  w.Compare("one prop, out of sight");
  CHECK(w.Seen() == 0, "%d are kept", int(w.Seen()));
  unused.Actor->UseBoundsOff();
  w.Renderer->AddActor(unused.Actor);
  w.Compare("UseBounds off");
  CHECK(w.Seen() == 1, "a prop whose bounds are not to be used is left out");
  vtkNew<vtkActor2D> title;
  vtkNew<vtkTextMapper> text;
  text->SetInput("title");
  title->SetMapper(text);
  title->SetPosition(10, 10);
  w.Renderer->AddViewProp(title);
  CHECK(!Empty(w.Compare("a title")) && w.Seen() == 2, "a prop without bounds is left out");
  vtkNew<vtkActor> empty; // no mapper
  w.Renderer->AddActor(empty);
  w.Compare("an actor without a mapper");
  vtkNew<vtkAssembly> assembly;
  outer.Actor->SetPosition(30, 0, 0);
  assembly->AddPart(outer.Actor);
  assembly->AddPart(turned.Actor);
  w.Renderer->AddViewProp(assembly);
  const vtkIdType before = w.Seen();
  w.Compare("an assembly, a part of it in sight");
  CHECK(w.Seen() == before + 1, "an assembly is one prop");
  turned.Actor->SetPosition(30, 3, 0);
  w.Compare("an assembly whose part left");
  CHECK(w.Seen() == before, "an assembly out of sight is kept");
  vtkNew<vtkFollower> follower;
  follower->SetMapper(far.Mapper);
  follower->SetCamera(w.Renderer->GetActiveCamera());
  w.Renderer->AddActor(follower);
  w.Compare("a follower");
  CHECK(w.Seen() == before + 1, "a follower is left out");
}

// A vertex has no extent, a wide line is seen where its ends are not.
void TestMarks()
{
  CulledWindow w;
  w.LookAhead();
  vtkNew<vtkPolyData> vertex;
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  const vtkIdType point = points->InsertNextPoint(0, 0, 0);
  cells->InsertNextCell(1, &point);
  vertex->SetPoints(points);
  vertex->SetVerts(cells);
  vtkNew<vtkPolyDataMapper> mapper, lineMapper;
  vtkNew<vtkActor> actor, wide;
  mapper->SetInputData(vertex);
  actor->SetMapper(mapper);
  actor->GetProperty()->SetPointSize(5);
  w.Renderer->AddActor(actor);
  CHECK(!Empty(w.Compare("a vertex")) && w.Seen() == 1, "a vertex is left out");
  vtkNew<vtkLineSource> line;
  const double edge = 10 * std::tan(10 * 3.14159265358979 / 180) * 160 / 120, pixel = edge / 80;
  line->SetPoint1(edge + 4 * pixel, -1, 0);
  line->SetPoint2(edge + 4 * pixel, 1, 0);
  lineMapper->SetInputConnection(line->GetOutputPort());
  wide->SetMapper(lineMapper);
  wide->GetProperty()->SetLineWidth(14);
  w.Renderer->AddActor(wide);
  w.Compare("a wide line outside the window");
  CHECK(w.Seen() == 2, "a line that reaches into the window is left out");
  w.Culler->SetMargin(0);
  w.Draw();
  CHECK(w.Seen() == 1, "without a margin the line outside the window is kept");
}

void TestFails()
{
  CulledWindow w;
  w.AddLattice(3);
  vtkNew<vtkMatrix4x4> matrix;
  matrix->SetElement(0, 0, std::nan(""));
  vtkCamera* camera = w.Renderer->GetActiveCamera();
  camera->SetExplicitProjectionTransformMatrix(matrix);
  camera->UseExplicitProjectionTransformMatrixOn();
  w.Draw();
  CHECK(w.Seen() == 27, "a camera that is not finite culls: %d are kept", int(w.Seen()));
  matrix->Zero(); // no plane separates any two points
  matrix->Modified();
  w.Draw();
  CHECK(w.Seen() == 27, "a camera of nothing culls: %d are kept", int(w.Seen()));
  camera->UseExplicitProjectionTransformMatrixOff();
  Part far(1e30), infinite(HUGE_VAL);
  w.Renderer->AddActor(far.Actor);
  w.Renderer->AddActor(infinite.Actor);
  w.LookAhead();
  w.Compare("props at infinity");
  CHECK(vtkStratusOctreeCuller::Install(nullptr) == nullptr, "a culler in no renderer");
  vtkStratusOctreeCuller::Uninstall(nullptr);
  vtkNew<vtkPolyData> boxes;
  vtkNew<vtkRenderer> other;
  CHECK(!w.Culler->GetBoxes(other, boxes) && !w.Culler->GetBoxes(w.Renderer, nullptr), "boxes of no tree");
  CHECK(w.Culler->GetNumberOfNodes(other) == 0 && w.Culler->GetBytes(nullptr) == 0, "nodes of no tree");
}

void TestBoxes()
{
  CulledWindow w;
  w.AddLattice(6);
  w.Renderer->GetActiveCamera()->SetPosition(5, 5, 9);
  w.Renderer->GetActiveCamera()->SetFocalPoint(9, 5, 0);
  w.Renderer->GetActiveCamera()->SetClippingRange(0.1, 100);
  vtkNew<vtkPolyData> boxes;
  w.Draw();
  CHECK(w.Culler->GetNumberOfNodes(w.Renderer) == 1, "a frame that asks all props splits %d nodes",
    int(w.Culler->GetNumberOfNodes(w.Renderer)));
  w.Draw();
  CHECK(w.Culler->GetBoxes(w.Renderer, boxes), "no boxes");
  CHECK(boxes->GetNumberOfCells() == w.Culler->GetNumberOfNodes(w.Renderer) && boxes->GetNumberOfCells() > 8, "%d boxes",
    int(boxes->GetNumberOfCells()));
  vtkDataArray* levels = boxes->GetCellData()->GetScalars();
  vtkDataArray* visibility = boxes->GetCellData()->GetArray("Visibility");
  vtkDataArray* objects = boxes->GetCellData()->GetArray("Objects");
  double props = 0.0, range[2];
  for (vtkIdType i = 0; i < boxes->GetNumberOfCells(); ++i) {
    props += objects->GetTuple1(i);
    CHECK(i == 0 || levels->GetTuple1(i) >= levels->GetTuple1(i - 1), "level %g after %g", levels->GetTuple1(i), levels->GetTuple1(i - 1));
  }
  CHECK(props == 216.0, "%g props in all nodes", props);
  visibility->GetRange(range);
  CHECK(range[0] == 0.0 && range[1] >= 1.0, "visibility %g..%g", range[0], range[1]);
  double cells[6], world[6];
  boxes->GetBounds(cells);
  w.Renderer->ComputeVisiblePropBounds(world);
  for (int a = 0; a < 3; ++a) {
    CHECK(cells[2 * a] <= world[2 * a] && cells[2 * a + 1] >= world[2 * a + 1], "the root does not hold all props along axis %d", a);
  }
}

void TestInstall()
{
  vtkNew<vtkRenderer> renderer;
  vtkFrustumCoverageCuller* given = vtkFrustumCoverageCuller::SafeDownCast(renderer->GetCullers()->GetLastItem());
  given->SetMinimumCoverage(0.01);
  given->SetSortingStyleToBackToFront();
  vtkStratusOctreeCuller* culler = vtkStratusOctreeCuller::Install(renderer);
  CHECK(renderer->GetCullers()->GetNumberOfItems() == 1 && renderer->GetCullers()->GetLastItem() == culler, "there is another culler");
  CHECK(culler->GetMinimumCoverage() == 0.01 && culler->GetSortingStyle() == vtkStratusOctreeCuller::SORT_BACK_TO_FRONT, "other settings");
  CHECK(vtkStratusOctreeCuller::Install(renderer) == culler, "a second one next to the first");
  std::ostringstream text;
  culler->Print(text);
  CHECK(text.str().find("StopRule: pixels") != std::string::npos, "%s", text.str().c_str());
  vtkStratusOctreeCuller::Uninstall(renderer);
  given = vtkFrustumCoverageCuller::SafeDownCast(renderer->GetCullers()->GetLastItem());
  CHECK(given && renderer->GetCullers()->GetNumberOfItems() == 1 && given->GetMinimumCoverage() == 0.01, "no way back");
}
} // namespace

int main()
{
  TestCameras(false);
  TestCameras(true);
  for (int rule = vtkStratusOctreeCuller::STOP_PIXELS; rule <= vtkStratusOctreeCuller::STOP_STATIC; ++rule) {
    TestPath(rule);
  }
  TestStereo();
  TestRenderers(false);
  TestRenderers(true);
  TestKinds();
  TestMarks();
  TestFails();
  TestBoxes();
  TestInstall();
  std::printf(Failures == 0 ? "all as expected\n" : "%d failures\n", Failures);
  return Failures == 0 ? 0 : 1;
}
