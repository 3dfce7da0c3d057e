// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVolumeRepresentation
 * @brief   ParaView's volume rendering of uniform and rectilinear grids by vtkStratusVolumeMapper
 *
 * Composite data are drawn block by block, in exact order (vtkStratusMultiBlockVolumeMapper).
 * Supports everything of ParaView's own representation "Volume" that the mapper supports. The mapper refuses the rest by an error in
 * ParaView's messages. vtkStratusVolumeMapper documents the setters below.
 *
 * @sa vtkStratusVolumeMapper vtkStratusMultiBlockVolumeMapper
 */
#ifndef vtkStratusVolumeRepresentation_h
#define vtkStratusVolumeRepresentation_h

#include "StratusParaViewRepresentationsModule.h" // For export macro
#include "vtkImageVolumeRepresentation.h"

class vtkStratusVolumeMapper;

class STRATUSPARAVIEWREPRESENTATIONS_EXPORT vtkStratusVolumeRepresentation : public vtkImageVolumeRepresentation
{
public:
  static vtkStratusVolumeRepresentation* New();
  vtkTypeMacro(vtkStratusVolumeRepresentation, vtkImageVolumeRepresentation);
  void PrintSelf(ostream& os, vtkIndent indent) override;

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

protected:
  vtkStratusVolumeRepresentation();
  ~vtkStratusVolumeRepresentation() override;

  int RequestData(vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  void UpdateMapperParameters() override;

private:
  vtkStratusVolumeRepresentation(const vtkStratusVolumeRepresentation&) = delete;
  void operator=(const vtkStratusVolumeRepresentation&) = delete;

  vtkStratusVolumeMapper* GetSettings();
  void ApplyBlendMode();

  int BlendMode = 0;
  int Projection = 0;
};

#endif
