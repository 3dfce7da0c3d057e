// SPDX-License-Identifier: BSD-3-Clause
// Draws a volume if ParaView colours by no array: one colour, at the opacity of the last chosen array and function, or of the data's first
// array by a ramp over its range. Private to the module.
#pragma once

#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <string>

class vtkColorTransferFunction;
class vtkDataObject;
class vtkMultiProcessController;
class vtkPiecewiseFunction;
class vtkVolumeProperty;

namespace stratus {

class SolidColor
{
public:
  SolidColor();
  ~SolidColor();

  // Takes the array that ParaView colours by, "" for none, and gives in its place the one whose values are drawn: "" where none was chosen
  // or found yet.
  void Choose(int& association, const char*& name);
  // Takes the functions of the chosen array, nullptr for none.
  void SetFunction(vtkColorTransferFunction* function);
  void SetOpacity(vtkPiecewiseFunction* function);
  void SetColor(double red, double green, double blue);

  // Returns whether an array must be found in the data, because none was ever chosen.
  bool IsOpen() const { return this->Solid && this->Name.empty(); }
  // Finds the data's active scalars, else their first array of points, else of cells, and its range. Returns false where there is none.
  bool FindArray(vtkDataObject* data);
  // Makes the ramp span the range over all ranks, each of which must call it.
  void JoinRange(vtkMultiProcessController* ranks);

  // Gives the property the functions that are drawn by.
  void Apply(vtkVolumeProperty* property);

private:
  bool Solid = true;
  int Association = 0, FoundAssociation = 0;
  std::string Name, FoundName; // of the array that was chosen last, and of the one that was found
  double Range[2];             // of the array that was found; the first is above the last where there is none
  vtkSmartPointer<vtkColorTransferFunction> Function, LastFunction;
  vtkSmartPointer<vtkPiecewiseFunction> Opacity, LastOpacity;
  vtkNew<vtkColorTransferFunction> One;
  vtkNew<vtkPiecewiseFunction> Ramp;
  double Color[3] = { 1.0, 1.0, 1.0 };
};
} // namespace stratus
