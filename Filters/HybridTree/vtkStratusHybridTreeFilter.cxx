// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusHybridTreeFilter.h"

#include "vtkStratusContext.h"
#include "vtkStratusInput.h"
#include "vtkStratusTreeArrays.h"
#include "vtkStratusTreeBoxes.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkRectilinearGrid.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cstdio>
#include <limits>

vtkStandardNewMacro(vtkStratusHybridTreeFilter);

class vtkStratusHybridTreeFilter::Internals
{
public:
  explicit Internals(vtkStratusHybridTreeFilter* filter)
      : Filter(filter), Context([filter](double fraction) {
          filter->UpdateProgress(fraction);
          return filter->GetAbortExecute() != 0;
        })
  {
  }
  ~Internals() { this->Clear(); }

  bool Build(vtkDataSet* input, std::string& error);
  void Fill(vtkDataSet* input, vtkDataSet* output, vtkPolyData* boxes);
  void Clear();

  vtkStratusHybridTreeFilter* Filter;
  vtkStratusContext Context;
  vtkSmartPointer<vtkVolumeProperty> Property;
  vtkSmartPointer<vtkDataSet> LastImage; // the last good outputs; nullptr before the first
  vtkNew<vtkPolyData> LastBoxes;
  vtkNew<vtkTable> Report; // of the last good outputs
  stratus_tree* Tree = nullptr;
  std::string Reason;

private:
  bool SetCriterion(stratus_criterion& criterion, std::string& error);
  stratus_tree_options GetOptions() const;

  vtkStratusImageView Image;
  vtkStratusTransferView Transfer;
  stratus_voxels* Voxels = nullptr;
};

void vtkStratusHybridTreeFilter::Internals::Clear()
{
  stratus_tree_destroy(this->Tree);
  stratus_voxels_destroy(this->Voxels);
  this->Tree = nullptr;
  this->Voxels = nullptr;
  this->Image.Release();
}

bool vtkStratusHybridTreeFilter::Internals::SetCriterion(stratus_criterion& criterion, std::string& error)
{
  criterion = stratus_criterion_default();
  if (this->Property) {
    if (!this->Transfer.Set(this->Property, error)) {
      return false;
    }
    criterion.transfer = &this->Transfer.GetTransfer();
    return true;
  }
  criterion.lower = this->Filter->LowerThreshold;
  criterion.upper = this->Filter->UpperThreshold;
  if (!(criterion.lower <= criterion.upper)) {
    error = "LowerThreshold is " + std::to_string(criterion.lower) + " and UpperThreshold " + std::to_string(criterion.upper) +
      ", lower must be <= upper";
  }
  return error.empty();
}

stratus_tree_options vtkStratusHybridTreeFilter::Internals::GetOptions() const
{
  const vtkStratusHybridTreeFilter* filter = this->Filter;
  stratus_tree_options options = stratus_tree_options_default();
  options.method = static_cast<stratus_tree_method>(filter->Method);
  options.max_depth = filter->MaximumDepth;
  options.leaf_bricks = filter->LeafBricks;
  options.leaf_voxels = filter->LeafVoxels;
  options.field_bricks = filter->FieldBricks;
  options.field_emptiness = filter->FieldEmptiness;
  options.uniform = filter->Uniform;
  options.paper_threshold = filter->PaperThreshold;
  options.bandwidth = filter->Bandwidth;
  options.exact_density = filter->ExactDensity ? 1 : 0;
  options.density_per_node = filter->DensityPerNode ? 1 : 0;
  options.agglomerative_by_edges = filter->AgglomerativeByEdges ? 1 : 0;
  options.uncorrected_flooding = filter->UncorrectedFlooding ? 1 : 0;
  return options;
}

bool vtkStratusHybridTreeFilter::Internals::Build(vtkDataSet* input, std::string& error)
{
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  vtkDataArray* array = input ? this->Filter->GetInputArrayToProcess(0, input, association) : nullptr;
  stratus_criterion criterion;
  if (!this->Image.SetInput(input, array, association, error) || !this->SetCriterion(criterion, error) ||
    !this->Context.Prepare(this->Filter->NumberOfThreads, error)) {
    return false;
  }
  stratus_context* context = this->Context.Get();
  const auto create = this->Filter->Purpose == FIRST_HITS ? stratus_voxels_create : stratus_voxels_create_cells;
  const stratus_tree_options options = this->GetOptions();
  stratus_context_start_build_report(context);
  if (create(context, &this->Image.GetVolume(), &criterion, &this->Voxels) != STRATUS_OK ||
    stratus_tree_create(context, this->Voxels, &options, &this->Tree) != STRATUS_OK) {
    error = stratus_context_message(context);
    return false;
  }
  this->Context.GetBuildReport(this->Report);
  return true;
}

void vtkStratusHybridTreeFilter::Internals::Fill(vtkDataSet* input, vtkDataSet* output, vtkPolyData* boxes)
{
  vtkNew<vtkUnsignedCharArray> bytes;
  bytes->SetName(vtkStratusTreeArray);
  bytes->SetNumberOfValues(static_cast<vtkIdType>(stratus_tree_bytes(this->Tree)));
  stratus_tree_save(this->Tree, bytes->GetPointer(0));
  vtkNew<vtkIntArray> version;
  version->SetName(vtkStratusTreeVersionArray);
  version->InsertNextValue(STRATUS_VERSION_MAJOR);
  version->InsertNextValue(STRATUS_VERSION_MINOR);
  char hex[17];
  std::snprintf(hex, sizeof hex, "%016llx", static_cast<unsigned long long>(stratus_tree_hash(this->Tree)));
  vtkNew<vtkStringArray> hash;
  hash->SetName(vtkStratusTreeHashArray);
  hash->InsertNextValue(hex);
  output->ShallowCopy(input);
  for (vtkAbstractArray* array :
    { static_cast<vtkAbstractArray*>(bytes), static_cast<vtkAbstractArray*>(version), static_cast<vtkAbstractArray*>(hash) }) {
    output->GetFieldData()->AddArray(array);
  }
  vtkStratusTreeBoxes(this->Tree, this->Image.GetVolume(), this->Filter->Purpose == RAY_CASTING, boxes);
}

vtkStratusHybridTreeFilter::vtkStratusHybridTreeFilter()
    : LowerThreshold(-std::numeric_limits<double>::infinity()), UpperThreshold(std::numeric_limits<double>::infinity()),
      Internal(new Internals(this))
{
  this->SetNumberOfOutputPorts(2);
}

vtkStratusHybridTreeFilter::~vtkStratusHybridTreeFilter() = default;

void vtkStratusHybridTreeFilter::ThresholdBetween(double lower, double upper)
{
  this->SetLowerThreshold(lower);
  this->SetUpperThreshold(upper);
}

void vtkStratusHybridTreeFilter::SetVolumeProperty(vtkVolumeProperty* property)
{
  if (this->Internal->Property != property) {
    this->Internal->Property = property;
    this->Modified();
  }
}

vtkVolumeProperty* vtkStratusHybridTreeFilter::GetVolumeProperty()
{
  return this->Internal->Property;
}

vtkMTimeType vtkStratusHybridTreeFilter::GetMTime()
{
  const vtkMTimeType time = this->Superclass::GetMTime();
  return this->Internal->Property ? std::max(time, this->Internal->Property->GetMTime()) : time;
}

void vtkStratusHybridTreeFilter::SetDevice(const char* device)
{
  std::string error;
  if (this->Internal->Context.SetDevice(device, this->NumberOfThreads, error)) {
    this->Modified();
  } else if (!error.empty()) {
    vtkErrorMacro(<< error);
  }
}

const char* vtkStratusHybridTreeFilter::GetDevice()
{
  return this->Internal->Context.GetDevice().c_str();
}

const char* vtkStratusHybridTreeFilter::GetDeviceName()
{
  std::string error;
  return this->Internal->Context.Prepare(this->NumberOfThreads, error) ? stratus_context_device(this->Internal->Context.Get()) : "";
}

vtkTable* vtkStratusHybridTreeFilter::GetBuildReport()
{
  return this->Internal->Report;
}

const char* vtkStratusHybridTreeFilter::GetMethodAsString()
{
  return stratus_tree_method_name(static_cast<stratus_tree_method>(this->Method));
}

const char* vtkStratusHybridTreeFilter::GetReason()
{
  return this->Internal->Reason.c_str();
}

vtkPolyData* vtkStratusHybridTreeFilter::GetBoxes()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(1));
}

int vtkStratusHybridTreeFilter::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkDataSet" : "vtkPolyData");
  return 1;
}

int vtkStratusHybridTreeFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  const int filled = this->Superclass::FillInputPortInformation(port, info);
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkRectilinearGrid");
  return filled;
}

// The first output is of the input's class: an image, or a rectilinear grid.
vtkTypeBool vtkStratusHybridTreeFilter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT())) {
    vtkStratusMakeOutput(inputs, outputs);
  }
  return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkStratusHybridTreeFilter::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  vtkInformation* input = inputs[0]->GetInformationObject(0);
  int extent[6];
  input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent, 6);
  return 1;
}

int vtkStratusHybridTreeFilter::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkDataSet* input = vtkStratusAsImage(vtkDataObject::GetData(inputs[0]));
  vtkDataSet* output = vtkDataSet::GetData(outputs, 0);
  vtkPolyData* boxes = vtkPolyData::GetData(outputs, 1);
  Internals* internal = this->Internal.get();
  std::string error;
  const bool built = internal->Build(input, error);
  if (built) {
    internal->Fill(input, output, boxes);
    internal->LastImage = vtkSmartPointer<vtkDataSet>::Take(output->NewInstance());
    internal->LastImage->ShallowCopy(output);
    internal->LastBoxes->ShallowCopy(boxes);
    stratus_tree_statistics statistics;
    stratus_tree_get_statistics(internal->Tree, &statistics);
    this->NumberOfVoxels = static_cast<vtkIdType>(statistics.voxels);
    this->NumberOfBricks = static_cast<vtkIdType>(statistics.bricks);
    this->NumberOfNodes = static_cast<vtkIdType>(statistics.nodes);
    this->NumberOfLeaves = static_cast<vtkIdType>(statistics.leaves);
    this->NumberOfFieldLeaves = static_cast<vtkIdType>(statistics.field_leaves);
    this->Depth = statistics.depth;
    this->Bytes = static_cast<vtkIdType>(statistics.bytes);
    this->SurfaceAreaCost = statistics.sah;
    this->BuildTime = statistics.build_ms;
    internal->Reason = statistics.why;
  } else {
    vtkErrorMacro(<< error);
    if (internal->LastImage && output && internal->LastImage->IsA(output->GetClassName())) { // the pipeline has emptied the outputs
      output->ShallowCopy(internal->LastImage);
      boxes->ShallowCopy(internal->LastBoxes);
    }
  }
  internal->Clear();
  return built ? 1 : 0;
}

void vtkStratusHybridTreeFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "LowerThreshold: " << this->LowerThreshold << "\n";
  os << indent << "UpperThreshold: " << this->UpperThreshold << "\n";
  os << indent << "VolumeProperty: " << this->Internal->Property.Get() << "\n";
  os << indent << "Purpose: " << (this->Purpose == FIRST_HITS ? "first hits" : "ray casting") << "\n";
  os << indent << "Method: " << this->GetMethodAsString() << "\n";
  os << indent << "MaximumDepth: " << this->MaximumDepth << "\n";
  os << indent << "LeafBricks: " << this->LeafBricks << "\n";
  os << indent << "LeafVoxels: " << this->LeafVoxels << "\n";
  os << indent << "FieldBricks: " << this->FieldBricks << "\n";
  os << indent << "FieldEmptiness: " << this->FieldEmptiness << "\n";
  os << indent << "Uniform: " << this->Uniform << "\n";
  os << indent << "PaperThreshold: " << this->PaperThreshold << "\n";
  os << indent << "Bandwidth: " << this->Bandwidth << "\n";
  os << indent << "ExactDensity: " << (this->ExactDensity ? "On" : "Off") << "\n";
  os << indent << "DensityPerNode: " << (this->DensityPerNode ? "On" : "Off") << "\n";
  os << indent << "AgglomerativeByEdges: " << (this->AgglomerativeByEdges ? "On" : "Off") << "\n";
  os << indent << "UncorrectedFlooding: " << (this->UncorrectedFlooding ? "On" : "Off") << "\n";
  os << indent << "Device: " << this->GetDevice() << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "Tree: " << this->NumberOfVoxels << " voxels, " << this->NumberOfBricks << " bricks, " << this->NumberOfNodes
     << " nodes, " << this->NumberOfLeaves << " leaves (" << this->NumberOfFieldLeaves << " of distance fields), depth " << this->Depth
     << ", " << this->Bytes << " bytes, cost " << this->SurfaceAreaCost << ", " << this->BuildTime << " ms; " << this->GetReason() << "\n";
}
