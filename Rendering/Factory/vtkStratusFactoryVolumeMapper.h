// SPDX-License-Identifier: BSD-3-Clause
// vtkGPUVolumeRayCastMapper for programs that do not know Stratus: a mapper of VTK that draws by vtkStratusVolumeMapper if that supports
// the settings.
#ifndef vtkStratusFactoryVolumeMapper_h
#define vtkStratusFactoryVolumeMapper_h

#include "vtkNew.h"
#include "vtkOpenGLGPUVolumeRayCastMapper.h"

#include <string>

class vtkStratusVolumeMapper;

class vtkStratusFactoryVolumeMapper : public vtkOpenGLGPUVolumeRayCastMapper
{
public:
  static vtkStratusFactoryVolumeMapper* New();
  vtkTypeMacro(vtkStratusFactoryVolumeMapper, vtkOpenGLGPUVolumeRayCastMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  void Render(vtkRenderer* renderer, vtkVolume* volume) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;
  void GetColorImage(vtkImageData* image) override;
  void GetDepthImage(vtkImageData* image) override;

protected:
  vtkStratusFactoryVolumeMapper();
  ~vtkStratusFactoryVolumeMapper() override;

private:
  vtkStratusFactoryVolumeMapper(const vtkStratusFactoryVolumeMapper&) = delete;
  void operator=(const vtkStratusFactoryVolumeMapper&) = delete;

  std::string FindHindrance(vtkVolume* volume);
  void TakeSettings();

  vtkNew<vtkStratusVolumeMapper> Own;
  bool DrawnByOwn = false; // the last picture
};

#endif
