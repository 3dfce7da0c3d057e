// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusLeftOut.h"

#include "vtkAbstractMapper.h"
#include "vtkImplicitFunction.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"

void vtkStratusLeftOut::AddUnused(const char* setting, const char* mode)
{
  this->Add(std::string(setting) + ", which mode " + mode + " does not use");
}

void vtkStratusLeftOut::AddTransforms(vtkAbstractMapper* mapper, vtkImplicitFunction* slice)
{
  if (slice && slice->GetTransform()) {
    this->Add("the transform of SliceFunction, which is used as it is");
  }
  vtkPlaneCollection* planes = mapper->GetClippingPlanes();
  for (int p = 0; planes && p < planes->GetNumberOfItems(); ++p) {
    if (planes->GetItem(p)->GetTransform()) {
      this->Add("the transforms of clipping planes, whose origins and normals are used as they are");
      return;
    }
  }
}

void vtkStratusLeftOut::WarnOnce(vtkObject* object, const std::string& warning)
{
  if (this->Reported.insert(warning).second) {
    vtkWarningWithObjectMacro(object, << warning);
  }
}

void vtkStratusLeftOut::Warn(vtkObject* object)
{
  std::string text;
  for (const std::string& what : this->Now) {
    if (this->Reported.insert(what).second) {
      text += (text.empty() ? "" : "; ") + what;
    }
  }
  if (!text.empty()) {
    vtkWarningWithObjectMacro(object, << "the picture is drawn without " << text);
  }
}
