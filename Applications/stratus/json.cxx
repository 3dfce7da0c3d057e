// SPDX-License-Identifier: BSD-3-Clause
#include "json.h"

#include "output.h"
#include "support.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace cli {

std::string json_text(const std::string& text)
{
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      quoted += format("\\u%04x", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string json_number(double value)
{
  if (!std::isfinite(value)) {
    return "null";
  }
  std::string text;
  for (int digits = 6; digits <= 17; ++digits) {
    text = format("%.*g", digits, value);
    if (std::strtod(text.c_str(), nullptr) == value) {
      break;
    }
  }
  return text;
}

std::string json_of_rows(const std::string& source)
{
  std::string text = "{\n  \"input\": " + json_text(source) + ",\n  \"rows\": [";
  const char* separator = "\n";
  for (const printed_row& one : printed_rows()) {
    text += separator;
    text += "    { \"name\": " + json_text(one.name) + ", \"text\": " + json_text(one.text);
    if (!one.numbers.empty()) {
      text += ", \"numbers\": [";
      for (size_t i = 0; i < one.numbers.size(); ++i) {
        text += (i ? ", " : "") + json_number(one.numbers[i]);
      }
      text += "]";
    }
    text += " }";
    separator = ",\n";
  }
  return text + "\n  ]\n}\n";
}

void write_json(const std::string& path, const std::string& json)
{
  if (path == "-") {
    std::fputs(json.c_str(), stdout);
  } else {
    output_file(path).write(std::vector<uint8_t>(json.begin(), json.end()));
  }
}
} // namespace cli
