// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVolumeRepresentation
 * @brief   ParaView's volume rendering of uniform and rectilinear grids by vtkStratusVolumeMapper
 *
 * Composite data are drawn block by block, in exact order, and AMR by levels (vtkStratusMultiBlockVolumeMapper). Of AMR each of several
 * ranks draws a part of the space, and gets the parts of boxes in it and around it; each grid has its own sampling. On several ranks each
 * draws the cells that it owns. It requests a layer of ghost cells, so that light and values at borders equal those in the whole volume.
 * All ranks sample alike: they agree on one choice of the automatic settings. Supports everything of ParaView's own representation "Volume"
 * that the mapper supports. The mapper refuses the rest by an error in ParaView's messages. vtkStratusVolumeMapper documents the setters
 * below.
 *
 * @sa vtkStratusVolumeMapper vtkStratusMultiBlockVolumeMapper
 */
#ifndef vtkStratusVolumeRepresentation_h
#define vtkStratusVolumeRepresentation_h

#include "StratusParaViewRepresentationsModule.h" // For export macro
#include "vtkImageVolumeRepresentation.h"
#include "vtkSmartPointer.h" // For vtkSmartPointer

#include <memory> // For std::unique_ptr
#include <string> // For std::string
#include <vector> // For std::vector

class vtkColorTransferFunction;
class vtkDataObject;
class vtkDataSet;
class vtkMultiProcessController;
class vtkPiecewiseFunction;
class vtkRenderer;
class vtkStratusMultiBlockVolumeMapper;
class vtkStratusPanelLight;
class vtkStratusVolumeMapper;
namespace stratus {
class PanelUpdate;
class SolidColor;
} // namespace stratus

class STRATUSPARAVIEWREPRESENTATIONS_EXPORT vtkStratusVolumeRepresentation : public vtkImageVolumeRepresentation
{
public:
  static vtkStratusVolumeRepresentation* New();
  vtkTypeMacro(vtkStratusVolumeRepresentation, vtkImageVolumeRepresentation);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out) override;

  //@{
  /**
   * Set the array that colours, the functions of its values, and the colour where there is none. Without an array (Solid Color) the values
   * of the one that was chosen last are drawn in that colour, at the opacity that their function gives; if none ever was, the data's active
   * scalars or first array, by a ramp over its range.
   */
  using Superclass::SetInputArrayToProcess;
  void SetInputArrayToProcess(int index, int port, int connection, int association, const char* name) override;
  void SetColor(vtkColorTransferFunction* function);
  void SetScalarOpacity(vtkPiecewiseFunction* function);
  void SetSolidColor(double red, double green, double blue);
  //@}

  //@{
  /**
   * Set what a ray shows: by the blend mode, where the projection is vtkVolumeMapper::COMPOSITE_BLEND, else by the projection, one of
   * vtkVolumeMapper's other modes up to ADDITIVE_BLEND.
   */
  void SetBlendMode(int mode);
  void SetProjection(int mode);
  //@}

  //@{
  /**
   * Forwarded to the mapper.
   */
  void SetRenderMode(int mode);
  void SetNormals(int normals);
  void SetStructure(int structure);
  void SetSampling(int sampling);
  void SetSampleDistance(double distance);
  void SetCellError(double error);
  void SetImageErrorTolerance(double tolerance);
  void SetTermination(double opacity);
  void SetDevice(const char* device);
  //@}

  /**
   * Set what the panel chooses of light that passes through matter, and of clouds. ParaView sets it once.
   */
  void SetLight(vtkStratusPanelLight* light);

  //@{
  /**
   * Get what the last picture took on this rank: numbers of all blocks together, and how the first block was drawn. Held cells are
   * the data's cells in this rank's memory, with cells around its part. Milliseconds are for casting rays. The sample distance is 0 where
   * rays go from cell to cell, which takes no step.
   */
  double GetHeldCells();
  double GetSamplesTaken();
  double GetSamplesSkipped();
  double GetCastTime();
  double GetUsedSampleDistance();
  const char* GetSamplingUsed();
  const char* GetStructureUsed();
  const char* GetReason();
  const char* GetDeviceUsed();
  //@}

protected:
  vtkStratusVolumeRepresentation();
  ~vtkStratusVolumeRepresentation() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  bool AddToView(vtkView* view) override;
  bool RemoveFromView(vtkView* view) override;
  void UpdateMapperParameters() override;

private:
  vtkStratusVolumeRepresentation(const vtkStratusVolumeRepresentation&) = delete;
  void operator=(const vtkStratusVolumeRepresentation&) = delete;

  vtkStratusMultiBlockVolumeMapper* GetMapper();
  vtkStratusVolumeMapper* GetSettings();
  void FindArray(vtkDataObject* data);
  void TakeData(vtkDataObject* data);
  void ApplyBlendMode();
  void ApplySampling();
  void ShareBounds();
  void Refine(vtkInformation* view);
  void OnUnfinished();
  void AgreeOnUnfinished(vtkMultiProcessController* ranks);
  vtkMTimeType GetSamplingTime();
  void ReportProblem(vtkMultiProcessController* ranks);
  void EndAtBorders(bool end);
  void GatherWhole(vtkMultiProcessController* ranks);
  bool MeasureWhole(vtkRenderer* renderer, vtkMultiProcessController* ranks);
  void ShareTransfer2D(vtkMultiProcessController* ranks);
  void AgreeOnSampling(vtkRenderer* renderer, vtkMultiProcessController* ranks);

  std::unique_ptr<stratus::SolidColor> Solid;
  std::unique_ptr<stratus::PanelUpdate> Panel;
  vtkSmartPointer<vtkStratusPanelLight> Light;
  int BlendMode = 0;
  int Projection = 0;
  int Sampling = 0; // of the user, as are the next two
  double SampleDistance = -1.0;
  double CellError = 0.0;
  double WholeBounds[6];                 // of all ranks
  vtkMTimeType AgreedFor = 0;            // modification time of the settings that the ranks agreed on last
  double Agreed[4] = { 0., 0., 0., 0. }; // sampling, sample distance, cell error, light spread
  bool Lost = false;                     // whether earlier data are shown, because the current data lack the array
  std::string Refusal;                   // of a device that is not there
  std::string Problem, Reported;         // the fault in this rank's part, and the last message about it
  bool EndsAtBorders = false;
  bool Unfinished = false;           // the last picture: the next one is better
  vtkMTimeType EndedFor = 0;         // of the data
  vtkSmartPointer<vtkDataSet> Whole; // of all ranks' pieces, on rank 0
  bool Gathered = false;             // whether rank 0 has it
  vtkMTimeType WholeFor = 0;         // of this rank's piece, when the whole was gathered; its array names and cells follow
  std::vector<std::string> WholeNames;
  bool WholeCells = false;
};

#endif
