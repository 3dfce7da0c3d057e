// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetrahedraRepresentation.h"

#include "vtkStratusCompositePass.h"
#include "vtkStratusLODVolume.h"
#include "vtkStratusPanelLight.h"
#include "vtkStratusPanelUpdate.h"
#include "vtkStratusRankCells.h"
#include "vtkStratusRanks.h"
#include "vtkStratusScalarChoice.h"
#include "vtkStratusSolidColor.h"
#include "vtkStratusTetrahedraMapper.h"

#include "vtkAlgorithmOutput.h"
#include "vtkBoundingBox.h"
#include "vtkCompositeDataSet.h"
#include "vtkContourValues.h"
#include "vtkDataSet.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkOutlineSource.h"
#include "vtkPVRenderView.h"
#include "vtkPlaneCollection.h"
#include "vtkPolyDataMapper.h"
#include "vtkRenderer.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVolumeProperty.h"

#include <string>

namespace {

void bounds_of(vtkDataObject* data, double bounds[6])
{
  vtkMath::UninitializeBounds(bounds);
  if (auto* grid = vtkDataSet::SafeDownCast(data)) {
    grid->GetBounds(bounds);
  } else if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data)) {
    blocks->GetBounds(bounds);
  }
}

// Copies composite data block by block, for arrays may be added to them.
vtkSmartPointer<vtkDataObject> Copy(vtkDataObject* data)
{
  const auto copy = vtkSmartPointer<vtkDataObject>::Take(data->NewInstance());
  copy->ShallowCopy(data);
  return copy;
}
} // namespace

vtkStandardNewMacro(vtkStratusTetrahedraRepresentation);

vtkStratusTetrahedraRepresentation::vtkStratusTetrahedraRepresentation()
    : Solid(new stratus::SolidColor), Panel(new stratus::PanelUpdate), Light(vtkSmartPointer<vtkStratusPanelLight>::New())
{
  this->Actor = vtkSmartPointer<vtkStratusLODVolume>::New();
  this->Actor->SetProperty(this->Property);
  this->Actor->SetLODMapper(this->OutlineMapper);
}

vtkStratusTetrahedraRepresentation::~vtkStratusTetrahedraRepresentation()
{
  this->Light->SetUser(nullptr);
}

int vtkStratusTetrahedraRepresentation::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkStructuredGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

int vtkStratusTetrahedraRepresentation::RequestData(vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkDataObject* data = input[0]->GetNumberOfInformationObjects() == 1 ? vtkDataObject::GetData(input[0], 0) : nullptr;
  vtkMath::UninitializeBounds(this->DataBounds);
  this->DataSize = 0;
  // A rank without data, such as a client, shows the outline of the data that the others draw.
  this->Actor->SetEnableLOD(data ? 0 : 1);
  if (data) {
    const vtkSmartPointer<vtkDataObject> before = this->Cache;
    this->FindArray(data);
    this->Cache = Copy(data);
    const std::string words = stratus::keep_if_lost(this->GetInputArrayInformation(0), this->Cache, before, this->Lost);
    if (!words.empty()) {
      vtkErrorMacro(<< words);
    }
    this->Light->TakeWater(this->Cache, this->GetInputArrayInformation(0));
    if (this->UseSeparateOpacityArray) {
      this->AppendOpacityComponent(vtkDataSet::SafeDownCast(this->Cache));
    }
    bounds_of(this->Cache, this->DataBounds);
    if (vtkMath::AreBoundsInitialized(this->DataBounds)) {
      this->OutlineSource->SetBounds(this->DataBounds);
      this->OutlineSource->Update();
    }
    this->DataSize = this->Cache->GetActualMemorySize();
  } else {
    this->Cache = vtkSmartPointer<vtkUnstructuredGrid>::New();
  }
  return this->Superclass::RequestData(request, input, output);
}

int vtkStratusTetrahedraRepresentation::ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out)
{
  if (!this->Superclass::ProcessViewRequest(request, in, out)) {
    return 0;
  }
  if (request == vtkPVView::REQUEST_UPDATE()) {
    if (this->Solid->IsOpen() && stratus::count_ranks() > 1) {
      this->Solid->JoinRange(vtkMultiProcessController::GetGlobalController());
    }
    vtkNew<vtkMatrix4x4> matrix;
    this->Actor->GetMatrix(matrix);
    out->Set(vtkPVRenderView::NEED_ORDERED_COMPOSITING(), 1);
    vtkPVRenderView::SetPiece(in, this, this->Cache, this->DataSize, 0);
    vtkPVRenderView::SetPiece(in, this, this->OutlineSource->GetOutputDataObject(0), 0, 1);
    vtkPVRenderView::SetDeliverToClientAndRenderingProcesses(in, this, false, false, 0);
    // ParaView cuts the cells' space into a box a rank, which it can put in order. Cells that reach into several boxes are whole on each of
    // their ranks (Deal), and the mapper clips them (ClipTo).
    vtkPVRenderView::SetOrderedCompositingConfiguration(in, this, vtkPVRenderView::USE_DATA_FOR_LOAD_BALANCING);
    vtkPVRenderView::SetRequiresDistributedRendering(in, this, true);
    vtkPVRenderView::SetGeometryBounds(in, this, this->DataBounds, matrix);
  } else if (request == vtkPVView::REQUEST_UPDATE_LOD()) {
    vtkPVRenderView::SetRequiresDistributedRenderingLOD(in, this, true);
  } else if (request == vtkPVView::REQUEST_RENDER()) {
    this->UpdateMapper(vtkPVRenderView::GetPieceProducer(in, this, 0)->GetProducer()->GetOutputDataObject(0));
    this->OutlineMapper->SetInputConnection(vtkPVRenderView::GetPieceProducer(in, this, 1));
  }
  return 1;
}

// Finds the array that is drawn. Returns nullptr where there is none.
const char* vtkStratusTetrahedraRepresentation::GetShownArray(bool& on_cells)
{
  vtkInformation* info = this->GetInputArrayInformation(0);
  const char* name = info && info->Has(vtkDataObject::FIELD_NAME()) ? info->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  on_cells = info && info->Has(vtkDataObject::FIELD_ASSOCIATION()) &&
    info->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
  return name && name[0] ? name : nullptr;
}

void vtkStratusTetrahedraRepresentation::UpdateMapper(vtkDataObject* data)
{
  bool on_cells = false;
  const char* name = this->GetShownArray(on_cells);
  this->Solid->Apply(this->Property);
  this->Piece = data;
  if (stratus::count_ranks() == 1) {
    this->Show(data, name ? name : "", on_cells);
  } else {
    this->Show(this->Dealt, this->DealtArray, this->DealtCells);
  }
  const std::string words = this->Light->TakeProblem();
  if (!words.empty()) {
    vtkErrorMacro(<< words);
  }
}

void vtkStratusTetrahedraRepresentation::Show(vtkDataObject* data, const std::string& name, bool on_cells)
{
  bool any = data && !name.empty();
  if (auto* grid = vtkDataSet::SafeDownCast(data)) {
    any = any && grid->GetNumberOfCells() > 0; // a rank may be left without any
  }
  this->Actor->SetVisibility(this->GetVisibility() && any);
  if (!any) {
    return;
  }
  this->Property->SetIndependentComponents(this->MapScalars && !this->MultiComponentsMapping && !this->UseSeparateOpacityArray);
  vtkVolumeProperty* drawn = this->Light->Apply(this->Mapper, this->Mapper->GetBlendMode(), this->Property);
  this->Actor->SetProperty(drawn);
  const std::string shown = drawn != this->Property ? this->Light->GetWater()
    : this->UseSeparateOpacityArray                 ? name + "_and_opacity"
                                                    : stratus::choose_scalars(data, name.c_str(), on_cells, this->Property);
  this->Mapper->SetScalarMode(on_cells ? VTK_SCALAR_MODE_USE_CELL_FIELD_DATA : VTK_SCALAR_MODE_USE_POINT_FIELD_DATA);
  this->Mapper->SelectScalarArray(shown.c_str());
  this->Mapper->SetInputDataObject(data);
  this->Actor->SetMapper(this->Mapper);
}

// Gives this rank the cells in its box, and those that light reads beyond it, where that has changed. Every rank must call it.
void vtkStratusTetrahedraRepresentation::Deal(vtkMultiProcessController* ranks, const std::vector<vtkBoundingBox>& boxes)
{
  bool on_cells = false;
  const char* name = this->GetShownArray(on_cells);
  std::vector<double> state = { static_cast<double>(this->Piece ? this->Piece->GetMTime() : 0), static_cast<double>(on_cells),
    static_cast<double>(this->Property->GetShade()), static_cast<double>(this->UseSeparateOpacityArray) };
  for (const vtkBoundingBox& box : boxes) {
    double bounds[6];
    box.GetBounds(bounds);
    state.insert(state.end(), bounds, bounds + 6);
  }
  const int changed = !this->Dealt || state != this->DealtFor || this->DealtOf != this->Piece || (name ? name : "") != this->DealtName;
  int any_changed = 0;
  ranks->AllReduce(&changed, &any_changed, 1, vtkCommunicator::MAX_OP);
  if (!any_changed) {
    return;
  }
  this->DealtFor = state;
  this->DealtOf = this->Piece;
  this->DealtName = name ? name : "";
  this->DealtArray = stratus::agree_on_array(ranks, this->DealtName, on_cells); // a rank without data has found none
  this->DealtCells = on_cells;
  stratus::Dealing dealing;
  dealing.cells = on_cells;
  dealing.names.push_back(this->UseSeparateOpacityArray ? this->DealtArray + "_and_opacity" : this->DealtArray);
  dealing.layers = this->Property->GetShade() ? (on_cells ? 2 : 1) : 0;
  this->Dealt = stratus::deal_cells(ranks, this->Piece, boxes, dealing, this->Problem);
  this->Show(this->Dealt, this->DealtArray, this->DealtCells);
}

// Lets rank 0 report which ranks left something out. Every rank must call it.
void vtkStratusTetrahedraRepresentation::ReportProblem(vtkMultiProcessController* ranks)
{
  const bool drawn = this->Actor->GetVisibility() && this->Actor->GetMapper() == this->Mapper;
  const std::string failed = drawn ? this->Mapper->GetLastError() : "";
  const std::string mine =
    stratus::choose_words(ranks, failed, this->Problem, this->Refusal, this->Mapper->GetBlendMode(), this->Light->IsLeftOut());
  const std::string words = stratus::join_words(ranks, mine, this->Reported);
  if (!words.empty()) {
    vtkErrorMacro(<< words);
  }
}

// Clips to a rank's box. Faces of the box that are faces of the union of all boxes cut nothing, since cells beyond them are drawn, too.
void vtkStratusTetrahedraRepresentation::ClipTo(const std::vector<vtkBoundingBox>& boxes, int rank)
{
  vtkBoundingBox whole;
  for (const vtkBoundingBox& box : boxes) {
    if (box.IsValid()) {
      whole.AddBox(box);
    }
  }
  vtkNew<vtkMatrix4x4> matrix;
  this->Actor->GetMatrix(matrix);
  double own[6], all[6];
  boxes[static_cast<size_t>(rank)].GetBounds(own);
  whole.GetBounds(all);
  const auto planes = stratus::planes_between(own, all, matrix);
  this->Mapper->SetClippingPlanes(planes->GetNumberOfItems() > 0 ? planes.Get() : nullptr);
}

void vtkStratusTetrahedraRepresentation::SetInputArrayToProcess(int index, int port, int connection, int association, const char* name)
{
  if (index == 0) {
    this->Solid->Choose(association, name);
    if (this->Lost || this->Light->GetCloud()) {
      this->MarkModified(); // the data may have this one, or it must be converted
    }
  }
  this->Superclass::SetInputArrayToProcess(index, port, connection, association, name);
}

void vtkStratusTetrahedraRepresentation::SetColor(vtkColorTransferFunction* function)
{
  this->Solid->SetFunction(function);
}

void vtkStratusTetrahedraRepresentation::SetScalarOpacity(vtkPiecewiseFunction* function)
{
  this->Solid->SetOpacity(function);
}

void vtkStratusTetrahedraRepresentation::SetSolidColor(double red, double green, double blue)
{
  this->Solid->SetColor(red, green, blue);
}

// Chooses an array of the data where ParaView has chosen none.
void vtkStratusTetrahedraRepresentation::FindArray(vtkDataObject* data)
{
  if (this->Solid->IsOpen()) {
    if (!this->Solid->FindArray(data) && data->GetNumberOfElements(vtkDataObject::CELL) > 0) {
      vtkWarningMacro("the data have no array of points or cells, and nothing is drawn");
    }
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::POINT, ""); // the one that was found
  }
}

bool vtkStratusTetrahedraRepresentation::AddToView(vtkView* view)
{
  auto* render_view = vtkPVRenderView::SafeDownCast(view);
  if (!render_view) {
    return false;
  }
  render_view->GetRenderer()->AddActor(this->Actor);
  if (stratus::count_ranks() == 1) { // among several, cells that are dealt out have other numbers than the data
    render_view->RegisterPropForHardwareSelection(this, this->Actor);
  }
  this->Panel->Enter(render_view->GetRenderer(), this);
  vtkStratusCompositePass::Enter(
    render_view->GetRenderer(), this,
    [this](vtkMultiProcessController* ranks, const std::vector<vtkBoundingBox>& boxes) {
      this->Deal(ranks, boxes);
      this->ClipTo(boxes, ranks->GetLocalProcessId());
    },
    [this](vtkMultiProcessController* ranks) { this->ReportProblem(ranks); });
  return this->Superclass::AddToView(view);
}

bool vtkStratusTetrahedraRepresentation::RemoveFromView(vtkView* view)
{
  auto* render_view = vtkPVRenderView::SafeDownCast(view);
  if (!render_view) {
    return false;
  }
  render_view->GetRenderer()->RemoveActor(this->Actor);
  render_view->UnRegisterPropForHardwareSelection(this, this->Actor);
  this->Panel->Leave();
  vtkStratusCompositePass::Leave(render_view->GetRenderer(), this);
  return this->Superclass::RemoveFromView(view);
}

void vtkStratusTetrahedraRepresentation::SetBlendMode(int mode)
{
  // ParaView numbers the modes as vtkVolumeMapper does.
  this->Mapper->SetBlendMode(mode);
}

void vtkStratusTetrahedraRepresentation::SetMethod(int method)
{
  this->Mapper->SetMethod(method);
}

void vtkStratusTetrahedraRepresentation::SetImageErrorTolerance(double tolerance)
{
  this->Mapper->SetImageErrorTolerance(tolerance);
}

void vtkStratusTetrahedraRepresentation::SetTermination(double opacity)
{
  this->Mapper->SetTermination(opacity);
}

void vtkStratusTetrahedraRepresentation::SetLight(vtkStratusPanelLight* light)
{
  if (light && light != this->Light) {
    this->Light->SetUser(nullptr);
    this->Light = light;
    this->Light->SetUser(this);
  }
}

void vtkStratusTetrahedraRepresentation::SetDevice(const char* device)
{
  this->Mapper->SetDevice(device);
  const char* used = this->Mapper->GetDevice(); // a device that is not there is refused, and the last stays
  const bool same = std::string(device ? device : "") == (used ? used : "");
  this->Refusal = same ? "" : std::string("there is no device \"") + device + "\" here, \"" + (used ? used : "") + "\" draws";
}

void vtkStratusTetrahedraRepresentation::SetShade(bool on)
{
  this->Property->SetShade(on);
}

void vtkStratusTetrahedraRepresentation::SetAmbient(double share)
{
  this->Property->SetAmbient(share);
}

void vtkStratusTetrahedraRepresentation::SetDiffuse(double share)
{
  this->Property->SetDiffuse(share);
}

void vtkStratusTetrahedraRepresentation::SetSpecular(double share)
{
  this->Property->SetSpecular(share);
}

void vtkStratusTetrahedraRepresentation::SetSpecularPower(double power)
{
  this->Property->SetSpecularPower(power);
}

void vtkStratusTetrahedraRepresentation::SetNumberOfIsosurfaces(int number)
{
  this->Property->GetIsoSurfaceValues()->SetNumberOfContours(number);
}

void vtkStratusTetrahedraRepresentation::SetIsosurfaceValue(int index, double value)
{
  this->Property->GetIsoSurfaceValues()->SetValue(index, value);
}

double vtkStratusTetrahedraRepresentation::GetTetrahedra()
{
  return static_cast<double>(this->Mapper->GetNumberOfTetrahedra());
}

double vtkStratusTetrahedraRepresentation::GetLeftOut()
{
  return static_cast<double>(this->Mapper->GetNumberOfBlankedTetrahedra());
}

double vtkStratusTetrahedraRepresentation::GetSegments()
{
  return static_cast<double>(this->Mapper->GetNumberOfSegments());
}

double vtkStratusTetrahedraRepresentation::GetCastTime()
{
  return this->Mapper->GetMarchMilliseconds() + this->Mapper->GetSortMilliseconds() + this->Mapper->GetBinMilliseconds() +
    this->Mapper->GetProjectMilliseconds();
}

const char* vtkStratusTetrahedraRepresentation::GetMethodUsed()
{
  return this->Mapper->GetMethodUsedAsString();
}

const char* vtkStratusTetrahedraRepresentation::GetReason()
{
  return this->Mapper->GetMethodReason();
}

const char* vtkStratusTetrahedraRepresentation::GetDeviceUsed()
{
  return this->Mapper->GetDeviceName();
}

void vtkStratusTetrahedraRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Mapper:\n";
  this->Mapper->PrintSelf(os, indent.GetNextIndent());
}
