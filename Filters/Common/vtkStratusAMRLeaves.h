// SPDX-License-Identifier: BSD-3-Clause
// Divides the space of boxes of several levels into parts without overlap, each of which one regular lattice holds exactly. Private to the
// modules.
//
// A part may hold cells of several levels: the lattice of the finest holds the coarser cells' field exactly. Planes along the boxes' sides
// cut a part in two as long as that saves values, each grid counted as some thousands of values for what it costs to draw. So a part has no
// more than 27 values for each of its cells, or it is that small.
#ifndef vtkStratusAMRLeaves_h
#define vtkStratusAMRLeaves_h

#include "vtkStratusAMRField.h"

#include <vector>

struct VTK_STRATUS_PRIVATE vtkStratusAMRLeaf {
  vtkStratusAMRField::Place Lo{}, Hi{}; // in the field's units
  int Level = 0;                        // the finest in it
  // Whether all cells in it and around it have its level or finer ones, so that centres and borders suffice in place of all corners of
  // parts.
  bool Even = false;
};

class VTK_STRATUS_PRIVATE vtkStratusAMRLeaves
{
public:
  // nearest: cells' values are taken as they are, and a leaf's lattice is that of its cells.
  vtkStratusAMRLeaves(const vtkStratusAMRField& field, bool nearest);
  const std::vector<vtkStratusAMRLeaf>& GetLeaves() const { return this->Leaves; }
  // The planes of a leaf's lattice along an axis.
  std::vector<int64_t> GetPlanes(const vtkStratusAMRLeaf& leaf, int axis) const;

private:
  using Place = vtkStratusAMRField::Place;
  struct Box {
    int Level;
    Place Lo, Hi; // in units
  };

  double VolumeIn(const std::vector<Box>& boxes, int level, const Place& lo, const Place& hi) const;
  vtkStratusAMRLeaf Describe(const std::vector<Box>& boxes, const Place& lo, const Place& hi, bool& covered) const;
  double CostOf(const vtkStratusAMRLeaf& leaf) const;
  void Divide(const std::vector<Box>& boxes, const Place& lo, const Place& hi);
  bool Peel(const std::vector<Box>& boxes, const vtkStratusAMRLeaf& leaf);

  const vtkStratusAMRField& Field;
  bool Nearest;
  Place WholeLo, WholeHi;
  std::vector<vtkStratusAMRLeaf> Leaves;
};

#endif
