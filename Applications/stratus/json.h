// SPDX-License-Identifier: BSD-3-Clause
// Results as JSON, for --json.
#pragma once

#include <string>

namespace cli {

// Text in quotes.
std::string json_text(const std::string& text);
// The shortest number that reads back as the value; null for values that are not finite, which JSON lacks.
std::string json_number(double value);
// All rows that were printed, and the INPUT that they are about.
std::string json_of_rows(const std::string& source);
// Writes a complete file or none; "-" is the standard output.
void write_json(const std::string& path, const std::string& json);
} // namespace cli
