// SPDX-License-Identifier: BSD-3-Clause
// The blocks of a composite data set as one: lattices side by side, or one grid, joined where their borders meet. Private to the modules,
// never installed.
#ifndef vtkStratusBlocks_h
#define vtkStratusBlocks_h

#include "vtkStratusPrivate.h"

#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

class vtkCompositeDataSet;
class vtkStructuredGrid;
class vtkUnsignedCharArray;

class VTK_STRATUS_PRIVATE vtkStratusBlocks
{
public:
  // Finds a block's scalars, nullptr where it has none; *cells is 1 where they belong to cells.
  using Find = std::function<vtkDataArray*(vtkDataSet* block, int& cells)>;

  // Takes the blocks at any depth that have cells and scalars, of points or cells like the first such block. A single block is taken as it
  // is. With `lattices`, several structured grids are kept without conversion, if their scalars have one type and all faces that two of
  // them share have one diagonal: see GetLattices(). Otherwise they become one unstructured grid: points of equal coordinates and, for
  // point scalars, equal values are merged, so that blocks meet in whole faces. Blocks are unstructured, structured or rectilinear grids,
  // or images. Nothing is done if no block has changed. Returns false, with the reason in `error`, if a block cannot be read.
  bool Set(vtkCompositeDataSet* whole, const Find& find, std::string& error, bool lattices);
  vtkDataSet* GetGrid() const { return this->Grid; } // nullptr: no block has cells, or they are lattices
  vtkDataArray* GetScalars() const { return this->Scalars; }
  // Structured grids and their scalars, which live as long as this; none where there is one grid.
  using Lattices = std::vector<std::pair<vtkStructuredGrid*, vtkDataArray*>>;
  const Lattices& GetLattices() const { return this->Several; }
  bool OfCells() const { return this->Cells; }
  // Returns which blocks are left out and why, "" if none is.
  const std::string& DescribeLeftOut() const { return this->LeftOut; }

private:
  struct Block {
    vtkDataSet* Set;
    vtkDataArray* Scalars;
    vtkMTimeType Time;
    bool operator==(const Block& b) const { return this->Set == b.Set && this->Scalars == b.Scalars && this->Time == b.Time; }
  };
  class Points;

  bool AreLattices() const;
  std::vector<Block> List(vtkCompositeDataSet* whole, const Find& find);
  bool Check(const Block& block, std::string& error) const;
  bool CheckAll(std::string& error) const;
  bool Join(std::string& error);
  bool Append(const Block& block, vtkUnsignedCharArray* hidden, std::string& error) const;
  void AppendCells(vtkUnstructuredGrid* from, const std::vector<vtkIdType>& names, vtkUnstructuredGrid* to) const;
  void AppendBoxes(const int points[3], const std::vector<vtkIdType>& names, vtkUnstructuredGrid* to) const;

  std::vector<Block> Known;
  std::vector<vtkSmartPointer<vtkDataSet>> Kept; // so that no other block gets the address of a known one
  vtkSmartPointer<vtkDataSet> Grid;
  vtkSmartPointer<vtkDataArray> Scalars;
  Lattices Several;
  bool Cells = false;
  std::string LeftOut, Refusal;
};

#endif
