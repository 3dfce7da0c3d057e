// SPDX-License-Identifier: BSD-3-Clause
// Light, gradient opacity and several components. Each is compared with the double reference, and each setter shows in the picture.
// (stratus-bench volume, scenes +shade and plume2, measures how far VTK's own mappers are from that reference.)
#include "mapper_testing.h"

#include "vtkLight.h"
#include "vtkLightCollection.h"

namespace {
// Limit in dB against the double reference at 1/16 voxel, for midpoint samples of .25. The rest is the sampling's own error, lit or not.
const double WantedDb = 50.0;

void Fine(Scene& scene)
{
  scene.Mapper->SetSampleDistance(0.25);
  scene.Mapper->SetSamplingToMidpoint();
}

stratus_shading ReferenceShading(Scene& scene)
{
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  stratus_shading shading = stratus_ray_cast_options_default().light.shading;
  shading.ambient = property->GetAmbient();
  shading.diffuse = property->GetDiffuse();
  shading.specular = property->GetSpecular();
  shading.specular_power = property->GetSpecularPower();
  shading.one_sided = scene.Renderer->GetTwoSidedLighting() ? 0 : 1;
  shading.light_count = 0;
  vtkLightCollection* lights = scene.Renderer->GetLights();
  for (int i = 0; i < lights->GetNumberOfItems(); ++i) {
    vtkLight* light = vtkLight::SafeDownCast(lights->GetItemAsObject(i));
    double position[3], focal[3];
    light->GetTransformedPosition(position);
    light->GetTransformedFocalPoint(focal);
    stratus_light& to = shading.lights[shading.light_count++];
    to.positional = light->GetPositional();
    to.separate_specular = 1;
    for (int a = 0; a < 3; ++a) {
      to.vector[a] = position[a] - (to.positional ? 0.0 : focal[a]);
      to.color[a] = light->GetIntensity() * light->GetDiffuseColor()[a];
      to.specular_color[a] = light->GetIntensity() * light->GetSpecularColor()[a];
      to.attenuation[a] = light->GetAttenuationValues()[a];
      to.axis[a] = focal[a] - position[a];
    }
    to.cone_angle = light->GetConeAngle();
    to.cone_exponent = light->GetExponent();
  }
  return shading;
}

double LitPsnr(Scene& scene)
{
  const stratus_shading shading = ReferenceShading(scene);
  return ReferencePsnr(scene, [&](reference_scene& reference) { reference.shading = &shading; });
}

void Shading()
{
  Scene scene;
  Fine(scene);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const double plain = scene.Light();
  property->ShadeOn();
  property->SetAmbient(0.2);
  property->SetDiffuse(0.7);
  property->SetSpecular(0.3);
  property->SetSpecularPower(12.0);
  const double lit = scene.Light();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  CHECK(std::fabs(lit - plain) > 0.02 * plain, "ShadeOn shows no light: %g of %g", lit, plain);
  double db = LitPsnr(scene);
  std::printf("the renderer's own light: %.1f dB\n", db);
  CHECK(db >= WantedDb, "%.1f dB", db);

  vtkNew<vtkLight> sun, lamp;
  sun->SetPosition(3, 1, -2);
  sun->SetDiffuseColor(1, 0.5, 0.2);
  lamp->SetPositional(1);
  lamp->SetConeAngle(90);
  lamp->SetPosition(40, 60, 50);
  lamp->SetIntensity(0.6);
  scene.Renderer->RemoveAllLights();
  scene.Renderer->AddLight(sun);
  scene.Renderer->AddLight(lamp);
  scene.Render();
  db = LitPsnr(scene);
  std::printf("sun and lamp: %.1f dB\n", db);
  CHECK(db >= WantedDb, "%.1f dB", db);

  const double white = scene.Light();
  sun->SetSpecularColor(0.1, 0, 0.9);
  lamp->SetSpecularColor(0, 0.5, 0);
  CHECK(scene.Light() < 0.99 * white, "SetSpecularColor changes nothing: %g of %g", scene.Light(), white);
  db = LitPsnr(scene);
  CHECK(db >= WantedDb, "colours of highlights: %.1f dB", db);

  const double two = scene.Light();
  scene.Renderer->TwoSidedLightingOff();
  const double one = scene.Light();
  CHECK(one < 0.97 * two, "TwoSidedLightingOff takes no light: %g of %g", one, two);
  db = LitPsnr(scene);
  CHECK(db >= WantedDb, "one-sided: %.1f dB", db);
  lamp->SwitchOff();
  CHECK(scene.Light() < 0.97 * one, "SwitchOff takes no light");
}

void Setters()
{
  Scene scene;
  Fine(scene);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const std::vector<float> plain = scene.Picture();
  property->ShadeOn();
  property->SetAmbient(1.0);
  property->SetDiffuse(0.0);
  property->SetSpecular(0.0);
  const std::vector<float> ambient = scene.Picture();
  double worst = 0.0;
  for (size_t i = 0; i < plain.size(); ++i) {
    worst = std::max(worst, std::fabs(static_cast<double>(plain[i]) - ambient[i]));
  }
  CHECK(worst < 1e-6, "ambient light of 1 changes colours by %g", worst);
  property->SetAmbient(0.0);
  property->SetDiffuse(0.8);
  const double diffuse = scene.Light();
  property->SetDiffuse(0.4);
  const double half = scene.Light();
  CHECK(half < diffuse, "SetDiffuse does nothing");
  property->SetSpecular(0.5);
  property->SetSpecularPower(5.0);
  const double broad = scene.Light();
  CHECK(broad > half, "SetSpecular does nothing");
  property->SetSpecularPower(100.0);
  CHECK(scene.Light() < broad, "SetSpecularPower does nothing");
  scene.Mapper->AuditOn();
  scene.Render();
  CHECK(scene.Mapper->GetDifferingPixels() == 0, "%llu pixels differ", static_cast<unsigned long long>(scene.Mapper->GetDifferingPixels()));
}

void GradientOpacity()
{
  Scene scene;
  Fine(scene);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const double plain = scene.Light();
  vtkNew<vtkPiecewiseFunction> steep;
  steep->AddPoint(0.05, 0.0);
  steep->AddPoint(0.1, 0.1);
  steep->AddPoint(0.3, 1.0);
  property->SetGradientOpacity(steep);
  const double thinned = scene.Light();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  CHECK(thinned < 0.9 * plain && thinned > 0.05 * plain, "gradient opacity: %g of %g", thinned, plain);
  const double points[] = { 0.05, 0.0, 0.1, 0.1, 0.3, 1.0 };
  stratus_transfer transfer;
  const double db = ReferencePsnr(scene, [&](reference_scene& reference) {
    transfer = *reference.transfer;
    transfer.gradient = points;
    transfer.gradient_count = 3;
    reference.transfer = &transfer;
  });
  std::printf("gradient opacity: %.1f dB\n", db);
  CHECK(db >= WantedDb, "%.1f dB", db);
  property->DisableGradientOpacityOn();
  CHECK(scene.Light() == plain, "DisableGradientOpacityOn does not");
}

// Two components: the scene's field, and one of its own.
vtkSmartPointer<vtkFloatArray> TwoComponents(vtkImageData* image)
{
  auto array = vtkSmartPointer<vtkFloatArray>::New();
  array->SetNumberOfComponents(2);
  array->SetName("two");
  int n[3];
  image->GetDimensions(n);
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const double x = static_cast<double>(i) / (n[0] - 1), y = static_cast<double>(j) / (n[1] - 1),
                     z = static_cast<double>(k) / (n[2] - 1);
        array->InsertNextTuple2(Field(x, y, z), 10.0 * Field(y, 1.0 - x, z));
      }
    }
  }
  image->GetPointData()->SetScalars(array);
  return array;
}

// The second component's functions, and both components' in the core's terms.
struct TwoMedia {
  explicit TwoMedia(vtkVolumeProperty* property)
  {
    this->Opacity->AddPoint(1.0, 0.0);
    this->Opacity->AddPoint(10.0, 0.4);
    this->Green->AddRGBPoint(0.0, 0.0, 1.0, 0.2);
    property->SetScalarOpacity(1, this->Opacity);
    property->SetColor(1, this->Green);
    property->SetScalarOpacityUnitDistance(1, 2.0);
    for (int c = 0; c < 2; ++c) {
      this->Transfers[c].opacity = this->Opacities[c];
      this->Transfers[c].opacity_count = 3;
      this->Transfers[c].color = this->Colors[c];
      this->Transfers[c].color_count = c ? 1 : 3;
      this->Transfers[c].unit_distance = c ? 2.0 : 1.5;
    }
  }
  vtkNew<vtkPiecewiseFunction> Opacity;
  vtkNew<vtkColorTransferFunction> Green;
  const double Opacities[2][6] = { { 0.1, 0.0, 0.4, 0.15, 1.0, 0.5 }, { 1.0, 0.0, 10.0, 0.4, 11.0, 0.4 } };
  const double Colors[2][12] = { { 0.0, 0.1, 0.2, 0.9, 0.5, 0.9, 0.8, 0.3, 1.0, 1.0, 0.2, 0.1 }, { 0.0, 0.0, 1.0, 0.2 } };
  stratus_transfer Transfers[2] = { stratus_transfer_default(), stratus_transfer_default() };
};

double ComponentsPsnr(Scene& scene, vtkFloatArray* array, const stratus_transfer* transfers, int dependent)
{
  stratus_volume volume;
  return ReferencePsnr(scene, [&](reference_scene& reference) {
    volume = *reference.volume;
    volume.components = array->GetNumberOfComponents();
    volume.value_stride = volume.components;
    reference.volume = &volume;
    reference.transfer = transfers;
    reference.dependent = dependent;
  });
}

void Components()
{
  Scene scene;
  Fine(scene);
  const double single = scene.Light();
  const vtkSmartPointer<vtkFloatArray> array = TwoComponents(scene.Image);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  TwoMedia media(property);
  const double both = scene.Light();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  CHECK(both > 1.1 * single, "a second component adds no light: %g and %g", both, single);

  double db = ComponentsPsnr(scene, array, media.Transfers, 0);
  std::printf("two independent components: %.1f dB\n", db);
  CHECK(db >= WantedDb, "%.1f dB", db);
  property->SetComponentWeight(1, 0.3);
  media.Transfers[1].weight = 0.3;
  CHECK(scene.Light() < 0.97 * both, "SetComponentWeight takes no light");
  db = ComponentsPsnr(scene, array, media.Transfers, 0);
  CHECK(db >= WantedDb, "with a weight: %.1f dB", db);
  property->SetComponentWeight(1, 0.0);
  CHECK(std::fabs(scene.Light() - single) < 1e-3 * single, "a component of weight 0 shows");

  property->IndependentComponentsOff();
  property->SetScalarOpacity(media.Opacity);
  media.Transfers[0].opacity = media.Opacities[1];
  scene.Render();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  db = ComponentsPsnr(scene, array, media.Transfers, 1);
  std::printf("two dependent components: %.1f dB\n", db);
  CHECK(db >= WantedDb, "%.1f dB", db);
  scene.Mapper->AuditOn();
  scene.Render();
  CHECK(scene.Mapper->GetDifferingPixels() == 0, "%llu pixels differ", static_cast<unsigned long long>(scene.Mapper->GetDifferingPixels()));
}

// Colours as they are, opacity from the fourth.
void Rgba()
{
  Scene scene;
  Fine(scene);
  vtkNew<vtkUnsignedCharArray> array;
  array->SetNumberOfComponents(4);
  for (vtkIdType i = 0; i < scene.Image->GetNumberOfPoints(); ++i) {
    array->InsertNextTuple4(255, 51, 0, 255.0 * scene.Image->GetPointData()->GetScalars()->GetComponent(i, 0));
  }
  scene.Image->GetPointData()->SetScalars(array);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(20.0, 0.0);
  opacity->AddPoint(255.0, 0.5);
  scene.Volume->GetProperty()->SetScalarOpacity(opacity);
  scene.Volume->GetProperty()->IndependentComponentsOff();
  const std::vector<float> picture = scene.Picture();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  int shown = 0;
  double worst = 0.0;
  for (size_t p = 0; p < picture.size(); p += 4) {
    shown += picture[p + 3] > 0.1f;
    worst = std::max({ worst, std::fabs(static_cast<double>(picture[p]) - picture[p + 3]),
      std::fabs(picture[p + 1] - 0.2 * static_cast<double>(picture[p + 3])), std::fabs(static_cast<double>(picture[p + 2])) });
  }
  CHECK(shown > 1000 && worst < 1e-5, "%d pixels show, colours are wrong by %g", shown, worst);
}

// A label map without functions of labels leaves several components as they are.
void LabelsOfNone()
{
  Scene scene;
  vtkNew<vtkImageData> image, map;
  for (vtkImageData* each : { image.Get(), map.Get() }) {
    each->SetDimensions(9, 8, 7);
    each->AllocateScalars(VTK_UNSIGNED_CHAR, each == image ? 3 : 1);
    for (vtkIdType v = 0; v < each->GetPointData()->GetScalars()->GetNumberOfValues(); ++v) {
      static_cast<unsigned char*>(each->GetScalarPointer())[v] = static_cast<unsigned char>(v % 5 % 3);
    }
  }
  scene.Mapper->SetInputData(image);
  scene.Renderer->ResetCamera();
  const std::vector<float> plain = scene.Picture();
  scene.Mapper->SetMaskInput(map);
  scene.Mapper->SetMaskTypeToLabelMap();
  scene.Render();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  CHECK(scene.Errors->Count > 0 || scene.Picture() == plain, "a label map without functions changes three components");
}

// The right half of the image is label 1, a slab below label 7, which has no functions.
void Labels()
{
  Scene scene;
  Fine(scene);
  vtkNew<vtkImageData> map;
  int n[3];
  scene.Image->GetDimensions(n);
  map->SetDimensions(n);
  map->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  unsigned char* labels = static_cast<unsigned char*>(map->GetScalarPointer());
  for (vtkIdType v = 0; v < map->GetNumberOfPoints(); ++v) {
    labels[v] = v % n[0] > n[0] / 2 ? 1 : v / (n[0] * n[1]) < 6 ? 7 : 0;
  }
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const std::vector<float> plain = scene.Picture();
  scene.Mapper->SetMaskInput(map);
  scene.Mapper->SetMaskTypeToLabelMap();
  CHECK(scene.Picture() == plain, "labels without functions change the picture");
  vtkNew<vtkColorTransferFunction> green;
  green->AddRGBPoint(0.0, 0.0, 1.0, 0.0);
  vtkNew<vtkPiecewiseFunction> thin;
  thin->AddPoint(0.2, 0.0);
  thin->AddPoint(1.0, 0.2);
  property->SetLabelColor(1, green);
  const std::vector<float> colored = scene.Picture();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  double opacity = 0.0, shown = 0.0;
  for (size_t p = 0; p < plain.size(); p += 4) {
    opacity = std::max(opacity, std::fabs(static_cast<double>(plain[p + 3]) - colored[p + 3]));
    shown += colored[p + 1] > plain[p + 1] + 0.05f && colored[p] < plain[p];
  }
  CHECK(opacity < 1e-5 && shown > 300, "SetLabelColor: opacity changes by %g, %g pixels are greener", opacity, shown);
  property->SetLabelScalarOpacity(1, thin);
  scene.Render();

  const double opacities[2][6] = { { 0.1, 0.0, 0.4, 0.15, 1.0, 0.5 }, { 0.2, 0.0, 1.0, 0.2 } };
  const double colors[2][12] = { { 0.0, 0.1, 0.2, 0.9, 0.5, 0.9, 0.8, 0.3, 1.0, 1.0, 0.2, 0.1 }, { 0.0, 0.0, 1.0, 0.0 } };
  stratus_transfer transfers[2] = { stratus_transfer_default(), stratus_transfer_default() };
  for (int l = 0; l < 2; ++l) {
    transfers[l].opacity = opacities[l];
    transfers[l].opacity_count = l ? 2 : 3;
    transfers[l].color = colors[l];
    transfers[l].color_count = l ? 1 : 3;
    transfers[l].unit_distance = 1.5;
  }
  scene.Mapper->SetSampleDistance(0.05); // labels are steps, which samples meet to the first order only
  scene.Render();
  const double db = ReferencePsnr(scene, [&](reference_scene& reference) {
    reference.transfer = transfers;
    reference.labels = labels;
    reference.label_count = 1;
  });
  std::printf("labels: %.1f dB\n", db);
  CHECK(db >= 45.0, "%.1f dB", db);
  vtkNew<vtkPiecewiseFunction> steep;
  steep->AddPoint(0.02, 0.1);
  steep->AddPoint(0.2, 1.0);
  const double gradients[] = { 0.02, 0.1, 0.2, 1.0 };
  property->SetLabelGradientOpacity(1, steep);
  transfers[1].gradient = gradients;
  transfers[1].gradient_count = 2;
  scene.Render();
  const double thinned = ReferencePsnr(scene, [&](reference_scene& reference) {
    reference.transfer = transfers;
    reference.labels = labels;
    reference.label_count = 1;
  });
  std::printf("labels, one with a gradient opacity: %.1f dB\n", thinned);
  CHECK(thinned >= 45.0, "%.1f dB", thinned);
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

// Two components in one light: one shines, and one is not lit.
void Materials()
{
  Scene scene;
  Fine(scene);
  const vtkSmartPointer<vtkFloatArray> array = TwoComponents(scene.Image);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  TwoMedia media(property);
  for (int shining = 0; shining < 2; ++shining) { // the first component, too, may be the one that is not lit
    const stratus_material lit = { 1, 0.1, 0.6, 0.4, 9.0 }, plain = { 0, 0.1, 0.7, 0.2, 10.0 };
    stratus_material materials[2] = { plain, plain };
    materials[shining] = lit;
    for (int c = 0; c < 2; ++c) {
      property->SetShade(c, materials[c].shade);
      property->SetAmbient(c, materials[c].ambient);
      property->SetDiffuse(c, materials[c].diffuse);
      property->SetSpecular(c, materials[c].specular);
      property->SetSpecularPower(c, materials[c].specular_power);
    }
    scene.Render();
    CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
    const stratus_shading shading = ReferenceShading(scene);
    stratus_volume volume;
    const double db = ReferencePsnr(scene, [&](reference_scene& reference) {
      volume = *reference.volume;
      volume.components = array->GetNumberOfComponents();
      volume.value_stride = volume.components;
      reference.volume = &volume;
      reference.transfer = media.Transfers;
      reference.shading = &shading;
      reference.materials = materials;
    });
    std::printf("component %d of 2 is lit: %.1f dB\n", shining, db);
    CHECK(db >= WantedDb, "component %d is lit: %.1f dB", shining, db);
  }
}

// A lamp whose light gets weaker with the distance and ends at a cone, in composite pictures and in first hits.
void Lamps()
{
  Scene scene;
  Fine(scene);
  scene.Mapper->SetSampleDistance(0.05); // the cone's border is a step
  scene.Volume->GetProperty()->ShadeOn();
  vtkNew<vtkLight> lamp;
  lamp->SetPositional(1);
  lamp->SetPosition(40, 60, 50);
  lamp->SetFocalPoint(14, 14, 13);
  lamp->SetIntensity(30);
  lamp->SetConeAngle(5);
  lamp->SetExponent(20);
  lamp->SetAttenuationValues(0.2, 0.1, 0.01);
  scene.Renderer->RemoveAllLights();
  scene.Renderer->AddLight(lamp);
  const double narrow = scene.Light();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  const double db = LitPsnr(scene);
  std::printf("a dim cone of light: %.1f dB\n", db);
  CHECK(db >= 45.0, "%.1f dB", db);
  lamp->SetConeAngle(90);
  const double wide = scene.Light();
  CHECK(wide > 1.02 * narrow, "without the cone there is no more light: %g, %g", wide, narrow);
  lamp->SetAttenuationValues(1, 0, 0);
  CHECK(scene.Light() > 1.5 * wide, "attenuation takes no light");
  scene.Mapper->SetRenderModeToFirstHit();
  lamp->SetIntensity(1);
  const double all = scene.Light();
  lamp->SetConeAngle(4);
  const double some = scene.Light();
  CHECK(some < 0.97 * all, "first hits have no cone: %g of %g", some, all);
  lamp->SetAttenuationValues(0, 0, 1);
  CHECK(scene.Light() < 0.97 * some, "first hits have no attenuation");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

double Brightness(const std::vector<float>& picture)
{
  double sum = 0.0;
  for (size_t i = 0; i < picture.size(); ++i) {
    sum += i % 4 < 3 ? static_cast<double>(picture[i]) : 0.0;
  }
  return sum / static_cast<double>(picture.size());
}

// The core's test compares shadows with a reference; here the settings reach it.
void Shadows()
{
  Scene scene(96, 80);
  scene.Volume->GetProperty()->ShadeOn();
  scene.Renderer->RemoveAllLights();
  vtkNew<vtkLight> sun;
  sun->SetLightTypeToSceneLight();
  sun->SetPosition(3.0, 1.0, 2.0);
  sun->SetFocalPoint(0.0, 0.0, 0.0);
  scene.Renderer->AddLight(sun);
  const std::vector<float> bright = scene.Picture();
  scene.Mapper->ShadowsOn();
  const std::vector<float> shadowed = scene.Picture();
  CHECK(Brightness(shadowed) < 0.98 * Brightness(bright), "shadows leave %g of %g", Brightness(shadowed), Brightness(bright));
  for (size_t i = 3; i < bright.size(); i += 4) {
    CHECK(std::abs(bright[i] - shadowed[i]) < 0.02F, "shadows change the opacity of pixel %zu", i / 4);
  }
  scene.Mapper->SetVolumetricScatteringBlending(3.0);
  CHECK(scene.Mapper->GetVolumetricScatteringBlending() == 2.0, "blending %g", scene.Mapper->GetVolumetricScatteringBlending());
  const std::vector<float> scattered = scene.Picture();
  scene.Mapper->ShadowsOff(); // scattered light has them
  CHECK(scattered != shadowed && scene.Picture() == scattered, "scattered light");
  scene.Mapper->SetScatteringAnisotropy(0.8);
  CHECK(scene.Picture() != scattered, "the anisotropy changes nothing");
  scene.Mapper->SetScatteringAnisotropy(0.0);
  double before = Brightness(scattered);
  for (const double reach : { 0.3, 0.1, 0.0 }) { // the shorter shadows are, the less is dark
    scene.Mapper->SetGlobalIlluminationReach(reach);
    const double now = Brightness(scene.Picture());
    CHECK(now > 1.02 * before, "a reach of %g: %g of %g", reach, now, before);
    before = now;
  }
  scene.Mapper->SetGlobalIlluminationReach(2.0);
  CHECK(scene.Mapper->GetGlobalIlluminationReach() == 1.0 && scene.Picture() == scattered, "a reach of 1 is not the whole way");
  scene.Mapper->MultipleScatteringOn();
  const std::vector<float> many = scene.Picture();
  CHECK(Brightness(many) > 1.02 * Brightness(scattered), "scattered again: %g of %g", Brightness(many), Brightness(scattered));
  scene.Mapper->SetSkyZenith(0.5, 0.5, 0.5);
  scene.Mapper->SetSkyUp(0.0, 1.0, 0.0);
  CHECK(Brightness(scene.Picture()) > 1.02 * Brightness(many), "the sky adds nothing");
  scene.Mapper->SetSkyZenith(-1.0, 0.0, 0.0);
  scene.Render();
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("sky"), "a dark sky: %s", scene.Errors->Text.c_str());
  scene.Errors->Count = 0;
  scene.Mapper->SetSkyZenith(0.0, 0.0, 0.0);
  scene.Mapper->MultipleScatteringOff();
  scene.Mapper->SetScatteringAnisotropy(-2.0);
  CHECK(scene.Mapper->GetScatteringAnisotropy() == -0.99, "anisotropy %g", scene.Mapper->GetScatteringAnisotropy());
  scene.Mapper->SetScatteringAnisotropy(0.0);
  scene.Mapper->SetVolumetricScatteringBlending(0.0);
  CHECK(scene.Picture() == bright && scene.Errors->Count == 0, "without them: %s", scene.Errors->Text.c_str());
}

void OwnSun()
{
  Scene scene(96, 80);
  scene.Volume->GetProperty()->ShadeOn();
  const std::vector<float> headlight = scene.Picture();
  vtkNew<vtkLight> sun;
  sun->SetPosition(3.0, 1.0, 2.0);
  sun->SetDiffuseColor(0.9, 0.6, 0.3);
  scene.Mapper->SetSun(sun);
  CHECK(scene.Mapper->GetSun() == sun, "GetSun() returns another light");
  const std::vector<float> own = scene.Picture();
  scene.Mapper->SetSun(nullptr);
  CHECK(scene.Picture() == headlight && own != headlight, "without the sun, the renderer's light is back");
  scene.Renderer->RemoveAllLights();
  scene.Renderer->AddLight(sun);
  CHECK(scene.Picture() == own, "the volume's own sun lights as a light of the renderer");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

// Each pixel's colour is encoded by the standard's formula before it is blended.
void ScreenEncoding()
{
  Scene scene(96, 80);
  for (const double level : { 0.0, 0.2 }) {
    scene.Renderer->SetBackground(level, level, level);
    scene.Mapper->ScreenEncodingOff();
    const std::vector<float> linear = scene.Picture();
    const std::vector<unsigned char> plain = scene.Bytes();
    scene.Mapper->ScreenEncodingOn();
    CHECK(scene.Picture() == linear, "the image of the mapper is not linear");
    const std::vector<unsigned char> shown = scene.Bytes();
    double worst = 0.0;
    for (size_t i = 0; i < linear.size(); ++i) {
      const double alpha = linear[4 * (i / 4) + 3], own = alpha > 0.0 ? linear[i] / alpha : 0.0;
      const double encoded = own <= 0.0031308 ? 12.92 * own : 1.055 * std::pow(own, 1.0 / 2.4) - 0.055;
      worst = i % 4 < 3 ? std::max(worst, std::fabs(255.0 * (alpha * encoded + (1.0 - alpha) * level) - shown[i])) : worst;
    }
    CHECK(worst < 0.6, "a level of the screen is off by %.2f of 255", worst); // a rounding, and a table; the background is 51 of 255
    CHECK(shown != plain && scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  }
}

void Refusals()
{
  Scene scene;
  vtkNew<vtkFloatArray> three;
  three->SetNumberOfComponents(3);
  three->SetNumberOfTuples(scene.Image->GetNumberOfPoints());
  three->Fill(0.5);
  scene.Image->GetPointData()->SetScalars(three);
  scene.Volume->GetProperty()->IndependentComponentsOff();
  scene.Render();
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("3 dependent"), "%s", scene.Errors->Text.c_str());
}
} // namespace

int main()
{
  Shading();
  Setters();
  GradientOpacity();
  Components();
  Rgba();
  Labels();
  LabelsOfNone();
  Materials();
  Lamps();
  Shadows();
  OwnSun();
  ScreenEncoding();
  Refusals();
  std::printf("%d failures\n", Failures);
  return Failures ? 1 : 0;
}
