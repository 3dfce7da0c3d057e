// SPDX-License-Identifier: BSD-3-Clause
// Rectilinear grids in the window and in the filters. Equal spacing draws the image's picture, stretched grids draw the double reference's;
// cell data, ghosts, blanking, cropping, masks, picking, trees and distance maps work as on images; other grids are refused.
#include "mapper_testing.h"

#include "Testing/support/reference_modes.h"
#include "vtkStratusDistanceMapFilter.h"
#include "vtkStratusHybridTreeFilter.h"

#include "vtkContourValues.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkHardwareSelector.h"
#include "vtkInformation.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkSmartPointer.h"

namespace {
const int Points[3] = { 33, 29, 25 }; // of the scene's image, too

// Coordinates from `begin` on; each spacing is `ratio` times the last one's, up to `stretch` over all. The mean is `spacing`.
vtkSmartPointer<vtkDoubleArray> Axis(int count, double begin, double spacing, double stretch)
{
  std::vector<double> x(static_cast<size_t>(count), 0.0);
  for (size_t i = 1; i < x.size(); ++i) {
    x[i] = x[i - 1] + std::pow(stretch, static_cast<double>(i - 1) / (count - 2));
  }
  vtkNew<vtkDoubleArray> axis;
  for (double place : x) {
    axis->InsertNextValue(begin + place / x.back() * spacing * (count - 1));
  }
  return axis;
}

struct GridScene : Scene {
  explicit GridScene(double stretch, bool cells = false, double begin = 0.0)
  {
    this->Grid->SetDimensions(Points[0], Points[1], Points[2]);
    this->Grid->SetXCoordinates(Axis(Points[0], begin, 0.9, stretch));
    this->Grid->SetYCoordinates(Axis(Points[1], begin, 1.0, 1.0 / stretch));
    this->Grid->SetZCoordinates(Axis(Points[2], begin, 1.1, stretch));
    if (cells) {
      this->Image->GetPointData()->Initialize();
      FillField(this->Image, true, "density");
      this->Grid->GetCellData()->ShallowCopy(this->Image->GetCellData());
      this->Values = vtkFloatArray::SafeDownCast(this->Grid->GetCellData()->GetScalars());
    } else {
      this->Grid->GetPointData()->ShallowCopy(this->Image->GetPointData());
      this->Values = vtkFloatArray::SafeDownCast(this->Grid->GetPointData()->GetScalars());
    }
    this->Mapper->SetInputData(this->Grid);
    this->Look(35, 20);
  }

  // The same grid for the reference.
  stratus_volume Volume0(bool cells)
  {
    stratus_volume volume = stratus_volume_default();
    volume.values = this->Values->GetPointer(0);
    volume.type = STRATUS_FLOAT32;
    volume.cell_centered = cells ? 1 : 0;
    vtkDataArray* const axes[3] = { this->Grid->GetXCoordinates(), this->Grid->GetYCoordinates(), this->Grid->GetZCoordinates() };
    for (int a = 0; a < 3; ++a) {
      volume.dimensions[a] = Points[a] - (cells ? 1 : 0);
      volume.coordinates[a] = vtkDoubleArray::SafeDownCast(axes[a])->GetPointer(0);
    }
    std::copy_n(&this->Volume->GetMatrix()->Element[0][0], 16, volume.matrix);
    return volume;
  }

  vtkNew<vtkRectilinearGrid> Grid;
  vtkFloatArray* Values = nullptr;
};

double Largest(const std::vector<float>& a, const std::vector<float>& b)
{
  double largest = a.empty() || a.size() != b.size() ? 1.0 : 0.0;
  for (size_t i = 0; i < a.size() && i < b.size(); ++i) {
    largest = std::max(largest, std::fabs(static_cast<double>(a[i]) - b[i]));
  }
  return largest;
}

double LightOf(const std::vector<float>& picture)
{
  double sum = 0.0;
  for (float value : picture) {
    sum += value;
  }
  return sum;
}

// Draws by the default options, which keep 60 dB, and compares with the reference.
void Against(const char* what, GridScene& scene, bool cells, const std::function<void(reference_scene&)>& more = nullptr)
{
  const SceneFunctions functions(scene);
  const std::vector<float> picture = scene.Picture();
  const stratus_volume volume = scene.Volume0(cells);
  const stratus_camera camera = ReferenceCamera(scene.Renderer);
  reference_scene reference = reference_scene();
  reference.volume = &volume;
  reference.transfer = &functions.Transfer;
  reference.camera = &camera;
  if (more) {
    more(reference);
  }
  std::vector<float> rgba(4 * scene.Pixels());
  const int* size = scene.Renderer->GetSize();
  CHECK(reference_render(&reference, size[0], size[1], 0.25, rgba.data(), nullptr) == 0, "no memory");
  const double db = picture.empty() ? 0.0 : reference_psnr(picture.data(), rgba.data(), scene.Pixels());
  CHECK(LightOf(rgba) > 100.0, "%s: the reference's picture is all but empty", what);
  CHECK(db >= 60.0 && scene.Errors->Count == 0, "%s: %.1f dB, '%s'", what, db, scene.Errors->Text.c_str());
  std::printf("%-32s %.1f dB; %s\n", what, db, scene.Mapper->GetReason());
  scene.Mapper->AuditOn();
  scene.Render();
  CHECK(scene.Mapper->GetDifferingPixels() == 0, "%s: skipping changes the picture", what);
}

void EqualSpacing()
{
  for (const bool cells : { false, true }) {
    GridScene scene(1.0, cells);
    const std::vector<float> grid = scene.Picture();
    double bounds[6], imageBounds[6];
    std::copy_n(scene.Mapper->GetBounds(), 6, bounds);
    CHECK(scene.Mapper->GetDataSetInput() == scene.Grid && scene.Mapper->GetInput() == scene.Grid, "the input is another");
    scene.Mapper->SetInputData(scene.Image);
    const std::vector<float> image = scene.Picture();
    std::copy_n(scene.Mapper->GetBounds(), 6, imageBounds);
    CHECK(LightOf(image) > 100.0, "nothing is shown");
    CHECK(Largest(grid, image) <= 1e-5, "%s: the image's picture differs by %g", cells ? "cells" : "points", Largest(grid, image));
    for (int side = 0; side < 6; ++side) {
      CHECK(std::fabs(bounds[side] - imageBounds[side]) < 1e-9, "bound %d is %g, not %g", side, bounds[side], imageBounds[side]);
    }
    CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  }
}

void StretchedGrids()
{
  {
    GridScene scene(100.0);
    Against("points, stretched 100:1", scene, false);
    scene.Volume->RotateWXYZ(30, 1, 2, 3);
    scene.Volume->SetScale(2, 1, 0.5);
    scene.Look(10, 50);
    Against("turned and scaled", scene, false);
  }
  {
    GridScene scene(100.0, true);
    Against("cells, stretched 100:1", scene, true);
  }
  {
    GridScene scene(100.0, false, 6e6); // as UTM coordinates
    Against("points, far away", scene, false);
  }
}

void Cropped()
{
  GridScene scene(20.0);
  double planes[6]; // about the larger blob
  vtkDataArray* const axes[3] = { scene.Grid->GetXCoordinates(), scene.Grid->GetYCoordinates(), scene.Grid->GetZCoordinates() };
  for (int a = 0; a < 3; ++a) {
    planes[2 * a] = 0.01 + axes[a]->GetComponent(Points[a] / 4, 0);
    planes[2 * a + 1] = 0.01 + axes[a]->GetComponent(Points[a] / 2, 0);
  }
  scene.Mapper->CroppingOn();
  scene.Mapper->SetCroppingRegionPlanes(planes);
  scene.Mapper->SetCroppingRegionFlagsToSubVolume();
  Against("cropped", scene, false, [&](reference_scene& reference) {
    reference.crop = 1;
    std::copy_n(planes, 6, reference.crop_bounds);
  });
  const double inside = LightOf(scene.Picture());
  scene.Mapper->SetCroppingRegionFlags(0x7ffffff & ~VTK_CROP_SUBVOLUME);
  const double outside = LightOf(scene.Picture());
  CHECK(inside > 100.0 && outside > 100.0 && scene.Errors->Count == 0, "crop regions: %g inside, %g outside", inside, outside);
}

void GhostsAndBlanking()
{
  GridScene scene(20.0);
  const double whole = LightOf(scene.Picture());
  scene.Grid->AllocateCellGhostArray();
  unsigned char* flags = scene.Grid->GetCellGhostArray()->GetPointer(0);
  for (vtkIdType c = 0; c < scene.Grid->GetNumberOfCells(); ++c) {
    flags[c] = c % 32 < 16 ? vtkDataSetAttributes::HIDDENCELL : 0;
  }
  scene.Grid->Modified();
  Against(
    "blanked cells", scene, false, [&](reference_scene& reference) { const_cast<stratus_volume*>(reference.volume)->cell_ghosts = flags; });
  const double blanked = LightOf(scene.Picture());
  CHECK(blanked > 0.1 * whole && blanked < 0.9 * whole, "blanking: %g of %g", blanked, whole);
  std::fill_n(flags, scene.Grid->GetNumberOfCells(), static_cast<unsigned char>(vtkDataSetAttributes::DUPLICATECELL));
  scene.Grid->GetCellGhostArray()->Modified();
  CHECK(LightOf(scene.Picture()) == 0.0, "cells of another piece are drawn");
}

void Modes()
{
  const std::pair<int, stratus_mode> modes[] = { { vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND, STRATUS_MODE_MAXIMUM },
    { vtkVolumeMapper::AVERAGE_INTENSITY_BLEND, STRATUS_MODE_AVERAGE }, { vtkVolumeMapper::ADDITIVE_BLEND, STRATUS_MODE_ADDITIVE },
    { vtkVolumeMapper::ISOSURFACE_BLEND, STRATUS_MODE_ISOSURFACE } };
  for (const auto& mode : modes) {
    GridScene scene(20.0);
    const SceneFunctions functions(scene);
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    options.mode = mode.second;
    options.optics.contour_count = 1;
    options.optics.contours[0] = 0.35;
    scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, 0.35);
    scene.Mapper->SetBlendMode(mode.first);
    scene.Mapper->SetSampleDistance(0.05f);
    const std::vector<float> picture = scene.Picture();
    const stratus_volume volume = scene.Volume0(false);
    const stratus_camera camera = ReferenceCamera(scene.Renderer);
    std::vector<float> rgba(4 * scene.Pixels()), depth(scene.Pixels());
    const int* size = scene.Renderer->GetSize();
    reference_modes_render(&volume, &functions.Transfer, &camera, &options, size[0], size[1], 1.0 / 32, rgba.data(), depth.data());
    const double db = picture.empty() ? 0.0 : reference_psnr(picture.data(), rgba.data(), scene.Pixels());
    const double least = mode.second == STRATUS_MODE_ISOSURFACE ? 35.0 : 55.0; // as for images
    CHECK(db >= least && scene.Errors->Count == 0, "%s: %.1f dB, '%s'", stratus_mode_name(mode.second), db, scene.Errors->Text.c_str());
    std::printf("%-32s %.1f dB\n", stratus_mode_name(mode.second), db);
  }
}

void LitAndMasked()
{
  GridScene scene(20.0);
  const std::vector<float> plain = scene.Picture();
  scene.Volume->GetProperty()->ShadeOn();
  const std::vector<float> lit = scene.Picture();
  CHECK(LightOf(lit) > 100.0 && Largest(plain, lit) > 0.05, "light changes nothing");
  vtkNew<vtkImageData> mask; // values by their indices, wherever they lie
  mask->SetDimensions(Points);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  mask->GetPointData()->GetScalars()->Fill(0);
  scene.Mapper->SetMaskInput(mask);
  CHECK(LightOf(scene.Picture()) == 0.0 && scene.Errors->Count == 0, "a mask that hides all: '%s'", scene.Errors->Text.c_str());
}

void Picking()
{
  GridScene scene(20.0);
  scene.Render();
  vtkNew<vtkHardwareSelector> selector;
  const int* size = scene.Renderer->GetSize();
  selector->SetRenderer(scene.Renderer);
  selector->SetArea(0, 0, size[0] - 1, size[1] - 1);
  selector->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
  const auto selection = vtkSmartPointer<vtkSelection>::Take(selector->Select());
  CHECK(selection && selection->GetNumberOfNodes() > 0 &&
      selection->GetNode(0)->GetProperties()->Get(vtkSelectionNode::PROP()) == scene.Volume.GetPointer(),
    "the volume is not picked");
}

void Filters()
{
  GridScene scene(100.0);
  const std::vector<float> picture = scene.Picture();
  vtkNew<vtkStratusHybridTreeFilter> tree;
  tree->SetInputData(scene.Grid);
  tree->SetVolumeProperty(scene.Volume->GetProperty());
  tree->Update();
  vtkRectilinearGrid* carried = vtkRectilinearGrid::SafeDownCast(tree->GetOutputDataObject(0));
  CHECK(carried && carried->GetNumberOfPoints() == scene.Grid->GetNumberOfPoints(), "the tree's output is no such grid");
  double bounds[6], boxes[6];
  scene.Grid->GetBounds(bounds);
  tree->GetBoxes()->GetBounds(boxes);
  for (int a = 0; a < 3; ++a) {
    CHECK(boxes[2 * a] >= bounds[2 * a] - 1e-9 && boxes[2 * a + 1] <= bounds[2 * a + 1] + 1e-9 && boxes[2 * a] < boxes[2 * a + 1],
      "boxes %g..%g along axis %d, the grid is %g..%g", boxes[2 * a], boxes[2 * a + 1], a, bounds[2 * a], bounds[2 * a + 1]);
  }
  scene.Mapper->SetInputConnection(tree->GetOutputPort());
  scene.Mapper->SetStructure(STRATUS_STRUCTURE_HYBRID);
  CHECK(scene.Picture() == picture, "the carried tree changes the picture");
  CHECK(scene.Mapper->GetCarriedTreeUsed() && scene.Errors->Count == 0, "the carried tree is not used: %s", scene.Mapper->GetReason());

  vtkNew<vtkStratusDistanceMapFilter> map;
  map->SetInputData(scene.Grid);
  map->SetVolumeProperty(scene.Volume->GetProperty());
  map->SetBlockSize(4);
  map->Update();
  vtkRectilinearGrid* blocks = vtkRectilinearGrid::SafeDownCast(map->GetOutputDataObject(0));
  CHECK(blocks, "the distance map's output is no grid");
  if (blocks) {
    CHECK(blocks->GetDimensions()[0] == 9 && blocks->GetDimensions()[1] == 8 && blocks->GetDimensions()[2] == 7, "blocks: %d x %d x %d",
      blocks->GetDimensions()[0] - 1, blocks->GetDimensions()[1] - 1, blocks->GetDimensions()[2] - 1);
    CHECK(blocks->GetXCoordinates()->GetComponent(2, 0) == scene.Grid->GetXCoordinates()->GetComponent(8, 0), "block 2 begins elsewhere");
    CHECK(blocks->GetXCoordinates()->GetComponent(8, 0) == scene.Grid->GetXCoordinates()->GetComponent(32, 0), "the last block's end");
    CHECK(blocks->GetCellData()->GetScalars()->GetNumberOfTuples() == 8 * 7 * 6, "not a value a block");
  }
  vtkNew<ErrorObserver> errors;
  tree->AddObserver(vtkCommand::ErrorEvent, errors);
  tree->SetPurposeToFirstHits();
  tree->Update();
  CHECK(errors->Count > 0 && errors->Has("rectilinear"), "a tree of voxels: '%s'", errors->Text.c_str());
  CHECK(vtkRectilinearGrid::SafeDownCast(tree->GetOutputDataObject(0))->GetNumberOfPoints() == scene.Grid->GetNumberOfPoints(),
    "the last good output is gone");
}

// Errors about invalid grids contain the wrong value, nothing is drawn, and the next valid input is drawn.
void BadGrids()
{
  GridScene scene(20.0);
  const std::vector<float> picture = scene.Picture();
  const auto good = vtkSmartPointer<vtkDataArray>(scene.Grid->GetYCoordinates());
  const auto refuse = [&](const char* what, vtkDataArray* axis, const char* word) {
    scene.Grid->SetYCoordinates(axis);
    const int before = scene.Errors->Count;
    CHECK(scene.Picture().empty() && scene.Errors->Count > before && scene.Errors->Has(word), "%s: '%s'", what, scene.Errors->Text.c_str());
    scene.Grid->SetYCoordinates(good);
    CHECK(scene.Picture() == picture, "after %s the picture is another", what);
  };
  auto axis = Axis(Points[1], 0.0, 1.0, 1.0);
  axis->SetValue(7, std::nan(""));
  refuse("NaN", axis, "coordinate 7 along y is nan");
  axis = Axis(Points[1], 0.0, 1.0, 1.0);
  axis->SetValue(7, 6.0);
  refuse("repeated", axis, "coordinates 6 and 7 along y");
  axis->SetValue(7, 3.0);
  refuse("falling", axis, "rise strictly");
  refuse("too few", Axis(Points[1] - 3, 0.0, 1.0, 1.0), "26 coordinates");

  vtkNew<vtkRectilinearGrid> flat;
  flat->SetDimensions(Points[0], Points[1], 1);
  flat->SetXCoordinates(scene.Grid->GetXCoordinates());
  flat->SetYCoordinates(scene.Grid->GetYCoordinates());
  flat->SetZCoordinates(Axis(2, 0.0, 1.0, 1.0));
  flat->GetPointData()->SetScalars(scene.Values);
  scene.Mapper->SetInputData(flat);
  CHECK(scene.Picture().empty() && scene.Errors->Has("flat"), "a flat grid of two coordinates: '%s'", scene.Errors->Text.c_str());
  scene.Mapper->SetInputData(scene.Grid);
  CHECK(scene.Picture() == picture, "after a flat grid the picture is another");
}

// A grid of one layer of points is a sheet, as thick as the mean spacing: the picture of two layers of its values.
void Sheet()
{
  Scene scene(64, 48), thick(64, 48);
  vtkNew<vtkRectilinearGrid> flat, layers;
  vtkNew<vtkFloatArray> values, twice;
  for (int i = 0; i < 2 * 20 * 15; ++i) {
    const float value = static_cast<float>(0.5 + 0.4 * std::sin(i % 300));
    twice->InsertNextValue(value);
    if (i < 20 * 15) {
      values->InsertNextValue(value);
    }
  }
  for (vtkRectilinearGrid* grid : { flat.Get(), layers.Get() }) {
    grid->SetDimensions(20, 15, grid == flat ? 1 : 2);
    grid->SetXCoordinates(Axis(20, 0.0, 1.0, 1.0));
    grid->SetYCoordinates(Axis(15, 0.0, 1.0, 1.0));
    vtkNew<vtkFloatArray> z;
    z->InsertNextValue(grid == flat ? 3.0f : 2.5f);
    if (grid == layers) {
      z->InsertNextValue(3.5f);
    }
    grid->SetZCoordinates(z);
    grid->GetPointData()->SetScalars(grid == flat ? values : twice);
  }
  scene.Mapper->SetInputData(flat);
  thick.Mapper->SetInputData(layers);
  scene.Look(35, 20);
  thick.Look(35, 20);
  const std::vector<float> picture = scene.Picture(), of_layers = thick.Picture();
  double worst = 0.0, light = 0.0;
  for (size_t i = 0; i < std::min(picture.size(), of_layers.size()); ++i) {
    worst = std::max(worst, std::fabs(static_cast<double>(picture[i]) - of_layers[i]));
    light += picture[i];
  }
  CHECK(light > 10.0 && worst < 0.01, "a sheet: light %g, %g from two layers; %s", light, worst, scene.Errors->Text.c_str());
}

// Solid voxels: halfway to the neighbours, on both ends too, so that bounds and pictures reach beyond the grid; of equal spacing the
// image's.
void FirstHits()
{
  for (bool cells : { false, true }) {
    GridScene even(1.0, cells), stretched(0.05, cells, -3.0);
    Scene image;
    if (cells) {
      image.Image->GetPointData()->Initialize();
      image.Image->GetCellData()->ShallowCopy(even.Image->GetCellData());
    }
    for (Scene* scene : { static_cast<Scene*>(&even), static_cast<Scene*>(&stretched), &image }) {
      scene->Mapper->SetRenderModeToFirstHit();
      scene->Volume->GetProperty()->ShadeOn();
      scene->Look(35, 20);
    }
    const std::vector<float> picture = even.Picture();
    CHECK(Largest(picture, image.Picture()) <= 1e-5 && LightOf(picture) > 1000.0, "first hits of equal spacing: %g from the image's",
      Largest(picture, image.Picture()));
    const double* inner = stretched.Grid->GetBounds();
    const double* outer = stretched.Mapper->GetBounds();
    const double first = 0.5 * (stretched.Grid->GetXCoordinates()->GetComponent(1, 0) - inner[0]);
    CHECK(std::fabs(inner[0] - outer[0] - (cells ? 0.0 : first)) < 1e-9, "bounds begin at %g, the grid at %g", outer[0], inner[0]);
    // The first voxels along x are long: seen along z, their outer half lies beyond the grid.
    stretched.Volume->GetProperty()->GetScalarOpacity()->RemoveAllPoints();
    stretched.Volume->GetProperty()->GetScalarOpacity()->AddPoint(0.0, 1.0); // all show
    vtkCamera* camera = stretched.Renderer->GetActiveCamera();
    camera->ParallelProjectionOn();
    camera->SetFocalPoint(inner[0], 0.5 * (inner[2] + inner[3]), 0.5 * (inner[4] + inner[5]));
    camera->SetPosition(inner[0], 0.5 * (inner[2] + inner[3]), inner[5] + 100.0);
    camera->SetViewUp(0, 1, 0);
    camera->SetParallelScale(4.0 * first);
    stretched.Renderer->ResetCameraClippingRange();
    stretched.Render();
    const int* size = stretched.Renderer->GetSize();
    const std::vector<unsigned char> bytes = stretched.Bytes();
    const auto shown = [&](double x) { // in halves of the first voxel from the grid's border
      const int column = static_cast<int>(std::floor(0.5 * size[0] + x / 8.0 * size[1]));
      const unsigned char* pixel = &bytes[4 * (static_cast<size_t>(size[1] / 2) * static_cast<size_t>(size[0]) + column)];
      return pixel[0] + pixel[1] + pixel[2] > 0;
    };
    CHECK(shown(0.2) && shown(-0.8) == !cells && !shown(-1.2), "%s: the first voxel's border is elsewhere", cells ? "cells" : "points");
    CHECK(even.Errors->Count + stretched.Errors->Count == 0, "first hits: '%s'", stretched.Errors->Text.c_str());
  }
}
} // namespace

int main()
{
  EqualSpacing();
  StretchedGrids();
  Cropped();
  GhostsAndBlanking();
  Modes();
  LitAndMasked();
  Picking();
  Filters();
  BadGrids();
  Sheet();
  FirstHits();
  return Failures ? 1 : 0;
}
