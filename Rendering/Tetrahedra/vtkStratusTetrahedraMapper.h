// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetrahedraMapper
 * @brief   draws the volume of an unstructured or structured grid, divided into tetrahedra, with exact thickness and order
 *
 * Replaces vtkProjectedTetrahedraMapper and vtkUnstructuredGridVolumeRayCastMapper. It draws a vtkUnstructuredGrid or a vtkStructuredGrid
 * with the vtkVolume's vtkVolumeProperty and composites the picture with the scene's opaque geometry.
 *
 * Supported are:
 * - linear and quadratic cells of every kind and polyhedra, of any orientation, in any number of parts, with gaps, hollows and flat
 *   cells. Cells are divided into linear tetrahedra, in which the field is linear; neighbours divide their common face alike.
 *   Lagrange and Bezier hexahedra, wedges and tetrahedra, including rational ones, are divided at their nodes, and Bezier cells at the
 *   points of the cell that correspond to their nodes. The frame then has the error of linear interpolation between nodes, which falls with
 *   the square of the node distance.
 *   Vertices, lines and polygons are ignored and counted; a grid that has nothing else is an error.
 * - structured (curvilinear) grids: hexahedra in layers, around poles, left-handed. Each is divided into six tetrahedra around the diagonal
 *   from its first corner to its last. The tetrahedra keep their orientation in layers over any ground. Where layers cross, all overlapping
 *   cells count. MARCH_METHOD needs about 21 bytes a hexahedron in addition to the grid. PROJECT_METHOD, and grids in which layers cross,
 *   need about 490;
 * - composite data sets of such grids, of rectilinear grids and of images, at any depth (vtkMultiBlockDataSet, vtkPartitionedDataSet,
 *   vtkPartitionedDataSetCollection), as one volume. Several structured grids are drawn without conversion, like a single one, if their
 *   scalars have one type and the faces that two of them share have one diagonal, from lowest to highest index in both. In all other cases,
 *   points of equal coordinates and values are merged, so that blocks meet in whole faces. Blocks without the array or without a volume are
 *   left out with a warning. A single block is drawn as it is;
 * - point and cell scalars of any numeric type but bits; also of 2 to 4 independent components, each with functions of its own, which mix
 *   in composite and slice (ComponentMixing), and of which isosurface shows all surfaces and first hits the nearest, while maximum,
 *   minimum, average and additive draw each by itself and add the weighted colours; and of dependent ones: 2 (colour by the first, opacity
 * by the second) and 4 of up to 16 bits or floats (red, green, blue in 0..255, and the opacity's value), in every mode as
 * vtkStratusVolumeMapper draws them. They are marched. Of independent ones the first colour function's VectorMode draws one value, as VTK's
 * mappers of meshes do: the magnitude, or the component that VectorComponent names, by the functions of component 0. The first component,
 * the default, leaves 2 to 4 components to mix; of more components only the first is drawn;
 * - scalar opacity, colour or grey, ScalarOpacityUnitDistance in world units;
 * - the blend modes composite, maximum and minimum intensity (the largest or smallest value on a ray, at the opacity of one unit distance),
 *   average and additive intensity, isosurfaces of point scalars (IsoSurfaceValues of the property; up to 16, exact in each
 *   tetrahedron), and slices (SliceFunction of the property, as vtkStratusVolumeMapper takes it). All but composite and maximum are
 *   marched: PROJECT_METHOD refuses them, AUTO_METHOD marches;
 * - first hits (RenderModeToFirstHit): lit, opaque solids, which write their depth. They are marched;
 * - light (Shade; the renderer's lights and TwoSidedLighting), in composite, isosurface and first hits, as vtkStratusVolumeMapper takes
 *   it. In a tetrahedron the field's gradient is constant; each point has the mean of its tetrahedra's, weighted by volume, and between
 *   points it is interpolated, so that light is smooth across cells. Cell scalars are averaged at points for it. Independent components
 *   are lit and thinned each by its own gradient, and have a Shade and a material of their own; dependent ones by the last one's;
 * - gradient opacity in composite, in values per mean spacing: the edge of a cube that six tetrahedra of the mean volume fill. It
 *   multiplies the optical depth, or the opacity (GradientOpacityDistance). Light and gradient opacity are marched;
 * - up to 6 clipping planes (of origin and normal) and cropping to any of the 27 regions. They cut rays exactly, cells are not left out;
 * - translucent surfaces peeled with volumes (UseDepthPeelingForVolumes). In composite mode, rays are cast up to each surface, so that the
 *   parts of the volume between surfaces are in depth order. In other modes the whole frame is placed between the surfaces, at its first
 *   depth;
 * - binary masks (MaskInput), which hide cells, and in composite label maps, by which each cell has functions of its own (LabelColor,
 *   LabelScalarOpacity and LabelGradientOpacity of the property). Labels are marched;
 * - ghost and blanking arrays, and values that are not finite, which make their whole cell transparent;
 * - the volume's matrix, and parallel and perspective cameras, also inside the grid. The near plane cuts cells.
 *
 * A setting that has no meaning here is left out, as VTK's mappers leave it out, and one warning a mapper says so: Shade outside of
 * composite, isosurface and first hits, gradient opacity and label maps outside of composite, functions of labels without a label map,
 * functions of two variables, transforms of clipping planes and of SliceFunction.
 *
 * Volumes of one renderer are drawn by depth, as vtkStratusVolumeMapper describes. A mesh is mixed with the volumes that overlap it if one
 * of them has a vtkStratusVolumeMapper, by method auto or march, without light and label maps.
 *
 * The mapper keeps what it builds: a new view of the same grid rebuilds nothing, a new transfer function rebuilds only a table.
 *
 * @sa vtkStratusVolumeMapper vtkProjectedTetrahedraMapper
 */
#ifndef vtkStratusTetrahedraMapper_h
#define vtkStratusTetrahedraMapper_h

#include "StratusRenderingTetrahedraModule.h" // For export macro
#include "vtkSmartPointer.h"                  // For MaskInput and Sun
#include "vtkUnstructuredGridVolumeMapper.h"

#include <memory> // For std::unique_ptr

class vtkDataObjectTree;
class vtkImageData;
class vtkLight;
class vtkTable;
struct vtkStratusMeshDescription;

class STRATUSRENDERINGTETRAHEDRA_EXPORT vtkStratusTetrahedraMapper : public vtkUnstructuredGridVolumeMapper
{
public:
  static vtkStratusTetrahedraMapper* New();
  vtkTypeMacro(vtkStratusTetrahedraMapper, vtkUnstructuredGridVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the root mean square error of RGBA in 0..1 over the lit pixels that the division of cells into pieces of one colour may cause,
   * at least 0 and finite; another is an error, and the last one stays. 0 takes the finest division. Default 0.001: 60 dB, a quarter of an
   * 8-bit step. It also governs Termination, unless that is set by hand. Not used in maximum intensity, which is exact.
   */
  virtual void SetImageErrorTolerance(double tolerance);
  vtkGetMacro(ImageErrorTolerance, double);
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
   * once. Not used if VolumetricScatteringBlending is 0.
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

  //@{
  /**
   * Set/Get the alpha beyond which a ray ends, 0..1. Default 0: by ImageErrorTolerance, 0.9999 at the default one. Not used in maximum
   * intensity.
   */
  vtkSetClampMacro(Termination, double, 0.0, 1.0);
  vtkGetMacro(Termination, double);
  //@}

  enum RenderModeType { COMPOSITE_MODE, FIRST_HIT_MODE };
  //@{
  /**
   * Set/Get the render mode. COMPOSITE_MODE draws by the blend mode. FIRST_HIT_MODE shows the first place of opacity > 0 on each ray as a
   * lit, opaque solid: of cell scalars the first cell that shows, of point scalars the place where the linear field begins to show. Default
   * COMPOSITE_MODE.
   */
  vtkSetClampMacro(RenderMode, int, COMPOSITE_MODE, FIRST_HIT_MODE);
  vtkGetMacro(RenderMode, int);
  void SetRenderModeToComposite() { this->SetRenderMode(COMPOSITE_MODE); }
  void SetRenderModeToFirstHit() { this->SetRenderMode(FIRST_HIT_MODE); }
  //@}

  enum NormalsType { FACE_NORMALS, GRADIENT_NORMALS };
  //@{
  /**
   * Set/Get the normals of first hits: of the cell's face by which a ray enters and, where a field of points begins to show within a cell,
   * of the flat surface on which it does; or the gradient between points, which is smooth across cells. Default FACE_NORMALS.
   */
  vtkSetClampMacro(Normals, int, FACE_NORMALS, GRADIENT_NORMALS);
  vtkGetMacro(Normals, int);
  void SetNormalsToFaces() { this->SetNormals(FACE_NORMALS); }
  void SetNormalsToGradient() { this->SetNormals(GRADIENT_NORMALS); }
  //@}

  //@{
  /**
   * Set the blend mode, which SetBlendMode() takes as a number, too. They have vtkVolumeMapper's numbers.
   */
  enum MoreBlendModes { MINIMUM_INTENSITY_BLEND = 2, AVERAGE_INTENSITY_BLEND, ADDITIVE_BLEND, ISOSURFACE_BLEND, SLICE_BLEND };
  void SetBlendModeToMinimumIntensity() { this->SetBlendMode(MINIMUM_INTENSITY_BLEND); }
  void SetBlendModeToAverageIntensity() { this->SetBlendMode(AVERAGE_INTENSITY_BLEND); }
  void SetBlendModeToAdditive() { this->SetBlendMode(ADDITIVE_BLEND); }
  void SetBlendModeToIsoSurface() { this->SetBlendMode(ISOSURFACE_BLEND); }
  void SetBlendModeToSlice() { this->SetBlendMode(SLICE_BLEND); }
  //@}

  //@{
  /**
   * Set/Get the values that count in average intensity, first and last, ends included. Default: all (the largest floats of either sign).
   */
  vtkSetVector2Macro(AverageIPScalarRange, double);
  vtkGetVectorMacro(AverageIPScalarRange, double, 2);
  //@}

  //@{
  /**
   * Set/Get whether only some of the 27 regions that CroppingRegionPlanes make in the input's coordinates are drawn: xmin, xmax, ymin,
   * ymax, zmin, zmax. Planes whose ends do not rise are refused. CroppingRegionFlags are as in vtkVolumeMapper: bit x + 3 y + 9 z shows
   * the region below (0), between (1) or above (2) the planes of each axis. Regions other than the inside are marched. Default off, 0 to 1,
   * and the inside (0x2000).
   */
  vtkSetMacro(Cropping, bool);
  vtkGetMacro(Cropping, bool);
  vtkBooleanMacro(Cropping, bool);
  vtkSetVector6Macro(CroppingRegionPlanes, double);
  vtkGetVectorMacro(CroppingRegionPlanes, double, 6);
  vtkSetClampMacro(CroppingRegionFlags, int, 0, 0x7ffffff);
  vtkGetMacro(CroppingRegionFlags, int);
  void SetCroppingRegionFlagsToSubVolume() { this->SetCroppingRegionFlags(0x0002000); }
  void SetCroppingRegionFlagsToFence() { this->SetCroppingRegionFlags(0x2ebfeba); }
  void SetCroppingRegionFlagsToInvertedFence() { this->SetCroppingRegionFlags(0x5140145); }
  void SetCroppingRegionFlagsToCross() { this->SetCroppingRegionFlags(0x0417410); }
  void SetCroppingRegionFlagsToInvertedCross() { this->SetCroppingRegionFlags(0x7be8bef); }
  //@}

  enum { BinaryMaskType = 0, LabelMapMaskType };
  //@{
  /**
   * Set/Get the mask: an image of the input's coordinates, of any size and spacing, whose point scalars are one unsigned char each. A
   * tetrahedron, or a cell of a structured grid, has the byte of the point nearest to its middle, and 0 outside the image. A binary mask
   * hides cells of byte 0, as a ghost array hides cells. A label map hides nothing: its bytes are labels, and the functions of
   * vtkVolumeProperty::SetLabelColor() and SetLabelScalarOpacity() replace the property's in cells of a label in 1..255 that has them. A
   * cell has one label, and is integrated by that label's functions from face to face. Modes other than composite leave label maps out.
   * Default nullptr and BinaryMaskType.
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
   * Set/Get the world length over which gradient opacity multiplies the opacity (default 0).
   * - 0: gradient opacity multiplies the optical depth instead. A value of opacity 1 then stays opaque.
   * - Above 0: a ray segment of this length through opacity A (per this length) with gradient opacity F transmits 1 - F A.
   * - Below 0: half of the mean spacing.
   *
   * NaN and infinity are an error when drawing.
   */
  vtkSetMacro(GradientOpacityDistance, double);
  vtkGetMacro(GradientOpacityDistance, double);
  //@}

  enum ComponentMixingType { ADD_COMPONENTS, MEAN_COMPONENTS };
  //@{
  /**
   * Set/Get how independent components mix where several show, as in vtkStratusVolumeMapper. ADD_COMPONENTS: their optical depths add up.
   * MEAN_COMPONENTS: each counts by its share, (sum of d^2) / (sum of d) of optical depths d, while their light adds up. Default
   * ADD_COMPONENTS.
   */
  vtkSetClampMacro(ComponentMixing, int, ADD_COMPONENTS, MEAN_COMPONENTS);
  vtkGetMacro(ComponentMixing, int);
  void SetComponentMixingToAdd() { this->SetComponentMixing(ADD_COMPONENTS); }
  void SetComponentMixingToMean() { this->SetComponentMixing(MEAN_COMPONENTS); }
  //@}

  //@{
  /**
   * Set/Get how a picture is drawn. MARCH_METHOD marches rays from cell to cell. PROJECT_METHOD sorts the cells that can show something and
   * projects them into tiles of pixels. AUTO_METHOD takes the one that should cost less, by the counts of cells, pixels
   * and segments in view; a camera that stands still never changes the choice. Both methods give the same picture up to the rounding of
   * floats, below .01 of 255 on the mean. Default AUTO_METHOD.
   */
  enum MethodType { AUTO_METHOD, MARCH_METHOD, PROJECT_METHOD };
  vtkSetClampMacro(Method, int, AUTO_METHOD, PROJECT_METHOD);
  vtkGetMacro(Method, int);
  void SetMethodToAuto() { this->SetMethod(AUTO_METHOD); }
  void SetMethodToMarch() { this->SetMethod(MARCH_METHOD); }
  void SetMethodToProject() { this->SetMethod(PROJECT_METHOD); }
  const char* GetMethodAsString();
  //@}

  //@{
  /**
   * Set/Get the number of threads that draw, 0..1024. 0 takes as many as OpenMP would. The picture does not depend on it. Default 0.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  //@{
  /**
   * Set/Get the device on which rays march: "auto" (the host or an OpenCL GPU, whichever draws a small picture faster), "host", or an
   * OpenCL device by its number or a part of its name. The picture does not depend on it. A device that does not exist is an error that
   * lists the existing ones, and the previous device stays. A mesh that does not fit a device is drawn on the host. Default "auto".
   */
  virtual void SetDevice(const char* device);
  virtual const char* GetDevice();
  const char* GetDeviceName(); // the device in use, "" if there is none
  //@}

  /**
   * Get the build stages of the last frame that built anything. Each row is a stage. Columns: "Stage" (string), "Where" (string: the name
   * of the device that ran its kernels, or "host"), "Milliseconds" (double: wall-clock time without nested stages), "Bytes" (vtkIdType:
   * size of the stage's results) and "Kernels" (vtkIdType: number of kernels that the device ran). Drawing itself is not a stage. A frame
   * that reuses everything changes no row. An aborted frame reports the stages that it finished. The table has no rows before the first
   * frame.
   */
  vtkTable* GetBuildReport();

  //@{
  /**
   * Get statistics of the last picture's march: milliseconds of the march; milliseconds to prepare the grid, 0 if it was ready; cells that
   * rays passed; faces through which rays entered.
   */
  double GetMarchMilliseconds();
  double GetBuildMilliseconds();
  vtkIdType GetNumberOfSegments();
  vtkIdType GetNumberOfEntries();
  //@}

  //@{
  /**
   * Get counts of the last picture: tetrahedra into which the cells were divided; cells ignored (vertices, lines and polygons); tetrahedra
   * left out though not hidden by a ghost or blanking array, because a value is not finite or a point is repeated.
   */
  vtkIdType GetNumberOfTetrahedra();
  vtkIdType GetNumberOfIgnoredCells();
  vtkIdType GetNumberOfBlankedTetrahedra();
  //@}

  //@{
  /**
   * Get the method of the last picture, march or project, and its reason. Get statistics of the projection, 0 where rays marched:
   * milliseconds to order cells, to sort their outlines into tiles, and to draw pixels; cells in view; pixels whose cells had come in a
   * wrong order (across gaps, in cycles) and were drawn again, nearest first.
   */
  const char* GetMethodUsedAsString();
  const char* GetMethodReason();
  double GetSortMilliseconds();
  double GetBinMilliseconds();
  double GetProjectMilliseconds();
  vtkIdType GetNumberOfCellsInView();
  vtkIdType GetNumberOfPixelsDrawnAgain();
  //@}

  /**
   * Get the number of leaves that were sorted in parallel for the last picture's projection. It is the number of
   * vtkStratusPartitionFilter's leaves if the input carries its arrays and the points have not moved, else 1. It is 0 where rays marched or
   * nothing was visible.
   */
  vtkIdType GetNumberOfLeaves();

  /**
   * Get how many functions of the property were translated since this mapper was made. A function is translated again when it was modified,
   * or another one takes its place.
   */
  vtkTypeUInt64 GetFunctionBuilds();

  //@{
  /**
   * Get how many times the neighbours and borders of cells were found, and how many times values were read, since the mapper was made. If
   * the points and cells of a simulation's steps keep their content, only values are read again, even if the data objects are new. The
   * exception is a step that shows other cells: hidden cells and cells at values that are not finite do not show.
   */
  vtkTypeUInt64 GetGeometryBuilds();
  vtkTypeUInt64 GetValueBuilds();
  //@}

  /**
   * Get the reason why the last picture was refused, empty if it was not. An error event reports it, too, but only once for equal reasons
   * in a row.
   */
  const char* GetLastError();

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
   * Lengths and depths are in world units, depths along the ray from the eye (parallel: from its plane). A number that a ray does not have
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

  /**
   * Get the last picture as floats, of the renderer's viewport's size: point arrays RGBA (premultiplied by alpha) and Depth (world distance
   * along the ray from the eye, infinity where nothing is), and what SetQuantities() names. nullptr before the first picture and after one
   * that was mixed with other volumes. Each call makes a new image.
   */
  vtkImageData* GetLastImage();

  //@{
  /**
   * Set the input: a vtkUnstructuredGrid, a vtkStructuredGrid, or blocks.
   */
  void SetInputData(vtkUnstructuredGridBase* grid) override;
  void SetInputData(vtkDataSet* grid) override;
  virtual void SetInputData(vtkDataObjectTree* blocks);
  //@}

  //@{
  /**
   * Get the bounds of the input. Cells of a structured grid that a ghost or blanking array hides do not count, nor do blocks that are not
   * drawn.
   */
  double* GetBounds() VTK_SIZEHINT(6) override;
  using Superclass::GetBounds;
  //@}

  /**
   * WARNING: INTERNAL METHOD - NOT INTENDED FOR GENERAL USE
   */
  void Render(vtkRenderer* ren, vtkVolume* vol) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;
#ifndef __VTK_WRAP__
  bool Describe(vtkRenderer* renderer, vtkVolume* volume, vtkStratusMeshDescription& description);
#endif

protected:
  vtkStratusTetrahedraMapper();
  ~vtkStratusTetrahedraMapper() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;

  int RenderMode = COMPOSITE_MODE;
  int Normals = FACE_NORMALS;
  double ImageErrorTolerance = 0.001;
  vtkTypeBool Shadows = 0;
  double VolumetricScatteringBlending = 0.0, ScatteringAnisotropy = 0.0, GlobalIlluminationReach = 1.0;
  vtkTypeBool MultipleScattering = 0;
  double SkyZenith[3] = { 0.0, 0.0, 0.0 }, SkyHorizon[3] = { 0.0, 0.0, 0.0 }, SkyUp[3] = { 0.0, 0.0, 1.0 };
  vtkSmartPointer<vtkLight> Sun;
  vtkTypeBool ScreenEncoding = 0;
  double Termination = 0.0;
  double GradientOpacityDistance = 0.0;
  int ComponentMixing = ADD_COMPONENTS;
  int Method = AUTO_METHOD;
  int NumberOfThreads = 0;
  char* Quantities = nullptr;
  double TransmittanceThreshold = 0.5;
  double AverageIPScalarRange[2] = { VTK_FLOAT_MIN, VTK_FLOAT_MAX };
  bool Cropping = false;
  double CroppingRegionPlanes[6] = { 0, 1, 0, 1, 0, 1 };
  int CroppingRegionFlags = 0x0002000;
  vtkSmartPointer<vtkImageData> MaskInput;
  int MaskType = BinaryMaskType;

private:
  vtkStratusTetrahedraMapper(const vtkStratusTetrahedraMapper&) = delete;
  void operator=(const vtkStratusTetrahedraMapper&) = delete;

  class Internals;
  friend class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
