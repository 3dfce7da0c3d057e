// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetrahedraRepresentation
 * @brief   ParaView's volume rendering of cells by vtkStratusTetrahedraMapper
 *
 * Draws unstructured and structured grids and composite data of them as they are: nothing divides their cells before the mapper does. If
 * there are several ranks, they exchange cells: each rank receives every cell that reaches into its box, which ParaView assigns, and draws
 * the part of the cells inside the box. Arrays of several components are drawn by their magnitude or one component, as the colour map says.
 * The mapper refuses the rest by an error in ParaView's messages.
 *
 * @sa vtkStratusTetrahedraMapper
 */
#ifndef vtkStratusTetrahedraRepresentation_h
#define vtkStratusTetrahedraRepresentation_h

#include "StratusParaViewRepresentationsModule.h" // For export macro
#include "vtkNew.h"                               // For vtkNew
#include "vtkSmartPointer.h"                      // For vtkSmartPointer
#include "vtkVolumeRepresentation.h"

#include <memory> // For std::unique_ptr
#include <string> // For std::string
#include <vector> // For std::vector

class vtkBoundingBox;
class vtkColorTransferFunction;
class vtkMultiProcessController;
class vtkPiecewiseFunction;
class vtkPolyDataMapper;
class vtkStratusPanelLight;
class vtkStratusTetrahedraMapper;
namespace stratus {
class PanelUpdate;
class SolidColor;
} // namespace stratus

class STRATUSPARAVIEWREPRESENTATIONS_EXPORT vtkStratusTetrahedraRepresentation : public vtkVolumeRepresentation
{
public:
  static vtkStratusTetrahedraRepresentation* New();
  vtkTypeMacro(vtkStratusTetrahedraRepresentation, vtkVolumeRepresentation);
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
   * Forwarded to the mapper.
   */
  void SetBlendMode(int mode);
  void SetMethod(int method);
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
   * Forwarded to the property of component 0, as for volumes of uniform grids.
   */
  void SetShade(bool on);
  void SetAmbient(double share);
  void SetDiffuse(double share);
  void SetSpecular(double share);
  void SetSpecularPower(double power);
  //@}

  //@{
  /**
   * Of the blend mode isosurface: its values.
   */
  void SetNumberOfIsosurfaces(int number);
  void SetIsosurfaceValue(int index, double value);
  //@}

  //@{
  /**
   * Get statistics of the last frame on this rank: tetrahedra that cells were divided into; tetrahedra left out because a value is not
   * finite or a point is repeated; tetrahedra that rays passed, or pieces that were composited if cells are projected; milliseconds of
   * drawing; the method, why it was chosen, and the device.
   */
  double GetTetrahedra();
  double GetLeftOut();
  double GetSegments();
  double GetCastTime();
  const char* GetMethodUsed();
  const char* GetReason();
  const char* GetDeviceUsed();
  //@}

protected:
  vtkStratusTetrahedraRepresentation();
  ~vtkStratusTetrahedraRepresentation() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  bool AddToView(vtkView* view) override;
  bool RemoveFromView(vtkView* view) override;

private:
  vtkStratusTetrahedraRepresentation(const vtkStratusTetrahedraRepresentation&) = delete;
  void operator=(const vtkStratusTetrahedraRepresentation&) = delete;

  void FindArray(vtkDataObject* data);
  const char* GetShownArray(bool& on_cells);
  void UpdateMapper(vtkDataObject* data);
  void Show(vtkDataObject* data, const std::string& name, bool on_cells);
  void Deal(vtkMultiProcessController* ranks, const std::vector<vtkBoundingBox>& boxes);
  void ReportProblem(vtkMultiProcessController* ranks);
  void ClipTo(const std::vector<vtkBoundingBox>& boxes, int rank);

  std::unique_ptr<stratus::SolidColor> Solid;
  std::unique_ptr<stratus::PanelUpdate> Panel;
  vtkSmartPointer<vtkStratusPanelLight> Light;
  vtkNew<vtkStratusTetrahedraMapper> Mapper;
  vtkNew<vtkPolyDataMapper> OutlineMapper;
  vtkSmartPointer<vtkDataObject> Cache; // what of the input this rank has
  vtkSmartPointer<vtkDataObject> Piece; // the same where it is drawn
  // With several ranks: the data that this rank draws, its array, and the settings that it was distributed for.
  vtkSmartPointer<vtkDataObject> Dealt;
  std::string DealtArray;
  bool DealtCells = false;
  std::vector<double> DealtFor;
  vtkSmartPointer<vtkDataObject> DealtOf;
  std::string DealtName;
  bool Lost = false;             // whether earlier data are shown, because the current data lack the array
  std::string Refusal;           // of a device that is not there
  std::string Problem, Reported; // why this rank left something out, and its last message about it
};

#endif
