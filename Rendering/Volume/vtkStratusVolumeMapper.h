// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVolumeMapper
 * @brief   draws a vtkImageData or vtkRectilinearGrid by ray casting that skips transparent regions without changing the picture
 *
 * Replaces vtkSmartVolumeMapper. It draws a vtkImageData, or a vtkRectilinearGrid without resampling it, with the vtkVolume's
 * vtkVolumeProperty and composites the picture with the scene's opaque geometry. Setters with vtkSmartVolumeMapper's names mean the same.
 *
 * Supported are:
 * - point and cell scalars of any numeric type but bits, with linear and nearest interpolation, ghost and blanking arrays;
 * - one layer of points (40x30x1, 1x1xN) as a sheet of a voxel's thickness about them: the image's spacing along that axis, or the mean
 *   spacing of the other axes where it has none, as rectilinear grids have;
 * - the image's extent, spacing, origin and direction, and the volume's matrix;
 * - scalar opacity, colour or grey, ScalarOpacityUnitDistance;
 * - cropping to any of the 27 regions, up to six clipping planes, binary masks, jitter;
 * - the blend modes composite, maximum and minimum intensity, average intensity (AverageIPScalarRange), additive, isosurface
 *   (vtkVolumeProperty::GetIsoSurfaceValues(), up to 16, linear interpolation, every root of the field in each cell), and slice
 *   (SliceFunction: a vtkPlane, vtkSphere, vtkCylinder, vtkCone or vtkQuadric without a transform, in the world);
 * - translucent surfaces peeled with volumes (UseDepthPeelingForVolumes). In composite mode, rays are cast up to each surface, so that the
 *   parts of the volume between surfaces are in depth order. In other modes the whole frame is placed between the surfaces, at its first
 *   depth;
 * - render passes of the renderer (vtkSSAAPass, vtkEDLShading, ...), whose frame buffers may be of another size than the window;
 * - hardware picking, which finds the volume where it is visible;
 * - arrays of any number of components by one component or the magnitude (VectorMode);
 * - pictures as images, not in the window (RenderToImage).
 *
 * Composite mode also supports:
 * - light (Shade; the renderer's lights and TwoSidedLighting, by VTK's formula with the normal and the eye's direction of each sample).
 *   Isosurface mode supports light, too;
 * - gradient opacity, over magnitudes in values per mean spacing as in VTK's mappers. It multiplies the optical depth or, as in VTK, the
 *   opacity (GradientOpacityDistance);
 * - arrays of 2 to 4 components. Independent components are media that mix (ComponentMixing): their optical depths, multiplied by
 *   ComponentWeight, add up or, as in VTK, each counts by its share. Each has its own Shade and material. Dependent components are colour
 *   and opacity (2), or red, green and blue in 0..255 and opacity (4 of up to 16 bits, or float);
 * - two-dimensional transfer functions (TF_2D). Columns cover the range of the values. Rows cover gradient magnitudes from 0 to a quarter
 *   of that range per mean spacing, as in VTK's mapper, or the range of a second array (Transfer2DYAxisArray). Opacities are per
 *   ScalarOpacityUnitDistance. Sampling is by the midpoint rule only, with a step that keeps ImageErrorTolerance;
 * - UseClippedVoxelIntensity: gradients at clipping planes use ClippedVoxelIntensity beyond the planes (vtkImageData, one component);
 * - label maps, with colours, opacities and gradient opacities of their own.
 *
 * Lights of all kinds shine, with attenuation and cones (vtkLight; a ConeAngle of 90 and more is none).
 *
 * Maximum, minimum, average and additive draw each of 2 to 4 independent components by itself, and add their weighted colours, as VTK's
 * mappers do. Slices mix them as composite mode mixes them at a sample. Isosurfaces show the surfaces of each component, first hits the
 * nearest hit of any, with opacities times ComponentWeight; VTK's mapper shows only the component of the greatest weight. Of dependent
 * components, extremes keep the last one's value, isosurfaces cut it, slices and first hits show it by its opacity, each in the colour of
 * the others at that place; average and additive take the last one's opacity times the first one's value, as VTK's mappers do.
 *
 * Cropping planes are along the image's own axes, as in VTK's mappers: at origin + spacing * index, before the direction matrix. Planes
 * that are taken from GetBounds() may miss a mirrored or turned image; a warning says so.
 *
 * Colours are those that GetColor() of the property's function returns, also where a vtkDiscretizableColorTransferFunction discretises and
 * where lookup is indexed, which VTK's mappers ignore.
 *
 * If the mode does not use a setting, the setting is ignored, as VTK's mappers ignore it, and each mapper warns once: Shade outside of
 * composite, isosurface and first hits; GradientOpacity, label maps and functions of two variables outside of composite; functions of
 * labels without a label map; transforms of clipping planes and of SliceFunction.
 *
 * Other data and the prop's own shaders are refused by an error, and nothing is drawn. Calls listed as *kept* in docs/vtk-parity.md have
 * no effect.
 *
 * RenderModeToFirstHit draws voxels of opacity > 0 as solids in the light of the renderer, and writes their depth. The property's Shade,
 * Ambient, Diffuse, Specular and SpecularPower apply. A voxel of point data is a box about its point, halfway to the next ones, so that
 * the mapper's bounds extend half a voxel farther.
 *
 * RenderModeToPath shows the light that the matter scatters by random paths, without a model: the reference of
 * VolumetricScatteringBlending 2, and of MultipleScattering where that is on. A Render() adds paths for PathSeconds, and continues the last
 * picture if nothing has changed. Until PathTolerance is reached it invokes vtkCommand::UpdateEvent, so that a program can draw the
 * next one. Images of one component, without labels and gradient opacity. Surfaces end its rays, and take and cast no shadows.
 *
 * Values that a reader left in their file as bricks (vtkStratusVariableReader::SetMapFile()) are read while rays meet them. While a picture
 * has to wait for bricks, pictures of a moving camera are of a coarse copy, which is kept since the file was drawn first; and if something
 * observes vtkCommand::UpdateEvent, the first picture is, too: the program can draw the exact one when it gets the event
 * (GetLastPictureIsCoarse()).
 *
 * The tree of an image that carries one (vtkStratusHybridTreeFilter) is used if it serves the transfer function: by first hits and by
 * HYBRID_STRUCTURE always, by AUTO_STRUCTURE where it is faster.
 *
 * The mapper keeps what it builds: a new picture of the same data rebuilds nothing, a new transfer function rebuilds only tables and the
 * structure.
 *
 * Volumes of one renderer are drawn by depth, in whatever order they were added. Volumes whose boxes do not overlap, as cropping and
 * clipping planes leave them, are drawn from back to front. Volumes that overlap are mixed along the rays, as by vtkStratusMultiVolume; in
 * such a group, the vtkStratusVolumeMapper whose volume has the lowest corner sets what the mapper at the lowest port sets there. If the
 * group can't be mixed, its volumes are drawn one over the other, the one with the nearest middle last, and a warning gives the reason,
 * once a renderer. A volume of another class's mapper is drawn in its place among the renderer's props, and a warning says so if that is
 * the wrong place. Hardware selectors draw each volume by itself, up to the first one that shows.
 *
 * @sa vtkStratusMultiVolume vtkStratusHybridTreeFilter vtkStratusDistanceMapFilter vtkSmartVolumeMapper
 */
#ifndef vtkStratusVolumeMapper_h
#define vtkStratusVolumeMapper_h

#include "StratusRenderingVolumeModule.h" // For export macro
#include "vtkSmartPointer.h"              // For MaskInput and Sun
#include "vtkVolumeMapper.h"

#include <memory> // For std::unique_ptr

class vtkImageData;
class vtkLight;
class vtkRenderWindow;
class vtkTable;
class vtkVolumeProperty;

class STRATUSRENDERINGVOLUME_EXPORT vtkStratusVolumeMapper : public vtkVolumeMapper
{
public:
  static vtkStratusVolumeMapper* New();
  vtkTypeMacro(vtkStratusVolumeMapper, vtkVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum RenderModeType { COMPOSITE_MODE, FIRST_HIT_MODE, PATH_MODE };
  //@{
  /**
   * Set/Get the render mode. COMPOSITE_MODE collects light along the whole ray. FIRST_HIT_MODE shows the first voxel of opacity > 0 as a
   * lit, opaque solid. PATH_MODE shows scattered light by random paths. Default COMPOSITE_MODE.
   */
  vtkSetClampMacro(RenderMode, int, COMPOSITE_MODE, PATH_MODE);
  vtkGetMacro(RenderMode, int);
  void SetRenderModeToComposite() { this->SetRenderMode(COMPOSITE_MODE); }
  void SetRenderModeToFirstHit() { this->SetRenderMode(FIRST_HIT_MODE); }
  void SetRenderModeToPath() { this->SetRenderMode(PATH_MODE); }
  const char* GetRenderModeAsString();
  //@}

  /**
   * Get whether the last picture is of a coarse copy of the values, because exact ones were not in memory yet.
   */
  vtkTypeBool GetLastPictureIsCoarse();

  //@{
  /**
   * Set/Get at which standard error a picture of PATH_MODE is finished, at least 0: root mean square over the pixels that show something.
   * Default 0.01. 0: never.
   */
  vtkSetClampMacro(PathTolerance, double, 0.0, 1e30);
  vtkGetMacro(PathTolerance, double);
  //@}

  //@{
  /**
   * Set/Get for how many seconds a Render() of PATH_MODE adds paths, at least 0. An unfinished picture gets at least one path a pixel more,
   * a new one two. Default 0.2.
   */
  vtkSetClampMacro(PathSeconds, double, 0.0, 1e30);
  vtkGetMacro(PathSeconds, double);
  //@}

  //@{
  /**
   * Get the standard error of the last picture of PATH_MODE (NaN: none was drawn), its paths a pixel, and whether it has reached
   * PathTolerance.
   */
  double GetPathError();
  vtkTypeUInt64 GetPathSamples();
  bool GetPathFinished();
  //@}

  enum NormalsType { FACE_NORMALS, GRADIENT_NORMALS };
  //@{
  /**
   * Set/Get the normals of first hits: the voxels' faces, or the field's gradient by central differences. Default FACE_NORMALS.
   */
  vtkSetClampMacro(Normals, int, FACE_NORMALS, GRADIENT_NORMALS);
  vtkGetMacro(Normals, int);
  void SetNormalsToFaces() { this->SetNormals(FACE_NORMALS); }
  void SetNormalsToGradient() { this->SetNormals(GRADIENT_NORMALS); }
  //@}

  //@{
  /**
   * Set/Get the world length between two samples of a ray. 0 or less: by ImageErrorTolerance. An automatic Sampling may take cells,
   * which have no steps. Default -1.
   */
  vtkSetMacro(SampleDistance, double);
  vtkGetMacro(SampleDistance, double);
  //@}

  //@{
  /**
   * Set/Get whether frames are coarser while the window's desired update rate is at least InteractiveUpdateRate. The time allotted to this
   * volume decides how coarse they are: steps get longer first, then there are fewer rays. Below that rate the frame is exact. Default on.
   */
  vtkSetClampMacro(AutoAdjustSampleDistances, vtkTypeBool, 0, 1);
  vtkGetMacro(AutoAdjustSampleDistances, vtkTypeBool);
  vtkBooleanMacro(AutoAdjustSampleDistances, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get the update rate in frames per second from which AutoAdjustSampleDistances applies, 1e-10..1e10. Default 1: VTK's interactor
   * draws still pictures at rate 0.0001, which are exact, and moving ones at rate 15, which are adjusted.
   */
  vtkSetClampMacro(InteractiveUpdateRate, double, 1.0e-10, 1.0e10);
  vtkGetMacro(InteractiveUpdateRate, double);
  //@}

  //@{
  /**
   * Set/Get the pixels between two rays along each axis of the window, and the most that AutoAdjustSampleDistances may take; each 1..100.
   * Default 1 and 8.
   */
  vtkSetClampMacro(ImageSampleDistance, double, 1.0, 100.0);
  vtkGetMacro(ImageSampleDistance, double);
  vtkSetClampMacro(MaximumImageSampleDistance, double, 1.0, 100.0);
  vtkGetMacro(MaximumImageSampleDistance, double);
  //@}

  //@{
  /**
   * Set/Get the most by which AutoAdjustSampleDistances may multiply the sample distance, 1..100. Default 2.
   */
  vtkSetClampMacro(MaximumSampleDistanceFactor, double, 1.0, 100.0);
  vtkGetMacro(MaximumSampleDistanceFactor, double);
  //@}

  //@{
  /**
   * Set/Get window and level of the final colours: a colour c is shown as (c - level) / window + 0.5. The window must not be 0; a negative
   * one inverts. Default 1 and 0.5, which change nothing. GetLastImage() is not affected.
   */
  vtkSetMacro(FinalColorWindow, float);
  vtkGetMacro(FinalColorWindow, float);
  vtkSetMacro(FinalColorLevel, float);
  vtkGetMacro(FinalColorLevel, float);
  //@}

  enum StructureType { AUTO_STRUCTURE, NO_STRUCTURE, BLOCK_STRUCTURE, DISTANCE_STRUCTURE, OCTANT_STRUCTURE, HYBRID_STRUCTURE };
  //@{
  /**
   * Set/Get the structure by which rays skip empty space: none, a flag per block, a distance map, eight distance maps by the ray's octant,
   * or a hybrid tree. The structure does not change the picture. Default AUTO_STRUCTURE, the fastest by times of frames.
   */
  vtkSetClampMacro(Structure, int, AUTO_STRUCTURE, HYBRID_STRUCTURE);
  vtkGetMacro(Structure, int);
  void SetStructureToAuto() { this->SetStructure(AUTO_STRUCTURE); }
  void SetStructureToNone() { this->SetStructure(NO_STRUCTURE); }
  void SetStructureToBlock() { this->SetStructure(BLOCK_STRUCTURE); }
  void SetStructureToDistance() { this->SetStructure(DISTANCE_STRUCTURE); }
  void SetStructureToOctant() { this->SetStructure(OCTANT_STRUCTURE); }
  void SetStructureToHybrid() { this->SetStructure(HYBRID_STRUCTURE); }
  const char* GetStructureAsString();
  //@}

  enum SamplingType { AUTO_SAMPLING, MIDPOINT_SAMPLING, PREINTEGRATED_SAMPLING, CELLS_SAMPLING };
  //@{
  /**
   * Set/Get the sampling of a ray's segments. MIDPOINT_SAMPLING takes one value in the middle. PREINTEGRATED_SAMPLING integrates the
   * transfer function between the values at both ends; it is never used with nearest interpolation. CELLS_SAMPLING goes from cell to cell
   * and integrates the field between a cell's walls, as finely as CellError says; composite of one component, without mask and
   * gradient opacity, else the picture is refused. AUTO_SAMPLING takes the cheapest of them that keeps ImageErrorTolerance, as a probe of
   * 640 rays measures, or cells in some blocks and midpoint in all others. Default AUTO_SAMPLING.
   */
  vtkSetClampMacro(Sampling, int, AUTO_SAMPLING, CELLS_SAMPLING);
  vtkGetMacro(Sampling, int);
  void SetSamplingToAuto() { this->SetSampling(AUTO_SAMPLING); }
  void SetSamplingToMidpoint() { this->SetSampling(MIDPOINT_SAMPLING); }
  void SetSamplingToPreintegrated() { this->SetSampling(PREINTEGRATED_SAMPLING); }
  void SetSamplingToCells() { this->SetSampling(CELLS_SAMPLING); }
  const char* GetSamplingAsString();
  //@}

  //@{
  /**
   * Set/Get the farthest that the field may depart from a straight line within a piece of CELLS_SAMPLING, as a fraction of the part of the
   * range of finite values that the functions' points span; smaller is finer. 0 or less: by ImageErrorTolerance. Default 0.
   */
  vtkSetMacro(CellError, double);
  vtkGetMacro(CellError, double);
  //@}

  //@{
  /**
   * Set/Get how far along a ray what it shows may spread about one place at which light is computed, where CELLS_SAMPLING draws with
   * shading: the sum of opacities times squared distances from that place, in squares of a voxel; smaller is finer. 0 or less: by
   * ImageErrorTolerance. Default 0.
   */
  vtkSetMacro(LightSpread, double);
  vtkGetMacro(LightSpread, double);
  //@}

  //@{
  /**
   * Set/Get whether matter absorbs light on its way from each light, where shading is on, in composite and isosurface. Matter that clip
   * planes, cropping and masks hide casts no shadow. Opaque surfaces of the renderer that are lit cast shadows on the matter, and take its
   * shadows. Maps of light are built again if data, functions or lights change; for lights that move with the camera, such as VTK's
   * headlight, also with the camera. Default off; a VolumetricScatteringBlending above 0 counts as on.
   */
  vtkSetMacro(Shadows, vtkTypeBool);
  vtkGetMacro(Shadows, vtkTypeBool);
  vtkBooleanMacro(Shadows, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get how much of the light is scattered by the matter, 0..2; the rest is reflected at the gradient, as without scattering. 0
   * (default): none, 2: all. This is the property of vtkGPUVolumeRayCastMapper, except that a half of the value is the share everywhere,
   * whatever the gradient. Scattered light is the material's diffuse part times the phase function.
   */
  vtkSetClampMacro(VolumetricScatteringBlending, double, 0.0, 2.0);
  vtkGetMacro(VolumetricScatteringBlending, double);
  //@}

  //@{
  /**
   * Set/Get the anisotropy of scattered light, -.99 to .99: Henyey and Greenstein's g. Above 0, light is scattered forward; clouds have
   * .85. Default 0: evenly, or as ScatteringAnisotropy of the volume's property says, which VTK has from 9.2 on.
   */
  vtkSetClampMacro(ScatteringAnisotropy, double, -0.99, 0.99);
  vtkGetMacro(ScatteringAnisotropy, double);
  //@}

  //@{
  /**
   * Set/Get how far away matter casts its shadows, 0..1: from next to nothing to the diagonal of the volume's bounds. This is the property
   * of vtkGPUVolumeRayCastMapper, which maps it to lengths alike; but the default here is 1, without a limit. Below 1, opaque surfaces take
   * no shadows.
   */
  vtkSetClampMacro(GlobalIlluminationReach, double, 0.0, 1.0);
  vtkGetMacro(GlobalIlluminationReach, double);
  //@}

  //@{
  /**
   * Set/Get whether scattered light is scattered again, any number of times, and the light of a sky with it. Then shadows are on. The
   * first scattering is computed at each sample, all others on a grid of at most 64 cells along each side. Default off: light is scattered
   * once. Not used if VolumetricScatteringBlending is 0, but in PATH_MODE.
   */
  vtkSetMacro(MultipleScattering, vtkTypeBool);
  vtkGetMacro(MultipleScattering, vtkTypeBool);
  vtkBooleanMacro(MultipleScattering, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get the radiance of the sky, red, green and blue, each at least 0: at the zenith, and at and below the horizon; between them it is
   * mixed by the cosine to SkyUp, a direction of any length above 0. Light of the sky is scattered where MultipleScattering is on. The
   * picture's background does not show it. Default 0, 0, 0 and z.
   */
  vtkSetVector3Macro(SkyZenith, double);
  vtkGetVector3Macro(SkyZenith, double);
  vtkSetVector3Macro(SkyHorizon, double);
  vtkGetVector3Macro(SkyHorizon, double);
  vtkSetVector3Macro(SkyUp, double);
  vtkGetVector3Macro(SkyUp, double);
  //@}

  //@{
  /**
   * Set/Get the light that lights the volume in place of the renderer's lights, at its own place in the world. Default nullptr: the
   * renderer's lights.
   */
  virtual void SetSun(vtkLight* light);
  vtkLight* GetSun();
  //@}

  //@{
  /**
   * Set/Get whether colours are linear, as scattered light is, and encoded for the screen (sRGB, IEC 61966-2-1) where the window shows
   * them, which blends encoded colours. GetLastImage() has linear ones. Default off: the window shows colours as they are.
   */
  vtkSetMacro(ScreenEncoding, vtkTypeBool);
  vtkGetMacro(ScreenEncoding, vtkTypeBool);
  vtkBooleanMacro(ScreenEncoding, vtkTypeBool);
  //@}

  enum { BinaryMaskType = 0, LabelMapMaskType };
  //@{
  /**
   * Set/Get the mask, as in vtkGPUVolumeRayCastMapper: an image whose point scalars are one unsigned char per value of the input, with the
   * same dimensions. The mask is taken at the nearest value. A binary mask hides values where it is 0. A label map hides nothing: its bytes
   * are labels, and the functions of vtkVolumeProperty::SetLabelColor() and SetLabelScalarOpacity() replace the property's where the label
   * has them (composite, one component). Default nullptr and BinaryMaskType.
   */
  virtual void SetMaskInput(vtkImageData* mask);
  vtkImageData* GetMaskInput();
  vtkSetClampMacro(MaskType, int, BinaryMaskType, LabelMapMaskType);
  vtkGetMacro(MaskType, int);
  void SetMaskTypeToBinary() { this->SetMaskType(BinaryMaskType); }
  void SetMaskTypeToLabelMap() { this->SetMaskType(LabelMapMaskType); }
  //@}

  //@{
  /**
   * Set/Get how much a label's own functions count where a mask of labels has them, as in vtkGPUVolumeRayCastMapper. Only 1 is supported,
   * which is the default of VTK's mapper, too: labels replace what the property has. Another value is an error when drawing a label map.
   */
  vtkSetClampMacro(MaskBlendFactor, float, 0.0f, 1.0f);
  vtkGetMacro(MaskBlendFactor, float);
  //@}

  //@{
  /**
   * Set/Get the world length over which gradient opacity multiplies the opacity (default 0).
   * - 0: gradient opacity multiplies the optical depth instead. A value of opacity 1 then stays opaque, and the frame depends only on the
   *   functions.
   * - Above 0: a ray segment of this length through opacity A (per this length) with gradient opacity F transmits 1 - F A. VTK's mappers
   *   apply gradient opacity in this way to a sample of this length, but here the frame does not depend on the sample distance.
   * - Below 0: half of the mean spacing, which is vtkSmartVolumeMapper's automatic sample distance.
   *
   * If the two definitions differ by much, a warning says so, once. NaN and infinity are an error when drawing.
   */
  vtkSetMacro(GradientOpacityDistance, double);
  vtkGetMacro(GradientOpacityDistance, double);
  //@}

  enum ComponentMixingType { ADD_COMPONENTS, MEAN_COMPONENTS };
  //@{
  /**
   * Set/Get how independent components mix. ADD_COMPONENTS adds their optical depths, as of media that share a place. MEAN_COMPONENTS has
   * each count by its share, (sum of d^2) / (sum of d) of optical depths d, while their light adds up, as VTK's mappers do with opacities:
   * equal components show no more than one of them. Default ADD_COMPONENTS.
   */
  vtkSetClampMacro(ComponentMixing, int, ADD_COMPONENTS, MEAN_COMPONENTS);
  vtkGetMacro(ComponentMixing, int);
  void SetComponentMixingToAdd() { this->SetComponentMixing(ADD_COMPONENTS); }
  void SetComponentMixingToMean() { this->SetComponentMixing(MEAN_COMPONENTS); }
  //@}

  enum VectorModeType { DISABLED = -1, MAGNITUDE = 0, COMPONENT = 1 };
  //@{
  /**
   * Set/Get which components of an array are drawn, as in vtkSmartVolumeMapper: all of them (DISABLED), their magnitude, computed in double
   * precision (MAGNITUDE), or only VectorComponent (COMPONENT). The last two use the property's functions of component 0. A component that
   * the array lacks is an error. An array of one component is drawn as it is. Default DISABLED and 0.
   */
  vtkSetClampMacro(VectorMode, int, DISABLED, COMPONENT);
  vtkGetMacro(VectorMode, int);
  vtkSetClampMacro(VectorComponent, int, 0, VTK_INT_MAX);
  vtkGetMacro(VectorComponent, int);
  //@}

  //@{
  /**
   * Set/Get the name of the array that is the second variable of a two-dimensional transfer function, as in vtkGPUVolumeRayCastMapper: one
   * component, of the points or cells that the scalars are of. nullptr: the gradient's magnitude is. Default nullptr.
   */
  vtkSetStringMacro(Transfer2DYAxisArray);
  vtkGetStringMacro(Transfer2DYAxisArray);
  //@}

  //@{
  /**
   * Set/Get whether pictures go into images in place of the window, as in vtkGPUVolumeRayCastMapper. Other props and the background have no
   * part in them. Default off.
   */
  vtkSetClampMacro(RenderToImage, vtkTypeBool, 0, 1);
  vtkGetMacro(RenderToImage, vtkTypeBool);
  vtkBooleanMacro(RenderToImage, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get the scalar type of GetDepthImage(): VTK_UNSIGNED_CHAR, VTK_UNSIGNED_SHORT or VTK_FLOAT. Others become VTK_FLOAT. Default
   * VTK_FLOAT.
   */
  virtual void SetDepthImageScalarType(int type);
  vtkGetMacro(DepthImageScalarType, int);
  void SetDepthImageScalarTypeToUnsignedChar() { this->SetDepthImageScalarType(VTK_UNSIGNED_CHAR); }
  void SetDepthImageScalarTypeToUnsignedShort() { this->SetDepthImageScalarType(VTK_UNSIGNED_SHORT); }
  void SetDepthImageScalarTypeToFloat() { this->SetDepthImageScalarType(VTK_FLOAT); }
  //@}

  //@{
  /**
   * Get the last picture as an image of the viewport's size, its first pixel at the bottom left. Colours: four bytes a pixel, multiplied by
   * alpha. Depths: of where the volume begins to show, between the camera's planes from 0 to 1, and 1 where it shows nothing; integers
   * have this range scaled to theirs. The image becomes empty where there is no picture.
   */
  void GetColorImage(vtkImageData* image);
  void GetDepthImage(vtkImageData* image);
  //@}

  /**
   * Get whether a property could be drawn in any window: 1, or 0 if it would be refused. Checks the mapper's settings, the isosurface
   * values and the slice function; functions without points are refused only when drawing. The data are not checked.
   */
  int IsRenderSupported(vtkRenderWindow* window, vtkVolumeProperty* property);

  enum RequestedRenderModeType {
    DefaultRenderMode = 0,
    RayCastRenderMode = 1,
    GPURenderMode = 2,
    OSPRayRenderMode = 3,
    UndefinedRenderMode = 4,
    InvalidRenderMode = 5
  };
  //@{
  /**
   * Calls of VTK's mappers, kept so that programs run after one changed line. They change no picture: there is one way to draw, SetDevice()
   * says where, functions are taken at all of their points, opaque geometry always ends rays, and the tolerance governs steps. VTK's ranges
   * and defaults.
   */
  vtkSetClampMacro(RequestedRenderMode, int, DefaultRenderMode, OSPRayRenderMode);
  vtkGetMacro(RequestedRenderMode, int);
  void SetRequestedRenderModeToDefault() { this->SetRequestedRenderMode(DefaultRenderMode); }
  void SetRequestedRenderModeToRayCast() { this->SetRequestedRenderMode(RayCastRenderMode); }
  void SetRequestedRenderModeToGPU() { this->SetRequestedRenderMode(GPURenderMode); }
  void SetRequestedRenderModeToOSPRay() { this->SetRequestedRenderMode(OSPRayRenderMode); }
  int GetLastUsedRenderMode() { return RayCastRenderMode; }
  vtkSetMacro(MaxMemoryInBytes, vtkIdType);
  vtkGetMacro(MaxMemoryInBytes, vtkIdType);
  vtkSetClampMacro(MaxMemoryFraction, float, 0.1f, 1.0f);
  vtkGetMacro(MaxMemoryFraction, float);
  vtkSetMacro(ReportProgress, bool);
  vtkGetMacro(ReportProgress, bool);
  vtkSetClampMacro(InterpolationMode, int, 0, 2);
  vtkGetMacro(InterpolationMode, int);
  void SetInterpolationModeToNearestNeighbor() { this->SetInterpolationMode(0); }
  void SetInterpolationModeToLinear() { this->SetInterpolationMode(1); }
  void SetInterpolationModeToCubic() { this->SetInterpolationMode(2); }
  vtkSetClampMacro(InteractiveAdjustSampleDistances, vtkTypeBool, 0, 1);
  vtkGetMacro(InteractiveAdjustSampleDistances, vtkTypeBool);
  vtkBooleanMacro(InteractiveAdjustSampleDistances, vtkTypeBool);
  vtkSetMacro(InteractiveSampleDistance, float);
  vtkGetMacro(InteractiveSampleDistance, float);
  vtkSetClampMacro(LockSampleDistanceToInputSpacing, vtkTypeBool, 0, 1);
  vtkGetMacro(LockSampleDistanceToInputSpacing, vtkTypeBool);
  vtkBooleanMacro(LockSampleDistanceToInputSpacing, vtkTypeBool);
  vtkSetClampMacro(MinimumImageSampleDistance, float, 0.1f, 100.0f);
  vtkGetMacro(MinimumImageSampleDistance, float);
  vtkSetClampMacro(IntermixIntersectingGeometry, vtkTypeBool, 0, 1);
  vtkGetMacro(IntermixIntersectingGeometry, vtkTypeBool);
  vtkBooleanMacro(IntermixIntersectingGeometry, vtkTypeBool);
  vtkSetClampMacro(UseDepthPass, vtkTypeBool, 0, 1);
  vtkGetMacro(UseDepthPass, vtkTypeBool);
  vtkBooleanMacro(UseDepthPass, vtkTypeBool);
  vtkSetMacro(ColorRangeType, int);
  vtkGetMacro(ColorRangeType, int);
  vtkSetMacro(ScalarOpacityRangeType, int);
  vtkGetMacro(ScalarOpacityRangeType, int);
  vtkSetMacro(GradientOpacityRangeType, int);
  vtkGetMacro(GradientOpacityRangeType, int);
  //@}

  //@{
  /**
   * Set/Get whether each ray's samples move along it by up to a sample distance, which turns the wood grain of long steps into noise. The
   * noise does not depend on the number of threads and does not change from picture to picture; another seed gives other noise. Sampling
   * by cells has no samples to move. Default off, seed 0.
   */
  vtkSetClampMacro(UseJittering, vtkTypeBool, 0, 1);
  vtkGetMacro(UseJittering, vtkTypeBool);
  vtkBooleanMacro(UseJittering, vtkTypeBool);
  vtkSetMacro(JitterSeed, unsigned int);
  vtkGetMacro(JitterSeed, unsigned int);
  //@}

  //@{
  /**
   * Set/Get the root mean square error of RGBA in 0..1 over the lit pixels that automatic settings may cause, at least 0 and finite; any
   * other value is an error and is ignored. 0 selects the finest settings. Default 0.001: 60 dB, a quarter of an 8-bit step. It governs
   * whichever of Sampling, SampleDistance (with cells: CellError, LightSpread) and Termination are automatic. GetExpectedError() returns
   * the error that is expected.
   */
  virtual void SetImageErrorTolerance(double tolerance);
  vtkGetMacro(ImageErrorTolerance, double);
  //@}

  //@{
  /**
   * Set/Get the opacity beyond which a ray ends, 0..1. Default 0: by ImageErrorTolerance.
   */
  vtkSetClampMacro(Termination, double, 0.0, 1.0);
  vtkGetMacro(Termination, double);
  //@}

  //@{
  /**
   * Set/Get the number of cells along a block's edge of the structure: 2, 4, 8, 16, 32, or 0 for the core's default. Other values are an
   * error when drawing. Default 0.
   */
  vtkSetMacro(BlockSize, int);
  vtkGetMacro(BlockSize, int);
  //@}

  //@{
  /**
   * Set/Get the device on which rays are cast: "auto" (the host or an OpenCL GPU, whichever draws a small picture faster), "host", or an
   * OpenCL device by its number or a part of its name. A device that does not exist is an error that lists the existing ones, and the
   * previous device stays. Default "auto".
   */
  virtual void SetDevice(const char* device);
  virtual const char* GetDevice();
  //@}

  //@{
  /**
   * Set/Get the number of threads of the host, 1..1024, or 0 for as many as OpenMP would take. The picture does not depend on it. Default
   * 0.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  //@{
  /**
   * Set/Get whether each picture is also drawn without structure and the differing pixels counted, see GetDifferingPixels(). Slow. Default
   * off.
   */
  vtkSetClampMacro(Audit, vtkTypeBool, 0, 1);
  vtkGetMacro(Audit, vtkTypeBool);
  vtkBooleanMacro(Audit, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get whether the values interpolated are counted for each pixel; GetLastImage() then has the array "Samples". The picture does not
   * change. Default off.
   */
  vtkSetClampMacro(CountSamples, vtkTypeBool, 0, 1);
  vtkGetMacro(CountSamples, vtkTypeBool);
  vtkBooleanMacro(CountSamples, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get the numbers of each ray that GetLastImage() has as float arrays in addition to the picture, by their names, with spaces or
   * commas between them. Default: none.
   * - "integral": of the values over the ray's length, a column density; "length" on which the ray meets values; "mean";
   * - "maximum", the largest value, and "maximum_depth", where it is;
   * - "cells", the number of cells that the ray passes;
   * - "transmittance", the part of light that passes by the property's functions, and "transmittance_depth", where it falls to
   *   TransmittanceThreshold.
   *
   * Depths are along the ray from the eye (parallel: from its plane). Lengths and depths are in the data's own units, whatever the volume's
   * matrix, or in metres if the field data of the input have an array "MetresPerUnit", which Stratus' readers add. Of several volumes
   * with different matrices or units they are in world units. Each array's vtkDataArray::UNITS_LABEL() has its unit, such as "kg m-2" for
   * the integral of values whose UNITS_LABEL() is "kg m-3", or "grid units" for lengths of no known unit. A number that a ray does not have
   * is NaN. Numbers are of the same values as the picture's, within clipping planes, cropping regions and masks, and in front of opaque
   * geometry, whatever the blend mode. Integral, maximum and cells are exact but for the rounding of floats: the field is integrated cell
   * by cell. Other names are an error.
   */
  vtkSetStringMacro(Quantities);
  vtkGetStringMacro(Quantities);
  //@}

  //@{
  /**
   * Set/Get the transmittance whose depth is "transmittance_depth" of SetQuantities(), above 0 and below 1. Default 0.5.
   */
  vtkSetMacro(TransmittanceThreshold, double);
  vtkGetMacro(TransmittanceThreshold, double);
  //@}

  //@{
  /**
   * Get counts of the last picture: values interpolated, segments skipped, reads of the structure, pixels that the audit found different,
   * blocks, occupied blocks, and bytes of the structure.
   */
  vtkTypeUInt64 GetSamplesTaken();
  vtkTypeUInt64 GetSamplesSkipped();
  vtkTypeUInt64 GetStructureLookups();
  vtkTypeUInt64 GetDifferingPixels();
  vtkTypeUInt64 GetBlocks();
  vtkTypeUInt64 GetOccupiedBlocks();
  vtkTypeUInt64 GetStructureBytes();
  //@}

  //@{
  /**
   * Get how often each was built since this mapper, its device or its threads were set up.
   */
  vtkTypeUInt64 GetRangeBuilds();
  vtkTypeUInt64 GetTableBuilds();
  vtkTypeUInt64 GetOccupancyBuilds();
  vtkTypeUInt64 GetStructureBuilds();
  vtkTypeUInt64 GetUploads();
  /**
   * Get how many functions of the property were translated since this mapper was made. A function is translated again when it was modified,
   * or another one takes its place.
   */
  vtkTypeUInt64 GetFunctionBuilds();
  /**
   * Get whether the last picture was drawn by the tree that the input carries, so that none had to be built.
   */
  bool GetCarriedTreeUsed();
  //@}

  //@{
  /**
   * Get the milliseconds of the last frame's stages, 0 for a stage that was not needed. The draw time covers reading the depth and
   * displaying the frame.
   */
  double GetRangeTime();
  double GetTableTime();
  double GetOccupancyTime();
  double GetStructureTime();
  double GetUploadTime();
  double GetCastTime();
  double GetDrawTime();
  //@}

  //@{
  /**
   * Get what the last picture used: structure, sampling, world length between samples, pixels between rays, the reason for the choice, and
   * the device.
   */
  const char* GetStructureUsedAsString();
  const char* GetSamplingUsedAsString();
  double GetUsedSampleDistance();
  double GetUsedImageSampleDistance();
  const char* GetReason();
  /**
   * Get the root mean square error of the last picture that was expected by its settings, NaN where none was measured, and whether the
   * finest settings are expected to reach ImageErrorTolerance; the picture is drawn at the finest where they are not.
   */
  double GetExpectedError();
  bool GetToleranceMet();
  /**
   * Get the milliseconds of the last picture's probe, the values that it interpolated, and the number of probes since this mapper, its
   * device or its threads were set up. New data, functions and settings are probed; a new camera is not.
   */
  double GetProbeTime();
  vtkTypeUInt64 GetProbeSamples();
  vtkTypeUInt64 GetProbeBuilds();
  const char* GetDeviceName();
  //@}

  /**
   * Get the build stages of the last frame that built anything. Each row is a stage. Columns: "Stage" (string), "Where" (string: the name
   * of the device that ran its kernels, or "host"), "Milliseconds" (double: wall-clock time without nested stages), "Bytes" (vtkIdType:
   * size of the stage's results) and "Kernels" (vtkIdType: number of kernels that the device ran). Drawing itself is not a stage. A frame
   * that reuses everything changes no row. An aborted frame reports the stages that it finished. The table has no rows before the first
   * frame.
   */
  vtkTable* GetBuildReport();

  /**
   * Get the reason why the last picture was refused, empty if it was not. An error event reports it, too, but only once for equal reasons
   * in a row.
   */
  const char* GetLastError();

  /**
   * Get the last picture as floats, of the renderer's viewport's size, its first pixel at the bottom left. Point data:
   * - "RGBA" (the scalars): 4 components, premultiplied by alpha, without the opaque geometry;
   * - "Depth": world distance along the ray from the eye, in a parallel view from its plane, to the first contribution; infinite where
   *   there is none;
   * - "Samples", if the picture was drawn with CountSamples;
   * - what SetQuantities() names.
   *
   * A pixel of a coarse picture is repeated. The result is nullptr before the first picture, and after one that was refused, aborted or
   * mixed with other volumes. The mapper owns the image, and the next call overwrites it.
   */
  vtkImageData* GetLastImage();

  /**
   * Get the input's bounds, extended by half a voxel on all sides for first hits of point data, and along axes of one layer of points.
   */
  double* GetBounds() VTK_SIZEHINT(6) override;
  using Superclass::GetBounds;

  /**
   * WARNING: INTERNAL METHOD - NOT INTENDED FOR GENERAL USE
   */
  void Render(vtkRenderer* ren, vtkVolume* vol) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

  /**
   * WARNING: INTERNAL METHOD - NOT INTENDED FOR GENERAL USE
   * Compute the automatic settings without drawing, so that the pieces of a larger volume can agree on one: the sampling (a SamplingType;
   * CELLS_SAMPLING also for a mix of cells and midpoints), the sample distance, the cell error and the light spread, 0 if they are not
   * used. Builds the data that the next frame needs. Returns false if nothing would be drawn; the next frame reports the reason.
   */
  bool MeasureSampling(vtkRenderer* renderer, vtkVolume* volume, double choice[4]);

protected:
  vtkStratusVolumeMapper();
  ~vtkStratusVolumeMapper() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;

  double SampleDistance = -1.0;
  vtkTypeBool AutoAdjustSampleDistances = 1;
  double InteractiveUpdateRate = 1.0;
  double ImageSampleDistance = 1.0;
  double MaximumImageSampleDistance = 8.0;
  double MaximumSampleDistanceFactor = 2.0;
  float FinalColorWindow = 1.0f;
  float FinalColorLevel = 0.5f;
  int RenderMode = COMPOSITE_MODE;
  double PathTolerance = 0.01, PathSeconds = 0.2;
  int Normals = FACE_NORMALS;
  int Structure = AUTO_STRUCTURE;
  int Sampling = AUTO_SAMPLING;
  double CellError = 0.0;
  double LightSpread = 0.0;
  vtkTypeBool Shadows = 0;
  double VolumetricScatteringBlending = 0.0, ScatteringAnisotropy = 0.0, GlobalIlluminationReach = 1.0;
  vtkTypeBool MultipleScattering = 0;
  double SkyZenith[3] = { 0.0, 0.0, 0.0 }, SkyHorizon[3] = { 0.0, 0.0, 0.0 }, SkyUp[3] = { 0.0, 0.0, 1.0 };
  vtkSmartPointer<vtkLight> Sun;
  vtkTypeBool ScreenEncoding = 0;
  double ImageErrorTolerance = 0.001;
  double Termination = 0.0;
  int BlockSize = 0;
  int NumberOfThreads = 0;
  vtkTypeBool Audit = 0;
  vtkSmartPointer<vtkImageData> MaskInput;
  int MaskType = BinaryMaskType;
  float MaskBlendFactor = 1.0f;
  double GradientOpacityDistance = 0.0;
  int ComponentMixing = ADD_COMPONENTS;
  int VectorMode = DISABLED;
  int VectorComponent = 0;
  vtkTypeBool RenderToImage = 0;
  int DepthImageScalarType = VTK_FLOAT;
  char* Transfer2DYAxisArray = nullptr;
  int RequestedRenderMode = DefaultRenderMode;
  vtkIdType MaxMemoryInBytes = 0;
  float MaxMemoryFraction = 0.75f;
  bool ReportProgress = true;
  int InterpolationMode = 1;
  vtkTypeBool InteractiveAdjustSampleDistances = 1;
  float InteractiveSampleDistance = 2.0f;
  vtkTypeBool LockSampleDistanceToInputSpacing = 0;
  float MinimumImageSampleDistance = 1.0f;
  vtkTypeBool IntermixIntersectingGeometry = 1;
  vtkTypeBool UseDepthPass = 0;
  int ColorRangeType = 0;
  int ScalarOpacityRangeType = 0;
  int GradientOpacityRangeType = 0;
  vtkTypeBool UseJittering = 0;
  unsigned int JitterSeed = 0;
  vtkTypeBool CountSamples = 0;
  char* Quantities = nullptr;
  double TransmittanceThreshold = 0.5;

private:
  vtkStratusVolumeMapper(const vtkStratusVolumeMapper&) = delete;
  void operator=(const vtkStratusVolumeMapper&) = delete;

  // These draw what the mappers of their blocks or volumes describe.
  friend class vtkStratusMultiBlockVolumeMapper;
  friend class vtkStratusMultiVolume;
  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
