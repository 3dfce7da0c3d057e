// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumeRepresentation.h"

#include "vtkStratusLODVolume.h"
#include "vtkStratusMultiBlockVolumeMapper.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkColorTransferFunction.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTree.h"
#include "vtkDataSet.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkOutlineSource.h"
#include "vtkPolyDataMapper.h"
#include "vtkVolumeProperty.h"

#include <algorithm>

vtkStandardNewMacro(vtkStratusVolumeRepresentation);

vtkStratusVolumeRepresentation::vtkStratusVolumeRepresentation()
{
  this->VolumeMapper = vtkSmartPointer<vtkStratusMultiBlockVolumeMapper>::New();
  this->Actor = vtkSmartPointer<vtkStratusLODVolume>::New();
  this->Actor->SetProperty(this->Property);
  this->Actor->SetLODMapper(this->OutlineMapper);
}

vtkStratusVolumeRepresentation::~vtkStratusVolumeRepresentation() = default;

vtkStratusVolumeMapper* vtkStratusVolumeRepresentation::GetSettings()
{
  return vtkStratusMultiBlockVolumeMapper::SafeDownCast(this->VolumeMapper)->GetSettings();
}

// The superclass takes composite data for its own mapper alone.
int vtkStratusVolumeRepresentation::RequestData(vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkDataObjectTree* tree = input[0]->GetNumberOfInformationObjects() == 1 ? vtkDataObjectTree::GetData(input[0], 0) : nullptr;
  if (!tree) {
    return this->Superclass::RequestData(request, input, output);
  }
  vtkMath::UninitializeBounds(this->DataBounds);
  this->Cache.TakeReference(tree->NewInstance());
  this->Cache->ShallowCopy(tree);
  auto* blocks = vtkDataObjectTree::SafeDownCast(this->Cache);
  if (this->UseSeparateOpacityArray) {
    for (vtkDataSet* block : vtkCompositeDataSet::GetDataSets(blocks)) {
      this->AppendOpacityComponent(block);
    }
  }
  this->Actor->SetEnableLOD(0);
  blocks->GetBounds(this->DataBounds);
  if (vtkMath::AreBoundsInitialized(this->DataBounds)) {
    this->OutlineSource->SetBounds(this->DataBounds);
    this->OutlineSource->Update();
  }
  this->DataSize = blocks->GetActualMemorySize();
  return this->vtkVolumeRepresentation::RequestData(request, input, output);
}

void vtkStratusVolumeRepresentation::UpdateMapperParameters()
{
  this->Superclass::UpdateMapperParameters();
  vtkStratusVolumeMapper* mapper = this->GetSettings();
  this->Actor->SetVisibility(this->Actor->GetVisibility() && this->GetVisibility());
  // A colour map shows a vector's magnitude or one of its components; components that the property takes as colour and opacity are left
  // as they are.
  vtkColorTransferFunction* colors = this->Property->GetRGBTransferFunction(0);
  const bool magnitude = colors->GetVectorMode() != vtkScalarsToColors::COMPONENT;
  mapper->SetVectorMode(!this->Property->GetIndependentComponents() ? vtkStratusVolumeMapper::DISABLED
      : magnitude                                                   ? vtkStratusVolumeMapper::MAGNITUDE
                                                                    : vtkStratusVolumeMapper::COMPONENT);
  mapper->SetTransfer2DYAxisArray(
    this->UseTransfer2D && !this->UseGradientForTransfer2D && !this->ColorArray2Name.empty() ? this->ColorArray2Name.c_str() : nullptr);
  const int component = std::max(colors->GetVectorComponent(), 0);
  mapper->SetVectorComponent(component);
  if (!magnitude && component > 0 && component < VTK_MAX_VRCOMP) { // ParaView edits the first component's functions, whichever shows
    this->Property->SetColor(component, colors);
    this->Property->SetScalarOpacity(component, this->Property->GetScalarOpacity(0));
    this->Property->SetScalarOpacityUnitDistance(component, this->Property->GetScalarOpacityUnitDistance(0));
  }
}

void vtkStratusVolumeRepresentation::ApplyBlendMode()
{
  this->VolumeMapper->SetBlendMode(this->Projection != vtkVolumeMapper::COMPOSITE_BLEND ? this->Projection : this->BlendMode);
}

void vtkStratusVolumeRepresentation::SetBlendMode(int mode)
{
  this->BlendMode = mode;
  this->ApplyBlendMode();
}

void vtkStratusVolumeRepresentation::SetProjection(int mode)
{
  this->Projection = mode;
  this->ApplyBlendMode();
}

void vtkStratusVolumeRepresentation::SetRenderMode(int mode)
{
  this->GetSettings()->SetRenderMode(mode);
}

void vtkStratusVolumeRepresentation::SetNormals(int normals)
{
  this->GetSettings()->SetNormals(normals);
}

void vtkStratusVolumeRepresentation::SetStructure(int structure)
{
  this->GetSettings()->SetStructure(structure);
}

void vtkStratusVolumeRepresentation::SetSampling(int sampling)
{
  this->GetSettings()->SetSampling(sampling);
}

void vtkStratusVolumeRepresentation::SetSampleDistance(double distance)
{
  this->GetSettings()->SetSampleDistance(distance);
}

void vtkStratusVolumeRepresentation::SetCellError(double error)
{
  this->GetSettings()->SetCellError(error);
}

void vtkStratusVolumeRepresentation::SetImageErrorTolerance(double tolerance)
{
  this->GetSettings()->SetImageErrorTolerance(tolerance);
}

void vtkStratusVolumeRepresentation::SetTermination(double opacity)
{
  this->GetSettings()->SetTermination(opacity);
}

void vtkStratusVolumeRepresentation::SetDevice(const char* device)
{
  this->GetSettings()->SetDevice(device);
}

void vtkStratusVolumeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "VolumeMapper:\n";
  this->VolumeMapper->PrintSelf(os, indent.GetNextIndent());
}
