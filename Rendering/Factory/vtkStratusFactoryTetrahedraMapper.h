// SPDX-License-Identifier: BSD-3-Clause
// vtkProjectedTetrahedraMapper for programs that do not know Stratus: a mapper of VTK that draws by vtkStratusTetrahedraMapper if that
// supports the settings.
#ifndef vtkStratusFactoryTetrahedraMapper_h
#define vtkStratusFactoryTetrahedraMapper_h

#include "vtkNew.h"
#include "vtkOpenGLProjectedTetrahedraMapper.h"

class vtkStratusTetrahedraMapper;

class vtkStratusFactoryTetrahedraMapper : public vtkOpenGLProjectedTetrahedraMapper
{
public:
  static vtkStratusFactoryTetrahedraMapper* New();
  vtkTypeMacro(vtkStratusFactoryTetrahedraMapper, vtkOpenGLProjectedTetrahedraMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  void Render(vtkRenderer* renderer, vtkVolume* volume) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

protected:
  vtkStratusFactoryTetrahedraMapper();
  ~vtkStratusFactoryTetrahedraMapper() override;

private:
  vtkStratusFactoryTetrahedraMapper(const vtkStratusFactoryTetrahedraMapper&) = delete;
  void operator=(const vtkStratusFactoryTetrahedraMapper&) = delete;

  vtkNew<vtkStratusTetrahedraMapper> Own;
};

#endif
