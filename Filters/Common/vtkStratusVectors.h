// SPDX-License-Identifier: BSD-3-Clause
// One value for each tuple of an array of several components. Private to the modules, never installed.
#ifndef vtkStratusVectors_h
#define vtkStratusVectors_h

#include "vtkStratusPrivate.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <vector>

class vtkVolumeProperty;

class VTK_STRATUS_PRIVATE vtkStratusVectors
{
public:
  static constexpr int All = -2, Magnitude = -1;

  // Returns the component of an array of `components` components that a mesh's colour function draws, as VTK's mappers of meshes read its
  // VectorMode: Magnitude, or a component, which may be one that the array lacks. Returns All, for every component, if there are 2 to 4 and
  // the function names the first, which is its default, or if they depend on each other.
  static int Find(vtkVolumeProperty* property, int components);

  // Returns a component, or the magnitudes in double, under the array's name.
  static vtkSmartPointer<vtkDataArray> Make(vtkDataArray* array, int component);
  // The same, kept until the array's own time or `time` changes.
  vtkDataArray* Get(vtkDataArray* array, int component, vtkMTimeType time);
  // Drops results that were not used since the last call.
  void Sweep();

private:
  struct Entry {
    vtkSmartPointer<vtkDataArray> Array, Values;
    int Component;
    vtkMTimeType Time;
    bool Asked;
  };
  std::vector<Entry> Entries;
};

#endif
