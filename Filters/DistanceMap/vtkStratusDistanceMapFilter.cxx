// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusDistanceMapFilter.h"

#include "vtkStratusContext.h"
#include "vtkStratusInput.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkRectilinearGrid.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <limits>

vtkStandardNewMacro(vtkStratusDistanceMapFilter);

class vtkStratusDistanceMapFilter::Internals
{
public:
  explicit Internals(vtkStratusDistanceMapFilter* filter)
      : Filter(filter), Context([filter](double fraction) {
          filter->UpdateProgress(fraction);
          return filter->GetAbortExecute() != 0;
        })
  {
  }
  ~Internals() { this->Clear(); }

  bool Build(vtkDataSet* input, std::string& error);
  void Fill(vtkDataSet* input, vtkDataSet* output);
  void Clear();

  vtkStratusDistanceMapFilter* Filter;
  vtkStratusContext Context;
  vtkSmartPointer<vtkVolumeProperty> Property;
  vtkSmartPointer<vtkDataSet> Last; // the last good output
  vtkNew<vtkTable> Report;          // of the last good output
  stratus_occupancy* Occupancy = nullptr;

private:
  bool CheckShown(std::string& error);
  void PlaceImage(vtkImageData* input, vtkImageData* output, const int64_t blocks[3], int size);
  void PlaceGrid(vtkRectilinearGrid* output, const int64_t blocks[3], int size);
  stratus_status MakeOccupancy(stratus_context* context);

  vtkStratusImageView Image;
  vtkStratusTransferView PropertyView;
  stratus_value_range* Ranges = nullptr;
  stratus_distance_map* Map = nullptr;
};

void vtkStratusDistanceMapFilter::Internals::Clear()
{
  stratus_distance_map_destroy(this->Map);
  stratus_occupancy_destroy(this->Occupancy);
  stratus_value_range_destroy(this->Ranges);
  this->Map = nullptr;
  this->Occupancy = nullptr;
  this->Ranges = nullptr;
  this->Image.Release();
}

bool vtkStratusDistanceMapFilter::Internals::CheckShown(std::string& error)
{
  if (this->Property) {
    return this->PropertyView.Set(this->Property, error);
  }
  const double lower = this->Filter->LowerThreshold, upper = this->Filter->UpperThreshold;
  if (!(lower <= upper)) {
    error = "LowerThreshold is " + std::to_string(lower) + " and UpperThreshold " + std::to_string(upper) + ", lower must be <= upper";
  }
  return lower <= upper;
}

stratus_status vtkStratusDistanceMapFilter::Internals::MakeOccupancy(stratus_context* context)
{
  stratus_occupancy** occupancy = &this->Occupancy;
  const double lower = this->Filter->LowerThreshold, upper = this->Filter->UpperThreshold;
  return this->Property
    ? stratus_occupancy_create(context, this->Ranges, &this->PropertyView.GetTransfer(), STRATUS_SAMPLING_MIDPOINT, occupancy)
    : stratus_occupancy_create_between(context, this->Ranges, lower, upper, occupancy);
}

bool vtkStratusDistanceMapFilter::Internals::Build(vtkDataSet* input, std::string& error)
{
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  vtkDataArray* array = input ? this->Filter->GetInputArrayToProcess(0, input, association) : nullptr;
  if (!this->Image.SetInput(input, array, association, error) || !this->CheckShown(error) ||
    !this->Context.Prepare(this->Filter->NumberOfThreads, error)) {
    return false;
  }
  stratus_context* context = this->Context.Get();
  stratus_context_start_build_report(context);
  const stratus_distance_kind kinds[] = { STRATUS_DISTANCE_BLOCK, STRATUS_DISTANCE_FULL, STRATUS_DISTANCE_PAPER, STRATUS_DISTANCE_OCTANT };
  if (stratus_value_range_create(context, &this->Image.GetVolume(), this->Filter->BlockSize, &this->Ranges) != STRATUS_OK ||
    this->MakeOccupancy(context) != STRATUS_OK ||
    stratus_distance_map_create(context, this->Occupancy, kinds[this->Filter->Kind], &this->Map) != STRATUS_OK) {
    error = stratus_context_message(context);
    return false;
  }
  this->Context.GetBuildReport(this->Report);
  return true;
}

void vtkStratusDistanceMapFilter::Internals::PlaceImage(vtkImageData* input, vtkImageData* output, const int64_t blocks[3], int size)
{
  const stratus_volume& volume = this->Image.GetVolume();
  double origin[3];
  double spacing[3];
  for (int a = 0; a < 3; ++a) {
    spacing[a] = size * volume.spacing[a];
    origin[a] = volume.origin[a];
    for (int b = 0; b < 3; ++b) {
      origin[a] += volume.cell_centered ? 0.5 * volume.direction[3 * a + b] * volume.spacing[b] : 0.0;
    }
  }
  output->SetDimensions(static_cast<int>(blocks[0] + 1), static_cast<int>(blocks[1] + 1), static_cast<int>(blocks[2] + 1));
  output->SetOrigin(origin);
  output->SetSpacing(spacing);
  output->SetDirectionMatrix(input->GetDirectionMatrix());
}

// Blocks begin and end at the positions of values. The last ones end with the grid's last value, or with its only cell.
void vtkStratusDistanceMapFilter::Internals::PlaceGrid(vtkRectilinearGrid* output, const int64_t blocks[3], int size)
{
  const stratus_volume& volume = this->Image.GetVolume();
  vtkNew<vtkDoubleArray> axes[3];
  for (int a = 0; a < 3; ++a) {
    const double last = static_cast<double>(volume.dimensions[a] - 1);
    for (int64_t block = 0; block <= blocks[a]; ++block) {
      const double index = static_cast<double>(block * size);
      axes[a]->InsertNextValue(vtkStratusPosition(volume, a, block < blocks[a] ? index : last > 0.0 ? std::min(index, last) : 0.5));
    }
  }
  output->SetDimensions(static_cast<int>(blocks[0] + 1), static_cast<int>(blocks[1] + 1), static_cast<int>(blocks[2] + 1));
  output->SetXCoordinates(axes[0]);
  output->SetYCoordinates(axes[1]);
  output->SetZCoordinates(axes[2]);
}

void vtkStratusDistanceMapFilter::Internals::Fill(vtkDataSet* input, vtkDataSet* output)
{
  int64_t blocks[3];
  int size;
  stratus_occupancy_blocks(this->Occupancy, blocks, &size);
  output->Initialize();
  vtkImageData* image = vtkImageData::SafeDownCast(output);
  if (image) {
    this->PlaceImage(vtkImageData::SafeDownCast(input), image, blocks, size);
  } else {
    this->PlaceGrid(vtkRectilinearGrid::SafeDownCast(output), blocks, size);
  }
  vtkNew<vtkUnsignedCharArray> distances;
  distances->SetName("Distance");
  distances->SetNumberOfTuples(static_cast<vtkIdType>(blocks[0] * blocks[1] * blocks[2]));
  unsigned char* distance = distances->GetPointer(0);
  for (int64_t k = 0; k < blocks[2]; ++k) {
    for (int64_t j = 0; j < blocks[1]; ++j) {
      for (int64_t i = 0; i < blocks[0]; ++i) {
        *distance++ = static_cast<unsigned char>(stratus_distance_map_get(this->Map, this->Filter->Octant, i, j, k));
      }
    }
  }
  output->GetCellData()->SetScalars(distances);
}

vtkStratusDistanceMapFilter::vtkStratusDistanceMapFilter()
    : LowerThreshold(-std::numeric_limits<double>::infinity()), UpperThreshold(std::numeric_limits<double>::infinity()),
      Internal(new Internals(this))
{
}

vtkStratusDistanceMapFilter::~vtkStratusDistanceMapFilter() = default;

void vtkStratusDistanceMapFilter::ThresholdBetween(double lower, double upper)
{
  this->SetLowerThreshold(lower);
  this->SetUpperThreshold(upper);
}

void vtkStratusDistanceMapFilter::SetVolumeProperty(vtkVolumeProperty* property)
{
  if (this->Internal->Property != property) {
    this->Internal->Property = property;
    this->Modified();
  }
}

vtkVolumeProperty* vtkStratusDistanceMapFilter::GetVolumeProperty()
{
  return this->Internal->Property;
}

vtkMTimeType vtkStratusDistanceMapFilter::GetMTime()
{
  const vtkMTimeType time = this->Superclass::GetMTime();
  return this->Internal->Property ? std::max(time, this->Internal->Property->GetMTime()) : time;
}

void vtkStratusDistanceMapFilter::SetDevice(const char* device)
{
  std::string error;
  if (this->Internal->Context.SetDevice(device, this->NumberOfThreads, error)) {
    this->Modified();
  } else if (!error.empty()) {
    vtkErrorMacro(<< error);
  }
}

const char* vtkStratusDistanceMapFilter::GetDevice()
{
  return this->Internal->Context.GetDevice().c_str();
}

const char* vtkStratusDistanceMapFilter::GetDeviceName()
{
  std::string error;
  return this->Internal->Context.Prepare(this->NumberOfThreads, error) ? stratus_context_device(this->Internal->Context.Get()) : "";
}

vtkTable* vtkStratusDistanceMapFilter::GetBuildReport()
{
  return this->Internal->Report;
}

const char* vtkStratusDistanceMapFilter::GetKindAsString()
{
  const char* const names[] = { "block", "full", "paper", "octant" };
  return names[this->Kind];
}

int vtkStratusDistanceMapFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  const int filled = this->Superclass::FillInputPortInformation(port, info);
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkRectilinearGrid");
  return filled;
}

int vtkStratusDistanceMapFilter::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataSet");
  return 1;
}

// The output is of the input's class: an image, or a rectilinear grid.
vtkTypeBool vtkStratusDistanceMapFilter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT())) {
    vtkStratusMakeOutput(inputs, outputs);
  }
  return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkStratusDistanceMapFilter::RequestInformation(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* input = inputs[0]->GetInformationObject(0);
  vtkInformation* output = outputs->GetInformationObject(0);
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  const vtkInformation* array = this->GetInputArrayInformation(0);
  const bool cells = const_cast<vtkInformation*>(array)->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
  const int size = this->BlockSize > 0 ? this->BlockSize : 4; // RequestData() refuses other sizes
  int blocks[6];
  for (int a = 0; a < 3; ++a) {
    const int length = extent[2 * a + 1] - extent[2 * a] - (cells ? 1 : 0);
    blocks[2 * a] = 0;
    blocks[2 * a + 1] = std::max(1, (length + size - 1) / size);
  }
  output->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), blocks, 6);
  return 1;
}

int vtkStratusDistanceMapFilter::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  vtkInformation* input = inputs[0]->GetInformationObject(0);
  int extent[6];
  input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent, 6);
  return 1;
}

int vtkStratusDistanceMapFilter::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkDataSet* input = vtkStratusAsImage(vtkDataObject::GetData(inputs[0]));
  vtkDataSet* output = vtkDataSet::GetData(outputs);
  std::string error;
  const bool built = this->Internal->Build(input, error);
  if (built) {
    this->Internal->Fill(input, output);
    this->OccupiedBlocks = static_cast<vtkIdType>(stratus_occupancy_count(this->Internal->Occupancy));
    this->Internal->Last = vtkSmartPointer<vtkDataSet>::Take(output->NewInstance());
    this->Internal->Last->ShallowCopy(output);
  } else {
    vtkErrorMacro(<< error);
    if (this->Internal->Last && output && this->Internal->Last->IsA(output->GetClassName())) { // the pipeline has emptied the output
      output->ShallowCopy(this->Internal->Last);
    }
  }
  this->Internal->Clear();
  return built ? 1 : 0;
}

void vtkStratusDistanceMapFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "LowerThreshold: " << this->LowerThreshold << "\n";
  os << indent << "UpperThreshold: " << this->UpperThreshold << "\n";
  os << indent << "VolumeProperty: " << this->Internal->Property.Get() << "\n";
  os << indent << "BlockSize: " << this->BlockSize << "\n";
  os << indent << "Kind: " << this->GetKindAsString() << "\n";
  os << indent << "Octant: " << this->Octant << "\n";
  os << indent << "Device: " << this->GetDevice() << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "OccupiedBlocks: " << this->OccupiedBlocks << "\n";
}
