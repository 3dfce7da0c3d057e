// SPDX-License-Identifier: BSD-3-Clause
// The curves of a table's charts: each method over its own setting, the peers' points that ours beat, and a sentence on each.
#include "bench.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

namespace bench {

namespace {

bool is_number(const std::string& text)
{
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

using values = std::map<std::string, double>; // of each metric

// One method on one scene, in the table's order.
struct measured_method {
  std::string scene, method;
  values metrics;
  double at(const char* metric) const
  {
    const auto found = this->metrics.find(metric);
    return found == this->metrics.end() ? -1.0 : found->second;
  }
};

std::vector<measured_method> methods_of(const std::vector<row>& rows)
{
  std::vector<measured_method> all;
  std::map<std::pair<std::string, std::string>, size_t> places;
  for (const row& r : rows) {
    const auto place = places.insert({ { r.scene, r.method }, all.size() });
    if (place.second) {
      all.push_back({ r.scene, r.method, {} });
    }
    all[place.first->second].metrics[r.metric] = r.value;
  }
  return all;
}

void add(curves& c, const measured_method& m, const std::string& name, double x, double y)
{
  if (x > 0.0 && y >= 0.0) {
    c.points.push_back({ m.scene, name, x, std::max(y, c.exact) });
  }
}

curves volume_curves(const std::vector<row>& rows)
{
  curves c = { "Volumes", "whole frame, ms", "RMS error of the window, of 1", "is faster and more exact", "at its error, ours is faster",
    {}, 0.0 };
  for (const measured_method& m : methods_of(rows)) {
    const double db = m.at("psnr8_db");
    add(c, m, m.method, m.at("frame_ms"), db > 0.0 ? std::pow(10.0, -0.05 * db) : -1.0);
  }
  return c;
}

curves light_curves(const std::vector<row>& rows)
{
  curves c = { "Light", "frame, ms", "RMS error, of 1", "is faster and more exact", "at its error, ours is faster", {}, 0.0 };
  for (const measured_method& m : methods_of(rows)) {
    const double error = m.at("error");
    add(c, m, m.method, m.at("frame_ms"), error > 0.0 ? error : -1.0);
  }
  return c;
}

curves tetra_curves(const std::vector<row>& rows)
{
  curves c = { "Tetrahedra", "whole frame, ms", "RMS error of the window, of 1", "is faster and more exact", "at its error, ours is faster",
    {}, 0.0 };
  for (const measured_method& m : methods_of(rows)) {
    const double of_255 = m.at("rmse255_8bit");
    add(c, m, m.method, m.at("frame_ms"), of_255 >= 0.0 ? of_255 / 255.0 : -1.0);
  }
  return c;
}

curves tree_curves(const std::vector<row>& rows, const char* title, const char* metric)
{
  curves c = { title, "build, ms", "a ray, ns", "builds and traces faster", "at its time a ray, ours builds faster", {}, 0.0 };
  for (const measured_method& m : methods_of(rows)) {
    add(c, m, m.method, m.at("build_ms"), m.at(metric));
  }
  return c;
}

curves distance_curves(const std::vector<row>& rows)
{
  curves c = { "Distance fields", "to an array of floats, ms", "wrong voxels, % (none: 1e-5)", "is faster and no less exact",
    "at its error, ours is faster", {}, 1e-5 };
  for (const measured_method& m : methods_of(rows)) {
    add(c, m, m.method, m.at("array_ms"), m.at("wrong_percent"));
  }
  return c;
}

curves octree_curves(const std::vector<row>& rows)
{
  curves c = { "Culling", "cull, ms", "kept falsely, % (none: .001)", "is faster and keeps less falsely",
    "at its share of falsely kept objects, ours is faster", {}, 1e-3 };
  for (const measured_method& m : methods_of(rows)) {
    add(c, m, m.method, m.at("cull_ms"), m.at("false_keeps"));
    add(c, m, m.method + "/exact", m.at("exact_cull_ms"), m.at("exact_false_keeps"));
  }
  return c;
}

std::string number(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, value >= 99.5 ? "%.0f" : "%.2g", value);
  return text;
}

// Says by how much ours is faster than the most exact point of each peer, at no larger error.
std::string ratios(const curves& c, const std::string& scene)
{
  std::map<std::string, const curve_point*> best;
  for (const curve_point& p : c.points) {
    if (p.scene == scene && !is_ours(p.method)) {
      const curve_point*& known = best[family_of(p.method)];
      known = !known || p.y < known->y ? &p : known;
    }
  }
  std::string text;
  for (const auto& peer : best) {
    double least = INFINITY;
    for (const curve_point& p : c.points) {
      if (p.scene == scene && is_ours(p.method) && p.y <= peer.second->y) {
        least = std::min(least, p.x);
      }
    }
    text += (text.empty() ? " Against the best of a peer, " + c.compared + ": " : ", ") + peer.first + " ";
    text += std::isinf(least) ? "(none of ours gets there)" : number(peer.second->x / least) + " times";
  }
  return text.empty() ? text : text + ".";
}
} // namespace

std::string family_of(const std::string& method)
{
  std::string name = method;
  const size_t about = name.find('~');
  if (about != std::string::npos) {
    const size_t at = name.find('@', about);
    name = name.substr(0, about) + (at == std::string::npos ? "" : name.substr(at));
  }
  for (const char* word : { ":low", ":medium", ":high" }) {
    const size_t length = std::string(word).size();
    if (name.size() > length && name.compare(name.size() - length, length, word) == 0) {
      name.resize(name.size() - length);
    }
  }
  const size_t colon = name.rfind(':');
  if (colon != std::string::npos && is_number(name.substr(colon + 1))) {
    name.resize(colon);
  }
  const size_t exact = name.rfind("/exact");
  if (exact != std::string::npos) {
    name.resize(exact);
    name = family_of(name);
  }
  // Floodings differ by their passes.
  return name == "stratus:jfa+1" || name == "stratus:jfa+2" || name == "stratus:1+jfa" || name == "stratus:jfa2" ? "stratus:jfa"
    : name == "stratus:ajfa-fig5"                                                                                ? "stratus:ajfa"
                                                                                                                 : name;
}

bool is_ours(const std::string& method)
{
  return method.rfind("stratus:", 0) == 0;
}

const std::vector<std::string>& parts_of_all()
{
  static const std::vector<std::string> parts = { "volume", "light", "tetra", "tree", "distance", "octree" };
  return parts;
}

std::vector<curves> curves_of(const std::string& part, const std::vector<row>& rows)
{
  if (part == "volume") {
    return { volume_curves(rows) };
  }
  if (part == "light") {
    return { light_curves(rows) };
  }
  if (part == "tetra") {
    return { tetra_curves(rows) };
  }
  if (part == "tree") {
    return { tree_curves(rows, "First hits, rays of a picture", "primary_ns"), tree_curves(rows, "First hits, random rays", "random_ns") };
  }
  if (part == "distance") {
    return { distance_curves(rows) };
  }
  return { octree_curves(rows) };
}

std::vector<std::string> scenes_of(const curves& c)
{
  std::vector<std::string> scenes;
  for (const curve_point& p : c.points) {
    if (std::find(scenes.begin(), scenes.end(), p.scene) == scenes.end()) {
      scenes.push_back(p.scene);
    }
  }
  return scenes;
}

std::vector<dominance> dominance_of(const curves& c, const std::string& scene)
{
  std::vector<dominance> all;
  for (const curve_point& peer : c.points) {
    if (peer.scene != scene || is_ours(peer.method)) {
      continue;
    }
    all.push_back({ &peer, nullptr });
    for (const curve_point& p : c.points) {
      const bool no_error = peer.y <= c.exact && p.y <= c.exact;
      if (p.scene == scene && is_ours(p.method) && p.x < peer.x && (p.y < peer.y || no_error)) {
        const curve_point*& by = all.back().by;
        by = !by || p.x * p.y < by->x * by->y ? &p : by;
      }
    }
  }
  return all;
}

std::string sentence_of(const curves& c, const std::string& scene)
{
  const std::vector<dominance> all = dominance_of(c, scene);
  std::string missing;
  for (const dominance& d : all) {
    missing += d.by ? "" : (missing.empty() ? "" : ", ") + d.peer->method;
  }
  if (all.empty()) {
    return "No peer is measured here.";
  }
  const std::string count = std::to_string(all.size());
  const std::string first = missing.empty()
    ? (all.size() == 1 ? "The only point" : "Each of the " + count + " points") + " of peers has one of ours that " + c.beats + "."
    : "Of " + count + " points of peers these have none of ours that " + c.beats + ": " + missing + ".";
  return first + ratios(c, scene);
}
} // namespace bench
