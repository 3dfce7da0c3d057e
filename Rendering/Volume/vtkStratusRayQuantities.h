// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusRayQuantities
 * @brief   numbers of parallel rays through a grid, as an image: column densities, path lengths, the largest values and their depths
 *
 * Input is a vtkImageData, vtkRectilinearGrid, vtkUnstructuredGrid, vtkStructuredGrid, vtkUniformGridAMR or a composite of such grids. The
 * array that SetInputArrayToProcess() names has the values, by default the active scalars. Of several components the first counts.
 *
 * Output is a vtkImageData of one point for each ray, on the side of the data's bounding box where rays enter it. For an axis, the rays
 * look against it: down from the top for z. Points are pixels' middles. Each quantity is an array of floats of its name: "integral",
 * "length", "mean", "maximum", "maximum_depth", "cells". Integrals are exact: the field is integrated cell by cell. Depths are distances
 * from the image's plane. A ray without a value has the integral 0, and NaN for mean, maximum and its depth.
 *
 * Lengths are in the units of the coordinates, or in metres if the input's field data have an array "MetresPerUnit", which Stratus'
 * readers add. The information of each array has its unit as vtkDataArray::UNITS_LABEL(), "kg m-2" for the integral of values in "kg m-3".
 *
 * The filter needs no window and no display. It works on one rank; several pieces are an error.
 *
 * @sa vtkStratusVolumeMapper
 */
#ifndef vtkStratusRayQuantities_h
#define vtkStratusRayQuantities_h

#include "StratusRenderingVolumeModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <memory> // For std::unique_ptr

class STRATUSRENDERINGVOLUME_EXPORT vtkStratusRayQuantities : public vtkImageAlgorithm
{
public:
  static vtkStratusRayQuantities* New();
  vtkTypeMacro(vtkStratusRayQuantities, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get which quantities are computed. Default: the integral only. None is an error.
   */
  vtkSetMacro(Integral, bool);
  vtkGetMacro(Integral, bool);
  vtkBooleanMacro(Integral, bool);
  vtkSetMacro(Length, bool);
  vtkGetMacro(Length, bool);
  vtkBooleanMacro(Length, bool);
  vtkSetMacro(Mean, bool);
  vtkGetMacro(Mean, bool);
  vtkBooleanMacro(Mean, bool);
  vtkSetMacro(Maximum, bool);
  vtkGetMacro(Maximum, bool);
  vtkBooleanMacro(Maximum, bool);
  vtkSetMacro(MaximumDepth, bool);
  vtkGetMacro(MaximumDepth, bool);
  vtkBooleanMacro(MaximumDepth, bool);
  vtkSetMacro(Cells, bool);
  vtkGetMacro(Cells, bool);
  vtkBooleanMacro(Cells, bool);
  //@}

  enum { X_AXIS = 0, Y_AXIS = 1, Z_AXIS = 2, ANY_DIRECTION = 3 };

  //@{
  /**
   * Set/Get the axis against which the rays go, or that they go along Direction. Default Z_AXIS.
   */
  vtkSetClampMacro(View, int, X_AXIS, ANY_DIRECTION);
  vtkGetMacro(View, int);
  //@}

  //@{
  /**
   * Set/Get the direction of the rays for ANY_DIRECTION, of any length above 0. The image's second axis is upright then: as near to z as
   * it can be, or to y where the rays are nearly along z. Default (0, 0, -1).
   */
  vtkSetVector3Macro(Direction, double);
  vtkGetVector3Macro(Direction, double);
  //@}

  //@{
  /**
   * Set/Get the numbers of rays along the image's axes, 0..16384. 0 (default): along an axis of an image or a structured grid, as many
   * as it has cells along each, at most 1024; otherwise 512.
   */
  vtkSetVector2Macro(Resolution, int);
  vtkGetVector2Macro(Resolution, int);
  //@}

  //@{
  /**
   * Set/Get the device: "auto" (default), "host", an OpenCL device's number, or a part of its name.
   */
  vtkSetStringMacro(Device);
  vtkGetStringMacro(Device);
  //@}

protected:
  vtkStratusRayQuantities();
  ~vtkStratusRayQuantities() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  bool Integral = true, Length = false, Mean = false, Maximum = false, MaximumDepth = false, Cells = false;
  int View = Z_AXIS;
  double Direction[3] = { 0.0, 0.0, -1.0 };
  int Resolution[2] = { 0, 0 };
  char* Device = nullptr;
  int Pieces = 1; // of the update

private:
  vtkStratusRayQuantities(const vtkStratusRayQuantities&) = delete;
  void operator=(const vtkStratusRayQuantities&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
