// SPDX-License-Identifier: BSD-3-Clause
// The nearest word to one that is not known, whatever the case of its letters.
#pragma once

#include <string>
#include <vector>

namespace cli {

// Returns the candidate that is nearest to a mistyped word; "" where none is near.
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

// Returns ": did you mean CANDIDATE?" with the nearest one to a word, or to an option before its =; "" where none is near.
std::string meant(const std::string& word, const std::vector<std::string>& candidates);
} // namespace cli
