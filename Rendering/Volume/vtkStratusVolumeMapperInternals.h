// SPDX-License-Identifier: BSD-3-Clause
// State that vtkStratusVolumeMapper keeps between pictures. Private to the module.
#ifndef vtkStratusVolumeMapperInternals_h
#define vtkStratusVolumeMapperInternals_h

#include "vtkStratusCellFinder.h"
#include "vtkStratusContext.h"
#include "vtkStratusDisplay.h"
#include "vtkStratusInput.h"
#include "vtkStratusLeftOut.h"
#include "vtkStratusSurfaces.h"
#include "vtkStratusMultiVolume.h"
#include "vtkStratusPicture.h"
#include "vtkStratusQuantities.h"
#include "vtkStratusSheet.h"
#include "vtkStratusVectors.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkDataObject.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

#include <array>
#include <string>
#include <vector>

class VTK_STRATUS_PRIVATE vtkStratusVolumeMapper::Internals
{
public:
  explicit Internals(vtkStratusVolumeMapper* mapper);
  ~Internals();

  // Makes the context and the caster where there are none, or where the number of threads has changed.
  bool PrepareContext(std::string& error);

  // Draws a whole picture. `error` stays empty where an abort ended it.
  bool Render(vtkRenderer* renderer, vtkVolume* prop, std::string& error);
  // vtkStratusVolumeMapper::MeasureSampling().
  bool Measure(vtkRenderer* renderer, vtkVolume* prop, double choice[4]);
  // The same by a caster, with options of Describe().
  bool Probe(stratus_ray_caster* caster, stratus_ray_cast_options options, double choice[4]);
  // Checks everything that is drawn but the camera, and sets Image, Functions and the options by it. Needs no context.
  bool Describe(vtkRenderer* renderer, vtkVolume* prop, stratus_ray_cast_options& options, std::string& error);
  // Offers the input's tree to a caster of the context. A damaged tree is reported once, and the caster builds its own.
  void OfferTree(stratus_ray_caster* caster, stratus_context* context);
  // Extends the ranges of a function's columns and rows by the data's ranges, if the property has a function of two variables.
  void AddTransfer2DRanges(vtkVolumeProperty* property, double ranges[4]);
  vtkImageData* GetLastImage();
  vtkTypeUInt64 GetFunctionBuilds() const;
  bool IsSupported(vtkVolumeProperty* property) const; // whether a picture by this property may be drawn, whatever the data
  // Fills an image of the viewport's size, or empties it where there is no picture.
  void FillColorImage(vtkImageData* image) const;
  void FillDepthImage(vtkImageData* image, int type) const;
  // Takes the report of a picture that was drawn with other volumes. The mapper has no picture of its own then.
  void SetMixed(const stratus_ray_cast_report& report);
  // Drops the prop that mixed this volume with others.
  void ReleaseJoint(vtkRenderer* renderer);
  // Extends the bounds by half a voxel on all sides, in first hits of point data, and along the axes of which there is one layer of points.
  void WidenBounds(double bounds[6]) const;

  vtkStratusVolumeMapper* Mapper;
  stratus_ray_caster* Caster = nullptr;
  vtkStratusContext Context;
  stratus_ray_cast_report Report = stratus_ray_cast_report();
  stratus_path_tracer* Tracer = nullptr; // of paths; belongs to the context
  stratus_path_report PathReport = stratus_path_report();
  vtkNew<vtkTable> BuildReport;
  vtkStratusCellFinder Finder;
  vtkStratusImageView Image;
  std::vector<vtkStratusTransferView> Transfers; // at least one per independent component, or per label
  std::vector<stratus_transfer> Functions;       // this frame's functions as the core's structs
  vtkStratusDisplay Display;
  vtkSmartPointer<vtkStratusMultiVolume> Joint; // mixes overlapping volumes of which this mapper's is the first; nullptr: there are none
  std::string LastError;                        // of the last picture, reported already; empty: none
  vtkStratusLeftOut LeftOut;                    // settings that the last picture did not use
  vtkStratusSurfaces Surfaces;                  // that hide the last picture's lights
  bool ShowsCoarse = false;                     // the last picture is of a coarse copy
  double DrawMilliseconds = 0.0;
  double UsedCoarseness = 1.0;
  vtkSmartPointer<vtkDataObject> PickedOf;           // composite data whose block the input is; nullptr: the input is all
  double Transfer2DRanges[4] = { 0., -1., 0., -1. }; // of a function's columns and rows in place of the data's; empty: of the data
  // Of the array, as stratus_volume has them, and the length that their magnitudes are of; nullptr and 0: differences of the values.
  const float* Gradients = nullptr;
  double GradientLength = 0.0;

private:
  // How coarsely the picture is drawn: the factor of the sample distance, and the pixels between rays.
  struct Coarseness {
    double Step = 1.0;
    double Pixels = 1.0;
  };

  bool OnProgress(double fraction);
  bool CheckMapper(std::string& error) const;
  bool CheckScene(vtkVolume* prop, std::string& error) const;
  bool PrepareInput(vtkVolume* prop, std::string& error);
  // Finds the scalar array, and whether it is of cells.
  vtkDataArray* FindArray(vtkDataSet* image, bool& cells, std::string& error) const;
  // Vectors and their modes, pictures as images, and calls of VTK's mappers (vtkStratusVolumeMapperVTK.cxx).
  int GetVectorComponent(vtkDataArray* array) const;
  double GetGradientOpacityDistance() const;
  void WarnOfGradientOpacity(vtkVolumeProperty* property);
  stratus_mode GetMode() const; // by render mode and blend mode, which CheckMapper() has found in range
  bool HasLight() const;        // whether the mode is lit
  bool HasLabelMap() const;     // whether the mask is a label map
  bool HasLabels() const;       // whether that map is drawn
  void NoteLeftOut(vtkVolumeProperty* property);
  void WarnOfCrop(const stratus_ray_cast_options& options);
  bool SetTransfers(vtkVolumeProperty* property, std::string& error);
  bool SetOptions(vtkVolumeProperty* property, stratus_ray_cast_options& options, std::string& error);
  // Light and first hits (vtkStratusVolumeMapperFirstHit.cxx).
  bool IsFirstHit() const { return this->Mapper->RenderMode == FIRST_HIT_MODE; }
  // Random paths (vtkStratusVolumeMapperPath.cxx).
  bool IsPath() const { return this->Mapper->RenderMode == PATH_MODE; }
  // Coarse copies of large files (vtkStratusVolumeMapperCoarse.cxx).
  void ChooseCoarse(vtkRenderer* renderer, const stratus_ray_cast_options& options);
  void ReleaseCoarse();
  stratus_status CastPaths(const stratus_ray_cast_options& options, const stratus_image& image);
  bool SetShading(vtkRenderer* renderer, vtkVolume* volume, stratus_ray_cast_options& options, std::string& error);
  bool SetMaterials(vtkVolumeProperty* property, stratus_ray_cast_options& options);
  bool SetMask(vtkVolumeProperty* property, stratus_ray_cast_options& options, std::string& error);
  // Functions of two variables (vtkStratusVolumeMapperLookup.cxx).
  bool HasTransfer2D(vtkVolumeProperty* property) const; // whether the function is drawn
  bool PrepareTransfer2D(
    vtkVolume* prop, vtkDataSet* image, vtkDataArray* array, bool cells, int component, const float* gradients, std::string& error);
  const float* FindGradients(vtkDataArray* array, int component, bool magnitude);
  vtkDataArray* FindSecond(vtkDataSet* image, bool cells, std::string& error) const;
  vtkDataArray* Pair(vtkDataArray* array, int component, vtkDataArray* second);
  bool SetTransfer2D(vtkVolumeProperty* property, vtkDataArray* array, int component, vtkDataArray* second, std::string& error);
  bool SetContours(vtkVolumeProperty* property, stratus_ray_cast_options& options, std::string& error) const;
  Coarseness ChooseCoarseness(vtkRenderer* renderer, vtkVolume* prop);
  void LearnTime(const Coarseness& coarseness);
  bool CastTo(const stratus_ray_cast_options& options, const float* depths, std::vector<float>& rgba);
  stratus_ray_cast_input InputOf(const stratus_ray_cast_options& options); // of the values or of their coarse copy
  bool Cast(vtkRenderer* renderer, const stratus_ray_cast_options& options, const float* opaqueDepth, bool bytes, std::string& error);

  vtkRenderer* Renderer = nullptr; // set while rendering
  vtkStratusPicture Picture;
  bool HasPicture = false;
  stratus_coarse* CoarseCopy =
    nullptr; // of the volume of identity CoarseOf; nullptr: none is kept. It and its caster belong to the context
  stratus_ray_caster* CoarseCaster = nullptr;
  uint64_t CoarseOf = 0;
  bool HasToRead = true;   // the last exact picture waited for bricks, or there was none
  bool HasSamples = false; // the picture was drawn with CountSamples
  std::vector<float> Rgba, Depth, PartDepth;
  std::vector<unsigned char> Bytes;
  std::vector<uint32_t> Samples;             // empty: not counted
  vtkStratusQuantities Quantities;           // of the picture
  vtkSmartPointer<vtkAbstractArray> Offered; // the array of the tree that the caster was last given
  vtkMTimeType OfferedTime = 0;
  const stratus_ray_caster* OfferedTo = nullptr;
  std::array<double, 27> LearnedFor{}; // settings and geometry for which FullMilliseconds and FullSampleDistance hold
  double FullMilliseconds = 0.0;       // estimated cast time of an exact picture, 0: unknown
  double FullSampleDistance = 0.0;
  stratus_sampling FullSampling = STRATUS_SAMPLING_AUTO;
  bool FullFollows = false;
  vtkSmartPointer<vtkImageData> LastImage;
  std::array<stratus_material, STRATUS_COMPONENTS_MAX> Materials{}; // of the picture's components
  vtkStratusVectors Vectors;
  std::vector<float> MagnitudeGradients; // of GradientsOf, as of GradientsTime
  const float* GradientsOf = nullptr;
  vtkMTimeType GradientsTime = 0;
  vtkStratusSheet Sheet, MaskSheet;                       // of an input, and of a mask, of one layer of points
  stratus_transfer_2d Transfer2D = stratus_transfer_2d(); // of this picture, if the property has one
  vtkSmartPointer<vtkDataArray> PairOf[2], Pairs;         // the arrays of two variables, and both in one as of PairTime
  vtkMTimeType PairTime = 0;
  int PairComponent = 0;     // of PairOf[0]
  vtkMTimeType WarnedOf = 0; // the property's time when it was last looked at for WarnOfGradientOpacity()
  bool Warned = false;
};

#endif
