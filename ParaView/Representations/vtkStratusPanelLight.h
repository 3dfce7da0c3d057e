// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusPanelLight
 * @brief   light that passes through matter, and clouds in physical units, as ParaView's panel sets them
 *
 * Representations of volumes and of cells have one each, which sets their mapper. Several ranks draw without shadows and scattered light,
 * because a rank does not have the matter of the others, whose shadows would end at its borders. They draw no clouds.
 *
 * A cloud replaces the representation's functions, material and lights in the blend mode composite: values are water in air, and the sun
 * and a clear sky light it as a photograph shows it (stratus/cloud.h).
 *
 * @sa vtkStratusVolumeRepresentation vtkStratusTetrahedraRepresentation
 */
#ifndef vtkStratusPanelLight_h
#define vtkStratusPanelLight_h

#include "StratusParaViewRepresentationsModule.h" // For export macro
#include "vtkObject.h"

#include <memory> // For std::unique_ptr
#include <string> // For std::string

class vtkDataObject;
class vtkInformation;
class vtkPVDataRepresentation;
class vtkStratusTetrahedraMapper;
class vtkStratusVolumeMapper;
class vtkVolumeProperty;

class STRATUSPARAVIEWREPRESENTATIONS_EXPORT vtkStratusPanelLight : public vtkObject
{
public:
  static vtkStratusPanelLight* New();
  vtkTypeMacro(vtkStratusPanelLight, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  void Modified() override;

  //@{
  /**
   * As of the mappers. A cloud has its own values of all but SkyUp.
   */
  vtkSetMacro(Shadows, bool);
  vtkSetMacro(VolumetricScatteringBlending, double);
  vtkSetMacro(ScatteringAnisotropy, double);
  vtkSetMacro(GlobalIlluminationReach, double);
  vtkSetMacro(MultipleScattering, bool);
  vtkSetVector3Macro(SkyZenith, double);
  vtkSetVector3Macro(SkyHorizon, double);
  vtkSetVector3Macro(SkyUp, double);
  //@}

  //@{
  /**
   * Set/Get whether values are water of clouds. Default off.
   */
  vtkSetMacro(Cloud, bool);
  vtkGetMacro(Cloud, bool);
  //@}

  /**
   * Set the unit of the water, such as "g/m3" or "kg/kg" (stratus_cloud_unit()). "auto" (default): the array's own, or kg/m3 if it has
   * none. Mixing ratios are converted by the density of the standard atmosphere at the height above 0 along SkyUp.
   */
  void SetWaterUnits(const char* unit);

  //@{
  /**
   * Set the effective radius of droplets or crystals in um, 0.1..10000 (default 0: 10, of ice 30), and the metres of a world unit
   * (default 0: as the data's MetresPerUnit says, otherwise 1).
   */
  vtkSetMacro(EffectiveRadius, double);
  vtkSetMacro(MetresPerUnit, double);
  //@}

  //@{
  /**
   * Set the sun of a cloud: azimuth, degrees clockwise from north, and elevation, degrees (default 120, 40); or a moment, as
   * stratus_time_parse() reads it ("", the default: by azimuth and elevation), and latitude and longitude in degrees. If SkyUp is along z,
   * x is east and y is north.
   */
  vtkSetVector2Macro(SunPosition, double);
  void SetSunTime(const char* time);
  vtkSetVector2Macro(SunPlace, double);
  //@}

  /**
   * Get the water and the sun of the cloud that was drawn last, or why none is drawn; "" without Cloud.
   */
  const char* GetCloudUsed();

  /**
   * Returns whether shadows and scattered light are left out.
   */
  bool IsLeftOut() const;

  //@{
  /**
   * The representation's part. TakeWater() adds the contents of a cloud of mixing ratios to the representation's own copy of the data. It
   * must be called for new data and for another array; if settings change so that contents do, the user requests its data again. array: as
   * an algorithm's input array. GetWater() returns the name of the array that a cloud draws. Apply() sets a mapper, and returns the
   * property to draw by: `own`, or the cloud's property. mode: the blend mode. TakeProblem() returns the reason why no cloud is drawn, ""
   * without a reason or if it was returned before.
   */
  void SetUser(vtkPVDataRepresentation* user);
  void TakeWater(vtkDataObject* data, vtkInformation* array);
  vtkVolumeProperty* Apply(vtkStratusVolumeMapper* mapper, int mode, vtkVolumeProperty* own);
  vtkVolumeProperty* Apply(vtkStratusTetrahedraMapper* mapper, int mode, vtkVolumeProperty* own);
  std::string TakeProblem();
  const std::string& GetWater() const;
  //@}

protected:
  vtkStratusPanelLight();
  ~vtkStratusPanelLight() override;

private:
  vtkStratusPanelLight(const vtkStratusPanelLight&) = delete;
  void operator=(const vtkStratusPanelLight&) = delete;

  bool NeedsWater() const;
  bool UpdateCloud(vtkVolumeProperty* own);
  template <class Mapper> vtkVolumeProperty* ApplyTo(Mapper* mapper, int mode, vtkVolumeProperty* own);

  class Internals;
  std::unique_ptr<Internals> Internal;
  bool Shadows = false, MultipleScattering = false, Cloud = false;
  double VolumetricScatteringBlending = 0.0, ScatteringAnisotropy = 0.0, GlobalIlluminationReach = 1.0;
  double SkyZenith[3] = { 0.0, 0.0, 0.0 }, SkyHorizon[3] = { 0.0, 0.0, 0.0 }, SkyUp[3] = { 0.0, 0.0, 1.0 };
  std::string WaterUnits = "auto", SunTime;
  double EffectiveRadius = 0.0, MetresPerUnit = 0.0;
  double SunPosition[2] = { 120.0, 40.0 }, SunPlace[2] = { 0.0, 0.0 };
};

#endif
