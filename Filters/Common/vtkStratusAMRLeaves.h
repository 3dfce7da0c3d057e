// SPDX-License-Identifier: BSD-3-Clause
// Divides the space of boxes of several levels into parts without overlap, each of which one regular lattice holds exactly. Private to the
// modules.
//
// A part may hold cells of several levels: the lattice of the finest holds the coarser cells' field exactly. Planes along the boxes' sides
// cut a part in two if that saves values. The cost of drawing a grid counts as some thousands of values. The number of values is therefore
// at most 27 a cell, plus these thousands for each part of one level.
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
  // all: the boxes, of which the field has the values in the piece and around it. nearest: cell values are not interpolated, and a leaf's
  // lattice equals its cells' lattice. piece of pieces: the part of the space that is divided.
  vtkStratusAMRLeaves(
    const vtkStratusAMRField& field, const std::vector<vtkStratusAMRField::Box>& all, bool nearest, int piece = 0, int pieces = 1);
  const std::vector<vtkStratusAMRLeaf>& GetLeaves() const { return this->Leaves; }
  // The planes of a leaf's lattice along an axis.
  std::vector<int64_t> GetPlanes(const vtkStratusAMRLeaf& leaf, int axis) const;

  using Place = vtkStratusAMRField::Place;
  struct Box {
    int Level;
    Place Lo{}, Hi{}; // in units
  };
  // Shrinks lo..hi, the bounds of all boxes, to one piece's bounds: planes across the longest side halve the pieces, so that each half has
  // its share of all boxes' values. The planes are between cells of level 0, which are `cell` wide. Returns false if nothing is left for
  // the piece.
  static bool FindPiece(
    const std::vector<Box>& boxes, const Place& cell, const std::vector<double>& values, int piece, int pieces, Place& lo, Place& hi);

private:
  double VolumeIn(const std::vector<Box>& boxes, int level, const Place& lo, const Place& hi) const;
  vtkStratusAMRLeaf Describe(const std::vector<Box>& boxes, const Place& lo, const Place& hi, bool& covered) const;
  double CostOf(const vtkStratusAMRLeaf& leaf) const;
  double Divide(const std::vector<Box>& boxes, const Place& lo, const Place& hi);
  bool FindPlane(const std::vector<Box>& near, const std::vector<const Box*>& within, const Place& lo, const Place& hi, Place& middle_hi,
    Place& middle_lo) const;
  bool Peel(const std::vector<Box>& boxes, const vtkStratusAMRLeaf& leaf);

  const vtkStratusAMRField& Field;
  bool Nearest;
  Place WholeLo{}, WholeHi{};
  std::vector<vtkStratusAMRLeaf> Leaves;
};

#endif
