// SPDX-License-Identifier: BSD-3-Clause
// Keeps reference pictures between runs, because they take most of the time.
#include "bench.h"

#include <cstdio>
#include <cstdlib>
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
  const auto named = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
  const std::string own = named("STRATUS_CACHE_DIR"), system = named("XDG_CACHE_HOME"), home = named("HOME");
  return !own.empty() ? own + "/references"
    : !system.empty() ? system + "/stratus/references"
    : !home.empty()   ? home + "/.cache/stratus/references"
                      : "";
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
  const std::string part = path + ".part";
  std::FILE* file = std::fopen(part.c_str(), "wb");
  const bool whole = file && std::fwrite(rgba.data(), sizeof(float), rgba.size(), file) == rgba.size();
  if (!file || std::fclose(file) != 0 || !whole || std::rename(part.c_str(), path.c_str()) != 0) {
    throw failure("cannot write " + path);
  }
}
} // namespace bench
