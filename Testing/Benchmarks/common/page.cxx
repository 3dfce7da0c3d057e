// SPDX-License-Identifier: BSD-3-Clause
// Writes index.html and the charts of a folder of tables. The page needs neither network nor script, and one column where it is narrow.
#include "bench.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

namespace bench {

namespace {

const char* const style = R"(
:root { color-scheme: light; font-family: system-ui, sans-serif; line-height: 1.45; color: #1c2430; background: #f5f6f8; }
body { margin: 0 auto; padding: 1rem; max-width: 1360px; }
h1 { font-size: 1.5rem; margin: .5rem 0; }
h2 { font-size: 1.2rem; margin: 2rem 0 .5rem; }
p, li, td, th, dd, dt { overflow-wrap: anywhere; }
.charts { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); }
figure { margin: 0; padding: .75rem; background: #fff; border: 1px solid #dde1e7; border-radius: .5rem; }
figure img { display: block; width: 100%; height: auto; }
figcaption { font-size: .9rem; margin-top: .5rem; }
figcaption a { white-space: nowrap; }
.wrong { color: #a50f15; }
details { margin: .5rem 0; background: #fff; border: 1px solid #dde1e7; border-radius: .5rem; padding: .5rem .75rem; }
summary { cursor: pointer; min-height: 1.75rem; display: flex; align-items: center; }
summary::before { content: "\25b8"; margin-right: .5rem; }
details[open] > summary::before { content: "\25be"; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .6rem .2rem 0; text-align: left; vertical-align: top; }
.wide th, .wide td { white-space: nowrap; overflow-wrap: normal; }
td.n { text-align: right; }
thead th { border-bottom: 1px solid #9aa4b2; }
)";

std::string escape(const std::string& text)
{
  std::string safe;
  for (const char c : text) {
    safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return safe;
}

std::string file_name(std::string name)
{
  std::replace_if(
    name.begin(), name.end(), [](char c) { return c == '/' || c == ':' || c == ' ' || c == ',' || c == '+'; }, '-');
  return name;
}

std::string number(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, value != 0.0 && (value >= 1e6 || value <= -1e6) ? "%.4g" : "%.5g", value);
  return text;
}

// One part of the bench: its table, and its charts' curves.
struct chapter {
  std::string part;
  table data;
  std::vector<curves> charts;
};

void write_origins(std::ostream& out, const std::vector<chapter>& chapters)
{
  std::map<std::string, std::string> machines; // what measured -> parts
  for (const chapter& c : chapters) {
    for (const origin& o : c.data.origins) {
      std::string& parts = machines[o.processor + ", " + o.cores + " cores, " + o.compiler + ", commit " + o.commit + ", " + o.date];
      parts += parts.find(c.part) == std::string::npos ? (parts.empty() ? "" : ", ") + c.part : "";
    }
  }
  for (const auto& machine : machines) {
    out << "<p><strong>" << escape(machine.first) << "</strong> (" << escape(machine.second) << ")</p>\n";
  }
}

void write_dominance(std::ostream& out, const std::vector<chapter>& chapters)
{
  size_t count = 0, beaten = 0;
  std::ostringstream open, rows;
  for (const chapter& chapter : chapters) {
    for (const curves& c : chapter.charts) {
      for (const std::string& scene : scenes_of(c)) {
        const std::string where = escape(c.title) + ", " + escape(scene);
        std::string unbeaten;
        for (const dominance& d : dominance_of(c, scene)) {
          ++count;
          beaten += d.by != nullptr;
          unbeaten += d.by ? "" : (unbeaten.empty() ? "" : ", ") + escape(d.peer->method);
          rows << "<tr><td>" << where << "</td><td>" << escape(d.peer->method) << "</td><td class=n>" << number(d.peer->x)
               << "</td><td class=n>" << number(d.peer->y) << "</td><td>" << (d.by ? escape(d.by->method) : "<span class=wrong>none</span>")
               << "</td><td class=n>" << (d.by ? number(d.by->x) : "") << "</td><td class=n>" << (d.by ? number(d.by->y) : "")
               << "</td></tr>\n";
        }
        open << (unbeaten.empty() ? "" : "<li>" + where + ": " + unbeaten + "</li>\n");
      }
    }
  }
  out << "<h2 id=dominated>Points of peers that ours beat by both axes</h2>\n<p>" << beaten << " of " << count
      << " points of peers have a point of ours that is better by both axes of their chart.</p>\n";
  if (beaten < count) {
    out << "<p class=wrong>These have none:</p>\n<ul>\n" << open.str() << "</ul>\n";
  }
  out
    << "<details><summary>The list</summary><div class=wide><table><thead><tr><th>chart</th><th>peer</th><th>x</th><th>y</th><th>ours</th>"
       "<th>x</th><th>y</th></tr></thead><tbody>\n"
    << rows.str() << "</tbody></table></div></details>\n";
}

void write_charts(std::ostream& out, const std::string& folder, const chapter& chapter)
{
  for (size_t i = 0; i < chapter.charts.size(); ++i) {
    const curves& c = chapter.charts[i];
    out << "<h2>" << escape(c.title) << "</h2>\n<p>Left is faster, lower is better (" << escape(c.y_title)
        << "). A line joins the settings of one method; blues and greens are ours.</p>\n<div class=charts>\n";
    for (const std::string& scene : scenes_of(c)) {
      const std::string name = file_name(chapter.part + (i > 0 ? "-" + std::to_string(i + 1) : "") + '-' + scene);
      const std::string sentence = sentence_of(c, scene);
      write_scene_chart(folder + "/charts/" + name, c, scene);
      out << "<figure><img src=\"charts/" << name << ".svg\" loading=lazy alt=\""
          << escape(c.title + ", " + scene + ": " + c.x_title + " against " + c.y_title) << "\"><figcaption>" << escape(sentence)
          << " <a href=\"charts/" << name << ".png\">PNG</a></figcaption></figure>\n";
    }
    out << "</div>\n";
  }
}

// A row for each method of each scene, a column for each metric; single repeats stay in the CSV.
void write_table(std::ostream& out, const chapter& c)
{
  std::vector<std::string> metrics;
  std::vector<std::pair<std::string, std::string>> lines;
  std::map<std::string, double> values;
  for (const row& r : c.data.rows) {
    if (r.metric.find('/') != std::string::npos) {
      continue;
    }
    if (std::find(metrics.begin(), metrics.end(), r.metric) == metrics.end()) {
      metrics.push_back(r.metric);
    }
    if (lines.empty() || lines.back() != std::make_pair(r.scene, r.method)) {
      lines.emplace_back(r.scene, r.method);
    }
    values[r.scene + '\n' + r.method + '\n' + r.metric] = r.value;
  }
  out << "<details><summary>Table of " << c.part << " (" << lines.size() << " rows)</summary><p><a href=\"" << c.part << ".csv\">" << c.part
      << ".csv</a></p><div class=wide><table><thead><tr><th>scene</th><th>method</th>";
  for (const std::string& metric : metrics) {
    out << "<th>" << escape(metric) << "</th>";
  }
  out << "</tr></thead><tbody>\n";
  for (const auto& line : lines) {
    out << "<tr><td>" << escape(line.first) << "</td><td>" << escape(line.second) << "</td>";
    for (const std::string& metric : metrics) {
      const auto found = values.find(line.first + '\n' + line.second + '\n' + metric);
      out << "<td class=n>" << (found == values.end() ? "" : number(found->second)) << "</td>";
    }
    out << "</tr>\n";
  }
  out << "</tbody></table></div></details>\n";
}
} // namespace

void write_page(const std::string& folder, const std::vector<std::string>& failures)
{
  std::vector<chapter> chapters;
  for (const std::string& part : parts_of_all()) {
    const table data = read_csv(folder + '/' + part + ".csv");
    if (!data.rows.empty()) {
      chapters.push_back({ part, data, curves_of(part, data.rows) });
    }
  }
  make_folder(folder + "/charts");
  std::ostringstream out;
  out << "<!doctype html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport content=\"width=device-width, initial-scale=1\">\n"
         "<title>Stratus: speed against accuracy</title>\n<style>"
      << style << "</style></head><body>\n<h1>Stratus: speed against accuracy</h1>\n";
  write_origins(out, chapters);
  for (const std::string& wrong : failures) {
    out << "<p class=wrong>Failed: " << escape(wrong) << "</p>\n";
  }
  write_dominance(out, chapters);
  for (const chapter& c : chapters) {
    write_charts(out, folder, c);
  }
  out << "<h2>Tables</h2>\n";
  for (const chapter& c : chapters) {
    write_table(out, c);
  }
  out << "</body></html>\n";
  const std::string text = out.str();
  save_file(folder + "/index.html", text.data(), text.size());
}
} // namespace bench
