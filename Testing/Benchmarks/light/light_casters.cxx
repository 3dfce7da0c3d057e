// SPDX-License-Identifier: BSD-3-Clause
// Kinds of light, and the casters that draw them.
#include "light_bench.h"

#include <cmath>

namespace bench {

const std::vector<lighting>& all_lighting()
{
  // Phong shading has vtkVolumeProperty's default material, as in stratus-bench volume. A matter that scatters evenly, of albedo 1 times
  // its colour, shows colours as bright as the unlit ones.
  static const std::vector<lighting> all = {
    { "local", false, 0.1, 0.7, 0.2, 0, 0.0, 0.0, -1 },
    { "shadows", true, 0.1, 0.7, 0.2, 1, 0.0, 0.0, -1 },
    { "single", true, 0.0, 1.0, 0.0, 1, 1.0, 0.0, 1 },
    { "multiple", true, 0.0, 1.0, 0.0, 1, 1.0, 0.0, 0 },
    { "path", true, 0.0, 1.0, 0.0, 1, 1.0, 0.0, 0 },
  };
  return all;
}

stratus_light sun_of(const light_subject& s)
{
  stratus_light sun = stratus_light();
  const stratus_camera& first = s.cameras.front();
  const double length = std::hypot(first.right[0], first.right[1], first.right[2]);
  for (int a = 0; a < 3; ++a) {
    sun.vector[a] = first.right[a] / length + (a == s.up_axis ? 0.7 : 0.0);
    sun.color[a] = 1.0;
  }
  return sun;
}

stratus_shading shading_of(const light_subject& s, const lighting& l, const stratus_camera& camera)
{
  stratus_shading shading = shading_of(camera); // a headlight
  shading.ambient = l.ambient;
  shading.diffuse = l.diffuse;
  shading.specular = l.specular;
  shading.shadows = l.shadows;
  shading.scattering = l.scattering;
  shading.anisotropy = l.anisotropy;
  shading.multiple = l.bounces == 0;
  if (l.sun) {
    shading.lights[0] = sun_of(s);
  }
  return shading;
}

void light_caster::move_light()
{
  this->Shading->lights[0].vector[0] *= this->Moved ? 1.0 / (1.0 + 1e-9) : 1.0 + 1e-9;
  this->Moved = !this->Moved;
}

namespace {

void check(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    throw failure(std::string(stratus_status_name(status)) + ": " + stratus_context_message(context));
  }
}

stratus_image image_of(int size, float* rgba)
{
  stratus_image image = stratus_image();
  image.width = image.height = size;
  image.rgba = rgba;
  return image;
}

// A headlight moves with the camera, as VTK's does.
stratus_shading casters_shading(const light_subject& s, const lighting& l)
{
  stratus_shading shading = shading_of(s, l, s.cameras.front());
  if (!l.sun) {
    shading.lights[0].follows_camera = 1;
    shading.lights[0].vector[0] = shading.lights[0].vector[1] = 0.0;
    shading.lights[0].vector[2] = 1.0;
  }
  return shading;
}

class volume_caster : public light_caster
{
public:
  volume_caster(stratus_context* context, const light_subject& s, const lighting* l, double tolerance)
      : Context(context), Subject(s), Functions(transfers_of(*s.volume)), Options(stratus_ray_cast_options_default())
  {
    this->Options.sampling.tolerance = tolerance;
    if (l) {
      this->Options.light.shade = 1;
      this->Options.light.shading = casters_shading(s, *l);
    }
    this->Shading = &this->Options.light.shading;
    check(context, stratus_ray_caster_create(context, &this->Caster));
  }
  ~volume_caster() override { stratus_ray_caster_destroy(this->Caster); }
  volume_caster(const volume_caster&) = delete;
  volume_caster& operator=(const volume_caster&) = delete;

  report draw(const stratus_camera& camera, int size, float* rgba) override
  {
    stratus_ray_cast_report r;
    const stratus_image image = image_of(size, rgba);
    check(this->Context,
      stratus_ray_caster_render(this->Caster, &this->Subject.volume->volume, this->Functions.data(), &camera, &this->Options, &image, &r));
    const bool shadows = this->Options.light.shade && this->Options.light.shading.shadows;
    report result;
    result.maps_ms = shadows ? r.light_ms : -1.0;
    result.maps_bytes = shadows ? static_cast<double>(r.light_bytes) : -1.0;
    result.maps_error = shadows ? r.light_error : -1.0;
    result.expected_error = std::isnan(r.expected_error) ? -1.0 : r.expected_error;
    result.samples = static_cast<double>(r.samples);
    return result;
  }

private:
  stratus_context* Context;
  const light_subject& Subject;
  std::vector<stratus_transfer> Functions;
  stratus_ray_cast_options Options;
  stratus_ray_caster* Caster = nullptr;
};

class mesh_caster : public light_caster
{
public:
  mesh_caster(stratus_context* context, const light_subject& s, const lighting* l, double tolerance)
      : Context(context), Mesh(s.mesh->view()), Function(s.function.view()), Options(stratus_tetra_options_default())
  {
    this->Options.tolerance = tolerance;
    if (l) {
      this->Options.shade = 1;
      this->Options.shading = casters_shading(s, *l);
    }
    this->Shading = &this->Options.shading;
    check(context, stratus_tetra_caster_create(context, &this->Caster));
  }
  ~mesh_caster() override { stratus_tetra_caster_destroy(this->Caster); }
  mesh_caster(const mesh_caster&) = delete;
  mesh_caster& operator=(const mesh_caster&) = delete;

  report draw(const stratus_camera& camera, int size, float* rgba) override
  {
    stratus_tetra_report r;
    const stratus_image image = image_of(size, rgba);
    check(this->Context, stratus_tetra_caster_render(this->Caster, &this->Mesh, &this->Function, &camera, &this->Options, &image, &r));
    report result;
    result.samples = static_cast<double>(r.segments);
    return result;
  }

private:
  stratus_context* Context;
  stratus_mesh Mesh;
  stratus_transfer Function;
  stratus_tetra_options Options;
  stratus_tetra_caster* Caster = nullptr;
};
} // namespace

std::unique_ptr<light_caster> make_caster(stratus_context* context, const light_subject& s, const lighting* l, double tolerance)
{
  if (s.mesh) {
    return std::make_unique<mesh_caster>(context, s, l, tolerance);
  }
  return std::make_unique<volume_caster>(context, s, l, tolerance);
}
} // namespace bench
