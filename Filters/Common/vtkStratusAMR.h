// SPDX-License-Identifier: BSD-3-Clause
// Adaptive mesh refinement (vtkOverlappingAMR) as grids side by side that hold its field exactly. Private to the modules.
#ifndef vtkStratusAMR_h
#define vtkStratusAMR_h

#include "vtkStratusPrivate.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <functional>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;
class vtkOverlappingAMR;
class vtkUniformGridAMR;

class VTK_STRATUS_PRIVATE vtkStratusAMR
{
public:
  // Gives a box's array and whether its values are of cells; nullptr where the box has none.
  using FindArray = std::function<vtkDataArray*(vtkDataSet* box, bool& cells)>;

  // How the grids are drawn.
  struct Use {
    bool Nearest = false;
    bool Gradients = false;    // lit, or by the gradient otherwise
    int Piece = 0, Pieces = 1; // the grids of a piece of the space are made
  };

  // Makes the grids: images and rectilinear grids, whose drawn array has the name of the data's, of points for linear interpolation, of
  // cells and as they are for nearest without gradients. Otherwise it is of floats, or of doubles where values lie close together, far from
  // 0. Boxes without data, as other ranks have them, count as not there. Returns false, with the reason in `error`, where the data can't be
  // drawn right.
  bool Set(vtkUniformGridAMR* amr, const FindArray& find, const Use& use, std::string& error);
  const std::vector<vtkSmartPointer<vtkDataSet>>& GetGrids() const { return this->Grids; }
  bool HasCells() const { return this->Cells; } // whether the grids' array is of cells
  const std::string& GetArrayName() const { return this->ArrayName; }
  int GetNumberOfLevels() const { return this->Levels; }
  bool HasGradients() const { return this->Gradients; }
  // Returns the gradients of a grid, as stratus_volume has them, nullptr if it was made without: the last numbers of an array that the grid
  // keeps. If its values are floats, they are the first, so that rays read both in place.
  static const float* GetGradients(vtkDataSet* grid);
  double GetSpacing() const { return this->Spacing; } // the mean one of level 0

  // Gives the bounds of a piece. Returns false where it has nothing.
  static bool GetBounds(vtkUniformGridAMR* amr, int piece, int pieces, double bounds[6]);
  // When the data or an array of theirs were modified last.
  static vtkMTimeType GetTime(vtkUniformGridAMR* amr);

private:
  bool Make(vtkOverlappingAMR* amr, const FindArray& find, const Use& use, std::string& error);

  std::vector<vtkSmartPointer<vtkDataSet>> Grids;
  bool Cells = false, Gradients = false;
  double Spacing = 0.0;
  std::string ArrayName;
  int Levels = 0;
};

#endif
