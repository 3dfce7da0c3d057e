// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusCFReader.h"

#include "vtkStratusCFGrid.h"
#include "vtkStratusMappedFile.h"
#include "vtkStratusParts.h"
#include "vtkStratusSphere.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <set>

vtkStandardNewMacro(vtkStratusCFReader);

namespace {
using Variable = vtkStratusNetCDFModel::Variable;

// The variables that others refer to as coordinates, bounds or terms of a height.
std::set<const Variable*> FindReferred(const vtkStratusNetCDFModel& file)
{
  std::set<const Variable*> referred;
  for (const Variable& one : file.GetVariables()) {
    for (const char* attribute : { "coordinates", "bounds", "formula_terms" }) {
      for (const std::string& word : vtkStratusWords(file.Text(one, attribute))) {
        referred.insert(file.Find(word, &one));
      }
    }
  }
  return referred;
}

// Throws an error that no variable is a volume, and lists the variables.
[[noreturn]] void FailWithoutVolume(const vtkStratusNetCDFModel& file)
{
  constexpr size_t most = 10;
  const std::vector<Variable>& all = file.GetVariables();
  std::string text;
  for (size_t i = 0; i < std::min(most, all.size()); ++i) {
    text += (i > 0 ? "; '" : "'") + all[i].Name + "' has the dimensions " + file.DescribeDimensions(all[i]) +
      (all[i].HasNumbers() ? "" : " and " + file.WhyNoNumbers(all[i]));
  }
  file.Fail("there is no variable on a grid of three dimensions in space that are longer than 1; " + (text.empty() ? "it has none" : text) +
    (all.size() > most ? "; and " + std::to_string(all.size() - most) + " others" : ""));
}

void Hide(vtkDataSetAttributes* data, const std::vector<char>& hidden, unsigned char flag)
{
  if (hidden.empty()) {
    return;
  }
  vtkSmartPointer<vtkUnsignedCharArray> ghosts = vtkSmartPointer<vtkUnsignedCharArray>::New();
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfValues(static_cast<vtkIdType>(hidden.size()));
  std::transform(hidden.begin(), hidden.end(), ghosts->GetPointer(0), [flag](char one) { return one ? flag : 0; });
  data->AddArray(ghosts);
}

stratus_globe_lattice LatticeOf(const vtkStratusCFGrid& grid, const std::vector<double>& degrees)
{
  return vtkStratusSphere::FindLattice(grid.GetLength(0), grid.GetLength(1), degrees);
}

// Places the grid on the sphere. factor: of heights, 0: automatic. Returns the one that is used.
double SetPointsOnSphere(const vtkStratusCFGrid& grid, const std::vector<double>& degrees, const stratus_globe_lattice& lattice,
  size_t step, double factor, vtkStructuredGrid* output)
{
  const size_t levels = grid.GetLength(2);
  std::vector<char> hidden, torn; // torn: none on the Earth
  const vtkSmartPointer<vtkDoubleArray> flat = vtkDoubleArray::SafeDownCast(grid.ReadPoints(step, hidden, torn));
  factor = factor > 0.0 ? factor : vtkStratusSphere::FactorOf(flat, hidden);
  const vtkSmartPointer<vtkDoubleArray> places = vtkStratusSphere::Place(&lattice, levels, degrees, flat, factor);
  hidden = vtkStratusSphere::Spread(lattice, levels, hidden);
  vtkNew<vtkPoints> points;
  points->SetData(places);
  output->SetDimensions(
    static_cast<int>(stratus_globe_columns(&lattice)), static_cast<int>(stratus_globe_rows(&lattice)), static_cast<int>(levels));
  output->SetPoints(points);
  Hide(output->GetPointData(), hidden, vtkDataSetAttributes::HIDDENPOINT);
  return factor;
}

void SetPointsOnPlane(const vtkStratusCFGrid& grid, size_t step, vtkStructuredGrid* output)
{
  vtkNew<vtkPoints> points;
  std::vector<char> hidden_points, hidden_cells;
  points->SetData(grid.ReadPoints(step, hidden_points, hidden_cells));
  output->SetDimensions(static_cast<int>(grid.GetLength(0)), static_cast<int>(grid.GetLength(1)), static_cast<int>(grid.GetLength(2)));
  output->SetPoints(points);
  Hide(output->GetPointData(), hidden_points, vtkDataSetAttributes::HIDDENPOINT);
  Hide(output->GetCellData(), hidden_cells, vtkDataSetAttributes::HIDDENCELL);
}

void SetValues(vtkDataSet* output, vtkDataArray* values)
{
  output->GetPointData()->AddArray(values);
  output->GetPointData()->SetActiveScalars(values->GetName());
}
} // namespace

vtkStratusCFReader::vtkStratusCFReader()
{
  this->GivesParts = true;
}

vtkStratusCFReader::~vtkStratusCFReader() = default;

bool vtkStratusCFReader::TakePlaces(vtkStructuredGrid* output)
{
  if (!this->Places || this->PlacesTime != this->GetMTime() || this->PlacesFile != vtkStratusIdentityOfFile(this->FileName, 0, -1)) {
    this->Places = nullptr;
    return false;
  }
  output->ShallowCopy(this->Places);
  return true;
}

void vtkStratusCFReader::KeepPlaces(vtkStructuredGrid* output)
{
  this->Places = vtkSmartPointer<vtkStructuredGrid>::New();
  this->Places->ShallowCopy(output);
  this->PlacesFile = vtkStratusIdentityOfFile(this->FileName, 0, -1);
  this->PlacesTime = this->GetMTime();
}

std::string vtkStratusCFReader::InspectFile(const vtkStratusNetCDFModel& file)
{
  const std::set<const Variable*> referred = FindReferred(file);
  for (const Variable& one : file.GetVariables()) {
    if (vtkStratusCFGrid::IsVolume(file, one) && referred.count(&one) == 0) {
      this->AddVariable(file, one);
    }
  }
  const Variable* wanted = this->VariableName && *this->VariableName ? file.Find(this->VariableName) : nullptr;
  if (wanted && !vtkStratusCFGrid::IsVolume(file, *wanted)) {
    vtkStratusCFGrid(file, *wanted); // fails with the reason, unless that is the type
    file.FailWithoutNumbers(*wanted);
  }
  if (this->Variables.empty()) {
    FailWithoutVolume(file);
  }
  const Variable& chosen = *file.Find(this->ChosenName());
  const vtkStratusCFGrid grid(file, chosen, this->Coordinates == SPHERE);
  for (int a = 0; a < 3; ++a) {
    this->WholeExtent[2 * a + 1] = static_cast<int>(grid.GetLength(a)) - 1;
  }
  this->Description = grid.Describe() + file.DescribeValues(chosen);
  if (grid.GetTime() >= 0) {
    const vtkStratusNetCDFModel::TimeSteps steps = file.ReadTimes(grid.GetTime());
    this->Times = steps.Values;
    this->TimeUnits = steps.Units;
    this->TimeCalendar = steps.Calendar;
    this->Description += steps.Note;
  }
  if (this->Coordinates == SPHERE) {
    if (!grid.IsInDegrees()) {
      file.Fail("'" + this->ChosenName() +
        "' has no longitudes and latitudes of the Earth, and no grid mapping that gives them, so that it has no place on a sphere");
    }
    const stratus_globe_lattice lattice = LatticeOf(grid, grid.ReadDegrees(0));
    this->WholeExtent[1] = static_cast<int>(stratus_globe_columns(&lattice)) - 1;
    this->WholeExtent[3] = static_cast<int>(stratus_globe_rows(&lattice)) - 1;
    this->Description += "; on a sphere of 6371 km" + vtkStratusSphere::Describe(lattice);
    this->SetAxesOnSphere();
    return "vtkStructuredGrid";
  }
  if (grid.IsSheet()) {
    vtkWarningMacro(
      << file.GetPath() << ": the levels of '" << this->ChosenName()
      << "' have no unit of length or pressure, and no formula that is known: heights are only numbers, while x and y are in metres");
  }
  try {
    this->SetPlaceOnPlane(grid.GetPlaceOnPlane(), "");
  } catch (const vtkStratusReadError& why) { // the grid itself needs no projection
    this->SetPlaceOnPlane(nullptr, why.Text);
  }
  this->LengthUnits = grid.IsInMetres() ? "m" : "";
  for (int a = 0; a < 3; ++a) {
    this->AxisNames[a] = grid.GetAxisName(a);
    this->AxisUnits[a] = grid.GetAxisUnits(a);
    this->FileAxes[a] = grid.GetFileAxis(a);
  }
  return grid.IsCurved() ? "vtkStructuredGrid" : grid.IsUniform() ? "vtkImageData" : "vtkRectilinearGrid";
}

void vtkStratusCFReader::BuildFile(const vtkStratusNetCDFModel& file, size_t step, vtkDataSet* output)
{
  const vtkStratusCFGrid grid(file, *file.Find(this->ChosenName()), this->Coordinates == SPHERE);
  vtkStructuredGrid* const curved = vtkStructuredGrid::SafeDownCast(output);
  const bool placed = curved && this->TakePlaces(curved);
  if (this->Coordinates == SPHERE) {
    const std::vector<double> degrees = grid.ReadDegrees(step);
    const stratus_globe_lattice lattice = LatticeOf(grid, degrees);
    if (!placed) {
      this->UsedHeightFactor = SetPointsOnSphere(grid, degrees, lattice, step, this->HeightFactor, curved);
      if (!grid.Moves()) {
        this->KeepPlaces(curved);
      }
    }
    SetValues(output, vtkStratusSphere::Spread(lattice, grid.GetLength(2), grid.ReadValues(step)));
    return;
  }
  const int n[3] = { static_cast<int>(grid.GetLength(0)), static_cast<int>(grid.GetLength(1)), static_cast<int>(grid.GetLength(2)) };
  if (vtkImageData* image = vtkImageData::SafeDownCast(output)) {
    image->SetDimensions(n[0], n[1], n[2]);
    double spacing[3];
    for (int a = 0; a < 3; ++a) {
      spacing[a] = (grid.GetAxis(a).back() - grid.GetAxis(a).front()) / (n[a] - 1);
    }
    image->SetSpacing(spacing);
    image->SetOrigin(grid.GetAxis(0).front(), grid.GetAxis(1).front(), grid.GetAxis(2).front());
  } else if (vtkRectilinearGrid* axes = vtkRectilinearGrid::SafeDownCast(output)) {
    axes->SetDimensions(n[0], n[1], n[2]);
    for (int a = 0; a < 3; ++a) {
      vtkSmartPointer<vtkDoubleArray> at = vtkSmartPointer<vtkDoubleArray>::New();
      at->SetNumberOfValues(n[a]);
      std::copy(grid.GetAxis(a).begin(), grid.GetAxis(a).end(), at->GetPointer(0));
      (a == 0 ? axes->SetXCoordinates(at) : a == 1 ? axes->SetYCoordinates(at) : axes->SetZCoordinates(at));
    }
  } else if (curved && !placed) {
    SetPointsOnPlane(grid, step, curved);
    if (!grid.Moves()) {
      this->KeepPlaces(curved);
    }
  }
  vtkSmartPointer<vtkDataArray> values;
  const vtkStratusBox box = vtkStratusBoxOf(this->WholeExtent, this->Part, false);
  if (this->MapFile && static_cast<double>(n[0]) * n[1] * n[2] * sizeof(float) >= static_cast<double>(this->MappedBytesLeast)) {
    values = this->BricksOf(step, [&grid, &box](size_t one) { return grid.MakeBricks(one, box); });
  }
  this->Mapped = values ? 1 : 0;
  values = values ? values : grid.ReadValues(step);
  SetValues(output, values);
}

void vtkStratusCFReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
