// SPDX-License-Identifier: BSD-3-Clause
// A grid of tetrahedra as what the core takes. Private to the module.
#ifndef vtkStratusMeshView_h
#define vtkStratusMeshView_h

#include "stratus.h"

#include "vtkStratusInput.h"

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
  // False, with the reason in `error`, where the core can't take the grid or the array. matrix: of the prop, or nullptr. Copies what has to be copied
  // when it changes only.
  bool Set(vtkUnstructuredGrid* grid, vtkDataArray* array, bool cells, vtkMatrix4x4* matrix, std::string& error);
  const stratus_mesh& GetMesh() const { return this->Mesh; }
  // A box about it, for who only needs to know where it is.
  stratus_volume GetBox() const;

private:
  bool CopyCells(vtkUnstructuredGrid* grid, std::string& error);
  void CopyPoints(vtkUnstructuredGrid* grid);
  bool CopyHidden(vtkUnstructuredGrid* grid, std::string& error);

  stratus_mesh Mesh;
  double Bounds[6] = { 0, 1, 0, 1, 0, 1 };
  vtkSmartPointer<vtkUnstructuredGrid> Grid; // held, so that no other can take its address
  vtkMTimeType Time = 0;
  bool Accepted = false;
  std::string Refusal;
  std::vector<double> Points;
  std::vector<int32_t> Vertices;
  std::vector<uint8_t> Hidden;
  vtkNew<vtkImageData> Carrier; // as long as the array: values are viewed as an image's are
  vtkStratusImageView Values;
};

#endif
