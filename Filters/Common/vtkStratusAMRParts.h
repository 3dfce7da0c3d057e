// SPDX-License-Identifier: BSD-3-Clause
// The parts of boxes of AMR that a piece of the space needs, so that no rank has all data. Private to the modules.
//
// A piece is a box of whole cells of level 0. A value on its border depends on the cells around, of any level, and a gradient on those a
// cell farther away, all within MARGIN cells of level 0. The parts of boxes within that distance hold the field and its gradients in the
// piece to the bit. All boxes, wherever their values are, say where pieces and grids begin: they are listed in the data's field data.
#ifndef vtkStratusAMRParts_h
#define vtkStratusAMRParts_h

#include "vtkStratusPrivate.h"

#include "vtkStratusAMRField.h"
#include "vtkStratusVersions.h"

#include "vtkSmartPointer.h"

#include <array>
#include <string>
#include <vector>

class vtkOverlappingAMR;

class VTK_STRATUS_PRIVATE vtkStratusAMRParts
{
public:
  using Box = vtkStratusAMRField::Box;
  using Place = vtkStratusAMRField::Place;
  using Ratios = std::vector<std::array<int, 3>>;
  static constexpr int64_t MARGIN = 3; // cells of level 0

  // "box 3 of level 1"
  static std::string NameOf(unsigned int level, unsigned int id);
  // Finds how many cells of each level fit along a cell of the level before. Returns false, with the reason, if that is no whole number.
  static bool FindRatios(vtkOverlappingAMR* amr, Ratios& ratios, std::string& error);
  // Gives the cells of a box. Returns false, with the reason, if it is not where the levels' lattice says.
  static bool FindBox(vtkOverlappingAMR* amr, unsigned int level, unsigned int id, vtkStratusAMRGrid* grid, Box& box, std::string& error);

  // A box that has data here.
  struct Held {
    unsigned int Level, Id;
    vtkStratusAMRGrid* Grid;
    Box Where;
  };
  // Lists them. Returns false if the data can't be cut: a box is not on the lattice, or an array has another size.
  static bool List(vtkOverlappingAMR* amr, std::vector<Held>& boxes);

  // The boxes of all ranks, those without data here, too. Unless they were set, the boxes that have data are all there are.
  static void SetAll(vtkOverlappingAMR* amr, const std::vector<Box>& boxes);
  static std::vector<Box> GetAll(vtkOverlappingAMR* amr);

  // Finds a piece, in halves of the finest level's cells, as the field counts, and how many of them a cell of level 0 has. Returns false
  // where the piece has nothing.
  static bool FindPiece(const Ratios& ratios, const std::vector<Box>& all, int piece, int pieces, Place& lo, Place& hi, Place& cell);
  // Finds the cells of a box that this piece needs. Returns false where it needs none.
  static bool FindNeeded(const Ratios& ratios, const Box& box, const Place& lo, const Place& hi, const Place& cell, Box& part);
  // Returns a part of a box, with its arrays of numbers; the box itself where that is all of it.
  static vtkSmartPointer<vtkStratusAMRGrid> Cut(const Held& box, const Box& part);
};

#endif
