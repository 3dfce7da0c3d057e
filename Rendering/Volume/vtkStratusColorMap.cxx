// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusColorMap.h"

#include "stratus/color_map.h"

#include <vtkColorTransferFunction.h>
#include <vtkObjectFactory.h>

#include <array>

vtkStandardNewMacro(vtkStratusColorMap);

const char* vtkStratusColorMap::GetName(int number)
{
  return stratus_color_map_name(number);
}

bool vtkStratusColorMap::SetColors(vtkColorTransferFunction* function, const char* name, double low, double high)
{
  std::array<double, 4 * STRATUS_COLOR_MAP_COLORS> points;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  options.threads = 1;
  stratus_context* context = nullptr;
  if (!function || stratus_context_create(&options, &context, nullptr, 0) != STRATUS_OK) {
    return false;
  }
  const bool known = stratus_color_map_points(context, name, low, high, points.data()) == STRATUS_OK;
  stratus_context_destroy(context);
  if (!known) {
    return false;
  }
  function->RemoveAllPoints();
  function->SetColorSpaceToRGB();
  for (size_t i = 0; i < points.size(); i += 4) {
    function->AddRGBPoint(points[i], points[i + 1], points[i + 2], points[i + 3]);
  }
  return true;
}
