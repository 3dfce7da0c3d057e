// SPDX-License-Identifier: BSD-3-Clause
// Settings that a picture has no use for, such as Shade in blend mode maximum. VTK's mappers ignore such settings, and so do these
// mappers, with one warning. Private to the modules.
#ifndef vtkStratusLeftOut_h
#define vtkStratusLeftOut_h

#include "vtkStratusPrivate.h"

#include <set>
#include <string>
#include <vector>

class vtkAbstractMapper;
class vtkImplicitFunction;
class vtkObject;

class VTK_STRATUS_PRIVATE vtkStratusLeftOut
{
public:
  // Begins a picture.
  void Begin() { this->Now.clear(); }
  // Adds a setting that the picture ignores, with the reason: "Shade, which mode maximum does not use".
  void Add(const std::string& what) { this->Now.push_back(what); }
  // Adds a setting that the mode does not use.
  void AddUnused(const char* setting, const char* mode);
  // Adds the transforms of clipping planes, and of a slice's function (nullptr: there is none), which are used as they are.
  void AddTransforms(vtkAbstractMapper* mapper, vtkImplicitFunction* slice);
  // Raises a warning of `object`, unless it has been raised before.
  void WarnOnce(vtkObject* object, const std::string& warning);
  // Raises one warning of `object` about all settings that no earlier warning named.
  void Warn(vtkObject* object);

private:
  std::vector<std::string> Now;
  std::set<std::string> Reported;
};

#endif
