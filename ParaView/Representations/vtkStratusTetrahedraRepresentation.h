// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetrahedraRepresentation
 * @brief   ParaView's volume rendering of cells by vtkStratusTetrahedraMapper
 *
 * Draws unstructured and structured grids and composite data of them as they are: nothing divides their cells before the mapper does.
 * Several ranks redistribute the cells as ParaView asks, so that each has all cells that reach into a box of its own, and draws what of
 * them lies in the box. Arrays of several components are drawn by their
 * magnitude or one component, as the colour map says. The mapper refuses the rest by an error in ParaView's messages.
 *
 * @sa vtkStratusTetrahedraMapper
 */
#ifndef vtkStratusTetrahedraRepresentation_h
#define vtkStratusTetrahedraRepresentation_h

#include "StratusParaViewRepresentationsModule.h" // For export macro
#include "vtkNew.h"                               // For vtkNew
#include "vtkSmartPointer.h"                      // For vtkSmartPointer
#include "vtkVolumeRepresentation.h"

#include <vector> // For std::vector

class vtkBoundingBox;
class vtkPolyDataMapper;
class vtkStratusTetrahedraMapper;

class STRATUSPARAVIEWREPRESENTATIONS_EXPORT vtkStratusTetrahedraRepresentation : public vtkVolumeRepresentation
{
public:
  static vtkStratusTetrahedraRepresentation* New();
  vtkTypeMacro(vtkStratusTetrahedraRepresentation, vtkVolumeRepresentation);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out) override;

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

  void UpdateMapper(vtkDataObject* data);
  void ClipTo(const std::vector<vtkBoundingBox>& boxes, int rank);

  vtkNew<vtkStratusTetrahedraMapper> Mapper;
  vtkNew<vtkPolyDataMapper> OutlineMapper;
  vtkSmartPointer<vtkDataObject> Cache; // what of the input this rank draws
};

#endif
