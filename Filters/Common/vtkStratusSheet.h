// SPDX-License-Identifier: BSD-3-Clause
// Images and rectilinear grids that are one point thick along an axis, as sheets of a voxel's thickness. Private to the modules, never
// installed.
#ifndef vtkStratusSheet_h
#define vtkStratusSheet_h

#include "vtkStratusPrivate.h"

#include "vtkDataSet.h"
#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

class VTK_STRATUS_PRIVATE vtkStratusSheet
{
public:
  // Returns the thickness along each axis of which a vtkImageData or vtkRectilinearGrid has one point, 0 along the others: the image's
  // spacing, or the mean spacing of the other axes where it has none; 1 for a single point. Returns whether there is such an axis.
  static bool FindThickness(vtkDataSet* grid, double thickness[3]);

  // Returns the grid itself if it is not flat. Otherwise returns a grid that has every value twice along each flat axis, half the thickness
  // before and behind it. It is kept until the grid changes. Values of cells stay as they are.
  vtkDataSet* Get(vtkDataSet* grid);

  // Whether the last grid that Get() returned was made of this one.
  bool IsOf(const vtkDataObject* grid) const { return this->Thick && this->Of.GetPointer() == grid; }

private:
  vtkSmartPointer<vtkDataSet> Thick;
  vtkWeakPointer<vtkDataSet> Of;
  vtkMTimeType Time = 0;
};

#endif
