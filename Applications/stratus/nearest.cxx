// SPDX-License-Identifier: BSD-3-Clause
#include "nearest.h"

#include <algorithm>
#include <cctype>

namespace cli {

namespace {

// Edits that make one word of the other: letters put in, left out, replaced, or swapped with the next.
size_t edits(const std::string& a, const std::string& b)
{
  std::vector<std::vector<size_t>> d(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({ d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1) });
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

std::string lower_case(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}
} // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& candidates)
{
  std::string best;
  size_t least = std::min<size_t>(3, word.size() / 2 + 1); // a word of which half is wrong was meant otherwise
  for (const std::string& candidate : candidates) {
    const size_t count = edits(lower_case(word), lower_case(candidate));
    if (count < least) {
      least = count;
      best = candidate;
    }
  }
  return best;
}

std::string meant(const std::string& word, const std::vector<std::string>& candidates)
{
  const std::string near = nearest(word.substr(0, word.find('=')), candidates);
  return near.empty() ? "" : ": did you mean " + near + "?";
}
} // namespace cli
