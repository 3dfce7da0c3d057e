// SPDX-License-Identifier: BSD-3-Clause
// Keeps reference pictures between runs, because they take most of the time.
#include "bench.h"

extern "C" {
#include "cache_folder.h"
}

#include <cstdio>
#include <filesystem>
#include <system_error>

namespace bench {

void make_folder(const std::string& folder)
{
  std::error_code error;
  if (!folder.empty() && (std::filesystem::create_directories(folder, error), error)) {
    throw failure("cannot make folder " + folder + ": " + error.message());
  }
}

std::string default_reference_cache()
{
  char path[STRATUS_CACHE_PATH];
  return stratus_cache_find(path) ? std::string(path) + "/references" : "";
}

bool load_picture(const std::string& path, std::vector<float>& rgba)
{
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) {
    return false;
  }
  const bool whole = std::fread(rgba.data(), sizeof(float), rgba.size(), file) == rgba.size() && std::fgetc(file) == EOF;
  std::fclose(file);
  return whole;
}

void save_picture(const std::string& path, const std::vector<float>& rgba)
{
  save_file(path, rgba.data(), rgba.size() * sizeof(float));
}
} // namespace bench
