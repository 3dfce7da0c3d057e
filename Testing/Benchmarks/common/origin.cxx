// SPDX-License-Identifier: BSD-3-Clause
// The origin of figures: rows at the head of a table that name processor, compiler, commit and date.
#include "bench.h"
#include "bench_commit.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <sstream>
#include <thread>

namespace bench {

namespace {

std::string processor_name()
{
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line)) {
    const size_t colon = line.find(": ");
    if (line.compare(0, 10, "model name") == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

std::string compiler_name()
{
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "gcc " __VERSION__;
#else
  return "unknown";
#endif
}

std::string today()
{
  const std::time_t now = std::time(nullptr);
  char text[16] = "";
  std::tm utc;
  return gmtime_r(&now, &utc) && std::strftime(text, sizeof text, "%Y-%m-%d", &utc) > 0 ? text : "unknown";
}

bool has(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> scenes_of(const std::vector<row>& rows)
{
  std::vector<std::string> scenes;
  for (const row& r : rows) {
    if (!has(scenes, r.scene)) {
      scenes.push_back(r.scene);
    }
  }
  return scenes;
}

std::vector<std::string> scenes_in(const std::string& list)
{
  std::vector<std::string> scenes;
  std::istringstream stream(list);
  std::string scene;
  while (std::getline(stream, scene, ',')) {
    scenes.push_back(scene);
  }
  return scenes;
}

// Gives scenes without an origin an unknown one. Tables of older versions have such scenes.
void add_missing(table& t)
{
  origin unknown;
  for (const std::string& scene : scenes_of(t.rows)) {
    if (std::none_of(t.origins.begin(), t.origins.end(), [&](const origin& o) { return has(o.scenes, scene); })) {
      unknown.scenes.push_back(scene);
    }
  }
  if (!unknown.scenes.empty()) {
    t.origins.push_back(unknown);
  }
}
} // namespace

origin origin_of_this_run()
{
  origin o;
  const unsigned cores = std::thread::hardware_concurrency();
  o.processor = processor_name();
  o.cores = cores > 0 ? std::to_string(cores) : "unknown";
  o.compiler = compiler_name();
  o.commit = STRATUS_BENCH_COMMIT;
  o.date = today();
  return o;
}

void write_origin(std::ostream& out, const origin& o)
{
  out << "# processor," << o.processor << "\n# cores," << o.cores << "\n# compiler," << o.compiler << "\n# commit," << o.commit
      << "\n# date," << o.date << "\n# scenes";
  for (const std::string& scene : o.scenes) {
    out << ',' << scene;
  }
  out << '\n';
}

void read_origin(const std::string& line, std::vector<origin>& origins)
{
  const size_t comma = line.find(',');
  if (line.compare(0, 2, "# ") != 0 || comma == std::string::npos) {
    return;
  }
  const std::string name = line.substr(2, comma - 2), value = line.substr(comma + 1);
  if (name == "processor") { // the first row of each origin
    origins.emplace_back();
    origins.back().processor = value;
  } else if (!origins.empty()) {
    origin& o = origins.back();
    if (name == "scenes") {
      o.scenes = scenes_in(value);
      return;
    }
    const std::pair<const char*, std::string*> fields[] = { { "cores", &o.cores }, { "compiler", &o.compiler }, { "commit", &o.commit },
      { "date", &o.date } };
    for (const auto& field : fields) {
      if (name == field.first) {
        *field.second = value;
      }
    }
  }
}

void replace_scenes(table& t, const std::vector<row>& rows)
{
  const std::vector<std::string> again = scenes_of(rows);
  add_missing(t);
  const auto stale = [&](const std::string& scene) { return has(again, scene); };
  t.rows.erase(std::remove_if(t.rows.begin(), t.rows.end(), [&](const row& r) { return stale(r.scene); }), t.rows.end());
  for (origin& o : t.origins) {
    o.scenes.erase(std::remove_if(o.scenes.begin(), o.scenes.end(), stale), o.scenes.end());
  }
  t.origins.erase(std::remove_if(t.origins.begin(), t.origins.end(), [](const origin& o) { return o.scenes.empty(); }), t.origins.end());
  t.origins.push_back(origin_of_this_run());
  t.origins.back().scenes = again;
  t.rows.insert(t.rows.end(), rows.begin(), rows.end());
}
} // namespace bench
