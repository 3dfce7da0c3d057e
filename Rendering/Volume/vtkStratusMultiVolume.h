// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusMultiVolume
 * @brief   draws up to eight volumes that may overlap as one medium, right in depth
 *
 * Along each ray the optical depths of all volumes add up, and their colours are mixed by them. Grids, spacings, directions, types and
 * matrices may differ. Volumes that overlap and are props of their own are drawn in this way, too. This prop is for programs that use
 * vtkMultiVolume's interface, need the picture or the reports of all volumes, or choose whose settings hold for the picture.
 *
 * Its interface is vtkMultiVolume's: SetVolume() accepts a vtkVolume and a port. VTK's own vtkMultiVolume works with
 * vtkGPUVolumeRayCastMapper only, which holds all inputs. Here each vtkVolume has a vtkStratusVolumeMapper of its own, which keeps its
 * input, array, cropping, clipping planes, mask, sampling and ImageErrorTolerance, and its own vtkVolumeProperty and matrix. Add this prop
 * to the renderer, not those volumes. A volume that is not visible (SetVisibility) is left out.
 *
 * A volume may have a vtkStratusTetrahedraMapper instead: unstructured and structured grids, and blocks of such, mix with the others cell
 * by cell, of blend mode composite, by method auto or march. Components, label maps, light, gradient opacity, clipping planes and crop
 * regions are each mesh's own. At least one volume must have a vtkStratusVolumeMapper.
 *
 * In all other modes, which all volumes must then have, each volume is drawn by itself. In maximum, minimum, average and additive intensity
 * the picture shows the best of the values that show, the mean over the lengths in all volumes, or the sum. First hits, isosurfaces and
 * slices are composited by depth, and surfaces at equal depth in the order of the ports.
 *
 * In composite mode volumes support one to four components, point and cell data, functions of two variables (TF_2D), light, gradient
 * opacity, binary masks and label maps, all crop regions and up to six clipping planes a volume. The prop supports opaque geometry,
 * translucent surfaces peeled with volumes, and hardware picking. Everything else is refused by an error, and nothing is drawn. A single
 * volume is drawn as by its mapper.
 *
 * The vtkStratusVolumeMapper at the lowest port sets Device, FinalColorWindow, FinalColorLevel, ImageSampleDistance,
 * MaximumImageSampleDistance, AutoAdjustSampleDistances, InteractiveUpdateRate, UseJittering, JitterSeed, NumberOfThreads, Audit and
 * CountSamples. The step is the smallest that any volume needs. A volume that needs a longer one uses every n-th of these steps, and a
 * volume whose functions are sharp is integrated from cell to cell.
 *
 * @sa vtkStratusVolumeMapper vtkStratusTetrahedraMapper vtkMultiVolume
 */
#ifndef vtkStratusMultiVolume_h
#define vtkStratusMultiVolume_h

#include "StratusRenderingVolumeModule.h" // For export macro
#include "vtkVolume.h"

#include <memory> // For std::unique_ptr
#include <string> // For Mix()
#include <vector>

class vtkImageData;
class vtkRenderer;

class STRATUSRENDERINGVOLUME_EXPORT vtkStratusMultiVolume : public vtkVolume
{
public:
  static vtkStratusMultiVolume* New();
  vtkTypeMacro(vtkStratusMultiVolume, vtkVolume);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the volume at a port, 0..7; nullptr removes it. Other ports, and a volume that is at another port or is this prop, are an
   * error, and nothing changes.
   */
  void SetVolume(vtkVolume* volume, int port = 0);
  vtkVolume* GetVolume(int port = 0);
  void RemoveVolume(int port) { this->SetVolume(nullptr, port); }
  //@}

  /**
   * Get the number of ports that have a volume.
   */
  int GetNumberOfVolumes();

  //@{
  /**
   * As in vtkMultiVolume, each volume has its own property. The getter returns the property of the volume at the lowest port (nullptr
   * without volumes), and the setter does nothing.
   */
  void SetProperty(vtkVolumeProperty* property) override;
  vtkVolumeProperty* GetProperty() override;
  //@}

  /**
   * Get the bounds of all volumes in world coordinates; uninitialized bounds (1, -1, ...) without a volume that is visible.
   */
  double* GetBounds() VTK_SIZEHINT(6) override;
  using Superclass::GetBounds;

  //@{
  /**
   * Get the latest time at which this prop, one of its volumes, or an input or function of these was modified.
   */
  vtkMTimeType GetMTime() override;
  vtkMTimeType GetRedrawMTime() override;
  //@}

  /**
   * Takes the volumes of another vtkStratusMultiVolume, too.
   */
  void ShallowCopy(vtkProp* prop) override;

  /**
   * Get the reason why the last picture was refused, empty if it was not. An error event reports it, too, but only once for equal reasons
   * in a row.
   */
  const char* GetLastError();

  /**
   * Get the last picture, as vtkStratusVolumeMapper::GetLastImage() does.
   */
  vtkImageData* GetLastImage();

  //@{
  /**
   * Get of the last picture: values interpolated, segments skipped, pixels that the audit found different, milliseconds of casting and,
   * for the volume at a port, the reason of its choice of structure and sampling ("" where there is none), and its world length between
   * samples (0).
   */
  vtkTypeUInt64 GetSamplesTaken();
  vtkTypeUInt64 GetSamplesSkipped();
  vtkTypeUInt64 GetDifferingPixels();
  double GetCastTime();
  const char* GetReason(int port);
  double GetUsedSampleDistance(int port);
  //@}

  /**
   * WARNING: INTERNAL METHOD - NOT INTENDED FOR GENERAL USE
   */
  int RenderVolumetricGeometry(vtkViewport* viewport) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;
#ifndef __VTK_WRAP__
  // Draws at most eight volumes, each of a mapper of its own, as one medium. The first vtkStratusVolumeMapper among them, of which there
  // must be one, sets what the mapper at the lowest port sets. prop: a prop of the renderer that draws one of them. Returns why nothing is
  // drawn, or "".
  static std::string Mix(vtkRenderer* renderer, vtkVolume* prop, const std::vector<vtkVolume*>& volumes);
#endif

protected:
  vtkStratusMultiVolume();
  ~vtkStratusMultiVolume() override;

private:
  vtkStratusMultiVolume(const vtkStratusMultiVolume&) = delete;
  void operator=(const vtkStratusMultiVolume&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
