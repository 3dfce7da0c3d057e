// SPDX-License-Identifier: BSD-3-Clause
// The filter's distances against brute force on random small images, its geometry, and that a failing filter keeps its last output.
#include "vtkStratusDistanceMapFilter.h"

#include "mapper_testing.h"

#include "vtkExecutive.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <limits>
#include <random>

namespace {
using Image = vtkSmartPointer<vtkImageData>;

Image RandomImage(std::mt19937& random, bool cells)
{
  std::uniform_int_distribution<int> side(cells ? 2 : 1, 21);
  std::uniform_real_distribution<float> value(0.0f, 1.0f);
  auto image = Image::New();
  image->SetExtent(2, 1 + side(random), -3, -4 + side(random), 0, side(random) - 1);
  image->SetOrigin(1, 2, 3);
  image->SetSpacing(0.5, 1.0, 2.0);
  vtkNew<vtkFloatArray> array;
  array->SetName("random");
  for (vtkIdType i = 0; i < (cells ? image->GetNumberOfCells() : image->GetNumberOfPoints()); ++i) {
    array->InsertNextValue(value(random) < 0.003f ? 1.0f : 0.0f);
  }
  if (cells) {
    image->GetCellData()->SetScalars(array);
  } else {
    image->GetPointData()->SetScalars(array);
  }
  return image;
}

// Is any value of the block, its far layer included, at least 0.5? Values are 0 or 1.
bool Occupied(const float* values, const int sides[3], const int block[3], int size)
{
  for (int k = block[2] * size; k <= std::min((block[2] + 1) * size, sides[2] - 1); ++k) {
    for (int j = block[1] * size; j <= std::min((block[1] + 1) * size, sides[1] - 1); ++j) {
      for (int i = block[0] * size; i <= std::min((block[0] + 1) * size, sides[0] - 1); ++i) {
        if (values[(k * sides[1] + j) * sides[0] + i] >= 0.5f) {
          return true;
        }
      }
    }
  }
  return false;
}

// Chebyshev distance to the nearest occupied block, `most` where none is nearer; octant >= 0: among those that its rays can reach.
int Nearest(const std::vector<char>& occupied, const int blocks[3], const int from[3], int octant, int most)
{
  int nearest = most;
  for (int k = 0; k < blocks[2]; ++k) {
    for (int j = 0; j < blocks[1]; ++j) {
      for (int i = 0; i < blocks[0]; ++i) {
        const int to[3] = { i, j, k };
        int distance = 0;
        bool reached = occupied[static_cast<size_t>((k * blocks[1] + j) * blocks[0] + i)] != 0;
        for (int a = 0; a < 3; ++a) {
          const int step = to[a] - from[a];
          reached = reached && (octant < 0 || (((octant >> a) & 1) ? step >= 0 : step <= 0));
          distance = std::max(distance, std::abs(step));
        }
        nearest = reached ? std::min(nearest, distance) : nearest;
      }
    }
  }
  return nearest;
}

void CheckMap(vtkStratusDistanceMapFilter* filter, vtkImageData* input, bool cells, int size, int kind, int octant)
{
  filter->SetInputData(input);
  filter->SetInputArrayToProcess(
    0, 0, 0, cells ? vtkDataObject::FIELD_ASSOCIATION_CELLS : vtkDataObject::FIELD_ASSOCIATION_POINTS, "random");
  filter->SetBlockSize(size);
  filter->SetKind(kind);
  filter->SetOctant(octant);
  filter->ThresholdBetween(0.5, 2.0);
  filter->Update();
  vtkImageData* output = filter->GetOutput();
  int sides[3], blocks[3];
  input->GetDimensions(sides);
  output->GetDimensions(blocks);
  for (int a = 0; a < 3; ++a) {
    sides[a] -= cells ? 1 : 0;
    blocks[a] -= 1;
    CHECK(blocks[a] == std::max(1, (sides[a] - 1 + size - 1) / size), "%d blocks of %d on %d values", blocks[a], size, sides[a]);
  }
  vtkDataArray* scalars = cells ? input->GetCellData()->GetScalars() : input->GetPointData()->GetScalars();
  const float* values = vtkFloatArray::SafeDownCast(scalars)->GetPointer(0);
  std::vector<char> occupied;
  for (int k = 0; k < blocks[2]; ++k) {
    for (int j = 0; j < blocks[1]; ++j) {
      for (int i = 0; i < blocks[0]; ++i) {
        const int block[3] = { i, j, k };
        occupied.push_back(Occupied(values, sides, block, size));
      }
    }
  }
  CHECK(filter->GetOccupiedBlocks() == std::count(occupied.begin(), occupied.end(), 1), "%lld blocks occupied",
    static_cast<long long>(filter->GetOccupiedBlocks()));
  vtkDataArray* distance = output->GetCellData()->GetArray("Distance");
  for (vtkIdType b = 0; b < distance->GetNumberOfTuples(); ++b) {
    const int from[3] = { static_cast<int>(b % blocks[0]), static_cast<int>(b / blocks[0] % blocks[1]),
      static_cast<int>(b / blocks[0] / blocks[1]) };
    const bool directed = kind == vtkStratusDistanceMapFilter::OCTANT;
    int expected = Nearest(occupied, blocks, from, directed ? octant : -1, kind == vtkStratusDistanceMapFilter::PAPER ? 255 : 127);
    expected = kind == vtkStratusDistanceMapFilter::BLOCK ? std::min(expected, 1) : expected;
    CHECK(distance->GetTuple1(b) == expected, "block %lld of %d %d %d, size %d, kind %d, octant %d: %g instead of %d",
      static_cast<long long>(b), blocks[0], blocks[1], blocks[2], size, kind, octant, distance->GetTuple1(b), expected);
  }
}

void BruteForce()
{
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    vtkNew<vtkStratusDistanceMapFilter> filter;
    const bool cells = round % 3 == 2;
    const int size = round % 2 ? 2 : 4;
    CheckMap(filter, RandomImage(random, cells), cells, size, round % 4, round % 8);
  }
}

// The first block is at the image's first points, or at the centre of its first cell for cell data, whatever extent and direction are.
void Geometry()
{
  for (bool cells : { false, true }) {
    vtkNew<vtkImageData> image;
    image->SetExtent(4, 20, -2, 14, 1, 17);
    image->SetOrigin(5, 6, 7);
    image->SetSpacing(0.5, 1, 2);
    const double turn[9] = { 0, -1, 0, 1, 0, 0, 0, 0, 1 };
    image->SetDirectionMatrix(turn);
    FillField(image, cells, "random");
    vtkNew<vtkStratusDistanceMapFilter> filter;
    filter->SetInputData(image);
    filter->SetInputArrayToProcess(
      0, 0, 0, cells ? vtkDataObject::FIELD_ASSOCIATION_CELLS : vtkDataObject::FIELD_ASSOCIATION_POINTS, "random");
    filter->Update();
    double expected[3], first[3];
    const double start[3] = { cells ? 4.5 : 4.0, cells ? -1.5 : -2.0, cells ? 1.5 : 1.0 };
    image->TransformContinuousIndexToPhysicalPoint(start, expected);
    const double zero[3] = { 0, 0, 0 };
    filter->GetOutput()->TransformContinuousIndexToPhysicalPoint(zero, first);
    for (int a = 0; a < 3; ++a) {
      CHECK(std::fabs(first[a] - expected[a]) < 1e-12, "axis %d begins at %g instead of %g", a, first[a], expected[a]);
      CHECK(filter->GetOutput()->GetSpacing()[a] == 4 * image->GetSpacing()[a], "spacing %g", filter->GetOutput()->GetSpacing()[a]);
    }
  }
}

// The property's opacity decides which blocks count, and an edit of the property updates the filter.
void Property()
{
  Scene scene;
  vtkNew<vtkStratusDistanceMapFilter> filter;
  filter->SetInputData(scene.Image);
  filter->Update();
  CHECK(filter->GetOutput()->GetCellData()->GetScalars()->GetRange()[1] == 0.0, "by default everything counts");
  filter->SetVolumeProperty(scene.Volume->GetProperty());
  filter->Update();
  const vtkIdType before = filter->GetOccupiedBlocks();
  CHECK(before > 0 && before < filter->GetOutput()->GetNumberOfCells(), "%lld blocks occupied", static_cast<long long>(before));
  scene.Opacity->RemoveAllPoints();
  scene.Opacity->AddPoint(0.6, 0.0);
  scene.Opacity->AddPoint(1.0, 0.5);
  filter->Update();
  CHECK(
    filter->GetOccupiedBlocks() < before, "an edit of the opacity leaves %lld blocks", static_cast<long long>(filter->GetOccupiedBlocks()));
}

// A threshold of one label finds the blocks between whose least and greatest label it lies, whatever the type.
void Labels()
{
  constexpr int Side = 33, Size = 4, Across = Side / Size, Kinds = 11;
  for (const int type : { VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_INT, VTK_LONG_LONG, VTK_FLOAT, VTK_DOUBLE }) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(Side, Side, Side);
    image->AllocateScalars(type, 1);
    vtkDataArray* labels = image->GetPointData()->GetScalars();
    for (vtkIdType i = 0; i < labels->GetNumberOfTuples(); ++i) {
      labels->SetTuple1(i, static_cast<double>((i % Side / 5 + i / Side % Side / 7 * 3 + i / Side / Side / 6 * 4) % Kinds));
    }
    for (int label = -1; label <= Kinds; ++label) {
      vtkIdType expected = 0;
      for (int b = 0; b < Across * Across * Across; ++b) {
        double least = Kinds, greatest = -1;
        for (int v = 0; v < (Size + 1) * (Size + 1) * (Size + 1); ++v) {
          const int x = b % Across * Size + v % (Size + 1), y = b / Across % Across * Size + v / (Size + 1) % (Size + 1);
          const int z = b / Across / Across * Size + v / (Size + 1) / (Size + 1);
          const double value = labels->GetTuple1((static_cast<vtkIdType>(z) * Side + y) * Side + x);
          least = std::min(least, value);
          greatest = std::max(greatest, value);
        }
        expected += least <= label && greatest >= label;
      }
      vtkNew<vtkStratusDistanceMapFilter> filter;
      filter->SetInputData(image);
      filter->ThresholdBetween(label, label);
      filter->Update();
      CHECK(filter->GetOccupiedBlocks() == expected && (expected > 0) == (label >= 0 && label < Kinds),
        "label %d of type %d is in %lld blocks of %lld", label, type, static_cast<long long>(filter->GetOccupiedBlocks()),
        static_cast<long long>(expected));
    }
  }
}

// A threshold of any one label, as a user picks it: every label of bytes, and 500 of each larger type.
void AllLabels()
{
  constexpr int Side = 21, Size = 4, Across = Side / Size;
  std::mt19937 random(7);
  for (const int type : { VTK_UNSIGNED_CHAR, VTK_UNSIGNED_SHORT, VTK_INT, VTK_FLOAT }) {
    const double most = type == VTK_UNSIGNED_CHAR ? 255 : type == VTK_UNSIGNED_SHORT ? 65535 : type == VTK_INT ? 2e9 : 1e6;
    const double least = type == VTK_INT ? -2e9 : 0.0;
    std::uniform_real_distribution<double> any(least, most);
    double of[27];
    for (double& label : of) {
      label = std::floor(any(random));
    }
    vtkNew<vtkImageData> image;
    image->SetDimensions(Side, Side, Side);
    image->AllocateScalars(type, 1);
    vtkDataArray* labels = image->GetPointData()->GetScalars();
    for (vtkIdType i = 0; i < labels->GetNumberOfTuples(); ++i) { // a label for each 9 values across
      labels->SetTuple1(i, of[i % Side / 9 + i / Side % Side / 9 * 3 + i / Side / Side / 9 * 9]);
    }
    double hulls[Across * Across * Across][2];
    for (int b = 0; b < Across * Across * Across; ++b) {
      hulls[b][0] = most;
      hulls[b][1] = least;
      for (int v = 0; v < (Size + 1) * (Size + 1) * (Size + 1); ++v) {
        const int x = b % Across * Size + v % (Size + 1), y = b / Across % Across * Size + v / (Size + 1) % (Size + 1);
        const int z = b / Across / Across * Size + v / (Size + 1) / (Size + 1);
        const double value = labels->GetTuple1((static_cast<vtkIdType>(z) * Side + y) * Side + x);
        hulls[b][0] = std::min(hulls[b][0], value);
        hulls[b][1] = std::max(hulls[b][1], value);
      }
    }
    vtkNew<vtkStratusDistanceMapFilter> filter;
    filter->SetInputData(image);
    for (int n = 0; n < (type == VTK_UNSIGNED_CHAR ? 256 : 500); ++n) {
      const double label = type == VTK_UNSIGNED_CHAR ? n : n % 2 ? of[random() % 27] : std::floor(any(random));
      const vtkIdType expected =
        std::count_if(std::begin(hulls), std::end(hulls), [&](const double* h) { return h[0] <= label && h[1] >= label; });
      filter->ThresholdBetween(label, label);
      filter->Update();
      CHECK(filter->GetOccupiedBlocks() == expected, "label %.9g of type %d is in %lld blocks of %lld", label, type,
        static_cast<long long>(filter->GetOccupiedBlocks()), static_cast<long long>(expected));
    }
  }
}

void Refused(const char* word, const std::function<void(vtkStratusDistanceMapFilter*)>& breaks)
{
  Scene scene;
  vtkNew<vtkStratusDistanceMapFilter> filter;
  vtkNew<ErrorObserver> errors, pipeline;
  filter->AddObserver(vtkCommand::ErrorEvent, errors);
  filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, pipeline);
  filter->SetInputData(scene.Image);
  filter->ThresholdBetween(0.3, 0.5);
  filter->Update();
  vtkNew<vtkImageData> before;
  before->DeepCopy(filter->GetOutput());
  breaks(filter);
  filter->Update();
  CHECK(errors->Count == 1 && errors->Has(word), "'%s' says nothing of '%s'", errors->Text.c_str(), word);
  vtkDataArray* now = filter->GetOutput()->GetCellData()->GetArray("Distance");
  vtkDataArray* then = before->GetCellData()->GetArray("Distance");
  CHECK(now && now->GetNumberOfTuples() == then->GetNumberOfTuples(), "%s: the last output is gone", word);
  for (vtkIdType b = 0; now && b < then->GetNumberOfTuples(); ++b) {
    CHECK(now->GetTuple1(b) == then->GetTuple1(b), "%s: the last output has changed", word);
  }
}

void Refusals()
{
  using Filter = vtkStratusDistanceMapFilter;
  Refused("Threshold", [](Filter* f) { f->ThresholdBetween(2, 1); });
  Refused("Threshold", [](Filter* f) { f->SetLowerThreshold(std::numeric_limits<double>::quiet_NaN()); });
  Refused("block", [](Filter* f) { f->SetBlockSize(5); });
  Refused("block", [](Filter* f) { f->SetBlockSize(-4); });
  Refused("'density'", [](Filter* f) { f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "nowhere"); });
  vtkNew<vtkVolumeProperty> property;
  vtkNew<vtkPiecewiseFunction> empty;
  property->SetScalarOpacity(empty);
  Refused("no points", [&](Filter* f) { f->SetVolumeProperty(property); });
  vtkNew<vtkImageData> vectors;
  vectors->SetDimensions(5, 5, 5);
  vectors->AllocateScalars(VTK_FLOAT, 3);
  Refused("3 components", [&](Filter* f) { f->SetInputData(vectors); });
  vtkNew<vtkImageData> none;
  Refused("empty", [&](Filter* f) { f->SetInputData(none); });
}
} // namespace

int main()
{
  BruteForce();
  Geometry();
  Property();
  Labels();
  AllLabels();
  Refusals();
  return Failures == 0 ? 0 : 1;
}
