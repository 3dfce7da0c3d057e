// SPDX-License-Identifier: BSD-3-Clause
// A plant of 9454 parts to walk through: plant [OUT.png [TREE.png]]. Key c switches the culler; the corner shows its name, the parts drawn,
// and frames a second. TREE.png: the culler's octree from afar, with the camera's frustum in it.
#include <vtkStratusOctreeCuller.h>

#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellData.h>
#include <vtkCubeSource.h>
#include <vtkCullerCollection.h>
#include <vtkCylinderSource.h>
#include <vtkFrustumSource.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPlanes.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

static const int Parts = 9454;

struct Plant {
  void Add(vtkAlgorithm* shape, double x, double y, double z, double sx, double sy, double sz, int turn, const double color[3])
  {
    if (this->Count == Parts) {
      return;
    }
    vtkNew<vtkPolyDataMapper> mapper;
    vtkNew<vtkActor> actor;
    mapper->SetInputConnection(shape->GetOutputPort());
    actor->SetMapper(mapper);
    actor->SetPosition(x, y, z);
    actor->SetScale(sx, sy, sz);
    actor->RotateWXYZ(turn ? 90 : 0, turn == 1, 0, turn == 2); // vtkCylinderSource's axis is y
    actor->GetProperty()->SetColor(color[0], color[1], color[2]);
    this->Renderer->AddActor(actor);
    ++this->Count;
  }

  // A steel frame of two floors with a tank, pipes along and across, and valves on them.
  void AddUnit(double x, double y)
  {
    static const double steel[3] = { 0.45, 0.5, 0.55 }, tank[3] = { 0.85, 0.82, 0.75 }, pipe[3] = { 0.3, 0.55, 0.75 },
                        valve[3] = { 0.85, 0.3, 0.15 };
    for (int i = 0; i < 9; ++i) {
      this->Add(this->Cube, x + 4 * (i % 3), y + 4 * (i / 3), 3, 0.25, 0.25, 6, 0, steel);
    }
    for (int i = 0; i < 12; ++i) {
      const double z = 3 + 3 * (i / 6);
      if (i % 2) {
        this->Add(this->Cube, x + 4, y + 4 * (i / 2 % 3), z, 8, 0.2, 0.2, 0, steel);
      } else {
        this->Add(this->Cube, x + 4 * (i / 2 % 3), y + 4, z, 0.2, 8, 0.2, 0, steel);
      }
    }
    this->Add(this->Cylinder, x + 2, y + 2, 2, 2.4, 3.6, 2.4, 1, tank);
    this->Add(this->Sphere, x + 2, y + 2, 3.8, 2.4, 2.4, 1, 0, tank);
    for (int i = 0; i < 14; ++i) {
      const double at = 0.6 * i, z = 0.6 + 0.35 * i;
      this->Add(this->Cylinder, x + 4, y + at, z, 0.25, 11, 0.25, 2, pipe);
      this->Add(this->Cylinder, x + at, y + 4, z + 0.2, 0.2, 11, 0.2, 0, pipe);
      this->Add(this->Sphere, x + at, y + at, z, 0.45, 0.45, 0.45, 0, valve);
    }
  }

  void Build()
  {
    for (int unit = 0; this->Count < Parts; ++unit) {
      this->AddUnit(14 * (unit % 12), 14 * (unit / 12));
    }
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetPosition(52, 40.5, 8.5);
    camera->SetFocalPoint(90, 66, 1);
    camera->SetViewUp(0, 0, 1);
    camera->SetClippingRange(0.3, 80);
    this->Renderer->SetBackground(0.75, 0.82, 0.88);
    this->Label->SetPosition(10, 10);
    this->Label->GetTextProperty()->SetFontSize(18);
    this->Label->GetTextProperty()->SetColor(0, 0, 0);
    this->Label->GetTextProperty()->SetBackgroundColor(1, 1, 1);
    this->Label->GetTextProperty()->SetBackgroundOpacity(0.7);
    this->Label->SetInput(" ");
    this->Renderer->AddViewProp(this->Label);
    this->SetMode(0);
  }

  void SetMode(int mode)
  {
    static const char* const names[] = { "octree", "octree, static props", "VTK's own culler" };
    this->Mode = mode % 3;
    this->Name = names[this->Mode];
    if (this->Mode == 2) {
      vtkStratusOctreeCuller::Uninstall(this->Renderer);
    } else {
      vtkStratusOctreeCuller::Install(this->Renderer)->SetStaticProps(this->Mode == 1);
    }
  }

  // Statistics of the last frame are shown in the next one.
  void ShowStatistics()
  {
    char text[200];
    const double seconds = this->Renderer->GetLastRenderTimeInSeconds();
    std::snprintf(text, sizeof text, "%s: %d of %d parts, %.1f frames/s", this->Name, this->Renderer->GetNumberOfPropsRendered(),
      this->Count, seconds > 0.0 ? 1.0 / seconds : 0.0);
    this->Label->SetInput(text);
  }

  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkTextActor> Label;
  vtkNew<vtkCubeSource> Cube;
  vtkNew<vtkCylinderSource> Cylinder;
  vtkNew<vtkSphereSource> Sphere;
  const char* Name = "";
  int Count = 0, Mode = 0;
};

static void OnFrame(vtkObject*, unsigned long, void* plant, void*)
{
  static_cast<Plant*>(plant)->ShowStatistics();
}

static void OnKey(vtkObject* caller, unsigned long, void* data, void*)
{
  vtkRenderWindowInteractor* interactor = vtkRenderWindowInteractor::SafeDownCast(caller);
  Plant* plant = static_cast<Plant*>(data);
  if (interactor->GetKeyCode() == 'c') {
    plant->SetMode(plant->Mode + 1);
    interactor->Render();
  }
}

static bool Save(vtkRenderWindow* window, const char* file)
{
  window->Render();
  vtkNew<vtkWindowToImageFilter> picture;
  picture->SetInput(window);
  picture->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(file);
  writer->SetInputConnection(picture->GetOutputPort());
  writer->Write();
  return writer->GetErrorCode() == 0;
}

// Cells at the ends of the tree that hold parts: grey where the frustum misses them, orange at its border, green within, lighter the
// farther down the tree.
static void ColorCells(vtkPolyData* boxes)
{
  static const double hues[3][3] = { { 0.55, 0.6, 0.65 }, { 0.95, 0.4, 0.0 }, { 0.0, 0.55, 0.2 } };
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetName("Color");
  colors->SetNumberOfComponents(4);
  for (vtkIdType cell = 0; cell < boxes->GetNumberOfCells(); ++cell) {
    const int side = static_cast<int>(boxes->GetCellData()->GetArray("Visibility")->GetTuple1(cell));
    const double light = 255 * std::min(1.0, 0.7 + 0.06 * boxes->GetCellData()->GetArray("Level")->GetTuple1(cell));
    const double split = boxes->GetCellData()->GetArray("Split")->GetTuple1(cell);
    const bool shown = split == 0 && boxes->GetCellData()->GetArray("Objects")->GetTuple1(cell) > 0;
    colors->InsertNextTuple4(light * hues[side][0], light * hues[side][1], light * hues[side][2], shown ? 255 : 0);
  }
  boxes->GetCellData()->SetScalars(colors);
}

// From afar: the octree's cells, the frustum, and the parts that are drawn.
static bool SaveTree(Plant& plant, const char* file)
{
  vtkNew<vtkPolyData> boxes;
  vtkStratusOctreeCuller* culler = vtkStratusOctreeCuller::Install(plant.Renderer);
  culler->SetLeafProps(16);                    // more cells than are worth their while, so that there is something to see
  plant.Renderer->GetRenderWindow()->Render(); // asks the parts for their bounds
  plant.Renderer->GetRenderWindow()->Render(); // splits the octree
  if (!culler->GetBoxes(plant.Renderer, boxes)) {
    return false;
  }
  ColorCells(boxes);
  vtkNew<vtkPolyDataMapper> boxMapper, frustumMapper;
  boxMapper->SetInputData(boxes);
  vtkNew<vtkActor> boxActor, frustumActor;
  boxActor->SetMapper(boxMapper);
  boxActor->GetProperty()->LightingOff();
  boxActor->ForceTranslucentOn(); // cells without parts are clear
  boxActor->GetProperty()->SetLineWidth(1.5);

  double numbers[24];
  plant.Renderer->GetActiveCamera()->GetFrustumPlanes(plant.Renderer->GetTiledAspectRatio(), numbers);
  vtkNew<vtkPlanes> planes;
  planes->SetFrustumPlanes(numbers);
  vtkNew<vtkFrustumSource> frustum;
  frustum->SetPlanes(planes);
  frustum->ShowLinesOff();
  frustumMapper->SetInputConnection(frustum->GetOutputPort());
  frustumActor->SetMapper(frustumMapper);
  frustumActor->GetProperty()->SetColor(0.2, 0.4, 0.9);
  frustumActor->GetProperty()->SetOpacity(0.25);

  vtkNew<vtkRenderer> overview;
  vtkPropCollection* props = plant.Renderer->GetViewProps();
  vtkCollectionSimpleIterator cookie;
  props->InitTraversal(cookie);
  while (vtkProp* prop = props->GetNextProp(cookie)) {
    if (prop != plant.Label.Get() && prop->GetRenderTimeMultiplier() > 0.0) {
      overview->AddViewProp(prop);
    }
  }
  overview->AddActor(frustumActor);
  overview->AddActor(boxActor);
  overview->SetBackground(1, 1, 1);
  vtkCamera* camera = overview->GetActiveCamera();
  camera->SetPosition(60, -55, 120);
  camera->SetFocalPoint(80, 68, 0);
  camera->SetViewUp(0, 0, 1);
  camera->SetViewAngle(40);
  camera->SetClippingRange(10, 1000);
  vtkNew<vtkRenderWindow> window;
  window->SetSize(900, 560);
  window->AddRenderer(overview);
  return Save(window, file);
}

int main(int argc, char** argv)
{
  Plant plant;
  plant.Build();
  vtkNew<vtkCallbackCommand> frame, key;
  frame->SetCallback(OnFrame);
  frame->SetClientData(&plant);
  plant.Renderer->AddObserver(vtkCommand::EndEvent, frame);
  vtkNew<vtkRenderWindow> window;
  window->SetSize(900, 560);
  window->AddRenderer(plant.Renderer);
  if (argc < 2) {
    vtkNew<vtkRenderWindowInteractor> interactor;
    vtkNew<vtkInteractorStyleTrackballCamera> style;
    style->AutoAdjustCameraClippingRangeOff(); // else each move of the mouse asks all parts for their bounds
    interactor->SetRenderWindow(window);
    interactor->SetInteractorStyle(style);
    key->SetCallback(OnKey);
    key->SetClientData(&plant);
    interactor->AddObserver(vtkCommand::CharEvent, key);
    window->Render();
    interactor->Start();
    return EXIT_SUCCESS;
  }
  for (int mode = 0; mode < 3; ++mode) {
    plant.SetMode(mode);
    for (int i = 0; i < 4; ++i) {
      plant.Renderer->GetActiveCamera()->Yaw(0.1);
      window->Render();
    }
    std::printf("%s\n", plant.Label->GetInput());
  }
  plant.SetMode(0);
  window->Render();
  const bool saved = Save(window, argv[1]) && (argc < 3 || SaveTree(plant, argv[2]));
  return saved ? EXIT_SUCCESS : EXIT_FAILURE;
}
