// SPDX-License-Identifier: BSD-3-Clause
#include "text.h"

#include "support.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkTextProperty.h>
#include <vtkStdString.h>
#include <vtkTextRenderer.h>

#include <cmath>

namespace cli {

text_image render_text(const std::string& text, int size)
{
  text_image result;
  vtkNew<vtkTextProperty> look;
  look->SetFontSize(size);
  look->SetFontFamilyToArial();
  vtkNew<vtkImageData> image;
  int dimensions[2] = { 0, 0 };
  vtkTextRenderer* renderer = vtkTextRenderer::GetInstance();
  if (!renderer || !renderer->RenderString(look, text, image, dimensions, 72)) {
    throw failure("VTK has no font to write '" + text + "' with");
  }
  int extent[6];
  image->GetExtent(extent);
  result.width = dimensions[0];
  result.height = dimensions[1];
  for (int j = 0; j < dimensions[1]; ++j) {
    for (int i = 0; i < dimensions[0]; ++i) {
      result.coverage.push_back(static_cast<const uint8_t*>(image->GetScalarPointer(extent[0] + i, extent[2] + j, 0))[3]);
    }
  }
  return result;
}

double round_step(double least)
{
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (double factor : { 1.0, 2.0, 5.0 }) {
    if (factor * power >= least * (1.0 - 1e-12)) {
      return factor * power;
    }
  }
  return 10.0 * power;
}
} // namespace cli
