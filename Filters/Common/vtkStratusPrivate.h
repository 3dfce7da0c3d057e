// SPDX-License-Identifier: BSD-3-Clause
// VTK_STRATUS_PRIVATE hides what a module keeps to itself: objects of the Common folders are in several modules, a copy in each.
// Private to the modules, never installed.
#ifndef vtkStratusPrivate_h
#define vtkStratusPrivate_h

#if defined(__GNUC__)
#define VTK_STRATUS_PRIVATE __attribute__((visibility("hidden")))
#else
#define VTK_STRATUS_PRIVATE
#endif

#endif
