// SPDX-License-Identifier: BSD-3-Clause
#include "bench.h"

#include "vtkStratusTemporaryFile.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <unistd.h>

namespace bench {

std::vector<std::string> split(const std::string& text)
{
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    parts.push_back(part);
  }
  return parts;
}

void add_repeats(const std::string& scene, const std::string& method, const std::string& metric, const char* unit,
  const std::vector<double>& values, std::vector<row>& rows)
{
  for (size_t i = 0; i < values.size(); ++i) {
    rows.push_back({ scene, method, metric + '/' + std::to_string(i), unit, values[i] });
  }
}

void add_failure(const std::string& scene, const std::string& method, const char* why, std::vector<row>& rows)
{
  std::fprintf(stderr, "%s%s of %s FAILED: %s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "", method.c_str(), scene.c_str(), why);
  rows.push_back({ scene, method, "failed", "1", 1.0 });
}

bool any_failed(const std::vector<row>& rows)
{
  return std::any_of(rows.begin(), rows.end(), [](const row& r) { return r.metric == "failed"; });
}

void save_rows(const std::string& path, const std::vector<row>& rows, const char* benchmark, bool append)
{
  table t = append ? read_csv(path) : table();
  replace_scenes(t, rows);
  write_csv(path, t, benchmark);
}

void add_rows(const result& r, std::vector<row>& rows)
{
  const auto add = [&](const char* metric, double value, const char* unit) { rows.push_back({ r.scene, r.method, metric, unit, value }); };
  add("first_ms", r.time.first_ms, "ms");
  add("frame_ms", r.time.frame_ms, "ms");
  if (r.time.update_ms >= 0.0) {
    add("update_ms", r.time.update_ms, "ms");
  }
  add_repeats(r.scene, r.method, "frame_ms", "ms", r.time.frames, rows);
  if (r.reference_db > 0.0) {
    if (!r.pictures[0].rgba.empty()) {
      add("psnr_db", r.psnr_db, "dB");
    }
    add("psnr8_db", r.psnr8_db, "dB");
    add("max_error", r.max_error, "1");
    add("reference_db", r.reference_db, "dB");
  }
  if (r.tolerance >= 0.0) {
    add("tolerance", r.tolerance, "1");
  }
  if (r.time.samples >= 0.0) {
    add("samples", r.time.samples, "1");
  }
  if (r.differing_pixels >= 0.0) {
    add("differing_pixels", r.differing_pixels, "1");
  }
}

void add_rows(const std::string& scene, const floor_result& f, std::vector<row>& rows)
{
  rows.push_back({ scene, "floor", "floor_ms", "ms", f.ms });
  rows.push_back({ scene, "floor", "samples", "1", f.samples });
  rows.push_back({ scene, "floor", "rate", "1/s", f.rate });
}

void save_file(const std::string& path, const void* bytes, size_t size)
{
  vtkStratusReplacingFile file;
  const int opening = file.Open(path), reason = opening != 0 ? opening : file.Finish(bytes, size);
  if (reason != 0) {
    throw failure("cannot write " + path + ": " + std::strerror(reason));
  }
}

void write_csv(const std::string& path, const table& t, const char* benchmark)
{
  std::ostringstream out;
  out.precision(9);
  for (const origin& o : t.origins) {
    write_origin(out, o);
  }
  out << "benchmark,scene,method,metric,value,unit\n";
  for (const row& r : t.rows) {
    out << benchmark << ',' << r.scene << ',' << r.method << ',' << r.metric << ',' << r.value << ',' << r.unit << '\n';
  }
  const std::string text = out.str();
  if (path != "-") {
    save_file(path, text.data(), text.size());
  } else if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw failure(std::string("cannot write to the standard output: ") + std::strerror(errno));
  }
}

void check_writable(const std::string& path)
{
  std::string target;
  if (path == "-") {
    return;
  }
  if (!vtkStratusFindTarget(path, target)) { // a pipe must not be opened and closed
    if (access(path.c_str(), W_OK) != 0) {
      throw failure("cannot write " + path + ": " + std::strerror(errno));
    }
    return;
  }
  vtkStratusReplacingFile file;
  if (const int reason = file.Open(path)) {
    throw failure("cannot write " + path + ": " + std::strerror(reason));
  }
}

table read_csv(const std::string& path)
{
  table t;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && line.compare(0, 1, "#") == 0) {
    read_origin(line, t.origins);
  }
  while (std::getline(file, line)) { // rows after the header
    std::vector<std::string> p;
    std::istringstream stream(line);
    std::string part;
    while (std::getline(stream, part, ',')) {
      p.push_back(part);
    }
    if (p.size() == 6) {
      t.rows.push_back({ p[1], p[2], p[3], p[5], std::atof(p[4].c_str()) });
    }
  }
  return t;
}

void print_table(const std::vector<row>& rows)
{
  static const char* const metrics[] = { "first_ms", "frame_ms", "update_ms", "psnr_db", "psnr8_db", "max_error", "reference_db", "samples",
    "differing_pixels", "floor_ms" };
  std::map<std::string, double> values;
  std::vector<std::pair<std::string, std::string>> lines;
  for (const row& r : rows) {
    values[r.scene + '\n' + r.method + '\n' + r.metric] = r.value;
    if (lines.empty() || lines.back() != std::make_pair(r.scene, r.method)) {
      lines.emplace_back(r.scene, r.method);
    }
  }
  std::fprintf(stderr, "%-12s %-24s", "scene", "method");
  for (const char* metric : metrics) {
    std::fprintf(stderr, " %11.11s", metric);
  }
  std::fprintf(stderr, "\n");
  for (const auto& line : lines) {
    std::fprintf(stderr, "%-12s %-24s", line.first.c_str(), line.second.c_str());
    for (const char* metric : metrics) {
      const auto found = values.find(line.first + '\n' + line.second + '\n' + metric);
      if (found == values.end()) {
        std::fprintf(stderr, " %11s", "");
      } else {
        std::fprintf(stderr,
          std::strcmp(metric, "max_error") == 0 ? " %11.5f"
            : found->second >= 1e5              ? " %11.4g"
                                                : " %11.2f",
          found->second);
      }
    }
    std::fprintf(stderr, "\n");
  }
}
} // namespace bench
