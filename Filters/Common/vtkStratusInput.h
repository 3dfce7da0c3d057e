// SPDX-License-Identifier: BSD-3-Clause
// What VTK gives, as what the core takes: views of images and transfer functions. Private to the modules, never installed.
#ifndef vtkStratusInput_h
#define vtkStratusInput_h

#include "stratus.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkColorTransferFunction;
class vtkDataArray;
class vtkImageData;
class vtkMatrix4x4;
class vtkPiecewiseFunction;
class vtkVolumeProperty;

// Hidden, because each module has its own copy.
#if defined(__GNUC__)
#define VTK_STRATUS_PRIVATE __attribute__((visibility("hidden")))
#else
#define VTK_STRATUS_PRIVATE
#endif

// A view of one array of an image. Keeps a copy where the array's memory is not one plain run of values, and remakes it when it changes.
class VTK_STRATUS_PRIVATE vtkStratusImageView
{
public:
  // False, with the reason in `error`, where the core can't take the array. matrix: of the prop, or nullptr.
  bool Set(vtkImageData* image, vtkDataArray* array, bool cells, vtkMatrix4x4* matrix, std::string& error, int mostComponents = 1);
  // A filter's input and the array of it that the filter is to process, each nullptr where there is none.
  bool SetInput(vtkImageData* image, vtkDataArray* array, int association, std::string& error);
  const stratus_volume& GetVolume() const { return this->Volume; }
  // What the image calls its origin and start, against what the volume does: crop_bounds = planes + offset.
  const double* GetCropOffset() const { return this->CropOffset; }
  void Release();

private:
  bool SetValues(vtkImageData* image, vtkDataArray* array, bool cells, int mostComponents, std::string& error);
  void SetGeometry(vtkImageData* image, vtkMatrix4x4* matrix);
  bool SetGhosts(vtkImageData* image, bool cells, std::string& error);

  stratus_volume Volume;
  double CropOffset[3] = { 0, 0, 0 };
  vtkSmartPointer<vtkDataArray> Source; // held, so that no other array can take its address
  vtkSmartPointer<vtkDataArray> Plain;
  vtkMTimeType PlainTime = 0;
};

// A transfer function and the arrays it points to.
class VTK_STRATUS_PRIVATE vtkStratusTransferView
{
public:
  // Of the property's component `index`.
  bool Set(vtkVolumeProperty* property, int index, std::string& error);
  // Of a label: what the property does not have for it is component 0's; no gradient opacity.
  bool SetLabel(vtkVolumeProperty* property, int label, std::string& error);
  bool Set(vtkVolumeProperty* property, std::string& error) { return this->Set(property, 0, error); }
  const stratus_transfer& GetTransfer() const { return this->Transfer; }

private:
  stratus_transfer Transfer;
  std::vector<double> Opacity;
  std::vector<double> Color;
  std::vector<double> Gradient;
};

// Which array a mapper or filter means is VTK's business; why there is none is told here.
VTK_STRATUS_PRIVATE std::string vtkStratusArrayNames(vtkImageData* image);

#endif
