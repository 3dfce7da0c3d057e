// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusColorMap
 * @brief   colour maps by name, as matplotlib, cmocean and ParaView have them, for vtkColorTransferFunction
 *
 * The maps are those of the core (stratus/color_map.h): 256 colours each, with the bytes of their owners' maps. "_r" after a name
 * reverses the map.
 *
 * @sa vtkStratusVolumeMapper
 */
#ifndef vtkStratusColorMap_h
#define vtkStratusColorMap_h

#include "StratusRenderingVolumeModule.h" // For export macro
#include "vtkObject.h"

class vtkColorTransferFunction;

class STRATUSRENDERINGVOLUME_EXPORT vtkStratusColorMap : public vtkObject
{
public:
  static vtkStratusColorMap* New();
  vtkTypeMacro(vtkStratusColorMap, vtkObject);

  /**
   * Return the name of a map, numbered from 0, or nullptr after the last one and below 0.
   */
  static const char* GetName(int number);
  /**
   * Replace a function's points by the 256 colours of a map, the first at the value low and the last at high, low <= high. Set its colour
   * space to RGB. Return false, and leave the function as it is, if no map has this name or the values are not finite or not in order.
   */
  static bool SetColors(vtkColorTransferFunction* function, const char* name, double low, double high);

protected:
  vtkStratusColorMap() = default;
  ~vtkStratusColorMap() override = default;

private:
  vtkStratusColorMap(const vtkStratusColorMap&) = delete;
  void operator=(const vtkStratusColorMap&) = delete;
};

#endif
