// SPDX-License-Identifier: BSD-3-Clause
// One picture of several grids, for which the settings of one vtkStratusVolumeMapper hold. Private to the module.
#ifndef vtkStratusJointPicture_h
#define vtkStratusJointPicture_h

#include "vtkStratusDisplay.h"
#include "vtkStratusPicture.h"
#include "vtkStratusQuantities.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

class vtkImageData;
class vtkProp3D;
class vtkRenderer;
class vtkStratusVolumeMapper;
class vtkWindow;

class VTK_STRATUS_PRIVATE vtkStratusJointPicture
{
public:
  using CastRays = std::function<bool(const stratus_camera& camera, const stratus_image& image, bool whole, std::string& error)>;

  // The drawn scene. Boxes are the grids that may show.
  struct Scene {
    vtkRenderer* Renderer = nullptr;
    vtkProp3D* Prop = nullptr;
    vtkStratusVolumeMapper* Settings = nullptr;
    std::vector<vtkStratusPicture::Box> Boxes;
    bool TakesShadows = false; // as in vtkStratusPicture; Cast() then adds them
    // Casts the rays. whole: it is the picture itself, not a part between peels. Returns false where it fails, with the reason in `error`,
    // or where an abort ends it. Valid in this frame, even when the scene is gone.
    CastRays Cast;
    // Computes the quantities of the rays that were cast. Returns as Cast.
    std::function<bool(const stratus_camera& camera, const stratus_image& image, vtkStratusQuantities& quantities, std::string& error)>
      Measure;
    vtkStratusCellFinder* Finder = nullptr; // for Display, while the renderer picks
    // Results of Cast() for the whole frame.
    double Milliseconds = 0.0;
    int Window[4] = { 0, 0, 0, 0 };

    // Adds shadows to surfaces, and sets the window, after the whole picture was cast.
    stratus_status Finish(
      const stratus_ray_cast_input* inputs, int count, const stratus_camera& camera, const stratus_image& image, const int window[4]);
  };

  // As in vtkStratusDisplay.
  bool Begin(vtkRenderer* renderer, vtkProp* prop, vtkAbstractMapper* mapper, const std::string& lastError, std::string& error);
  // Must follow Begin(). `error` stays empty where an abort ended the picture.
  bool Render(Scene& scene, std::string& error);
  // Returns nullptr where there is no picture, as after one that was refused.
  vtkImageData* GetLastImage();
  // Forgets how long a picture takes.
  void ForgetTime() { this->FullMilliseconds = 0.0; }
  void ReleaseGraphicsResources(vtkWindow* window) { this->Display.ReleaseGraphicsResources(window); }

  // The error of random paths through several grids.
  static constexpr const char* NoPaths =
    "paths go through one grid alone, not through several: composite mode with MultipleScattering scatters light in all of them";

  // Whether another prop is drawn by this module and writes no depth, so that no ray ends at it.
  static bool EndsNoRay(vtkProp* other);

private:
  double ChooseCoarseness(const Scene& scene) const;
  void LearnTime(const Scene& scene);

  vtkStratusDisplay Display;
  vtkStratusPicture Picture;
  bool HasPicture = false, HasSamples = false;
  double FullMilliseconds = 0.0; // estimated time of an exact picture, 0: unknown
  vtkMTimeType LearnedFor = 0;
  CastRays CastPart; // of the frame
  std::vector<float> Rgba, Depth, PartDepth;
  std::vector<unsigned char> Bytes;
  std::vector<uint32_t> Samples;
  vtkStratusQuantities Quantities;
  vtkSmartPointer<vtkImageData> LastImage;
};

#endif
