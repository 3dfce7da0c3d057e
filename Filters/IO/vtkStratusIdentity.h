// SPDX-License-Identifier: BSD-3-Clause
// Identities of arrays that are a part of a file. Private to the module.
#ifndef vtkStratusIdentity_h
#define vtkStratusIdentity_h

#include <cstdint>
#include <string>
#include <vector>

// Returns the identity of a file's variable, of which `numbers` choose a part. identity: of the file; 0: it has none, nor has the part.
inline uint64_t vtkStratusIdentityOfPart(uint64_t identity, const std::string& variable, const std::vector<uint64_t>& numbers)
{
  if (identity == 0) {
    return 0;
  }
  const auto mix = [&identity](uint64_t number) { identity = (identity ^ number) * UINT64_C(0x9e3779b97f4a7c15) ^ identity >> 29; };
  for (const char c : variable) {
    mix(static_cast<unsigned char>(c));
  }
  for (const uint64_t number : numbers) {
    mix(number);
  }
  return identity ? identity : 1;
}

#endif
