// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMapped.h"

#include "stratus/volume.h"

#include "vtkDataArray.h"
#include "vtkInformation.h"
#include "vtkInformationKeyLookup.h"
#include "vtkInformationUnsignedLongKey.h"

#include <algorithm>
#include <string>

namespace {
static_assert(sizeof(unsigned long) >= sizeof(uint64_t) || sizeof(void*) < sizeof(uint64_t), "numbers of a mapping fit the key");

// The key of that name, which the first of the modules made that needed it.
vtkInformationUnsignedLongKey* Key(const char* name)
{
  constexpr const char* place = "vtkStratusMapped";
  vtkInformationKey* key = vtkInformationKeyLookup::Find(name, place);
  if (!key) {
    key = vtkInformationUnsignedLongKey::MakeKey(name, place);
  }
  return static_cast<vtkInformationUnsignedLongKey*>(key);
}

// The number that the key has in the array's information; 0 where there is none.
unsigned long Find(vtkDataArray* array, const char* name)
{
  vtkInformationUnsignedLongKey* const key = Key(name);
  return array->HasInformation() && array->GetInformation()->Has(key) ? array->GetInformation()->Get(key) : 0;
}

// Whether these are the values that were mapped: copies of the array have its information, too.
bool HasItsValues(vtkDataArray* array)
{
  return array && Find(array, "VALUES") != 0 && Find(array, "VALUES") == reinterpret_cast<unsigned long>(array->GetVoidPointer(0));
}
} // namespace

void vtkStratusSetMapped(vtkDataArray* array, uint64_t identity, const uint64_t* missing, const uint64_t* reads, const stratus_tiles* tiles,
  const stratus_parts* parts)
{
  vtkInformation* const information = array->GetInformation();
  information->Set(Key("IDENTITY"), static_cast<unsigned long>(identity));
  information->Set(Key("MISSING"), reinterpret_cast<unsigned long>(missing));
  information->Set(Key("READS"), reinterpret_cast<unsigned long>(reads));
  information->Set(Key("TILES"), reinterpret_cast<unsigned long>(tiles));
  information->Set(Key("PARTS"), reinterpret_cast<unsigned long>(parts));
  information->Set(Key("VALUES"), reinterpret_cast<unsigned long>(array->GetVoidPointer(0)));
  information->Set(Key("TIME"), static_cast<unsigned long>(array->GetMTime()));
}

uint64_t vtkStratusIdentityOf(vtkDataArray* array)
{
  return HasItsValues(array) && Find(array, "TIME") == array->GetMTime() ? Find(array, "IDENTITY") : 0;
}

void vtkStratusSetOnlyDuplicates(vtkDataArray* flags)
{
  flags->GetInformation()->Set(Key("DUPLICATES"), reinterpret_cast<unsigned long>(flags->GetVoidPointer(0)));
}

bool vtkStratusHasOnlyDuplicates(vtkDataArray* flags)
{
  return flags && Find(flags, "DUPLICATES") != 0 && Find(flags, "DUPLICATES") == reinterpret_cast<unsigned long>(flags->GetVoidPointer(0));
}

const uint64_t* vtkStratusReadsOf(vtkDataArray* array)
{
  return HasItsValues(array) ? reinterpret_cast<const uint64_t*>(Find(array, "READS")) : nullptr;
}

void vtkStratusSetSource(vtkDataArray* array, int component, stratus_volume& volume)
{
  volume.identity = vtkStratusIdentityOf(array);
  volume.identity += volume.identity ? static_cast<uint64_t>(component) : 0;
  volume.missing = HasItsValues(array) ? reinterpret_cast<const uint64_t*>(Find(array, "MISSING")) : nullptr;
  volume.tiles = {};
  const bool unchanged = HasItsValues(array) && Find(array, "TIME") == array->GetMTime();
  volume.parts = unchanged ? reinterpret_cast<const stratus_parts*>(Find(array, "PARTS")) : nullptr;
  const stratus_tiles* const tiles = unchanged ? reinterpret_cast<const stratus_tiles*>(Find(array, "TILES")) : nullptr;
  if (tiles && std::equal(tiles->dimensions, tiles->dimensions + 3, volume.dimensions)) { // the array is on the grid that it was read for
    volume.tiles = *tiles;
    volume.tiles.values = static_cast<const char*>(tiles->values) + component * array->GetDataTypeSize();
  }
}
