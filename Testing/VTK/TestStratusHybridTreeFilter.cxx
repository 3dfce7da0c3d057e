// SPDX-License-Identifier: BSD-3-Clause
// The tree that an image carries: it stays valid through VTK's writers and readers, its boxes contain the voxels, and a filter that fails
// keeps its last outputs. Argument: a folder to write files to.
#include "vtkStratusHybridTreeFilter.h"

#include "mapper_testing.h"

#include "vtkDataSetReader.h"
#include "vtkDataSetWriter.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLImageDataWriter.h"

#include <cstring>
#include <limits>

namespace {
using Filter = vtkStratusHybridTreeFilter;
std::string OutputFolder;

vtkUnsignedCharArray* Tree(vtkDataObject* image)
{
  return vtkUnsignedCharArray::SafeDownCast(image->GetFieldData()->GetAbstractArray("StratusHybridTree"));
}

bool Same(vtkUnsignedCharArray* a, vtkUnsignedCharArray* b)
{
  return a && b && a->GetNumberOfValues() == b->GetNumberOfValues() && a->GetNumberOfValues() > 0 &&
    std::memcmp(a->GetPointer(0), b->GetPointer(0), static_cast<size_t>(a->GetNumberOfValues())) == 0;
}

// The core itself reads the bytes and says that they are of this image.
bool IsValid(vtkUnsignedCharArray* tree, vtkImageData* image, double lower, double upper, bool cells)
{
  stratus_context* context = nullptr;
  stratus_tree* loaded = nullptr;
  int covers = 0;
  vtkNew<vtkMatrix4x4> identity;
  const stratus_volume volume = ReferenceVolume(image, vtkFloatArray::SafeDownCast(image->GetPointData()->GetScalars()), false, identity);
  stratus_criterion criterion = stratus_criterion_default();
  criterion.lower = lower;
  criterion.upper = upper;
  if (stratus_context_create(nullptr, &context, nullptr, 0) == STRATUS_OK &&
    stratus_tree_load(context, tree->GetPointer(0), static_cast<size_t>(tree->GetNumberOfValues()), &loaded) == STRATUS_OK &&
    stratus_tree_covers(context, loaded, &volume, &criterion, cells, &covers) != STRATUS_OK) {
    covers = 0;
  }
  stratus_tree_destroy(loaded);
  stratus_context_destroy(context);
  return covers == 1;
}

void FilesKeepTheTree()
{
  Scene scene;
  vtkNew<Filter> filter;
  filter->SetInputData(scene.Image);
  filter->ThresholdBetween(0.2, 2.0);
  filter->Update();
  vtkImageData* output = filter->GetOutput();
  CHECK(Tree(output) && IsValid(Tree(output), scene.Image, 0.2, 2.0, true), "the tree is not of its image");
  CHECK(!IsValid(Tree(output), scene.Image, 0.1, 2.0, true) && !IsValid(Tree(output), scene.Image, 0.2, 2.0, false),
    "the tree says that it is of more than it is");
  CHECK(scene.Image->GetFieldData()->GetNumberOfArrays() == 0, "the input got the tree, too");
  CHECK(output->GetPointData()->GetScalars() == scene.Image->GetPointData()->GetScalars(), "values were copied");
  for (int mode = 0; mode < 5; ++mode) {
    const std::string path = OutputFolder + "/tree-" + std::to_string(mode) + (mode < 3 ? ".vti" : ".vtk");
    vtkSmartPointer<vtkDataObject> read;
    if (mode < 3) {
      vtkNew<vtkXMLImageDataWriter> writer;
      const int modes[] = { vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended };
      writer->SetDataMode(modes[mode]);
      writer->SetFileName(path.c_str());
      writer->SetInputConnection(filter->GetOutputPort());
      CHECK(writer->Write() == 1, "%s was not written", path.c_str());
      vtkNew<vtkXMLImageDataReader> reader;
      reader->SetFileName(path.c_str());
      reader->Update();
      read = reader->GetOutputDataObject(0);
    } else {
      vtkNew<vtkDataSetWriter> writer;
      writer->SetFileType(mode == 3 ? VTK_ASCII : VTK_BINARY);
      writer->SetFileName(path.c_str());
      writer->SetInputConnection(filter->GetOutputPort());
      CHECK(writer->Write() == 1, "%s was not written", path.c_str());
      vtkNew<vtkDataSetReader> reader;
      reader->SetFileName(path.c_str());
      reader->ReadAllFieldsOn();
      reader->Update();
      read = reader->GetOutputDataObject(0);
    }
    vtkImageData* image = vtkImageData::SafeDownCast(read);
    CHECK(image && Same(Tree(image), Tree(output)), "%s: the tree is another", path.c_str());
    vtkStringArray* hash = image ? vtkStringArray::SafeDownCast(image->GetFieldData()->GetAbstractArray("StratusHybridTreeHash")) : nullptr;
    vtkDataArray* version = image ? image->GetFieldData()->GetArray("StratusHybridTreeVersion") : nullptr;
    CHECK(hash && hash->GetValue(0).size() == 16 && hash->GetValue(0) != "0000000000000000", "%s: no hash", path.c_str());
    CHECK(version && version->GetNumberOfTuples() * version->GetNumberOfComponents() == 2, "%s: no version", path.c_str());
    if (image && mode != 0 && mode != 3) { // as text floats come back rounded
      CHECK(IsValid(Tree(image), image, 0.2, 2.0, true), "%s: the tree is not of the image read", path.c_str());
    }
    std::remove(path.c_str());
  }
}

// Leaves hold every voxel in the range, none lies outside the root, and boxes are where the image is.
void BoxesLieOnTheVoxels()
{
  for (int purpose : { Filter::RAY_CASTING, Filter::FIRST_HITS }) {
    vtkNew<vtkImageData> image;
    image->SetExtent(4, 30, -2, 20, 1, 25);
    image->SetOrigin(5, 6, 7);
    image->SetSpacing(0.5, 1, 2);
    const double turn[9] = { 0, -1, 0, 1, 0, 0, 0, 0, 1 };
    image->SetDirectionMatrix(turn);
    FillField(image, false, "random");
    vtkNew<Filter> filter;
    filter->SetInputData(image);
    filter->ThresholdBetween(0.2, 2.0);
    filter->SetPurpose(purpose);
    filter->Update();
    vtkPolyData* boxes = filter->GetBoxes();
    CHECK(boxes->GetNumberOfCells() == filter->GetNumberOfNodes() && boxes->GetNumberOfCells() >= 1, "%lld boxes for %lld nodes",
      static_cast<long long>(boxes->GetNumberOfCells()), static_cast<long long>(filter->GetNumberOfNodes()));
    vtkDataArray* depth = boxes->GetCellData()->GetArray("Depth");
    vtkDataArray* kind = boxes->GetCellData()->GetArray("Kind");
    vtkDataArray* count = boxes->GetCellData()->GetArray("Count");
    CHECK(depth && kind && count, "cell data are missing");
    if (!depth || !kind || !count) {
      return;
    }
    CHECK(
      count->GetTuple1(0) == static_cast<double>(filter->GetNumberOfVoxels()) && depth->GetTuple1(0) == 0.0, "the root is not the whole");
    vtkFloatArray* values = vtkFloatArray::SafeDownCast(image->GetPointData()->GetScalars());
    vtkIdType inside = 0, all = 0;
    double leaves = 0.0;
    for (vtkIdType b = 0; b < boxes->GetNumberOfCells(); ++b) {
      leaves += kind->GetTuple1(b) == 0.0 ? 0.0 : count->GetTuple1(b);
      CHECK(depth->GetTuple1(b) <= filter->GetDepth(), "a node is deeper than the tree");
    }
    CHECK(leaves == count->GetTuple1(0), "leaves hold %g voxels of %g", leaves, count->GetTuple1(0));
    for (vtkIdType p = 0; p < image->GetNumberOfPoints(); ++p) {
      if (values->GetValue(p) >= 0.2f) {
        ++all;
        double point[3];
        bool found = false;
        image->GetPoint(p, point);
        for (vtkIdType b = 0; b < boxes->GetNumberOfCells() && !found; ++b) {
          double box[6];
          boxes->GetCellBounds(b, box);
          found = kind->GetTuple1(b) != 0.0;
          for (int a = 0; a < 3; ++a) {
            found = found && point[a] >= box[2 * a] - 1e-9 && point[a] <= box[2 * a + 1] + 1e-9;
          }
        }
        inside += found;
      }
    }
    CHECK(all > 100 && inside == all, "%lld of %lld voxels are inside a leaf", static_cast<long long>(inside), static_cast<long long>(all));
    CHECK(purpose == Filter::RAY_CASTING || filter->GetNumberOfVoxels() == all, "%lld voxels of %lld count",
      static_cast<long long>(filter->GetNumberOfVoxels()), static_cast<long long>(all));
    double root[6], bounds[6];
    boxes->GetCellBounds(0, root);
    image->GetBounds(bounds);
    for (int a = 0; a < 3; ++a) { // half a voxel at most beyond the image
      CHECK(root[2 * a] >= bounds[2 * a] - 1.0 - 1e-9 && root[2 * a + 1] <= bounds[2 * a + 1] + 1.0 + 1e-9, "the root is at %g..%g",
        root[2 * a], root[2 * a + 1]);
    }
  }
}

void EveryMethodBuilds()
{
  Scene scene;
  vtkNew<Filter> filter;
  filter->SetInputData(scene.Image);
  filter->SetVolumeProperty(scene.Volume->GetProperty());
  filter->SetPurposeToFirstHits();
  vtkIdType voxels = -1;
  for (int method = Filter::HYBRID; method <= Filter::AUTO; ++method) {
    filter->SetMethod(method);
    filter->Update();
    CHECK(filter->GetNumberOfVoxels() > 100 && (voxels < 0 || voxels == filter->GetNumberOfVoxels()), "%s: %lld voxels",
      filter->GetMethodAsString(), static_cast<long long>(filter->GetNumberOfVoxels()));
    CHECK(std::strlen(filter->GetReason()) > 0 && filter->GetBytes() > 0 && filter->GetNumberOfLeaves() >= 1, "%s reports nothing",
      filter->GetMethodAsString());
    voxels = filter->GetNumberOfVoxels();
  }
  scene.Opacity->AddPoint(0.4, 0.0); // an edit of the property is one of the filter
  filter->Update();
  CHECK(
    filter->GetNumberOfVoxels() < voxels, "an edit of the opacity leaves %lld voxels", static_cast<long long>(filter->GetNumberOfVoxels()));
}

// Ray casting by the tree that comes with the image: no second build as long as it shows all that the opacity does.
void RayCastingUsesTheTree()
{
  Scene plain, scene;
  vtkNew<Filter> filter;
  filter->SetInputData(scene.Image);
  filter->SetVolumeProperty(scene.Volume->GetProperty());
  filter->Update();
  vtkNew<vtkImageData> carried;
  carried->DeepCopy(filter->GetOutput());
  scene.Mapper->SetInputData(carried);
  plain.Mapper->SetStructureToNone();
  scene.Mapper->SetStructureToHybrid();
  CHECK(scene.Picture() == plain.Picture(), "the tree changes the picture");
  CHECK(scene.Mapper->GetCarriedTreeUsed() && scene.Mapper->GetStructureBuilds() == 0, "%llu structures built in addition to the tree",
    static_cast<unsigned long long>(scene.Mapper->GetStructureBuilds()));
  scene.Mapper->SetStructureToAuto(); // takes the tree only where it is faster
  CHECK(scene.Picture() == plain.Picture(), "an automatic structure next to a tree changes the picture");
  scene.Mapper->SetStructureToHybrid();
  for (bool wider : { false, true }) { // less shows: the tree still serves; more: it does not
    for (Scene* each : { &plain, &scene }) {
      each->Opacity->RemoveAllPoints();
      each->Opacity->AddPoint(wider ? 0.02 : 0.3, 0.0);
      each->Opacity->AddPoint(1.0, 0.5);
    }
    const vtkTypeUInt64 before = scene.Mapper->GetStructureBuilds();
    CHECK(scene.Picture() == plain.Picture(), "the tree changes the picture of another opacity");
    CHECK(scene.Mapper->GetCarriedTreeUsed() == !wider && scene.Mapper->GetStructureBuilds() - before == (wider ? 1u : 0u),
      "%s opacity: %llu structures built", wider ? "a wider" : "a narrower",
      static_cast<unsigned long long>(scene.Mapper->GetStructureBuilds() - before));
  }
  CHECK(scene.Light() > 100.0 && scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

void Refused(const char* word, const std::function<void(Filter*)>& breaks)
{
  Scene scene;
  vtkNew<Filter> filter;
  vtkNew<ErrorObserver> errors, pipeline;
  filter->AddObserver(vtkCommand::ErrorEvent, errors);
  filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, pipeline);
  filter->SetInputData(scene.Image);
  filter->ThresholdBetween(0.3, 0.5);
  filter->Update();
  vtkNew<vtkImageData> before;
  before->DeepCopy(filter->GetOutput());
  const vtkIdType boxes = filter->GetBoxes()->GetNumberOfCells();
  breaks(filter);
  filter->Update();
  CHECK(errors->Count == 1 && errors->Has(word), "'%s' says nothing of '%s'", errors->Text.c_str(), word);
  CHECK(Same(Tree(filter->GetOutput()), Tree(before)), "%s: the last tree is gone", word);
  CHECK(boxes > 0 && filter->GetBoxes()->GetNumberOfCells() == boxes, "%s: the last boxes are gone", word);
}

void Refusals()
{
  Refused("Threshold", [](Filter* f) { f->ThresholdBetween(2, 1); });
  Refused("Threshold", [](Filter* f) { f->SetLowerThreshold(std::numeric_limits<double>::quiet_NaN()); });
  Refused("field", [](Filter* f) { f->SetFieldBricks(0); });
  Refused("emptiness", [](Filter* f) { f->SetFieldEmptiness(0.5); });
  Refused("bandwidth", [](Filter* f) { f->SetBandwidth(-1); });
  Refused("uniformity", [](Filter* f) { f->SetUniform(-1); });
  Refused("threshold", [](Filter* f) { f->SetPaperThreshold(std::numeric_limits<double>::quiet_NaN()); });
  Refused("'density'", [](Filter* f) { f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "nowhere"); });
  vtkNew<vtkImageData> vectors;
  vectors->SetDimensions(5, 5, 5);
  vectors->AllocateScalars(VTK_FLOAT, 3);
  Refused("3 components", [&](Filter* f) { f->SetInputData(vectors); });
  vtkNew<vtkImageData> none;
  Refused("empty", [&](Filter* f) { f->SetInputData(none); });
}
} // namespace

int main(int argc, char** argv)
{
  OutputFolder = argc > 1 ? argv[1] : ".";
  FilesKeepTheTree();
  BoxesLieOnTheVoxels();
  EveryMethodBuilds();
  RayCastingUsesTheTree();
  Refusals();
  return Failures == 0 ? 0 : 1;
}
