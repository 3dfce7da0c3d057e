// SPDX-License-Identifier: BSD-3-Clause
// A view of a grid in the core's terms: the cells of an unstructured one divided into tetrahedra, a structured one as a lattice. Private to
// the module.
#ifndef vtkStratusMeshView_h
#define vtkStratusMeshView_h

#include "stratus.h"

#include "vtkStratusInput.h"
#include "vtkStratusLattice.h"
#include "vtkStratusLeaves.h"
#include "vtkStratusTetrahedra.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkDataSet.h"
#include "vtkUnstructuredGrid.h"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

class vtkStructuredGrid;

class VTK_STRATUS_PRIVATE vtkStratusMeshView
{
public:
  // Returns false, with the reason in `error`, where the core cannot take the grid or the array. `matrix` is the prop's, or nullptr for the
  // identity. Copies are made only where the input's content has changed.
  // The grid is unstructured or structured.
  // Of an array up to `mostComponents` are taken; more are refused.
  bool Set(vtkDataSet* grid, vtkDataArray* array, bool cells, vtkMatrix4x4* matrix, std::string& error, int mostComponents = 1);
  // The same of several structured grids side by side, as one mesh of lattices.
  using Grids = std::vector<std::pair<vtkStructuredGrid*, vtkDataArray*>>;
  bool SetSeveral(const Grids& grids, bool cells, vtkMatrix4x4* matrix, std::string& error, int mostComponents = 1);
  // Reads only a grid's points and cells; bounds are known after that. Returns false if the core does not support them.
  bool SetGeometry(vtkDataSet* grid, std::string& error);
  const double* GetBounds() const { return this->Bounds; }
  const stratus_mesh& GetMesh() const { return this->Mesh; }
  // The grid's partition, or nullptr where it carries none. DropLeaves() forgets a partition that the core has refused because the points
  // were moved.
  const stratus_leaves* GetLeaves() const { return this->HasLeaves ? &this->Leaves.Leaves : nullptr; }
  void DropLeaves() { this->HasLeaves = false; }
  vtkIdType GetLeftOut() const { return this->IsLattice ? 0 : this->Tetrahedra.LeftOut; }
  // A box around the grid, for code that needs only its place.
  stratus_volume GetBox() const;

private:
  void Divide(vtkUnstructuredGrid* grid);
  bool SetHidden(vtkUnstructuredGrid* grid, std::string& error);
  vtkDataArray* Spread(vtkDataArray* array, bool cells);
  void HideNotFinite();
  void HideWhole(std::vector<uint8_t>& hidden) const;

  stratus_mesh Mesh = stratus_mesh_default();
  double Bounds[6] = { 0, 1, 0, 1, 0, 1 };
  vtkSmartPointer<vtkDataSet> Grid; // kept alive, so that no other grid can get the same address
  vtkMTimeType Time = 0;
  // Of points, cells, hidden flags and partition: the cells are divided anew only where it changes, not with every step of a simulation.
  uint64_t Content = 0;
  vtkTimeStamp Geometry; // when that was; 0: no grid has been divided
  bool Accepted = false;
  std::string Refusal;
  vtkStratusTetrahedra Tetrahedra;
  vtkStratusLattice Lattice;
  bool IsLattice = false;
  vtkStratusLeaves Leaves;
  bool HasLeaves = false;
  std::vector<uint8_t> Hidden; // one per tetrahedron, by ghost arrays and blanking
  // Copies for divided cells: a value for each tetrahedron, or for each of their points.
  vtkSmartPointer<vtkDataArray> Source;
  vtkSmartPointer<vtkDataArray> Divided;
  vtkMTimeType DividedTime = 0;
  bool DividedCells = false;
  std::vector<uint8_t> DividedHidden;                       // Hidden, and by values that are not finite
  std::vector<std::unique_ptr<vtkStratusMeshView>> Several; // of several grids
  std::vector<stratus_mesh> Blocks;                         // their meshes
  vtkNew<vtkImageData> Carrier;                             // an image as long as the array, because vtkStratusImageView takes images
  vtkStratusImageView Values;
};

#endif
