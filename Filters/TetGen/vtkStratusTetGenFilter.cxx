// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenFilter.h"

#include "vtkStratusTetGenSurface.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

vtkStandardNewMacro(vtkStratusTetGenFilter);

class vtkStratusTetGenFilter::Internals
{
public:
  void Mesh(vtkStratusTetGenFilter* filter, vtkPolyData* surface, vtkUnstructuredGrid* mesh, vtkPolyData* boundary) const;

  std::vector<std::array<double, 3>> Holes;
  std::vector<std::array<double, 5>> Regions;

private:
  static tetgen_exchange::Request GetOptions(vtkStratusTetGenFilter* filter);
};

namespace {
// Throws unless lower < value <= upper. `included` allows lower itself.
void CheckRange(const char* name, double value, double lower, bool included, double upper)
{
  if (!(value > lower || (included && value == lower)) || !(value <= upper)) {
    throw vtkStratusTetGenFailure{ std::string(name) + " is " + std::to_string(value) + ", it must be " +
      (included ? "at least " : "above ") + std::to_string(lower) + " and at most " + std::to_string(upper) };
  }
}
} // namespace

tetgen_exchange::Request vtkStratusTetGenFilter::Internals::GetOptions(vtkStratusTetGenFilter* filter)
{
  CheckRange("RadiusEdgeRatio", filter->RadiusEdgeRatio, 0.0, false, 1e6);
  CheckRange("MinimumDihedralAngle", filter->MinimumDihedralAngle, 0.0, true, 70.0);
  CheckRange("MaximumVolume", filter->MaximumVolume, 0.0, true, std::numeric_limits<double>::max());
  CheckRange("MaximumSteinerPoints", static_cast<double>(filter->MaximumSteinerPoints), -1.0, true, std::numeric_limits<int>::max());
  CheckRange("TimeLimit", filter->TimeLimit, 0.0, false, 1e6);
  tetgen_exchange::Request options = {};
  options.RadiusEdgeRatio = filter->Quality ? filter->RadiusEdgeRatio : 0.0;
  options.MinimumDihedralAngle = filter->Quality ? filter->MinimumDihedralAngle : 0.0;
  options.MaximumVolume = filter->MaximumVolume;
  options.SteinerPoints = filter->MaximumSteinerPoints;
  options.PreserveBoundary = filter->PreserveBoundary;
  options.Seconds = static_cast<std::int32_t>(std::ceil(filter->TimeLimit)) +
    10; // 10 s later than the filter's own limit, in case this process is gone by then
  return options;
}

void vtkStratusTetGenFilter::Internals::Mesh(
  vtkStratusTetGenFilter* filter, vtkPolyData* input, vtkUnstructuredGrid* mesh, vtkPolyData* boundary) const
{
  if (!input || input->GetNumberOfPoints() < 1) {
    throw vtkStratusTetGenFailure{ "the input has no points, at least 4 enclose a volume" };
  }
  const tetgen_exchange::Request options = GetOptions(filter);
  const std::string program = vtkStratusTetGenFindProgram(filter->Program ? filter->Program : "");
  vtkStratusTetGenSurface surface;
  surface.Holes = this->Holes;
  surface.Regions = this->Regions;
  surface.Set(input);
  vtkStratusTetGenSpool request, answer;
  surface.Write(options, request);
  filter->UpdateProgress(0.1);
  vtkStratusTetGenRun(program, filter->TimeLimit, request, answer, [filter](double seconds) {
    filter->UpdateProgress(0.1 + 0.8 * std::min(1.0, seconds / filter->TimeLimit)); // TetGen reports no progress, so the time replaces it
    return filter->GetAbortExecute() != 0;
  });
  vtkStratusTetGenReadAnswer(answer, surface, mesh, boundary);
}

vtkStratusTetGenFilter::vtkStratusTetGenFilter() : Internal(new Internals)
{
  this->SetNumberOfOutputPorts(2);
}

vtkStratusTetGenFilter::~vtkStratusTetGenFilter()
{
  this->SetProgram(nullptr);
}

void vtkStratusTetGenFilter::AddHole(double x, double y, double z)
{
  this->Internal->Holes.push_back({ x, y, z });
  this->Modified();
}

void vtkStratusTetGenFilter::RemoveAllHoles()
{
  this->Internal->Holes.clear();
  this->Modified();
}

int vtkStratusTetGenFilter::GetNumberOfHoles()
{
  return static_cast<int>(this->Internal->Holes.size());
}

void vtkStratusTetGenFilter::AddRegion(double x, double y, double z, double attribute, double maximumVolume)
{
  this->Internal->Regions.push_back({ x, y, z, attribute, maximumVolume });
  this->Modified();
}

void vtkStratusTetGenFilter::RemoveAllRegions()
{
  this->Internal->Regions.clear();
  this->Modified();
}

int vtkStratusTetGenFilter::GetNumberOfRegions()
{
  return static_cast<int>(this->Internal->Regions.size());
}

vtkPolyData* vtkStratusTetGenFilter::GetBoundary()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(1));
}

int vtkStratusTetGenFilter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

int vtkStratusTetGenFilter::FillOutputPortInformation(int port, vtkInformation* info)
{
  if (port == 0) {
    return this->Superclass::FillOutputPortInformation(port, info);
  }
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPolyData");
  return 1;
}

int vtkStratusTetGenFilter::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::GetData(outputs, 0);
  vtkPolyData* boundary = vtkPolyData::GetData(outputs, 1);
  try {
    this->Internal->Mesh(this, vtkPolyData::GetData(inputs[0]), mesh, boundary);
    return 1;
  } catch (const vtkStratusTetGenFailure& failure) {
    vtkErrorMacro(<< failure.Text);
  } catch (const std::bad_alloc&) {
    vtkErrorMacro(<< "out of memory");
  }
  mesh->Initialize();
  boundary->Initialize();
  return 0;
}

void vtkStratusTetGenFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Quality: " << (this->Quality ? "On" : "Off") << "\n";
  os << indent << "RadiusEdgeRatio: " << this->RadiusEdgeRatio << "\n";
  os << indent << "MinimumDihedralAngle: " << this->MinimumDihedralAngle << "\n";
  os << indent << "MaximumVolume: " << this->MaximumVolume << "\n";
  os << indent << "MaximumSteinerPoints: " << this->MaximumSteinerPoints << "\n";
  os << indent << "PreserveBoundary: " << (this->PreserveBoundary ? "On" : "Off") << "\n";
  os << indent << "TimeLimit: " << this->TimeLimit << "\n";
  os << indent << "Program: " << (this->Program ? this->Program : "(next to the library)") << "\n";
  os << indent << "Holes: " << this->GetNumberOfHoles() << ", regions: " << this->GetNumberOfRegions() << "\n";
}
