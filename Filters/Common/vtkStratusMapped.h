// SPDX-License-Identifier: BSD-3-Clause
// The identity of an array over a file's bytes, and the bytes that the file lacks. The array carries them in its information, since every
// module has a copy of these functions. Private to the modules, never installed.
#ifndef vtkStratusMapped_h
#define vtkStratusMapped_h

#include "vtkStratusPrivate.h"

#include <cstdint>

class vtkDataArray;
struct stratus_parts;
struct stratus_tiles;
struct stratus_volume;

// Marks an array that holds a file's values unchanged. identity: not 0, as stratus_volume has it. missing: counts
// the bytes that could not be read; it lives as long as the array's values.
// reads: null, or counts the parts of an array of bricks that were read, as long. tiles, parts: null, or of bricks, as long.
VTK_STRATUS_PRIVATE void vtkStratusSetMapped(vtkDataArray* array, uint64_t identity, const uint64_t* missing,
  const uint64_t* reads = nullptr, const stratus_tiles* tiles = nullptr, const stratus_parts* parts = nullptr);

// Returns the identity of the array's values; 0 where they come from no mapped file, or where the array was modified since.
VTK_STRATUS_PRIVATE uint64_t vtkStratusIdentityOf(vtkDataArray* array);

// Marks flags of points or cells that say of each only whether it is another rank's, and whose cells that are not are a box; returns
// whether an array has the mark.
VTK_STRATUS_PRIVATE void vtkStratusSetOnlyDuplicates(vtkDataArray* flags);
VTK_STRATUS_PRIVATE bool vtkStratusHasOnlyDuplicates(vtkDataArray* flags);

// Returns where the parts that were read of an array of bricks are counted; null for another array.
VTK_STRATUS_PRIVATE const uint64_t* vtkStratusReadsOf(vtkDataArray* array);
// Sets the identity, the missing bytes, the tiles and the parts of a volume whose values are a component of an array. Its type and
// dimensions are set.
VTK_STRATUS_PRIVATE void vtkStratusSetSource(vtkDataArray* array, int component, stratus_volume& volume);

#endif
