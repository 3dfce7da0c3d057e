// SPDX-License-Identifier: BSD-3-Clause
// Names of the field-data arrays in which an image carries its tree. vtkStratusHybridTreeFilter writes all three, vtkStratusVolumeMapper
// reads the first. Private to the modules.
#ifndef vtkStratusTreeArrays_h
#define vtkStratusTreeArrays_h

constexpr const char* vtkStratusTreeArray = "StratusHybridTree";
constexpr const char* vtkStratusTreeVersionArray = "StratusHybridTreeVersion";
constexpr const char* vtkStratusTreeHashArray = "StratusHybridTreeHash";

#endif
