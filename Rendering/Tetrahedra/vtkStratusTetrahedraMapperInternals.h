// SPDX-License-Identifier: BSD-3-Clause
// State that vtkStratusTetrahedraMapper keeps between pictures. Private to the module.
#ifndef vtkStratusTetrahedraMapperInternals_h
#define vtkStratusTetrahedraMapperInternals_h

#include "vtkStratusBlocks.h"
#include "vtkStratusCellFinder.h"
#include "vtkStratusContext.h"
#include "vtkStratusDisplay.h"
#include "vtkStratusLeftOut.h"
#include "vtkStratusSurfaces.h"
#include "vtkStratusMeshDescription.h"
#include "vtkStratusMeshMask.h"
#include "vtkStratusMeshView.h"
#include "vtkStratusPicture.h"
#include "vtkStratusQuantities.h"
#include "vtkStratusTetrahedraMapper.h"
#include "vtkStratusVectors.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"
#include "vtkVolumeProperty.h"
#include "vtkWeakPointer.h"

#include <array>
#include <string>
#include <vector>

class vtkDataSet;
class vtkMatrix4x4;

class VTK_STRATUS_PRIVATE vtkStratusTetrahedraMapper::Internals
{
public:
  explicit Internals(vtkStratusTetrahedraMapper* mapper);
  ~Internals();

  // Draws a whole picture. `error` stays empty where an abort ended it.
  bool Render(vtkRenderer* renderer, vtkVolume* prop, std::string& error);
  bool PrepareContext(std::string& error);
  // Describes the updated input to another module's picture. On failure the description's error says why.
  bool Describe(vtkRenderer* renderer, vtkVolume* prop, vtkStratusMeshDescription& description);
  // Of what a structured grid or the blocks of a composite data set show; nullptr for other input.
  const double* FindBounds();
  vtkImageData* GetLastImage();
  vtkTypeUInt64 GetFunctionBuilds() const;
  vtkIdType GetNumberOfIgnoredCells() const { return this->Mesh.GetLeftOut(); }

  vtkStratusTetrahedraMapper* Mapper;
  stratus_tetra_caster* Caster = nullptr;
  vtkStratusContext Context;
  stratus_tetra_report Report = stratus_tetra_report();
  vtkNew<vtkTable> BuildReport;
  vtkStratusDisplay Display;
  std::string LastError; // of the last picture, reported already; empty: none

private:
  bool OnProgress(double fraction);
  bool CheckMapper(std::string& error) const;
  void NoteLeftOut(vtkVolumeProperty* property);
  // The drawn part of the input, and its scalars: a grid, or several structured ones.
  struct Drawn {
    vtkDataSet* Grid;
    vtkDataArray* Scalars;
    bool Cells;
    const vtkStratusBlocks::Lattices* Several;
  };
  vtkDataArray* FindScalars(vtkDataSet* grid, int& cells, std::string& error);
  bool FindDrawn(Drawn& drawn, std::string& error);
  bool SetMesh(const Drawn& drawn, vtkMatrix4x4* matrix, std::string& error);
  bool PrepareInput(vtkVolume* prop, bool& empty, std::string& error);
  bool SetMask(vtkVolumeProperty* property, std::string& error);
  // Whether the mask is a label map, and whether that is drawn.
  bool HasLabelMap() const { return this->Mapper->MaskInput && this->Mapper->MaskType == LabelMapMaskType; }
  bool HasLabels() const { return this->HasLabelMap() && this->GetMode() == STRATUS_TETRA_COMPOSITE; }
  stratus_tetra_mode GetMode() const; // by render mode and blend mode
  bool SetTransfers(vtkVolumeProperty* property, std::string& error);
  bool SetClipPlanes(stratus_tetra_options& options, std::string& error) const;
  bool SetOptions(vtkVolumeProperty* property, stratus_tetra_options& options, std::string& error) const;
  bool SetMode(vtkVolumeProperty* property, stratus_tetra_options& options, std::string& error) const;
  bool SetShading(vtkRenderer* renderer, vtkVolume* volume, stratus_tetra_options& options, std::string& error);
  stratus_ray_cast_input InputOf(const stratus_tetra_options& options);
  bool Cast(vtkRenderer* renderer, stratus_tetra_options& options, const float* opaqueDepth, std::string& error);

  vtkRenderer* Renderer = nullptr; // set while rendering
  vtkStratusMeshView Mesh;
  vtkStratusMeshMask Mask;
  const stratus_mesh* Shown = nullptr;           // the mesh without the cells that a mask hides, or with the labels of one
  std::vector<vtkStratusTransferView> Transfers; // at least one per independent component, or per label
  std::vector<stratus_transfer> Functions;
  std::array<stratus_material, STRATUS_COMPONENTS_MAX> Materials{};
  vtkStratusPicture Picture;
  vtkStratusQuantities Quantities; // of the picture
  bool HasPicture = false;
  vtkStratusVectors Vectors;
  vtkWeakPointer<vtkVolumeProperty> Property; // its colour function selects the component that is drawn
  vtkStratusBlocks Blocks;
  std::string LastLeftOut;     // blocks that a warning has named
  vtkStratusLeftOut LeftOut;   // settings that the last picture did not use
  vtkStratusSurfaces Surfaces; // that hide the last picture's lights
  double Box[6] = { 0, 0, 0, 0, 0, 0 };
  std::vector<float> Rgba, Depth, PartDepth;
  stratus_tetra_options Options; // of the last picture
  vtkStratusCellFinder Finder;
  vtkSmartPointer<vtkImageData> LastImage;
};

#endif
