// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVolumeMapper
 * @brief   draws a vtkImageData by ray casting that skips what is transparent, without changing the picture
 *
 * Takes the place of vtkSmartVolumeMapper: a vtkImageData and the vtkVolume's vtkVolumeProperty go in, the picture is composited with
 * the opaque geometry of the scene. Setters that mean the same have vtkSmartVolumeMapper's names.
 *
 * Supported: point and cell scalars of any numeric type but bits, linear and nearest interpolation, scalar opacity, colour or grey,
 * ScalarOpacityUnitDistance, ghost and blanking arrays, the image's extent, spacing, origin and direction, the volume's matrix, cropping
 * to any of the 27 regions, up to six clipping planes, binary masks, jitter, and the blend modes composite, maximum and minimum
 * intensity, average intensity (AverageIPScalarRange), additive, and isosurface (vtkVolumeProperty::GetIsoSurfaceValues(), up to 16,
 * linear interpolation, every root of the field in each cell). In composite also: light (Shade; the renderer's lights and
 * TwoSidedLighting, by VTK's formula with the normal and the eye's direction of each sample; isosurfaces, too); gradient opacity (over
 * magnitudes in values per mean spacing, as VTK's mappers have it; it multiplies the optical depth); arrays of 2 to 4 components:
 * independent ones are media that mix (their optical depths add up, times ComponentWeight; their shading must be alike), dependent ones
 * are colour and opacity (2), or red, green, blue and opacity (4 of unsigned char); and label maps. All else (blend mode slice,
 * two-dimensional transfer functions, gradient opacity of labels, UseClippedVoxelIntensity, depth peeling of volumes, shaders of the
 * prop's own, other data than vtkImageData) is refused by an error, and nothing is drawn; the module's README has a table of it. Picking
 * by hardware finds the volume where it shows.
 *
 * RenderModeToFirstHit draws what shows (opacity > 0) as solid voxels in the light of the renderer instead, and writes their depth. There
 * the property's Shade, Ambient, Diffuse, Specular and SpecularPower count; positional lights are taken without attenuation and cone (a
 * cone below 90 degrees is refused), and the mapper's bounds reach half a voxel farther, for a voxel of point data is a cube about its
 * point.
 *
 * An image that comes with a tree (vtkStratusHybridTreeFilter) has it used where it serves.
 *
 * What is built is kept: a new picture of the same data rebuilds nothing, a new transfer function rebuilds tables and structure only.
 *
 * @sa vtkStratusHybridTreeFilter vtkStratusDistanceMapFilter vtkSmartVolumeMapper
 */
#ifndef vtkStratusVolumeMapper_h
#define vtkStratusVolumeMapper_h

#include "StratusRenderingVolumeModule.h" // For export macro
#include "vtkSmartPointer.h"              // For MaskInput
#include "vtkVolumeMapper.h"

#include <memory> // For std::unique_ptr

class vtkImageData;

class STRATUSRENDERINGVOLUME_EXPORT vtkStratusVolumeMapper : public vtkVolumeMapper
{
public:
  static vtkStratusVolumeMapper* New();
  vtkTypeMacro(vtkStratusVolumeMapper, vtkVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum RenderModeType { COMPOSITE_MODE, FIRST_HIT_MODE };
  //@{
  /**
   * Light through the whole of each ray, or the first voxel of opacity > 0 as a lit, opaque solid. Default COMPOSITE_MODE.
   */
  vtkSetClampMacro(RenderMode, int, COMPOSITE_MODE, FIRST_HIT_MODE);
  vtkGetMacro(RenderMode, int);
  void SetRenderModeToComposite() { this->SetRenderMode(COMPOSITE_MODE); }
  void SetRenderModeToFirstHit() { this->SetRenderMode(FIRST_HIT_MODE); }
  const char* GetRenderModeAsString();
  //@}

  enum NormalsType { FACE_NORMALS, GRADIENT_NORMALS };
  //@{
  /**
   * What light falls on in first hits: the voxels' faces, or the field's gradient by central differences. Default FACE_NORMALS.
   */
  vtkSetClampMacro(Normals, int, FACE_NORMALS, GRADIENT_NORMALS);
  vtkGetMacro(Normals, int);
  void SetNormalsToFaces() { this->SetNormals(FACE_NORMALS); }
  void SetNormalsToGradient() { this->SetNormals(GRADIENT_NORMALS); }
  //@}

  //@{
  /**
   * World length between two samples of a ray; 0 or less takes it from the data's spacing and the transfer function. Default -1.
   */
  vtkSetMacro(SampleDistance, double);
  vtkGetMacro(SampleDistance, double);
  //@}

  //@{
  /**
   * While the window's desired update rate is at least InteractiveUpdateRate, draw as coarsely as the time allotted to this volume
   * asks for: first longer steps, then fewer rays. Below that rate the picture is exact. Default on.
   */
  vtkSetClampMacro(AutoAdjustSampleDistances, vtkTypeBool, 0, 1);
  vtkGetMacro(AutoAdjustSampleDistances, vtkTypeBool);
  vtkBooleanMacro(AutoAdjustSampleDistances, vtkTypeBool);
  //@}

  //@{
  /**
   * Frames a second from which AutoAdjustSampleDistances is at work, 1e-10..1e10. Default 1: a still picture of VTK's interactor (rate
   * 0.0001) is exact, one that moves (rate 15) is adjusted.
   */
  vtkSetClampMacro(InteractiveUpdateRate, double, 1.0e-10, 1.0e10);
  vtkGetMacro(InteractiveUpdateRate, double);
  //@}

  //@{
  /**
   * Pixels between two rays along each axis of the window, 1..100, and the most that AutoAdjustSampleDistances may take. Default 1 and 8.
   */
  vtkSetClampMacro(ImageSampleDistance, double, 1.0, 100.0);
  vtkGetMacro(ImageSampleDistance, double);
  vtkSetClampMacro(MaximumImageSampleDistance, double, 1.0, 100.0);
  vtkGetMacro(MaximumImageSampleDistance, double);
  //@}

  //@{
  /**
   * How many times the sample distance AutoAdjustSampleDistances may make it, 1..100. Default 2.
   */
  vtkSetClampMacro(MaximumSampleDistanceFactor, double, 1.0, 100.0);
  vtkGetMacro(MaximumSampleDistanceFactor, double);
  //@}

  //@{
  /**
   * Window and level of the final colours: a colour c is shown as (c - level) / window + 0.5. The window is not 0, a negative one
   * inverts. Default 1 and 0.5: as they are. GetLastImage() is not affected.
   */
  vtkSetMacro(FinalColorWindow, float);
  vtkGetMacro(FinalColorWindow, float);
  vtkSetMacro(FinalColorLevel, float);
  vtkGetMacro(FinalColorLevel, float);
  //@}

  enum StructureType { AUTO_STRUCTURE, NO_STRUCTURE, BLOCK_STRUCTURE, DISTANCE_STRUCTURE, OCTANT_STRUCTURE, HYBRID_STRUCTURE };
  //@{
  /**
   * What tells the rays where nothing is to see: nothing, a flag a block, a distance map, eight of them by the ray's octant, or a hybrid
   * tree. No choice changes the picture. Default AUTO_STRUCTURE: the cheapest that the scene needs.
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

  enum SamplingType { AUTO_SAMPLING, MIDPOINT_SAMPLING, PREINTEGRATED_SAMPLING };
  //@{
  /**
   * One value in the middle of each segment, or the transfer function integrated between the values at its ends. Nearest interpolation is
   * never pre-integrated. Default AUTO_SAMPLING: by the transfer function's bend against the data.
   */
  vtkSetClampMacro(Sampling, int, AUTO_SAMPLING, PREINTEGRATED_SAMPLING);
  vtkGetMacro(Sampling, int);
  void SetSamplingToAuto() { this->SetSampling(AUTO_SAMPLING); }
  void SetSamplingToMidpoint() { this->SetSampling(MIDPOINT_SAMPLING); }
  void SetSamplingToPreintegrated() { this->SetSampling(PREINTEGRATED_SAMPLING); }
  const char* GetSamplingAsString();
  //@}

  enum { BinaryMaskType = 0, LabelMapMaskType };
  //@{
  /**
   * As vtkGPUVolumeRayCastMapper's: an image of one unsigned char a value of the input (point scalars; of the same dimensions as the
   * values), 0 where nothing is to be seen. Taken at the nearest value. Default nullptr: none. Of type label map it hides nothing: its
   * bytes are labels, and where label l has vtkVolumeProperty::SetLabelColor() or SetLabelScalarOpacity(), values have those in place of
   * the property's (composite, one component). Default binary.
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
   * Move each ray's samples along it by up to a sample distance, so that the wood grain of long steps turns into noise. The noise is the
   * same from picture to picture, at any number of threads; another seed is another noise. Default off, seed 0.
   */
  vtkSetClampMacro(UseJittering, vtkTypeBool, 0, 1);
  vtkGetMacro(UseJittering, vtkTypeBool);
  vtkBooleanMacro(UseJittering, vtkTypeBool);
  vtkSetMacro(JitterSeed, unsigned int);
  vtkGetMacro(JitterSeed, unsigned int);
  //@}

  //@{
  /**
   * A ray ends when its opacity passes this, 0..1. Default 0.999.
   */
  vtkSetClampMacro(Termination, double, 0.0, 1.0);
  vtkGetMacro(Termination, double);
  //@}

  //@{
  /**
   * Cells along a block of the structure: 2, 4, 8, 16, 32, or 0 for the core's default. Others are an error when drawing. Default 0.
   */
  vtkSetMacro(BlockSize, int);
  vtkGetMacro(BlockSize, int);
  //@}

  //@{
  /**
   * Where rays are cast: "auto" (the first OpenCL GPU, else the host), "host", or an OpenCL device by its number or a part of its name.
   * One that does not exist is an error with the list of those that do, and the device stays what it was. Default "auto".
   */
  virtual void SetDevice(const char* device);
  virtual const char* GetDevice();
  //@}

  //@{
  /**
   * Threads of the host, 1..1024, or 0 for as many as OpenMP would take. The picture does not depend on it. Default 0.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  //@{
  /**
   * Also march without structure and count the pixels that differ, see GetDifferingPixels(). Slow. Default off.
   */
  vtkSetClampMacro(Audit, vtkTypeBool, 0, 1);
  vtkGetMacro(Audit, vtkTypeBool);
  vtkBooleanMacro(Audit, vtkTypeBool);
  //@}

  //@{
  /**
   * Also count the values interpolated for each pixel: GetLastImage() then has them as "Samples". Does not change the picture. Default off.
   */
  vtkSetClampMacro(CountSamples, vtkTypeBool, 0, 1);
  vtkGetMacro(CountSamples, vtkTypeBool);
  vtkBooleanMacro(CountSamples, vtkTypeBool);
  //@}

  //@{
  /**
   * Of the last picture drawn: values interpolated, segments skipped, reads of the structure, pixels that the audit found different,
   * blocks and how many of them are occupied, and bytes of the structure.
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
   * How often each was built since this mapper (or its device or threads) was set up.
   */
  vtkTypeUInt64 GetRangeBuilds();
  vtkTypeUInt64 GetTableBuilds();
  vtkTypeUInt64 GetOccupancyBuilds();
  vtkTypeUInt64 GetStructureBuilds();
  vtkTypeUInt64 GetUploads();
  /**
   * Whether the last picture was drawn by the tree that the input carries, so that none had to be built.
   */
  bool GetCarriedTreeUsed();
  //@}

  //@{
  /**
   * Milliseconds of the last picture by stage; 0 for what was not done. Draw is the read-back of depth and the display of the picture.
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
   * What the last picture used, and why: structure, sampling, world length between samples, pixels between rays, device.
   */
  const char* GetStructureUsedAsString();
  const char* GetSamplingUsedAsString();
  double GetUsedSampleDistance();
  double GetUsedImageSampleDistance();
  const char* GetReason();
  const char* GetDeviceName();
  //@}

  /**
   * Why the last picture was refused; empty if it was not. An error event tells the same, but only the first of equal ones in a row.
   */
  const char* GetLastError();

  /**
   * The last picture in float, the size of the renderer's viewport, its first pixel at the bottom left: point data "RGBA" (the scalars, 4
   * components, premultiplied by alpha, without the opaque geometry) and "Depth" (world distance along the ray from the eye, in a parallel
   * view from its plane, to the first contribution; infinite where there is none), and "Samples" if the picture was drawn with
   * CountSamples, whatever it is now. A coarse picture is repeated pixel by pixel. nullptr before the first picture, and after one that was
   * refused or aborted. Copied on each call; it is the mapper's, and the next call overwrites it.
   */
  vtkImageData* GetLastImage();

  /**
   * Of the input, half a voxel more on all sides for first hits of point data.
   */
  double* GetBounds() VTK_SIZEHINT(6) override;
  using Superclass::GetBounds;

  /**
   * WARNING: INTERNAL METHOD - NOT INTENDED FOR GENERAL USE
   */
  void Render(vtkRenderer* ren, vtkVolume* vol) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

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
  int Normals = FACE_NORMALS;
  int Structure = AUTO_STRUCTURE;
  int Sampling = AUTO_SAMPLING;
  double Termination = 0.999;
  int BlockSize = 0;
  int NumberOfThreads = 0;
  vtkTypeBool Audit = 0;
  vtkSmartPointer<vtkImageData> MaskInput;
  int MaskType = BinaryMaskType;
  vtkTypeBool UseJittering = 0;
  unsigned int JitterSeed = 0;
  vtkTypeBool CountSamples = 0;

private:
  vtkStratusVolumeMapper(const vtkStratusVolumeMapper&) = delete;
  void operator=(const vtkStratusVolumeMapper&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
