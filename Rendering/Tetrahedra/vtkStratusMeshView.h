// SPDX-License-Identifier: BSD-3-Clause
// A grid, its cells divided into tetrahedra, as what the core takes. Private to the module.
#ifndef vtkStratusMeshView_h
#define vtkStratusMeshView_h

#include "stratus.h"

#include "vtkStratusInput.h"
#include "vtkStratusLeaves.h"
#include "vtkStratusTetrahedra.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <cstdint>
#include <string>
#include <vector>

class VTK_STRATUS_PRIVATE vtkStratusMeshView
{
public:
  // False, with the reason in `error`, where the core can't take the grid or the array. matrix: of the prop, or nullptr. Copies what has to
  // be copied when it changes only.
  bool Set(vtkUnstructuredGrid* grid, vtkDataArray* array, bool cells, vtkMatrix4x4* matrix, std::string& error);
  const stratus_mesh& GetMesh() const { return this->Mesh; }
  // Of the grid's partition, nullptr if it carries none; or none any more, once the core has refused it: then the points were moved.
  const stratus_leaves* GetLeaves() const { return this->HasLeaves ? &this->Leaves.Leaves : nullptr; }
  void DropLeaves() { this->HasLeaves = false; }
  vtkIdType GetLeftOut() const { return this->Tetrahedra.LeftOut; }
  // A box about it, for who only needs to know where it is.
  stratus_volume GetBox() const;

private:
  bool SetHidden(vtkUnstructuredGrid* grid, std::string& error);
  vtkDataArray* Spread(vtkDataArray* array, bool cells);
  void HideNotFinite();
  void HideWhole(std::vector<uint8_t>& hidden) const;

  stratus_mesh Mesh;
  double Bounds[6] = { 0, 1, 0, 1, 0, 1 };
  vtkSmartPointer<vtkUnstructuredGrid> Grid; // held, so that no other can take its address
  vtkMTimeType Time = 0;
  bool Accepted = false;
  std::string Refusal;
  vtkStratusTetrahedra Tetrahedra;
  vtkStratusLeaves Leaves;
  bool HasLeaves = false;
  std::vector<uint8_t> Hidden; // a tetrahedron, by ghosts and blanking
  // Where cells are divided: a value for each tetrahedron, or for their points.
  vtkSmartPointer<vtkDataArray> Source;
  vtkSmartPointer<vtkDataArray> Divided;
  vtkMTimeType DividedTime = 0;
  bool DividedCells = false;
  std::vector<uint8_t> DividedHidden; // by values that are not finite, too
  vtkNew<vtkImageData> Carrier;       // as long as the array: values are viewed as an image's are
  vtkStratusImageView Values;
};

#endif
