// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVolumePicker
 * @brief   picks the cell of a volume where the field first becomes as opaque as is asked for
 *
 * vtkVolumePicker knows point values of images alone: of cell values it takes other places, and of rectilinear and unstructured grids none.
 * This one takes what vtkStratusVolumeMapper and vtkStratusTetrahedraMapper draw: images and rectilinear grids with values of points or
 * cells, structured and unstructured grids, the blocks of composite data, and each volume of a vtkStratusMultiVolume. Other props are the
 * superclass's, and so are images where UseVolumeGradientOpacity or PickCroppingPlanes is on.
 *
 * Along the ray the field is what the picture shows: linear or nearest as the property's interpolation says, in tetrahedra linear. Picked
 * is the first place whose scalar opacity reaches VolumeOpacityIsovalue. It is found exactly, however narrow a peak of the opacity is:
 * a ray's way through a cell is cut where the field turns, and opacities are asked over whole intervals of values. Crop regions (of grids
 * of cells: the box), clip planes, ghosts and blanking count; blend modes, masks, labels and gradient opacity do not. Of several
 * components, VectorMode says which counts, else the first one, or of dependent ones the last.
 *
 * GetCellId() and GetPointId() (the nearest of the cell's points) are of GetDataSet(), GetPCoords() is the place in the cell; of images and
 * rectilinear grids, GetCellIJK() and GetPointIJK() count from 0 of the structured coordinates, extents included. Of composite data,
 * GetDataSet() is the block and GetFlatBlockIndex() its number. GetPickNormal() points against the field's gradient or along it, towards
 * the eye.
 *
 * @sa vtkStratusVolumeMapper vtkStratusTetrahedraMapper vtkStratusMultiVolume
 */
#ifndef vtkStratusVolumePicker_h
#define vtkStratusVolumePicker_h

#include "StratusRenderingPickingModule.h" // For export macro
#include "vtkVolumePicker.h"

#include <memory> // For std::unique_ptr

class vtkStratusMultiVolume;

class STRATUSRENDERINGPICKING_EXPORT vtkStratusVolumePicker : public vtkVolumePicker
{
public:
  static vtkStratusVolumePicker* New();
  vtkTypeMacro(vtkStratusVolumePicker, vtkVolumePicker);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkStratusVolumePicker();
  ~vtkStratusVolumePicker() override;

  int Pick3DInternal(vtkRenderer* renderer, double p1World[4], double p2World[4]) override;
  double IntersectVolumeWithLine(
    const double p1[3], const double p2[3], double t1, double t2, vtkProp3D* prop, vtkAbstractVolumeMapper* mapper) override;

private:
  vtkStratusVolumePicker(const vtkStratusVolumePicker&) = delete;
  void operator=(const vtkStratusVolumePicker&) = delete;

  bool PickSeveral(vtkStratusMultiVolume* several, const double p1[4], const double p2[4]);

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
