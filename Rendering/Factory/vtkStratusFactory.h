// SPDX-License-Identifier: BSD-3-Clause
// The object factory, and the common parts of its mappers: each is VTK's own, draws by ours if that supports the request, and else as VTK
// does.
#ifndef vtkStratusFactory_h
#define vtkStratusFactory_h

#include "vtkObjectFactory.h"

#include <string>

#ifndef VTK_FUTURE_CONST // before VTK 9.2
#define VTK_FUTURE_CONST
#endif

class vtkAbstractVolumeMapper;

class vtkStratusFactory : public vtkObjectFactory
{
public:
  static vtkStratusFactory* New();
  vtkTypeMacro(vtkStratusFactory, vtkObjectFactory);

  const char* GetVTKSourceVersion() VTK_FUTURE_CONST override;
  const char* GetDescription() VTK_FUTURE_CONST override;

protected:
  vtkStratusFactory();
  ~vtkStratusFactory() override = default;

private:
  vtkStratusFactory(const vtkStratusFactory&) = delete;
  void operator=(const vtkStratusFactory&) = delete;
};

// Gives our mapper the input of VTK's, the array that is drawn and the clipping planes.
void vtkStratusTakeInput(vtkAbstractVolumeMapper* own, vtkAbstractVolumeMapper* of_vtk);

// Prints no error of our mapper: VTK's draws then.
void vtkStratusKeepQuiet(vtkAbstractVolumeMapper* own);

// Says on the standard error, once for equal reasons of all mappers, why VTK's mapper draws in place of ours.
void vtkStratusSayWhyNot(const std::string& reason);

#endif
