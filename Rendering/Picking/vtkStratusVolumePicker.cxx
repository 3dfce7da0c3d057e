// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumePicker.h"

#include "vtkStratusMultiVolume.h"
#include "vtkStratusPickRay.h"
#include "vtkStratusTetrahedra.h"
#include "vtkStratusTetrahedraMapper.h"
#include "vtkStratusVectors.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkAssemblyPath.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPropCollection.h"
#include "vtkRectilinearGrid.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkStructuredGrid.h"
#include "vtkTransform.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <map>

vtkStandardNewMacro(vtkStratusVolumePicker);

class vtkStratusVolumePicker::Internals
{
public:
  // A nearer hit in a data set. Returns whether there is one.
  bool Pick(vtkStratusPickRay ray, vtkDataSet* data, vtkAbstractVolumeMapper* mapper, vtkVolumeProperty* property, vtkStratusPickHit& hit);

private:
  // Of a grid as it was divided last.
  struct Divided {
    vtkSmartPointer<vtkUnstructuredGrid> Grid;
    vtkMTimeType Time = 0;
    vtkStratusTetrahedra Parts;
    bool Accepted = false;
  };
  const Divided& Divide(vtkUnstructuredGrid* grid);

  std::map<vtkUnstructuredGrid*, Divided> Known;
};

const vtkStratusVolumePicker::Internals::Divided& vtkStratusVolumePicker::Internals::Divide(vtkUnstructuredGrid* grid)
{
  Divided& one = this->Known[grid];
  if (one.Grid != grid || one.Time != grid->GetMTime()) {
    for (auto other = this->Known.begin(); other != this->Known.end();) { // grids that nobody else has any more
      other = other->second.Grid && other->second.Grid->GetReferenceCount() == 1 ? this->Known.erase(other) : std::next(other);
    }
    std::string error;
    one.Grid = grid;
    one.Time = grid->GetMTime();
    one.Parts = vtkStratusTetrahedra();
    one.Accepted = one.Parts.Set(grid, error);
  }
  return one;
}

bool vtkStratusVolumePicker::Internals::Pick(
  vtkStratusPickRay ray, vtkDataSet* data, vtkAbstractVolumeMapper* mapper, vtkVolumeProperty* property, vtkStratusPickHit& hit)
{
  int where = 0;
  vtkDataArray* array = data->GetNumberOfPoints() > 0 ? vtkAbstractMapper::GetScalars(data, mapper->GetScalarMode(),
                                                          mapper->GetArrayAccessMode(), mapper->GetArrayId(), mapper->GetArrayName(), where)
                                                      : nullptr;
  ray.OfCells = where == 1;
  ray.Nearest = property->GetInterpolationType() == VTK_NEAREST_INTERPOLATION;
  if (!array || where > 1 || array->GetNumberOfTuples() < (ray.OfCells ? data->GetNumberOfCells() : data->GetNumberOfPoints())) {
    return false;
  }
  const int components = array->GetNumberOfComponents();
  int component = components > 1 && !property->GetIndependentComponents() ? components - 1 : 0;
  bool magnitude = false;
  if (vtkStratusVolumeMapper* rays = vtkStratusVolumeMapper::SafeDownCast(mapper)) {
    magnitude = rays->GetVectorMode() == vtkStratusVolumeMapper::MAGNITUDE && components > 1;
    component =
      rays->GetVectorMode() == vtkStratusVolumeMapper::COMPONENT ? std::min(rays->GetVectorComponent(), components - 1) : component;
    ray.CropPlanes = rays->GetCropping() ? rays->GetCroppingRegionPlanes() : nullptr;
    ray.CropRegions = rays->GetCroppingRegionFlags();
  } else if (vtkStratusTetrahedraMapper* march = vtkStratusTetrahedraMapper::SafeDownCast(mapper)) {
    const int wanted = vtkStratusVectors::Find(property, components);
    magnitude = wanted == vtkStratusVectors::Magnitude;
    component = wanted >= 0 ? std::min(wanted, components - 1) : component;
    ray.CropPlanes = march->GetCropping() ? march->GetCroppingRegionPlanes() : nullptr;
  }
  ray.Value = [=](vtkIdType tuple) {
    double sum = 0.0;
    for (int c = 0; magnitude && c < components; ++c) {
      sum += array->GetComponent(tuple, c) * array->GetComponent(tuple, c);
    }
    return magnitude ? std::sqrt(sum) : array->GetComponent(tuple, component);
  };
  if (vtkImageData::SafeDownCast(data) || vtkRectilinearGrid::SafeDownCast(data)) {
    return vtkStratusPickLattice(ray, data, hit);
  }
  if (vtkStructuredGrid* curved = vtkStructuredGrid::SafeDownCast(data)) {
    return vtkStratusPickStructured(ray, curved, hit);
  }
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(data);
  if (!grid) {
    return false;
  }
  const Divided& divided = this->Divide(grid);
  vtkNew<vtkDoubleArray> plain, values;
  if (divided.Accepted && !ray.OfCells) {
    plain->SetNumberOfValues(grid->GetNumberOfPoints());
    for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
      plain->SetValue(i, ray.Value(i));
    }
    values->SetNumberOfValues(static_cast<vtkIdType>(divided.Parts.Points.size() / 3));
    divided.Parts.CopyPointValues(plain, values);
  }
  return divided.Accepted && vtkStratusPickTetrahedra(ray, grid, divided.Parts, values, hit);
}

vtkStratusVolumePicker::vtkStratusVolumePicker() : Internal(new Internals) {}
vtkStratusVolumePicker::~vtkStratusVolumePicker() = default;

// VTK passes over a prop without a mapper, as a vtkStratusMultiVolume is.
int vtkStratusVolumePicker::Pick3DInternal(vtkRenderer* renderer, double p1[4], double p2[4])
{
  int picked = this->Superclass::Pick3DInternal(renderer, p1, p2);
  vtkPropCollection* props = this->GetPickFromList() ? this->GetPickList() : renderer->GetViewProps();
  vtkCollectionSimpleIterator each;
  props->InitTraversal(each);
  while (vtkProp* prop = props->GetNextProp(each)) {
    vtkStratusMultiVolume* several = vtkStratusMultiVolume::SafeDownCast(prop);
    if (several && several->GetVisibility() && several->GetPickable() && this->PickSeveral(several, p1, p2)) {
      picked = 1;
    }
  }
  return picked;
}

// Each volume has its own matrix to world coordinates.
bool vtkStratusVolumePicker::PickSeveral(vtkStratusMultiVolume* several, const double p1[4], const double p2[4])
{
  bool picked = false;
  several->InitPathTraversal();
  vtkAssemblyPath* path = several->GetNextPath();
  for (int port = 0; port < 8; ++port) {
    vtkVolume* volume = several->GetVolume(port);
    if (!volume || !volume->GetVisibility() || !volume->GetMapper()) {
      continue;
    }
    vtkNew<vtkMatrix4x4> inverse;
    vtkMatrix4x4::Invert(volume->GetMatrix(), inverse);
    double own[2][4];
    inverse->MultiplyPoint(p1, own[0]);
    inverse->MultiplyPoint(p2, own[1]);
    const double before = this->GlobalTMin;
    const double t = this->IntersectWithLine(own[0], own[1], 0.0, path, volume, volume->GetMapper());
    if (t < before) {
      vtkDataSet* const data = this->DataSet;
      this->Transform->SetMatrix(volume->GetMatrix());
      double place[3] = { this->MapperPosition[0], this->MapperPosition[1], this->MapperPosition[2] };
      this->MarkPicked(path, several, volume->GetMapper(), t, place);
      this->DataSet = data;
      this->Transform->Identity();
      picked = true;
    }
  }
  return picked;
}

double vtkStratusVolumePicker::IntersectVolumeWithLine(
  const double p1[3], const double p2[3], double t1, double t2, vtkProp3D* prop, vtkAbstractVolumeMapper* mapper)
{
  vtkVolume* volume = vtkVolume::SafeDownCast(prop);
  const bool ours = vtkStratusVolumeMapper::SafeDownCast(mapper) || vtkStratusTetrahedraMapper::SafeDownCast(mapper);
  const bool image = vtkImageData::SafeDownCast(mapper->GetDataObjectInput()) != nullptr;
  if (!volume || !ours || (image && (this->UseVolumeGradientOpacity || this->PickCroppingPlanes))) {
    return this->Superclass::IntersectVolumeWithLine(p1, p2, t1, t2, prop, mapper);
  }
  vtkStratusPickRay ray;
  std::copy(p1, p1 + 3, ray.P1);
  std::copy(p2, p2 + 3, ray.P2);
  ray.Begin = t1;
  ray.End = t2;
  ray.Opacity = volume->GetProperty()->GetScalarOpacity(0);
  ray.Bound = this->VolumeOpacityIsovalue;
  vtkStratusPickHit hit;
  vtkDataSet* picked = nullptr;
  vtkIdType block = -1;
  vtkCompositeDataSet* whole = vtkCompositeDataSet::SafeDownCast(mapper->GetDataObjectInput());
  if (whole) {
    const auto each = vtkSmartPointer<vtkCompositeDataIterator>::Take(whole->NewIterator());
    for (each->InitTraversal(); !each->IsDoneWithTraversal(); each->GoToNextItem()) {
      vtkDataSet* data = vtkDataSet::SafeDownCast(each->GetCurrentDataObject());
      if (data && this->Internal->Pick(ray, data, mapper, volume->GetProperty(), hit)) {
        picked = data;
        block = static_cast<vtkIdType>(each->GetCurrentFlatIndex());
      }
    }
  } else if (vtkDataSet* data = vtkDataSet::SafeDownCast(mapper->GetDataObjectInput())) {
    picked = this->Internal->Pick(ray, data, mapper, volume->GetProperty(), hit) ? data : nullptr;
  }
  if (!picked || !(hit.T < this->GlobalTMin)) {
    return hit.T;
  }
  this->ResetPickInfo();
  this->Mapper = mapper;
  this->DataSet = picked;
  this->CompositeDataSet = whole;
  this->FlatBlockIndex = block;
  this->CellId = hit.Cell;
  this->PointId = hit.Point;
  this->SubId = 0;
  std::copy(hit.PCoords, hit.PCoords + 3, this->PCoords);
  std::copy(hit.CellIJK, hit.CellIJK + 3, this->CellIJK);
  std::copy(hit.PointIJK, hit.PointIJK + 3, this->PointIJK);
  double along[3];
  vtkMath::Subtract(p2, p1, along);
  for (int a = 0; a < 3; ++a) {
    this->MapperPosition[a] = p1[a] + hit.T * along[a];
  }
  const bool sloped = vtkMath::Normalize(hit.Gradient) > 0.0;
  const double* from = sloped ? hit.Gradient : along;
  const double side = vtkMath::Dot(from, along) > 0.0 ? -1.0 : 1.0;
  for (int a = 0; a < 3; ++a) {
    this->MapperNormal[a] = side * from[a];
  }
  vtkMath::Normalize(this->MapperNormal);
  return hit.T;
}

void vtkStratusVolumePicker::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
