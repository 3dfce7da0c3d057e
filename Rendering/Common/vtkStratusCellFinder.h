// SPDX-License-Identifier: BSD-3-Clause
// Finds the cell or point of a mapper's input at the place where a ray first shows something. Private to the modules.
#ifndef vtkStratusCellFinder_h
#define vtkStratusCellFinder_h

#include "vtkStratusPrivate.h"

#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <vector>

class vtkDataObject;
class vtkDataSet;
class vtkGenericCell;
class vtkMatrix4x4;
class vtkStaticCellLocator;

class VTK_STRATUS_PRIVATE vtkStratusCellFinder
{
public:
  vtkStratusCellFinder();
  ~vtkStratusCellFinder();
  vtkStratusCellFinder(const vtkStratusCellFinder&) = delete;
  void operator=(const vtkStratusCellFinder&) = delete;

  struct Found {
    unsigned int Block = 0; // flat index in composite data
    vtkIdType Element = -1; // number of the cell or the point; -1: there is none
  };

  // Takes a data set or composite data, which a prop shows under `matrix`. The search tree of a mesh stays until the mesh changes.
  void Set(vtkDataObject* input, vtkMatrix4x4* matrix);
  bool HasBlocks() const { return this->IsComposite; }
  // The largest number of cells and of points of a block.
  vtkIdType GetMost() const { return this->Most; }
  // Finds the cell that a ray in `direction` enters at `place`, both in the world, or of its points the nearest.
  Found Find(const double place[3], const double direction[3], bool points);

private:
  struct Grid {
    vtkSmartPointer<vtkDataSet> Data;
    unsigned int Block = 0;
    double Bounds[6] = { 0, 0, 0, 0, 0, 0 };
    double Length = 0.0;                           // of a cell, about
    vtkSmartPointer<vtkStaticCellLocator> Locator; // of a mesh
    vtkMTimeType Time = 0;                         // of the data, when it was built
  };

  void Add(vtkDataSet* data, unsigned int block, std::vector<Grid>& before);
  vtkIdType FindIn(const Grid& grid, const double place[3], bool points, bool nearest);

  std::vector<Grid> Grids;
  bool IsComposite = false;
  vtkIdType Most = 0;
  double ToData[16];
  vtkNew<vtkGenericCell> Cell; // room for FindIn()
};

#endif
