// SPDX-License-Identifier: BSD-3-Clause
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/RayIntersector.h>

#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/Ray.h>
#include <nanovdb/util/SampleFromVoxels.h>

#include "vdb_mapper.h"
#include "reference.h"

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRenderer.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtk_glew.h>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>

namespace bench {

vtkStandardNewMacro(vdb_mapper);

namespace {

using intersector = openvdb::tools::VolumeRayIntersector<openvdb::MaskGrid>;
constexpr int table_size = 4096;

struct entry {
  float rgba[4]; // premultiplied, for one step
};

struct view {
  openvdb::Vec3d eye, forward, right, up; // the ray of (u, v), within -1..1, has direction forward + u right + v up
};

view view_of(vtkRenderer* renderer)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  const double half = std::tan(camera->GetViewAngle() * std::acos(-1.0) / 360.0);
  const int* viewport = renderer->GetSize();
  view v;
  double direction[3];
  v.eye = openvdb::Vec3d(camera->GetPosition());
  camera->GetDirectionOfProjection(direction);
  v.forward = openvdb::Vec3d(direction);
  v.right = v.forward.cross(openvdb::Vec3d(camera->GetViewUp())).unit();
  v.up = v.right.cross(v.forward) * half;
  v.right *= half * viewport[0] / viewport[1];
  return v;
}
} // namespace

struct vdb_mapper::inside {
  stratus_volume volume;
  double step = 1.0;
  bool nano = false; // then the NanoVDB grids, copies of the OpenVDB grids, are drawn
  openvdb::FloatGrid::Ptr values;
  openvdb::MaskGrid::Ptr shown; // its leaves cover the cells that show something
  nanovdb::GridHandle<> nano_values, nano_shown;
  std::unique_ptr<intersector> rays;
  std::vector<entry> table;
  double low = 0.0, high = 1.0;
  vtkMTimeType built = 0;
  std::atomic<unsigned long long> samples{ 0 };
  std::vector<uint8_t> bytes;

  double value(size_t at) const { return reference_value_at(&this->volume, static_cast<int64_t>(at)); }
  void make_grid();
  void make_table(vtkVolumeProperty* property);
  void make_topology();
  template <typename Walk> void cast(const view& v, int width, int height);
  template <typename Walk> unsigned long long trace(Walk& walk, float* pixel) const;
};

namespace {

// The part of a ray that a thread marches along. Times are world lengths, because a direction corresponds to one world unit.
class open_walk
{
public:
  open_walk(const intersector& rays, const openvdb::FloatGrid& values, const nanovdb::FloatGrid*, const nanovdb::MaskGrid*)
      : Spans(rays), Accessor(values.getConstAccessor()), Sampler(Accessor, values.transform())
  {
  }
  // Clips the ray to 0..last, because leaves extend beyond the volume. eye, direction and last are in voxels.
  bool start(const openvdb::Vec3d& eye, const openvdb::Vec3d& direction, const openvdb::Vec3d& last)
  {
    this->Ray = intersector::RayType(eye, direction, 1e-6, 1e30);
    return this->Ray.clip(openvdb::BBoxd(openvdb::Vec3d(0.0), last)) && this->Spans.setIndexRay(this->Ray);
  }
  bool next(double& from, double& to) { return this->Spans.march(from, to); }
  float value(double t) { return this->Sampler.isSample(this->Ray(t)); }

private:
  using accessor = openvdb::FloatGrid::ConstAccessor;
  intersector Spans;
  accessor Accessor;
  openvdb::tools::GridSampler<accessor, openvdb::tools::BoxSampler> Sampler;
  intersector::RayType Ray;
};

// The same by NanoVDB. TreeMarcher needs directions of length 1 in voxels.
class nano_walk
{
public:
  nano_walk(const intersector&, const openvdb::FloatGrid&, const nanovdb::FloatGrid* values, const nanovdb::MaskGrid* shown)
      : Shown(shown->getAccessor()), Accessor(values->getAccessor()), Spans(Shown), Sampler(Accessor)
  {
  }
  bool start(const openvdb::Vec3d& eye, const openvdb::Vec3d& direction, const openvdb::Vec3d& last)
  {
    this->Length = direction.length();
    this->Ray = ray(vector(eye), vector(direction / this->Length));
    return this->Ray.clip(nanovdb::BBox<nanovdb::Vec3f>(nanovdb::Vec3f(0.0f), vector(last))) && this->Spans.init(this->Ray);
  }
  bool next(double& from, double& to)
  {
    const leaf* hit;
    float t[2];
    const bool found = this->Spans.step(&hit, t[0], t[1]);
    from = t[0] / this->Length;
    to = t[1] / this->Length;
    return found;
  }
  float value(double t) { return this->Sampler(this->Ray(static_cast<float>(t * this->Length))); }

private:
  using ray = nanovdb::Ray<float>;
  using leaf = nanovdb::NanoLeaf<nanovdb::ValueMask>;
  using accessor = nanovdb::FloatGrid::AccessorType;
  static nanovdb::Vec3f vector(const openvdb::Vec3d& v)
  {
    return nanovdb::Vec3f(static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
  }
  nanovdb::MaskGrid::AccessorType Shown;
  accessor Accessor;
  nanovdb::TreeMarcher<leaf, ray, nanovdb::MaskGrid::AccessorType> Spans;
  nanovdb::SampleFromVoxels<accessor, 1> Sampler;
  ray Ray;
  double Length = 1.0; // voxels in a world unit along the ray
};
} // namespace

void vdb_mapper::inside::make_grid()
{
  const int64_t* n = this->volume.dimensions;
  std::vector<float> dense(static_cast<size_t>(n[0] * n[1] * n[2]));
  this->low = this->high = this->value(0);
  for (size_t i = 0; i < dense.size(); ++i) {
    const double v = this->value(i);
    dense[i] = static_cast<float>(v);
    this->low = std::min(this->low, v);
    this->high = std::max(this->high, v);
  }
  const openvdb::CoordBBox box(0, 0, 0, static_cast<int>(n[0]) - 1, static_cast<int>(n[1]) - 1, static_cast<int>(n[2]) - 1);
  openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> layout(box, dense.data());
  this->values = openvdb::FloatGrid::create(static_cast<float>(this->low));
  openvdb::tools::copyFromDense(layout, *this->values, 0.0f);
  if (this->nano) {
    this->nano_values = nanovdb::openToNanoVDB(*this->values);
  }
}

void vdb_mapper::inside::make_table(vtkVolumeProperty* property)
{
  vtkPiecewiseFunction* opacity = property->GetScalarOpacity();
  vtkColorTransferFunction* color = property->GetRGBTransferFunction();
  this->table.resize(table_size + 1);
  for (int i = 0; i <= table_size; ++i) {
    const double value = this->low + (this->high - this->low) * i / table_size;
    double rgb[3];
    color->GetColor(value, rgb);
    const double alpha = 1.0 - std::pow(1.0 - opacity->GetValue(value), this->step / property->GetScalarOpacityUnitDistance());
    for (int c = 0; c < 3; ++c) {
      this->table[i].rgba[c] = static_cast<float>(rgb[c] * alpha);
    }
    this->table[i].rgba[3] = static_cast<float>(alpha);
  }
}

// Activates the cells whose opacity is not 0 for all values between their lowest and highest corner.
void vdb_mapper::inside::make_topology()
{
  const int64_t* n = this->volume.dimensions;
  std::vector<double> next(table_size + 2, 1e300); // lowest visible value from entry i on
  for (int i = table_size; i >= 0; --i) {
    const double value = this->low + (this->high - this->low) * i / table_size;
    next[i] = this->table[i].rgba[3] > 0.0f ? value : next[i + 1];
  }
  this->shown = openvdb::MaskGrid::create();
  openvdb::MaskGrid::Accessor mark = this->shown->getAccessor();
  const double scale = table_size / std::max(this->high - this->low, 1e-300);
  for (int64_t k = 0; k + 1 < n[2]; ++k) {
    for (int64_t j = 0; j + 1 < n[1]; ++j) {
      for (int64_t i = 0; i + 1 < n[0]; ++i) {
        double lo = 1e300;
        double hi = -1e300;
        for (int c = 0; c < 8; ++c) {
          const double v = this->value(static_cast<size_t>(((k + (c >> 2)) * n[1] + j + (c >> 1 & 1)) * n[0] + i + (c & 1)));
          lo = std::min(lo, v);
          hi = std::max(hi, v);
        }
        if (hi > this->low && next[static_cast<int>((lo - this->low) * scale)] <= hi + 1.0 / scale) {
          mark.setValueOn(openvdb::Coord(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k)));
        }
      }
    }
  }
  this->rays = this->shown->empty() ? nullptr : std::make_unique<intersector>(*this->shown);
  if (this->nano && this->rays) {
    this->nano_shown = nanovdb::openToNanoVDB(*this->shown);
  }
}

// Returns the number of samples.
template <typename Walk> unsigned long long vdb_mapper::inside::trace(Walk& walk, float* pixel) const
{
  const float scale = static_cast<float>(table_size / (this->high - this->low));
  unsigned long long count = 0;
  float left = 1.0f;
  double from = 0.0;
  double to = 0.0;
  while (walk.next(from, to)) {
    for (double t = (std::floor(from / this->step - 0.5) + 1.5) * this->step; t < to; t += this->step) {
      const float value = walk.value(t);
      const int at = std::min(std::max(static_cast<int>((value - static_cast<float>(this->low)) * scale + 0.5f), 0), table_size);
      const entry& e = this->table[static_cast<size_t>(at)];
      ++count;
      for (int c = 0; c < 4; ++c) {
        pixel[c] += left * e.rgba[c];
      }
      left *= 1.0f - e.rgba[3];
      if (left < 0.001f) {
        return count;
      }
    }
  }
  return count;
}

template <typename Walk> void vdb_mapper::inside::cast(const view& v, int width, int height)
{
  this->bytes.assign(4 * static_cast<size_t>(width) * static_cast<size_t>(height), 0);
  this->samples = 0;
  if (!this->rays) {
    return;
  }
  const openvdb::Vec3d spacing(this->volume.spacing);
  const openvdb::Vec3d eye = (v.eye - openvdb::Vec3d(this->volume.origin)) / spacing;
  const int64_t* n = this->volume.dimensions;
  const openvdb::Vec3d last(double(n[0] - 1), double(n[1] - 1), double(n[2] - 1));
  tbb::parallel_for(tbb::blocked_range2d<int>(0, height, 16, 0, width, 16), [&](const tbb::blocked_range2d<int>& tile) {
    Walk walk(*this->rays, *this->values, this->nano_values.grid<float>(), this->nano_shown.grid<nanovdb::ValueMask>());
    unsigned long long count = 0;
    for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
      for (int x = tile.cols().begin(); x < tile.cols().end(); ++x) {
        const openvdb::Vec3d direction =
          (v.forward + ((2.0 * x + 1.0) / width - 1.0) * v.right + ((2.0 * y + 1.0) / height - 1.0) * v.up).unit();
        float pixel[4] = { 0, 0, 0, 0 };
        if (walk.start(eye, direction / spacing, last)) {
          count += this->trace(walk, pixel);
        }
        for (int c = 0; c < 4; ++c) {
          this->bytes[4 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) + static_cast<size_t>(c)] =
            static_cast<uint8_t>(std::min(pixel[c], 1.0f) * 255.0f + 0.5f);
        }
      }
    }
    this->samples += count;
  });
}

vdb_mapper::vdb_mapper() : In(new inside)
{
  openvdb::initialize();
}

vdb_mapper::~vdb_mapper() = default;

void vdb_mapper::set_volume(const stratus_volume& volume, double step, bool nano)
{
  this->In->volume = volume;
  this->In->step = step;
  this->In->nano = nano;
  this->In->values.reset();
}

unsigned long long vdb_mapper::samples() const
{
  return this->In->samples;
}

void vdb_mapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkVolumeProperty* property = volume->GetProperty();
  if (!this->In->values) {
    this->In->make_grid();
    this->In->built = 0;
  }
  if (this->In->built < property->GetMTime()) {
    this->In->make_table(property);
    this->In->make_topology();
    this->In->built = property->GetMTime();
  }
  const int* size = renderer->GetSize();
  if (this->In->nano) {
    this->In->cast<nano_walk>(view_of(renderer), size[0], size[1]);
  } else {
    this->In->cast<open_walk>(view_of(renderer), size[0], size[1]);
  }
  // Draw each texel on its pixel. vtkRayCastImageDisplayHelper would stretch the picture by up to a pixel, an error that is not VDB's.
  // Nothing is behind it, so neither blending nor a depth test is needed.
  auto* target = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  vtkOpenGLState* state = target->GetState();
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable depth(state, GL_DEPTH_TEST);
  state->vtkglDisable(GL_BLEND);
  state->vtkglDisable(GL_DEPTH_TEST);
  target->DrawPixels(0, 0, size[0] - 1, size[1] - 1, 4, VTK_UNSIGNED_CHAR, this->In->bytes.data());
}
} // namespace bench
