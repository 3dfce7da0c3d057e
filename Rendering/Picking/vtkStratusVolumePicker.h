// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVolumePicker
 * @brief   picks the first cell of a volume along a ray in which the scalar opacity reaches VolumeOpacityIsovalue
 *
 * vtkVolumePicker supports only point values of images: it misplaces picks of cell values, and finds none in rectilinear and unstructured
 * grids. This class picks all data that vtkStratusVolumeMapper and vtkStratusTetrahedraMapper draw: images and rectilinear grids with point
 * or cell values, structured and unstructured grids, the blocks of composite data, and each volume of a vtkStratusMultiVolume. The
 * superclass handles other props, and images if UseVolumeGradientOpacity or PickCroppingPlanes is on.
 *
 * Along the ray the field is the one in the frame: linear or nearest as the property's interpolation says, in tetrahedra linear. The pick
 * is the first place whose scalar opacity reaches VolumeOpacityIsovalue. It is found exactly, however narrow a peak of the opacity is: a
 * ray's segment in a cell is cut at the extrema of the field, and the opacity is examined over whole intervals of values. Crop regions (of
 * grids of cells: the box), clip planes, ghosts and blanking count; blend modes, masks, labels and gradient opacity do not. If there are
 * several components, VectorMode says which one counts, otherwise the first, or the last of dependent ones.
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
