// SPDX-License-Identifier: BSD-3-Clause
// What VTK 9.1 to 9.7 call by different names, in one place.
#pragma once

#include "vtkCellArray.h"
#include "vtkIdTypeArray.h"
#include "vtkRectilinearGrid.h"
#include "vtkUniformGrid.h"
#include "vtkUniformGridAMR.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVersionMacros.h"

#include <array>

#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
#include "vtkCellTypeUtilities.h"
#else
#include "vtkCellTypes.h"
#endif

// 1: the faces of polyhedra are cells of an array of cells; 0: one run of numbers.
#define VTK_STRATUS_FACES_ARE_CELLS (VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 4, 0))

// The name of the class of a type of cells.
inline const char* vtkStratusNameOfCellType(int type)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
  return vtkCellTypeUtilities::GetClassNameFromTypeId(type);
#else
  return vtkCellTypes::GetClassNameFromTypeId(type);
#endif
}

// The types of the grid's cells, null where it has none.
inline vtkDataArray* vtkStratusCellTypes(vtkUnstructuredGrid* grid)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
  return grid->GetCellTypes();
#else
  return grid->GetCellTypesArray();
#endif
}

// Finds the cell of a grid that a place is in, and where in it. Returns 0 outside.
inline int vtkStratusFindCell(vtkRectilinearGrid* grid, double place[3], int ijk[3], double within[3])
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
  const double* at = place;
  return grid->ComputeStructuredCoordinates(at, ijk, within);
#else
  return grid->ComputeStructuredCoordinates(place, ijk, within);
#endif
}

// The arrays that say which faces polyhedra have, null where there are none.
inline std::array<vtkAbstractArray*, 4> vtkStratusFaceArrays(vtkUnstructuredGrid* grid)
{
#if VTK_STRATUS_FACES_ARE_CELLS
  vtkCellArray *faces = grid->GetPolyhedronFaces(), *of_cells = grid->GetPolyhedronFaceLocations();
  return { faces ? faces->GetConnectivityArray() : nullptr, faces ? faces->GetOffsetsArray() : nullptr,
    of_cells ? of_cells->GetConnectivityArray() : nullptr, of_cells ? of_cells->GetOffsetsArray() : nullptr };
#else
  return { grid->GetFaces(), grid->GetFaceLocations(), nullptr, nullptr };
#endif
}

// The grids of a level of AMR: their number, and each, null where another process has it.
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
using vtkStratusAMRGrid = vtkImageData;
inline unsigned int vtkStratusNumberOfGrids(vtkUniformGridAMR* amr, unsigned int level)
{
  return amr->GetNumberOfBlocks(level);
}
inline vtkStratusAMRGrid* vtkStratusGridOf(vtkUniformGridAMR* amr, unsigned int level, unsigned int index)
{
  return amr->GetDataSetAsImageData(level, index);
}
#else
using vtkStratusAMRGrid = vtkUniformGrid;
inline unsigned int vtkStratusNumberOfGrids(vtkUniformGridAMR* amr, unsigned int level)
{
  return amr->GetNumberOfDataSets(level);
}
inline vtkStratusAMRGrid* vtkStratusGridOf(vtkUniformGridAMR* amr, unsigned int level, unsigned int index)
{
  return amr->GetDataSet(level, index);
}
#endif
