// SPDX-License-Identifier: BSD-3-Clause
// Words of files as readers compare them.
#ifndef vtkStratusText_h
#define vtkStratusText_h

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

// Returns the text without the white space at its ends.
inline std::string vtkStratusTrimmed(std::string_view text)
{
  const auto space = [](unsigned char c) { return std::isspace(c) != 0; };
  while (!text.empty() && space(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && space(text.back())) {
    text.remove_suffix(1);
  }
  return std::string(text);
}

// Returns the text in small letters.
inline std::string vtkStratusLowerCase(std::string_view text)
{
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// Whether the text ends with `end`, which has small letters, in letters of any size.
inline bool vtkStratusEndsWith(std::string_view text, std::string_view end)
{
  return text.size() >= end.size() && vtkStratusLowerCase(text.substr(text.size() - end.size())) == end;
}

#endif
