// SPDX-License-Identifier: BSD-3-Clause
// Picking by hardware reads props off the window. The volume is picked where it adds more than 3 of 255; props before it, or behind
// transparent parts of it, are picked instead; and later pictures are as before. The selection contains the cell and the point that a ray
// shows first, as the picture's depths do.
#include "mapper_testing.h"

#include "vtkActor.h"
#include "vtkHardwareSelector.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkPolyDataMapper.h"
#include "vtkPropPicker.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkSphereSource.h"

namespace {
// area: first column and row, last column and row; null: the whole picture.
vtkSmartPointer<vtkSelection> Select(Scene& scene, bool propsOnly, const unsigned int* area = nullptr)
{
  vtkNew<vtkHardwareSelector> selector;
  selector->SetRenderer(scene.Renderer);
  const int* size = scene.Renderer->GetSize();
  const unsigned int whole[4] = { 0, 0, static_cast<unsigned int>(size[0] - 1), static_cast<unsigned int>(size[1] - 1) };
  selector->SetArea(area ? area : whole);
  selector->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
  selector->SetActorPassOnly(propsOnly);
  return vtkSmartPointer<vtkSelection>::Take(selector->Select());
}

// Returns whether a selection has many cells, and each of them has a visible point, or a cell within `margin` of it has one, as at the
// beginning of a ray's segment.
bool HasShownCells(Scene& scene, vtkSelection* selection, int margin)
{
  auto* numbers = vtkIdTypeArray::SafeDownCast(selection->GetNode(0)->GetSelectionList());
  const int* size = scene.Image->GetDimensions();
  bool all = numbers && numbers->GetNumberOfValues() > 50;
  for (vtkIdType i = 0; all && i < numbers->GetNumberOfValues(); ++i) {
    const vtkIdType cell = numbers->GetValue(i);
    const int at[3] = { static_cast<int>(cell % (size[0] - 1)), static_cast<int>(cell / (size[0] - 1) % (size[1] - 1)),
      static_cast<int>(cell / ((size[0] - 1) * (size[1] - 1))) };
    double most = 0.0;
    for (int z = std::max(at[2] - margin, 0); z <= std::min(at[2] + 1 + margin, size[2] - 1); ++z) {
      for (int y = std::max(at[1] - margin, 0); y <= std::min(at[1] + 1 + margin, size[1] - 1); ++y) {
        for (int x = std::max(at[0] - margin, 0); x <= std::min(at[0] + 1 + margin, size[0] - 1); ++x) {
          most = std::max(most, scene.Opacity->GetValue(scene.Image->GetScalarComponentAsDouble(x, y, z, 0)));
        }
      }
    }
    all = most > 0.0;
  }
  return all;
}

// The cells of an area, from a selector that reads no more and from one that reads the whole picture.
void Areas(Scene& scene)
{
  const int* size = scene.Renderer->GetSize();
  const unsigned int last[2] = { static_cast<unsigned int>(size[0] - 1), static_cast<unsigned int>(size[1] - 1) };
  vtkNew<vtkHardwareSelector> whole;
  whole->SetRenderer(scene.Renderer);
  whole->SetArea(0, 0, last[0], last[1]);
  whole->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
  CHECK(whole->CaptureBuffers(), "nothing was captured");
  int found = 0;
  for (unsigned int n = 0; n < 6; ++n) {
    const unsigned int x = last[0] * (8 + n) / 20, y = last[1] * (12 - n) / 20;
    const unsigned int area[4] = { x, y, n < 4 ? x : x + 8 * n, n < 4 ? y : y + 4 * n }; // single pixels, and rectangles
    const vtkSmartPointer<vtkSelection> own = Select(scene, false, area);
    const vtkSmartPointer<vtkSelection> part =
      vtkSmartPointer<vtkSelection>::Take(whole->GenerateSelection(area[0], area[1], area[2], area[3]));
    CHECK(own && own->GetNumberOfNodes() == part->GetNumberOfNodes(), "area %u has other props", n);
    if (own && own->GetNumberOfNodes() == 1 && part->GetNumberOfNodes() == 1) {
      vtkAbstractArray* lists[2] = { own->GetNode(0)->GetSelectionList(), part->GetNode(0)->GetSelectionList() };
      CHECK(lists[0]->GetNumberOfValues() == lists[1]->GetNumberOfValues(), "area %u has %lld cells, %lld of them in the whole", n,
        static_cast<long long>(lists[0]->GetNumberOfValues()), static_cast<long long>(lists[1]->GetNumberOfValues()));
      for (vtkIdType i = 0; i < std::min(lists[0]->GetNumberOfValues(), lists[1]->GetNumberOfValues()); ++i) {
        CHECK(lists[0]->GetVariantValue(i) == lists[1]->GetVariantValue(i), "area %u has another cell", n);
        ++found;
      }
    }
  }
  CHECK(found > 10, "%d cells are found in the areas", found);
}

void Volume(int mode, bool coarse)
{
  Scene scene;
  scene.Mapper->SetRenderMode(mode);
  scene.Mapper->SetImageSampleDistance(coarse ? 3.0 : 1.0);
  scene.Mapper->SetFinalColorWindow(0.5f); // ids are no colours
  scene.Renderer->SetBackground(0.3, 0.6, 0.9);
  const std::vector<float> before = scene.Picture();
  int shown = 0;
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    shown += before[4 * p + 3] > 3.0f / 255.0f;
  }
  const vtkSmartPointer<vtkSelection> selection = Select(scene, true);
  CHECK(selection && selection->GetNumberOfNodes() == 1, "%u props picked", selection ? selection->GetNumberOfNodes() : 0);
  if (selection && selection->GetNumberOfNodes() == 1) {
    vtkInformation* node = selection->GetNode(0)->GetProperties();
    CHECK(node->Get(vtkSelectionNode::PROP()) == scene.Volume, "another prop is picked");
    CHECK(node->Get(vtkSelectionNode::PIXEL_COUNT()) == shown, "%d pixels are picked, %d show", node->Get(vtkSelectionNode::PIXEL_COUNT()),
      shown);
  }
  CHECK(shown > 1000 && scene.Picture() == before, "the picture after picking is another");
  const vtkSmartPointer<vtkSelection> cells = Select(scene, false);
  CHECK(cells && cells->GetNumberOfNodes() == 1 && cells->GetNode(0)->GetProperties()->Get(vtkSelectionNode::PROP()) == scene.Volume,
    "a selection of cells names another prop");
  CHECK(!cells || HasShownCells(scene, cells, mode == vtkStratusVolumeMapper::FIRST_HIT_MODE ? 0 : 1), "invisible cells are selected");
  Areas(scene);
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

void Picked()
{
  Scene scene;
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(4);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(ball->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  scene.Renderer->AddActor(actor);
  double center[3], along[3];
  scene.Renderer->GetActiveCamera()->GetFocalPoint(center);
  scene.Renderer->GetActiveCamera()->GetDirectionOfProjection(along);
  vtkNew<vtkPropPicker> picker;
  const int* size = scene.Renderer->GetSize();
  for (double where : { -40.0, 40.0 }) {
    actor->SetPosition(center[0] + where * along[0], center[1] + where * along[1], center[2] + where * along[2]);
    scene.Renderer->ResetCameraClippingRange();
    const bool seen = scene.Picture()[4 * scene.Pixels() / 2 + 2 * static_cast<size_t>(size[0]) + 3] > 0.0f;
    CHECK(seen == (where > 0.0), "the ball at %g: the volume %s", where, seen ? "shows" : "does not show");
    CHECK(picker->PickProp(size[0] / 2, size[1] / 2, scene.Renderer) == 1, "nothing is picked");
    CHECK(
      picker->GetViewProp() == (where < 0.0 ? static_cast<vtkProp*>(actor) : scene.Volume), "the ball at %g: the other is picked", where);
  }
  CHECK(picker->PickProp(1, 1, scene.Renderer) == 0, "something is picked where nothing is");
}
} // namespace

int main()
{
  for (int mode : { vtkStratusVolumeMapper::COMPOSITE_MODE, vtkStratusVolumeMapper::FIRST_HIT_MODE }) {
    Volume(mode, false);
    Volume(mode, true);
  }
  Picked();
  return Failures == 0 ? 0 : 1;
}
