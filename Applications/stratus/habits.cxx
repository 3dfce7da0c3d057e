// SPDX-License-Identifier: BSD-3-Clause
#include "habits.h"

#include "colors.h"
#include "nearest.h"
#include "options.h"
#include "support.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

namespace {

using cli::split;

// A part of help(): its lines up to an empty one. The first line is its title, except of the first part and the last ones.
using part = std::vector<std::string>;

std::vector<part> parts_of_help()
{
  std::vector<part> parts(1);
  for (const std::string& line : split(cli::help(), '\n')) {
    if (line.empty()) {
      parts.emplace_back();
    } else {
      parts.back().push_back(line);
    }
  }
  parts.erase(std::remove_if(parts.begin(), parts.end(), [](const part& one) { return one.empty(); }), parts.end());
  return parts;
}

// Topics, and how the title of each one's part begins.
constexpr std::array<std::array<const char*, 2>, 9> topics = { { { "inputs", "INPUT is" }, { "data", "Data and" }, { "camera", "Camera" },
  { "rendering", "Rendering" }, { "light", "Scattered light" }, { "clouds", "Clouds" }, { "trees", "Trees" }, { "sorting", "Sorting" },
  { "comparisons", "Comparisons" } } };

bool begins(const std::string& text, const std::string& with)
{
  return text.compare(0, with.size(), with) == 0;
}

const part* find_topic(const std::vector<part>& parts, const std::string& topic)
{
  for (const auto& known : topics) {
    if (topic == known[0]) {
      const auto found = std::find_if(parts.begin(), parts.end(), [&](const part& one) { return begins(one[0], known[1]); });
      return found == parts.end() ? nullptr : &*found;
    }
  }
  return nullptr;
}

std::string joined(const part& lines)
{
  std::string text;
  for (const std::string& line : lines) {
    text += line + "\n";
  }
  return text;
}

size_t indent_of(const std::string& line)
{
  return std::min(line.find_first_not_of(' '), line.size());
}

// An option in help(): its words, such as "--lower V, --upper V", and its description.
struct described {
  std::string words, about;
};

// The options that a part describes: lines that begin with two blanks and a dash, and the lines behind that are indented further.
std::vector<described> options_of(const part& lines)
{
  std::vector<described> found;
  for (const std::string& line : lines) {
    if (begins(line, "  -")) {
      const size_t gap = line.find("  ", 2);
      found.push_back({ line.substr(2, gap == std::string::npos ? gap : gap - 2), "" });
      const size_t text = gap == std::string::npos ? gap : line.find_first_not_of(' ', gap);
      found.back().about = text == std::string::npos ? "" : line.substr(text);
    } else if (!found.empty() && indent_of(line) > 4) {
      found.back().about += (found.back().about.empty() ? "" : " ") + line.substr(indent_of(line));
    }
  }
  return found;
}

// Whether an option's words name it: "--lower" and "--upper" of "--lower V, --upper V".
bool names(const described& one, const std::string& option)
{
  for (const std::string& word : split(one.words, ' ')) {
    if (word == option || word == option + ",") {
      return true;
    }
  }
  return false;
}

part lines_with(const std::vector<part>& parts, const std::string& text)
{
  part lines;
  bool follows = false;
  for (const part& one : parts) {
    for (const std::string& line : one) {
      const bool has = begins(line, "  " + text);
      if (has || (follows && indent_of(line) > 8)) {
        lines.push_back(line);
      }
      follows = has || (follows && indent_of(line) > 8);
    }
  }
  return lines;
}

std::string topic_list()
{
  std::string text;
  for (const auto& known : topics) {
    text += std::string(text.empty() ? "" : ", ") + known[0];
  }
  return text;
}

// The text within single quotes of a shell.
std::string quoted(const std::string& text)
{
  std::string result;
  for (const char c : text) {
    result += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return result;
}

// The values that an option can have, where they are few.
std::map<std::string, std::string> choices()
{
  std::map<std::string, std::string> of;
  for (int i = STRATUS_MODE_COMPOSITE; i <= STRATUS_MODE_SLICE; ++i) {
    of["--mode"] += std::string(stratus_mode_name(static_cast<stratus_mode>(i))) + " ";
  }
  of["--mode"] += "path";
  for (int i = STRATUS_STRUCTURE_AUTO; i <= STRATUS_STRUCTURE_HYBRID; ++i) {
    of["--structure"] += std::string(i > STRATUS_STRUCTURE_AUTO ? " " : "") + stratus_structure_name(static_cast<stratus_structure>(i));
  }
  of["--color"] = cli::color_names(" ") + " list";
  of["--sampling"] = "auto midpoint preintegrated cells";
  of["--up"] = "x y z";
  of["--normals"] = "faces gradient";
  of["--background"] = "dark light black white transparent";
  of["--show"] = "samples";
  return of;
}

std::string joined_words(const std::vector<std::string>& words)
{
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

std::string bash()
{
  std::string text = "# Completion for bash: source it, or put it where bash-completion looks\n_stratus()\n{\n"
                     "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n  COMPREPLY=()\n  case $before in\n";
  for (const auto& [option, values] : choices()) {
    text += "    " + option + ") COMPREPLY=($(compgen -W '" + values + "' -- \"$word\")); return ;;\n";
  }
  return text + "  esac\n  if [[ $word == -* ]]; then\n    COMPREPLY=($(compgen -W '" + joined_words(cli::option_words()) +
    "' -- \"$word\"))\n  elif ((COMP_CWORD == 1)); then\n    COMPREPLY=($(compgen -W '" + joined_words(cli::commands()) +
    "' -- \"$word\"))\n  fi\n}\ncomplete -o default -F _stratus stratus\n";
}

std::vector<described> all_options()
{
  std::vector<described> all;
  for (const part& one : parts_of_help()) {
    for (const described& option : options_of(one)) {
      all.push_back(option);
    }
  }
  return all;
}

// The description of an option, up to its first sentence's end.
std::string short_about(const std::string& option, const std::vector<described>& all)
{
  const auto found = std::find_if(all.begin(), all.end(), [&](const described& one) { return names(one, option); });
  std::string about = found == all.end() ? "" : found->about;
  for (const char* end : { ". ", "; ", ": ", " (" }) {
    about = about.substr(0, about.find(end));
  }
  return about;
}

std::string zsh()
{
  const std::vector<described> all = all_options();
  std::string text = "#compdef stratus\nlocal -a commands options\ncommands=(" + joined_words(cli::commands()) + ")\noptions=(\n";
  for (const std::string& option : cli::option_words()) {
    text += "  '" + quoted(option) + ":" + quoted(short_about(option, all)) + "'\n";
  }
  text += ")\ncase $words[CURRENT-1] in\n";
  for (const auto& [option, values] : choices()) {
    text += "  " + option + ") compadd -- " + values + "; return ;;\n";
  }
  return text +
    "esac\nif [[ $PREFIX == -* ]]; then\n  _describe option options\nelif ((CURRENT == 2)); then\n  compadd -- $commands\nelse\n" +
    "  _files\nfi\n";
}

std::string fish()
{
  const std::vector<described> all = all_options();
  const std::map<std::string, std::string> values = choices();
  std::string text;
  for (const std::string& command : cli::commands()) {
    text += "complete -c stratus -n __fish_use_subcommand -a " + command + "\n";
  }
  for (const std::string& option : cli::option_words()) {
    const auto found = values.find(option);
    const bool is_long = begins(option, "--");
    text += std::string("complete -c stratus ") + (is_long ? "-l " : "-s ") + option.substr(is_long ? 2 : 1) +
      (found == values.end() ? "" : " -x -a '" + found->second + "'") + " -d '" + quoted(short_about(option, all)) + "'\n";
  }
  return text;
}

// A line of a manual page: backslashes, and dots and quotes at its begin, mean themselves.
std::string manual_line(const std::string& text)
{
  std::string line;
  for (const char c : text) {
    line += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return (!line.empty() && (line[0] == '.' || line[0] == '\'') ? "\\&" : "") + line + "\n";
}

// A part of help() that describes options, as a section.
std::string manual_section(const part& lines, const std::vector<described>& options)
{
  std::string text = ".SH ";
  for (const char c : lines[0].substr(0, lines[0].find(':'))) {
    text += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  text += "\n";
  for (size_t line = 1; line < lines.size() && !begins(lines[line], "  -"); ++line) {
    text += manual_line(lines[line].substr(indent_of(lines[line])));
  }
  for (const described& option : options) {
    text += ".TP\n" + manual_line(option.words) + manual_line(option.about);
  }
  return text;
}

// Lines that keep their ends. before: a request before each.
std::string manual_lines(const part& lines, const std::string& before, bool indented)
{
  std::string text;
  for (const std::string& line : lines) {
    text += before + manual_line(indented ? line : line.substr(indent_of(line)));
  }
  return text;
}

std::string manual()
{
  const std::vector<part> parts = parts_of_help();
  std::string text = std::string(".TH STRATUS 1 \"\" \"Stratus ") + stratus_version() +
    "\"\n.SH NAME\nstratus \\- draws volumes\n.SH SYNOPSIS\n.nf\n" + manual_lines(parts[1], "", true) + ".fi\n";
  for (size_t i = 2; i + 1 < parts.size(); ++i) {
    const std::vector<described> options = options_of(parts[i]);
    text += options.empty() ? (i == 2 ? ".SH INPUT\n" : ".SH NOTES\n") + manual_lines(parts[i], ".br\n", false)
                            : manual_section(parts[i], options);
  }
  return text + ".SH EXAMPLES\n.nf\n" + manual_lines(parts.back(), "", true) + ".fi\n";
}
} // namespace

const std::vector<std::string>& cli::commands()
{
  static const std::vector<std::string> all = { "render", "info", "tree", "sort", "compare", "devices", "help", "completion" };
  return all;
}

std::string cli::help_about(const std::string& topic)
{
  const std::vector<part> parts = parts_of_help();
  const std::string more =
    "Topics of stratus help: " + topic_list() + ",\n  a command, or an option such as --opacity. stratus --help prints all\n";
  const std::string examples = joined(parts.back());
  if (topic.empty()) {
    return joined(parts[0]) + "\n" + joined(parts[1]) + "\n" + more + "\n" + examples;
  }
  if (const part* found = find_topic(parts, topic)) {
    return joined(*found);
  }
  std::string options;
  for (const described& option : all_options()) {
    options += names(option, topic) || names(option, "--" + topic) ? option.words + "\n    " + option.about + "\n" : "";
  }
  if (!options.empty()) {
    return options;
  }
  const part of_command =
    std::find(commands().begin(), commands().end(), topic) == commands().end() ? part() : lines_with(parts, "stratus " + topic);
  if (!of_command.empty()) {
    return joined(of_command) + "\n" + more;
  }
  std::vector<std::string> known = option_words();
  known.insert(known.end(), commands().begin(), commands().end());
  for (const auto& one : topics) {
    known.emplace_back(one[0]);
  }
  std::string near = nearest(topic, known);
  near = near.empty() ? nearest("--" + topic, known) : near;
  throw usage("help: no topic '" + topic + "'" + (near.empty() ? "; topics are " + topic_list() : ": did you mean " + near + "?"));
}

std::string cli::completion(const std::string& shell)
{
  if (shell == "bash") {
    return bash();
  }
  if (shell == "zsh") {
    return zsh();
  }
  if (shell == "fish") {
    return fish();
  }
  if (shell == "man") {
    return manual();
  }
  throw usage("completion: '" + shell + "' is none of bash, zsh, fish, man");
}
