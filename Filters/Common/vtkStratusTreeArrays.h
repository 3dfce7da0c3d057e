// SPDX-License-Identifier: BSD-3-Clause
// Names of the field data by which an image carries its tree: the filter writes them, the mapper looks for the first. Private to the
// modules.
#ifndef vtkStratusTreeArrays_h
#define vtkStratusTreeArrays_h

constexpr const char* vtkStratusTreeArray = "StratusHybridTree";
constexpr const char* vtkStratusTreeVersionArray = "StratusHybridTreeVersion";
constexpr const char* vtkStratusTreeHashArray = "StratusHybridTreeHash";

#endif
