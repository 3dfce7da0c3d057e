// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumeRepresentation.h"

#include "vtkStratusCompositePass.h"
#include "vtkStratusGather.h"
#include "vtkStratusLODVolume.h"
#include "vtkStratusMapped.h"
#include "vtkStratusMultiBlockVolumeMapper.h"
#include "vtkStratusPanelLight.h"
#include "vtkStratusPanelUpdate.h"
#include "vtkStratusRankWhole.h"
#include "vtkStratusRanks.h"
#include "vtkStratusSolidColor.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkCellData.h"
#include "vtkColorTransferFunction.h"
#include "vtkCommand.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkOutlineSource.h"
#include "vtkOverlappingAMR.h"
#include "vtkPVRenderView.h"
#include "vtkPlaneCollection.h"
#include "vtkPointData.h"
#include "vtkPolyDataMapper.h"
#include "vtkRectilinearGrid.h"
#include "vtkRenderer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <string>

namespace {
// Rank 0 takes pieces of up to so many bytes to ask which step a picture of the whole needs.
constexpr vtkIdType WHOLE_BYTES = vtkIdType(1) << 28;
// Gradients at places in the first cell beyond a piece take values of the second.
constexpr int GHOST_LEVELS = 2;

double mean_spacing(const double bounds[6], const double extent[6])
{
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    sum += (bounds[2 * axis + 1] - bounds[2 * axis]) / std::max(extent[2 * axis + 1] - extent[2 * axis], 1.0);
  }
  return sum / 3.0;
}
} // namespace

vtkStandardNewMacro(vtkStratusVolumeRepresentation);

vtkStratusVolumeRepresentation::vtkStratusVolumeRepresentation()
    : Solid(new stratus::SolidColor), Panel(new stratus::PanelUpdate), Light(vtkSmartPointer<vtkStratusPanelLight>::New())
{
  this->VolumeMapper = vtkSmartPointer<vtkStratusMultiBlockVolumeMapper>::New();
  this->Actor = vtkSmartPointer<vtkStratusLODVolume>::New();
  this->Actor->SetProperty(this->Property);
  this->Actor->SetLODMapper(this->OutlineMapper);
  vtkMath::UninitializeBounds(this->WholeBounds);
}

vtkStratusVolumeRepresentation::~vtkStratusVolumeRepresentation()
{
  this->Light->SetUser(nullptr);
}

vtkStratusMultiBlockVolumeMapper* vtkStratusVolumeRepresentation::GetMapper()
{
  return vtkStratusMultiBlockVolumeMapper::SafeDownCast(this->VolumeMapper);
}

vtkStratusVolumeMapper* vtkStratusVolumeRepresentation::GetSettings()
{
  return this->GetMapper()->GetSettings();
}

int vtkStratusVolumeRepresentation::FillInputPortInformation(int port, vtkInformation* info)
{
  const int filled = this->Superclass::FillInputPortInformation(port, info);
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUniformGridAMR");
  return filled;
}

int vtkStratusVolumeRepresentation::RequestUpdateExtent(vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output)
{
  const int done = this->Superclass::RequestUpdateExtent(request, input, output);
  if (stratus::count_ranks() > 1 && input[0]->GetNumberOfInformationObjects() == 1) {
    input[0]->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), GHOST_LEVELS);
  }
  return done;
}

// The superclass cuts ghost cells off, and accepts composite data only for its own mapper.
int vtkStratusVolumeRepresentation::RequestData(vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkDataObject* data = input[0]->GetNumberOfInformationObjects() == 1 ? vtkDataObject::GetData(input[0], 0) : nullptr;
  if (!data) {
    return this->Superclass::RequestData(request, input, output);
  }
  const vtkSmartPointer<vtkDataObject> before = this->Cache;
  this->TakeData(data);
  this->FindArray(this->Cache);
  const std::string words = stratus::keep_if_lost(this->GetInputArrayInformation(0), this->Cache, before, this->Lost);
  if (!words.empty()) {
    vtkErrorMacro(<< words);
  }
  this->Light->TakeWater(this->Cache, this->GetInputArrayInformation(0));
  if (this->UseSeparateOpacityArray) {
    if (auto* grid = vtkDataSet::SafeDownCast(this->Cache)) {
      this->AppendOpacityComponent(grid);
    } else {
      for (vtkDataSet* block : vtkCompositeDataSet::GetDataSets(vtkCompositeDataSet::SafeDownCast(this->Cache))) {
        this->AppendOpacityComponent(block);
      }
    }
  }
  this->Actor->SetEnableLOD(0);
  this->EndsAtBorders = false;
  this->VolumeMapper->SetClippingPlanes(static_cast<vtkPlaneCollection*>(nullptr));
  this->VolumeMapper->SetInputDataObject(this->Cache);
  this->VolumeMapper->GetBounds(this->DataBounds);
  if (vtkMath::AreBoundsInitialized(this->DataBounds)) {
    this->OutlineSource->SetBounds(this->DataBounds);
    this->OutlineSource->Update();
  }
  this->DataSize = this->Cache->GetActualMemorySize();
  return this->vtkVolumeRepresentation::RequestData(request, input, output);
}

// Keeps a copy of the data, or, for AMR, of the parts of all ranks' boxes that this rank needs.
void vtkStratusVolumeRepresentation::TakeData(vtkDataObject* data)
{
  auto* refined = vtkOverlappingAMR::SafeDownCast(data);
  vtkStratusMultiBlockVolumeMapper* mapper = this->GetMapper();
  const int ranks = refined ? stratus::count_ranks() : 1;
  if (ranks > 1) {
    vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
    this->Cache = stratus::gather(controller, refined);
    mapper->SetPiece(controller->GetLocalProcessId());
  } else {
    this->Cache.TakeReference(data->NewInstance());
    this->Cache->ShallowCopy(data); // composite data block by block: arrays may be added to them
    mapper->SetPiece(0);
  }
  mapper->SetNumberOfPieces(ranks);
}

int vtkStratusVolumeRepresentation::ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out)
{
  if (!this->Superclass::ProcessViewRequest(request, in, out)) {
    return 0;
  }
  if (request == vtkPVView::REQUEST_UPDATE()) {
    this->ShareBounds();
    this->Refine(in);
  } else if (request == vtkPVRenderView::REQUEST_STREAMING_UPDATE() && this->Unfinished) {
    this->Unfinished = false;
    // ParaView draws again where anything comes. The rays read the values themselves, so that this may be empty.
    vtkPVRenderView::SetNextStreamedPiece(in, this, vtkSmartPointer<vtkDataObject>::Take(this->Cache->NewInstance()));
  }
  return 1;
}

// Where ParaView streams (its option --enable-streaming), its client requests another picture after each one that was not the last.
void vtkStratusVolumeRepresentation::Refine(vtkInformation* view)
{
  const bool streams = vtkPVView::GetEnableStreaming();
  vtkPVRenderView::SetStreamable(view, this, streams);
  if (!streams) {
    this->VolumeMapper->RemoveObservers(vtkCommand::UpdateEvent);
  } else if (!this->VolumeMapper->HasObserver(vtkCommand::UpdateEvent)) {
    this->VolumeMapper->AddObserver(vtkCommand::UpdateEvent, this, &vtkStratusVolumeRepresentation::OnUnfinished);
  }
}

void vtkStratusVolumeRepresentation::OnUnfinished()
{
  this->Unfinished = true;
}

// The client gets parts from all ranks or from none. Every rank must call it.
void vtkStratusVolumeRepresentation::AgreeOnUnfinished(vtkMultiProcessController* ranks)
{
  const int mine = this->Unfinished ? 1 : 0;
  int any = 0;
  ranks->AllReduce(&mine, &any, 1, vtkCommunicator::MAX_OP);
  this->Unfinished = any != 0;
}

// Finds the bounds of all ranks' data, by which a crop is set, and the range of a solid colour's ramp. Every rank must call it.
void vtkStratusVolumeRepresentation::ShareBounds()
{
  const double nobody[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 };
  std::copy_n(this->DataBounds, 6, this->WholeBounds);
  if (stratus::count_ranks() > 1) {
    vtkMultiProcessController* ranks = vtkMultiProcessController::GetGlobalController();
    stratus::join_bounds(ranks, this->DataBounds, this->WholeBounds);
    // Of composite data a rank has several boxes.
    this->Problem = stratus::judge_parts(ranks, vtkDataSet::SafeDownCast(this->Cache) ? this->DataBounds : nobody);
    if (this->Solid->IsOpen()) {
      this->Solid->JoinRange(vtkMultiProcessController::GetGlobalController());
    }
  }
}

// Lets rank 0 report which ranks drew nothing, and which parts are not adjacent. Every rank must call it.
void vtkStratusVolumeRepresentation::ReportProblem(vtkMultiProcessController* ranks)
{
  const std::string failed = this->Actor->GetVisibility() ? this->GetMapper()->GetLastError() : "";
  const bool hits = this->GetSettings()->GetRenderMode() == vtkStratusVolumeMapper::FIRST_HIT_MODE;
  const std::string mine = stratus::choose_words(
    ranks, failed, this->Problem, this->Refusal, hits ? 0 : this->VolumeMapper->GetBlendMode(), this->Light->IsLeftOut());
  const std::string words = stratus::join_words(ranks, mine, this->Reported);
  if (!words.empty()) {
    vtkErrorMacro(<< words);
  }
}

// Sets whether segments end at the borders of ranks. Otherwise each rank draws whole segments, assigned by their middles. A rank knows only
// the translucent surfaces in its own part, and a segment that reaches beyond the part would be drawn in front of all surfaces of the next
// part. They end there, too, where values stay in a file: without flags of cells, value ranges are kept, and no flags are read.
void vtkStratusVolumeRepresentation::EndAtBorders(bool end)
{
  auto* piece = vtkDataSet::SafeDownCast(this->Cache);
  if (end == this->EndsAtBorders && (!end || this->EndedFor == this->Cache->GetMTime())) {
    return;
  }
  this->EndsAtBorders = end;
  this->EndedFor = this->Cache->GetMTime();
  vtkUnsignedCharArray* flags = piece ? piece->GetCellGhostArray() : nullptr;
  if (!end || !flags || !vtkMath::AreBoundsInitialized(this->DataBounds)) {
    this->VolumeMapper->SetInputDataObject(this->Cache);
    this->VolumeMapper->SetClippingPlanes(static_cast<vtkPlaneCollection*>(nullptr));
    return;
  }
  const auto all = vtkSmartPointer<vtkDataSet>::Take(piece->NewInstance());
  all->ShallowCopy(piece);
  if (vtkStratusHasOnlyDuplicates(flags)) {
    all->GetCellData()->RemoveArray(flags->GetName());
    if (vtkStratusHasOnlyDuplicates(piece->GetPointGhostArray())) {
      all->GetPointData()->RemoveArray(flags->GetName());
    }
  } else {
    vtkNew<vtkUnsignedCharArray> hidden; // but who owns cells: planes cut instead
    hidden->SetName(vtkDataSetAttributes::GhostArrayName());
    for (vtkIdType cell = 0; cell < flags->GetNumberOfValues(); ++cell) {
      hidden->InsertNextValue(static_cast<unsigned char>(flags->GetValue(cell) & ~vtkDataSetAttributes::DUPLICATECELL));
    }
    all->GetCellData()->AddArray(hidden);
  }
  this->VolumeMapper->SetInputDataObject(all);
  vtkNew<vtkMatrix4x4> matrix;
  this->Actor->GetMatrix(matrix);
  const auto planes = stratus::planes_between(this->DataBounds, this->WholeBounds, matrix);
  this->VolumeMapper->SetClippingPlanes(planes->GetNumberOfItems() > 0 ? planes.Get() : nullptr);
}

// Returns the time of the last change of the data and settings that the sampling follows from, except those that ranks agree on.
vtkMTimeType vtkStratusVolumeRepresentation::GetSamplingTime()
{
  return std::max({ this->Cache ? this->Cache->GetMTime() : 0, this->Actor->GetProperty()->GetMTime(), this->Actor->GetMTime(),
    this->VolumeMapper->GetMTime() });
}

// Puts the pieces of all ranks together on rank 0, if they are a grid of at most WHOLE_BYTES and any has changed. Every rank must call it.
void vtkStratusVolumeRepresentation::GatherWhole(vtkMultiProcessController* ranks)
{
  std::vector<std::string> names;
  const char* second = this->UseTransfer2D ? this->GetSettings()->GetTransfer2DYAxisArray() : nullptr;
  for (const char* name : { static_cast<const char*>(this->VolumeMapper->GetArrayName()), second }) {
    if (name && name[0]) {
      names.push_back(name);
    }
  }
  const bool cells = this->VolumeMapper->GetScalarMode() == VTK_SCALAR_MODE_USE_CELL_FIELD_DATA;
  const vtkMTimeType time = this->Cache ? this->Cache->GetMTime() : 0;
  int changed = time != this->WholeFor || names != this->WholeNames || cells != this->WholeCells, any_changed = 0;
  ranks->AllReduce(&changed, &any_changed, 1, vtkCommunicator::MAX_OP);
  if (any_changed) {
    this->Whole = stratus::gather_whole(ranks, vtkDataSet::SafeDownCast(this->Cache), names, cells, WHOLE_BYTES, this->Gathered);
    this->WholeFor = time;
    this->WholeNames = names;
    this->WholeCells = cells;
  }
}

// Measures on rank 0 how a picture of the whole is sampled. Every rank must call it. Returns false if rank 0 has no whole, or draws none.
bool vtkStratusVolumeRepresentation::MeasureWhole(vtkRenderer* renderer, vtkMultiProcessController* ranks)
{
  double measured[5] = { 0.0, 0.0, 0.0, 0.0, 0.0 };
  this->GatherWhole(ranks);
  if (this->Gathered && this->Whole) {
    measured[4] = this->GetMapper()->MeasureSampling(renderer, this->Actor, measured, this->Whole);
  }
  if (this->Gathered) {
    ranks->Broadcast(measured, 5, 0);
    std::copy_n(measured, 4, this->Agreed);
  }
  return this->Gathered && measured[4] != 0.0;
}

// Lets a function of two variables go over the ranges of all ranks' data. Gradients are in mean spacings, which on a rectilinear grid are
// other ones in each piece. Every rank must call it.
void vtkStratusVolumeRepresentation::ShareTransfer2D(vtkMultiProcessController* ranks)
{
  double all[4] = { 0.0, -1.0, 0.0, -1.0 };
  if (!this->UseTransfer2D) {
    this->GetMapper()->SetTransfer2DRanges(all);
    return;
  }
  vtkStratusVolumeMapper* settings = this->GetSettings();
  const bool cells = this->VolumeMapper->GetScalarMode() == VTK_SCALAR_MODE_USE_CELL_FIELD_DATA;
  const int mode = settings->GetVectorMode();
  const char* names[2] = { this->VolumeMapper->GetArrayName(), settings->GetTransfer2DYAxisArray() };
  double least[4], mine[4] = { VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX }; // upper ends have their sign changed
  auto* piece = vtkDataSet::SafeDownCast(this->Cache);
  for (int i = 0; i < 2 && piece; ++i) {
    vtkDataArray* array = names[i] ? piece->GetAttributes(cells ? vtkDataObject::CELL : vtkDataObject::POINT)->GetArray(names[i]) : nullptr;
    const bool vector = array && i == 0 && array->GetNumberOfComponents() > 1;
    const int component = !vector ? 0 : mode == vtkStratusVolumeMapper::MAGNITUDE ? -1 : settings->GetVectorComponent();
    if (array && component < array->GetNumberOfComponents()) {
      double range[2];
      array->GetFiniteRange(range, component);
      mine[2 * i] = range[0];
      mine[2 * i + 1] = -range[1];
    }
  }
  ranks->AllReduce(mine, least, 4, vtkCommunicator::MIN_OP);
  for (int i = 0; i < 4 && least[i / 2 * 2] <= -least[i / 2 * 2 + 1]; ++i) {
    all[i] = i % 2 ? -least[i] : least[i];
  }
  double bounds[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 }, extent[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 }, whole_bounds[6], whole[6];
  auto* rectilinear = vtkRectilinearGrid::SafeDownCast(piece);
  if (rectilinear && rectilinear->GetNumberOfPoints() > 0) {
    rectilinear->GetBounds(bounds);
    std::copy_n(rectilinear->GetExtent(), 6, extent);
  }
  const bool any = stratus::join_bounds(ranks, bounds, whole_bounds) && stratus::join_bounds(ranks, extent, whole);
  if (any && !names[1] && vtkMath::AreBoundsInitialized(bounds)) {
    all[2] = 0.0;
    all[3] = 0.25 * (all[1] > all[0] ? all[1] - all[0] : 1.0) * mean_spacing(bounds, extent) / mean_spacing(whole_bounds, whole);
  }
  this->GetMapper()->SetTransfer2DRanges(all);
}

// Chooses the sampling for all ranks: the sampling of the whole volume if rank 0 has it. Otherwise the ranks use the rule that the most
// curved part of the field needs, with the shortest step and the least error. The user's own settings are kept. Every rank must call it.
void vtkStratusVolumeRepresentation::AgreeOnSampling(vtkRenderer* renderer, vtkMultiProcessController* ranks)
{
  if (vtkOverlappingAMR::SafeDownCast(this->Cache)) { // whose grids sample as their levels need
    this->ApplySampling();
    return;
  }
  this->ShareTransfer2D(ranks);
  const bool open_rule = this->Sampling == vtkStratusVolumeMapper::AUTO_SAMPLING;
  auto* piece = vtkDataSet::SafeDownCast(this->Cache);
  const bool in_file = piece && vtkStratusHasOnlyDuplicates(piece->GetCellGhostArray());
  const int mine[2] = { this->GetSamplingTime() > this->AgreedFor, in_file || stratus::has_translucent(renderer) };
  int any[2] = { 0, 0 };
  ranks->AllReduce(mine, any, 2, vtkCommunicator::MAX_OP);
  if (this->Cache) {
    this->EndAtBorders(any[1] != 0);
  }
  if (any[0]) {
    this->ApplySampling();
  }
  if (any[0] && !this->MeasureWhole(renderer, ranks)) {
    vtkStratusVolumeMapper* settings = this->GetSettings();
    const bool draws = this->Actor->GetVisibility() != 0;
    double rule = 0.0, choice[4] = { 0.0, 0.0, 0.0, 0.0 };
    bool measured = draws && this->GetMapper()->MeasureSampling(renderer, this->Actor, choice);
    const double own = measured ? choice[0] : 0.0;
    ranks->AllReduce(&own, &rule, 1, vtkCommunicator::MAX_OP);
    if (measured && open_rule && rule != own) {
      settings->SetSampling(static_cast<int>(rule));
      measured = this->GetMapper()->MeasureSampling(renderer, this->Actor, choice);
    }
    double lengths[3] = { VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX };
    if (measured) {
      std::copy_n(choice + 1, 3, lengths);
    }
    this->Agreed[0] = rule;
    ranks->AllReduce(lengths, this->Agreed + 1, 3, vtkCommunicator::MIN_OP);
  }
  if (this->Agreed[0] > 0.0) {
    vtkStratusVolumeMapper* settings = this->GetSettings();
    settings->SetSampling(static_cast<int>(this->Agreed[0]));
    settings->SetSampleDistance(this->Agreed[1]);
    settings->SetCellError(this->Agreed[2]);
    settings->SetLightSpread(this->Agreed[3]);
  }
  this->AgreedFor = this->GetSamplingTime();
}

void vtkStratusVolumeRepresentation::SetInputArrayToProcess(int index, int port, int connection, int association, const char* name)
{
  if (index == 0) {
    this->Solid->Choose(association, name);
    if (this->Lost || this->Light->GetCloud()) {
      this->MarkModified(); // the data may have this one, or it must be converted
    }
  }
  this->Superclass::SetInputArrayToProcess(index, port, connection, association, name);
}

void vtkStratusVolumeRepresentation::SetColor(vtkColorTransferFunction* function)
{
  this->Solid->SetFunction(function);
}

void vtkStratusVolumeRepresentation::SetScalarOpacity(vtkPiecewiseFunction* function)
{
  this->Solid->SetOpacity(function);
}

void vtkStratusVolumeRepresentation::SetSolidColor(double red, double green, double blue)
{
  this->Solid->SetColor(red, green, blue);
}

// Chooses an array of the data where ParaView has chosen none.
void vtkStratusVolumeRepresentation::FindArray(vtkDataObject* data)
{
  if (this->Solid->IsOpen()) {
    if (!this->Solid->FindArray(data) && data->GetNumberOfElements(vtkDataObject::CELL) > 0) {
      vtkWarningMacro("the data have no array of points or cells, and nothing is drawn");
    }
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::POINT, ""); // the one that was found
  }
}

bool vtkStratusVolumeRepresentation::AddToView(vtkView* view)
{
  if (auto* render_view = vtkPVRenderView::SafeDownCast(view)) {
    vtkRenderer* renderer = render_view->GetRenderer();
    this->Panel->Enter(renderer, this);
    vtkStratusCompositePass::Enter(
      renderer, this,
      [this, renderer](vtkMultiProcessController* ranks, const std::vector<vtkBoundingBox>&) { this->AgreeOnSampling(renderer, ranks); },
      [this](vtkMultiProcessController* ranks) {
        this->AgreeOnUnfinished(ranks);
        this->ReportProblem(ranks);
      });
  }
  return this->Superclass::AddToView(view);
}

bool vtkStratusVolumeRepresentation::RemoveFromView(vtkView* view)
{
  if (auto* render_view = vtkPVRenderView::SafeDownCast(view)) {
    this->Panel->Leave();
    vtkStratusCompositePass::Leave(render_view->GetRenderer(), this);
  }
  return this->Superclass::RemoveFromView(view);
}

void vtkStratusVolumeRepresentation::UpdateMapperParameters()
{
  this->Solid->Apply(this->Property);
  this->Superclass::UpdateMapperParameters();
  vtkStratusVolumeMapper* mapper = this->GetSettings();
  if (this->VolumeMapper->GetCropping()) { // the superclass scales the bounds of each rank's own data
    double planes[6];
    for (int i = 0; i < 6; ++i) {
      planes[i] = this->CroppingOrigin[i / 2] + this->WholeBounds[i] * this->CroppingScale[i / 2];
    }
    this->VolumeMapper->SetCroppingRegionPlanes(planes);
  }
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
  mapper->SetVectorComponent(std::max(colors->GetVectorComponent(), 0));
  const bool hits = mapper->GetRenderMode() == vtkStratusVolumeMapper::FIRST_HIT_MODE;
  vtkVolumeProperty* drawn = this->Light->Apply(mapper, hits ? -1 : this->VolumeMapper->GetBlendMode(), this->Property);
  this->Actor->SetProperty(drawn);
  if (drawn != this->Property) {
    this->VolumeMapper->SelectScalarArray(this->Light->GetWater().c_str());
  }
  const std::string words = this->Light->TakeProblem();
  if (!words.empty()) {
    vtkErrorMacro(<< words);
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

void vtkStratusVolumeRepresentation::ApplySampling()
{
  this->GetSettings()->SetSampling(this->Sampling);
  this->GetSettings()->SetSampleDistance(this->SampleDistance);
  this->GetSettings()->SetCellError(this->CellError);
  this->GetSettings()->SetLightSpread(0.0);
}

void vtkStratusVolumeRepresentation::SetSampling(int sampling)
{
  this->Sampling = sampling;
  this->ApplySampling();
}

void vtkStratusVolumeRepresentation::SetSampleDistance(double distance)
{
  this->SampleDistance = distance;
  this->ApplySampling();
}

void vtkStratusVolumeRepresentation::SetCellError(double error)
{
  this->CellError = error;
  this->ApplySampling();
}

void vtkStratusVolumeRepresentation::SetImageErrorTolerance(double tolerance)
{
  this->GetSettings()->SetImageErrorTolerance(tolerance);
}

void vtkStratusVolumeRepresentation::SetTermination(double opacity)
{
  this->GetSettings()->SetTermination(opacity);
}

void vtkStratusVolumeRepresentation::SetLight(vtkStratusPanelLight* light)
{
  if (light && light != this->Light) {
    this->Light->SetUser(nullptr);
    this->Light = light;
    this->Light->SetUser(this);
  }
}

void vtkStratusVolumeRepresentation::SetDevice(const char* device)
{
  this->GetSettings()->SetDevice(device);
  const char* used = this->GetSettings()->GetDevice(); // a device that is not there is refused, and the last stays
  const bool same = std::string(device ? device : "") == (used ? used : "");
  this->Refusal = same ? "" : std::string("there is no device \"") + device + "\" here, \"" + (used ? used : "") + "\" draws";
}

double vtkStratusVolumeRepresentation::GetHeldCells()
{
  return this->Cache ? static_cast<double>(this->Cache->GetNumberOfElements(vtkDataObject::CELL)) : 0.0;
}

#define SUM_OF_BLOCKS(getter)                                                                                                              \
  double vtkStratusVolumeRepresentation::getter()                                                                                          \
  {                                                                                                                                        \
    double sum = 0.0;                                                                                                                      \
    for (int block = 0; block < this->GetMapper()->GetNumberOfBlocks(); ++block) {                                                         \
      sum += static_cast<double>(this->GetMapper()->GetBlockMapper(block)->getter());                                                      \
    }                                                                                                                                      \
    return sum;                                                                                                                            \
  }
SUM_OF_BLOCKS(GetSamplesTaken)
SUM_OF_BLOCKS(GetSamplesSkipped)
SUM_OF_BLOCKS(GetCastTime)

#define OF_FIRST_BLOCK(type, getter, from, none)                                                                                           \
  type vtkStratusVolumeRepresentation::getter()                                                                                            \
  {                                                                                                                                        \
    vtkStratusVolumeMapper* first = this->GetMapper()->GetBlockMapper(0);                                                                  \
    return first ? first->from() : none;                                                                                                   \
  }
OF_FIRST_BLOCK(const char*, GetSamplingUsed, GetSamplingUsedAsString, "")
OF_FIRST_BLOCK(const char*, GetStructureUsed, GetStructureUsedAsString, "")
OF_FIRST_BLOCK(const char*, GetReason, GetReason, "")
OF_FIRST_BLOCK(const char*, GetDeviceUsed, GetDeviceName, "")

double vtkStratusVolumeRepresentation::GetUsedSampleDistance()
{
  vtkStratusVolumeMapper* first = this->GetMapper()->GetBlockMapper(0);
  return first && std::string(first->GetSamplingUsedAsString()) != "cells" ? first->GetUsedSampleDistance() : 0.0;
}

void vtkStratusVolumeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "VolumeMapper:\n";
  this->VolumeMapper->PrintSelf(os, indent.GetNextIndent());
}
