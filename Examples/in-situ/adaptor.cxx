// SPDX-License-Identifier: BSD-3-Clause
// The simulation's values as an image of VTK, without a copy, for Catalyst's pipelines in Python.
#include "adaptor.h"

#include <vtkCPDataDescription.h>
#include <vtkCPInputDataDescription.h>
#include <vtkCPProcessor.h>
#include <vtkCPPythonPipeline.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>

namespace {

vtkSmartPointer<vtkCPProcessor> processor;
}

int adaptor_start(const char* script)
{
  processor = vtkSmartPointer<vtkCPProcessor>::New();
  if (!processor->Initialize()) {
    return 1;
  }
  const auto pipeline = vtkCPPythonPipeline::CreateAndInitializePipeline(script, 2);
  return pipeline && processor->AddPipeline(pipeline) ? 0 : 1;
}

void adaptor_show(const int whole[3], int first, int last, const float* values, double time, int step)
{
  vtkNew<vtkCPDataDescription> description;
  description->AddInput("plume");
  description->SetTimeData(time, step);
  if (!processor->RequestDataDescription(description)) {
    return; // no pipeline wants this step
  }
  vtkNew<vtkImageData> image;
  image->SetExtent(first, last, 0, whole[1], 0, whole[2]);
  vtkNew<vtkFloatArray> array;
  array->SetName("concentration");
  array->SetArray(const_cast<float*>(values), image->GetNumberOfPoints(), 1); // 1: it stays the simulation's
  image->GetPointData()->SetScalars(array);
  vtkCPInputDataDescription* input = description->GetInputDescriptionByName("plume");
  input->SetGrid(image);
  int extent[6] = { 0, whole[0], 0, whole[1], 0, whole[2] };
  input->SetWholeExtent(extent);
  processor->CoProcess(description);
}

void adaptor_end(void)
{
  processor->Finalize();
  processor = nullptr;
}
