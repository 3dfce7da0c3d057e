// SPDX-License-Identifier: BSD-3-Clause
// VTK's functions of a value as the core's piecewise linear points. Private to the modules, never installed.
#ifndef vtkStratusFunction_h
#define vtkStratusFunction_h

#include "vtkStratusPrivate.h"

#include "vtkObject.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <vector>

class vtkColorTransferFunction;
class vtkPiecewiseFunction;

// The points of one function: numbers of `width` + 1 each, the value first. They are translated once, and again when the function was
// modified or another one takes its place.
//
// A linear piece between two nodes stays two points. A bent piece (midpoint and sharpness, a logarithmic axis, a colour space that is not
// RGB) is divided until the chords differ from VTK's GetValue() or GetColor() by at most 1e-5. A step stays a step, at the very number
// where VTK takes it: VTK holds the value left of a node at the node itself, while the core holds the value right of a step at the step. A
// step at a node therefore moves up to the next number. Two things are found less closely. An opacity within 1e-9 of 1 is 1, as it is in
// VTK's own tables of floats. VTK rounds colours of the space LabCIEDE2000 to 8 bits; the steps that this makes are found to 2^-20 of the
// distance between two nodes.
class VTK_STRATUS_PRIVATE vtkStratusFunction
{
public:
  static constexpr double Error = 1e-5; // the bound on the difference

  // Returns false where the function has no node. `width` is the number of equal numbers after the value.
  bool Set(vtkPiecewiseFunction* function, int width);
  bool Set(vtkColorTransferFunction* function);

  const double* GetPoints() const { return this->Points.data(); }
  size_t GetCount() const { return this->Points.size() / static_cast<size_t>(this->Width + 1); }
  // Returns how often a function was translated.
  uint64_t GetBuilds() const { return this->Builds; }

private:
  bool IsCurrent(vtkObject* function, int width);

  std::vector<double> Points;
  int Width = 1;
  vtkSmartPointer<vtkObject> Source; // kept alive, so that no new function can get the same address
  vtkMTimeType Time = 0;
  uint64_t Builds = 0;
};

#endif
