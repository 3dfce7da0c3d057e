// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSurfaces.h"

#include "vtkActor.h"
#include "vtkAssemblyNode.h"
#include "vtkAssemblyPath.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCompositeDataDisplayAttributes.h"
#include "vtkCompositePolyDataMapper.h"
#include "vtkDataSetMapper.h"
#include "vtkDataSetSurfaceFilter.h"
#include "vtkIdList.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkPolygon.h"
#include "vtkPropCollection.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkVersionMacros.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <vector>

// The mapper whose attributes hide blocks.
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 3, 0)
using BlockMapper = vtkCompositePolyDataMapper;
#else
#include "vtkCompositePolyDataMapper2.h"
using BlockMapper = vtkCompositePolyDataMapper2;
#endif

namespace {

// A part of an actor, as it is in the world.
struct Surface {
  vtkDataSet* Data;
  vtkMTimeType Time;
  std::array<double, 16> Matrix;
  std::vector<std::array<double, 4>> Planes; // in the world: normal and constant, at least 0 where the surface is seen

  bool operator==(const Surface& other) const
  {
    return this->Data == other.Data && this->Time == other.Time && this->Matrix == other.Matrix && this->Planes == other.Planes;
  }
};

std::vector<std::array<double, 4>> PlanesOf(vtkMapper* mapper)
{
  std::vector<std::array<double, 4>> planes;
  vtkPlaneCollection* given = mapper->GetClippingPlanes();
  for (int i = 0; given && i < given->GetNumberOfItems(); ++i) {
    double normal[3], origin[3];
    given->GetItem(i)->GetNormal(normal);
    given->GetItem(i)->GetOrigin(origin);
    planes.push_back({ normal[0], normal[1], normal[2], -(normal[0] * origin[0] + normal[1] * origin[1] + normal[2] * origin[2]) });
  }
  return planes;
}

// Calls `add` with the blocks that the mapper draws as opaque. A block without attributes has its parent's. attributes: nullptr: no block
// has.
void VisitBlocks(vtkDataObject* data, vtkCompositeDataDisplayAttributes* attributes, bool shown, bool opaque,
  const std::function<void(vtkDataObject*)>& add)
{
  if (attributes && data && attributes->HasBlockVisibility(data)) {
    shown = attributes->GetBlockVisibility(data);
  }
  if (attributes && data && attributes->HasBlockOpacity(data)) {
    opaque = attributes->GetBlockOpacity(data) >= 1.0;
  }
  if (auto* blocks = vtkMultiBlockDataSet::SafeDownCast(data)) {
    for (unsigned int i = 0; i < blocks->GetNumberOfBlocks(); ++i) {
      VisitBlocks(blocks->GetBlock(i), attributes, shown, opaque, add);
    }
  } else if (auto* sets = vtkPartitionedDataSetCollection::SafeDownCast(data)) {
    for (unsigned int i = 0; i < sets->GetNumberOfPartitionedDataSets(); ++i) {
      VisitBlocks(sets->GetPartitionedDataSet(i), attributes, shown, opaque, add);
    }
  } else if (auto* parts = vtkPartitionedDataSet::SafeDownCast(data)) {
    for (unsigned int i = 0; i < parts->GetNumberOfPartitions(); ++i) {
      VisitBlocks(parts->GetPartitionAsDataObject(i), attributes, shown, opaque, add);
    }
  } else if (shown && opaque) {
    add(data);
  }
}

void AddActor(vtkActor* actor, vtkMatrix4x4* matrix, std::vector<Surface>& surfaces)
{
  vtkMapper* mapper = actor->GetMapper();
  vtkProperty* property = actor->GetProperty();
  if (!mapper || !actor->GetVisibility() || property->GetRepresentation() != VTK_SURFACE || !property->GetLighting() ||
    !actor->HasOpaqueGeometry()) {
    return;
  }
  const bool grids = vtkDataSetMapper::SafeDownCast(mapper) != nullptr;
  if ((!grids && !vtkPolyDataMapper::SafeDownCast(mapper) && !vtkCompositePolyDataMapper::SafeDownCast(mapper)) ||
    mapper->GetNumberOfInputConnections(0) < 1) {
    return; // glyphs, and lines and texts of annotations
  }
  Surface surface;
  std::copy_n(matrix->GetData(), 16, surface.Matrix.begin());
  surface.Planes = PlanesOf(mapper);
  BlockMapper* blocks = BlockMapper::SafeDownCast(mapper);
  VisitBlocks(
    mapper->GetInputDataObject(0, 0), blocks ? blocks->GetCompositeDataDisplayAttributes() : nullptr, true, true, [&](vtkDataObject* data) {
      vtkPolyData* polygons = vtkPolyData::SafeDownCast(data);
      surface.Data = polygons || grids ? vtkDataSet::SafeDownCast(data) : nullptr;
      if (surface.Data &&
        (polygons ? polygons->GetNumberOfPolys() + polygons->GetNumberOfStrips() : surface.Data->GetNumberOfCells()) > 0) {
        surface.Time = surface.Data->GetMTime();
        surfaces.push_back(surface);
      }
    });
}

// Adds the part of a triangle that is in front of all planes.
void AddTriangle(const Surface& surface, const std::array<double, 3> corners[3], std::vector<double>& points)
{
  std::vector<std::array<double, 3>> polygon(corners, corners + 3), kept;
  for (const std::array<double, 4>& plane : surface.Planes) {
    const auto height = [&plane](const std::array<double, 3>& p) { return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3]; };
    kept.clear();
    for (size_t i = 0; i < polygon.size(); ++i) {
      const std::array<double, 3>&a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double from = height(a), to = height(b);
      if (from >= 0.0) {
        kept.push_back(a);
      }
      if ((from >= 0.0) != (to >= 0.0)) {
        const double part = from / (from - to);
        kept.push_back({ a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2]) });
      }
    }
    polygon.swap(kept);
  }
  for (size_t i = 1; i + 1 < polygon.size(); ++i) {
    for (const size_t corner : { size_t(0), i, i + 1 }) {
      points.insert(points.end(), polygon[corner].begin(), polygon[corner].end());
    }
  }
}

bool IsFinite(const std::array<double, 3>& place)
{
  return std::all_of(place.begin(), place.end(), [](double x) { return std::isfinite(x); });
}

// Returns the surface that a vtkDataSetMapper draws of the data. VTK does not draw an actor that is out of view: then the mapper's own
// surface is missing, or is of older data.
vtkSmartPointer<vtkPolyData> PolygonsOf(vtkDataSet* data)
{
  if (vtkPolyData* polygons = vtkPolyData::SafeDownCast(data)) {
    return polygons;
  }
  vtkNew<vtkDataSetSurfaceFilter> filter;
  filter->SetInputData(data);
  filter->Update();
  return filter->GetOutput();
}

// Adds the triangles of a surface. A cell hides no light if one of its points is missing or not finite: VTK does not draw it, either.
void AddTriangles(const Surface& surface, std::vector<double>& points)
{
  const vtkSmartPointer<vtkPolyData> data = PolygonsOf(surface.Data);
  vtkPoints* given = data->GetPoints();
  const vtkIdType beyond = given ? given->GetNumberOfPoints() : 0;
  const auto exist = [beyond](const vtkIdType* cell, vtkIdType count) {
    return std::all_of(cell, cell + count, [beyond](vtkIdType point) { return point >= 0 && point < beyond; });
  };
  const auto place = [&surface, given](vtkIdType point) {
    double from[3];
    std::array<double, 3> to;
    given->GetPoint(point, from);
    for (size_t row = 0; row < 3; ++row) {
      const double* m = surface.Matrix.data() + 4 * row;
      to[row] = m[0] * from[0] + m[1] * from[1] + m[2] * from[2] + m[3];
    }
    return to;
  };
  const auto add = [&](vtkIdType a, vtkIdType b, vtkIdType c) {
    const std::array<double, 3> corners[3] = { place(a), place(b), place(c) };
    if (std::all_of(corners, corners + 3, IsFinite)) {
      AddTriangle(surface, corners, points);
    }
  };
  vtkIdType count;
  const vtkIdType* cell;
  vtkNew<vtkIdList> triangles;
  vtkNew<vtkPolygon> polygon;
  vtkNew<vtkPoints> corners;
  const auto polys = vtk::TakeSmartPointer(data->GetPolys()->NewIterator());
  for (polys->GoToFirstCell(); !polys->IsDoneWithTraversal(); polys->GoToNextCell()) {
    polys->GetCurrentCell(count, cell);
    if (count < 3 || !exist(cell, count)) {
      continue;
    }
    if (count == 3) {
      add(cell[0], cell[1], cell[2]);
      continue;
    }
    polygon->Initialize(static_cast<int>(count), cell, given);
    polygon->Triangulate(0, triangles, corners);
    for (vtkIdType i = 0; i + 2 < triangles->GetNumberOfIds(); i += 3) {
      add(triangles->GetId(i), triangles->GetId(i + 1), triangles->GetId(i + 2));
    }
  }
  const auto strips = vtk::TakeSmartPointer(data->GetStrips()->NewIterator());
  for (strips->GoToFirstCell(); !strips->IsDoneWithTraversal(); strips->GoToNextCell()) {
    strips->GetCurrentCell(count, cell);
    const bool exists = exist(cell, count);
    for (vtkIdType i = 0; exists && i + 2 < count; ++i) {
      add(cell[i], cell[i + 1], cell[i + 2]);
    }
  }
}

} // namespace

struct vtkStratusSurfaces::Triangles {
  std::vector<Surface> Of;
  std::vector<double> Points;
  stratus_surfaces Core = {};
};

bool vtkStratusSurfaces::TakeShadows(vtkRenderer* renderer, const stratus_ray_cast_input* inputs, int count)
{
  return !renderer->GetSelector() && !renderer->GetUseDepthPeelingForVolumes() &&
    std::any_of(inputs, inputs + count, [](const stratus_ray_cast_input& input) {
      const stratus_shading& shading = input.mesh ? input.tetra_options->shading : input.options->light.shading;
      return shading.shadows && shading.shadow_length == 0.0 && shading.surfaces && shading.surfaces->triangle_count > 0;
    });
}

const stratus_surfaces* vtkStratusSurfaces::Find(vtkRenderer* renderer)
{
  static std::mutex mutex;
  static std::map<vtkRenderer*, std::weak_ptr<const Triangles>> known;
  static std::atomic<uint64_t> revisions{ 0 };
  std::vector<Surface> surfaces;
  vtkCollectionSimpleIterator props;
  renderer->GetViewProps()->InitTraversal(props);
  while (vtkProp* prop = renderer->GetViewProps()->GetNextProp(props)) {
    if (prop->GetVisibility()) {
      prop->InitPathTraversal();
      while (vtkAssemblyPath* path = prop->GetNextPath()) {
        vtkAssemblyNode* last = path->GetLastNode();
        vtkActor* actor = vtkActor::SafeDownCast(last->GetViewProp());
        if (actor && last->GetMatrix()) {
          AddActor(actor, last->GetMatrix(), surfaces);
        }
      }
    }
  }
  const std::lock_guard<std::mutex> lock(mutex);
  for (auto it = known.begin(); it != known.end();) {
    it = it->second.expired() ? known.erase(it) : std::next(it);
  }
  std::shared_ptr<const Triangles> found = known[renderer].lock();
  if (!found || !(found->Of == surfaces)) {
    const auto made = std::make_shared<Triangles>();
    for (const Surface& surface : surfaces) {
      AddTriangles(surface, made->Points);
    }
    made->Of = std::move(surfaces);
    made->Core.points = made->Points.data();
    made->Core.triangle_count = made->Points.size() / 9;
    made->Core.revision = ++revisions;
    known[renderer] = found = made;
  }
  this->Found = found;
  return &this->Found->Core;
}
