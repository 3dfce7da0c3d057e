// SPDX-License-Identifier: BSD-3-Clause
// The identity of an array over a file's bytes, and the bytes that the file lacks. The array carries them in its information, since every
// module has a copy of these functions. Private to the modules, never installed.
#ifndef vtkStratusMapped_h
#define vtkStratusMapped_h

#include "vtkStratusPrivate.h"

#include <cstdint>

class vtkDataArray;
struct stratus_tiles;

// Marks an array that holds a file's values unchanged. identity: not 0, as stratus_volume has it. missing: counts
// the bytes that could not be read; it lives as long as the array's values.
// reads: null, or counts the parts of an array of bricks that were read, as long. tiles: null, or of bricks, as long.
VTK_STRATUS_PRIVATE void vtkStratusSetMapped(
  vtkDataArray* array, uint64_t identity, const uint64_t* missing, const uint64_t* reads = nullptr, const stratus_tiles* tiles = nullptr);

// Returns the identity of the array's values; 0 where they come from no mapped file, or where the array was modified since.
VTK_STRATUS_PRIVATE uint64_t vtkStratusIdentityOf(vtkDataArray* array);

// Returns where the bytes are counted that were missing when something looked at them; null for an array in memory. They count as 0.
VTK_STRATUS_PRIVATE const uint64_t* vtkStratusMissingOf(vtkDataArray* array);

// Returns where the parts that were read of an array of bricks are counted; null for another array.
VTK_STRATUS_PRIVATE const uint64_t* vtkStratusReadsOf(vtkDataArray* array);
// Returns the values in tiles, of an array of bricks that has them; else null.
VTK_STRATUS_PRIVATE const stratus_tiles* vtkStratusTilesOf(vtkDataArray* array);

#endif
