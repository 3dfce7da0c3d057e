// SPDX-License-Identifier: BSD-3-Clause
// Habits that users bring from other programs: help by topic, completions, a manual page. All of it is made from help() and the tables of
// options.
#pragma once

#include <string>
#include <vector>

namespace cli {

// Returns the part of help() about a command (render), a topic (camera) or an option (--opacity); without a topic an overview. Throws usage
// for any other topic.
std::string help_about(const std::string& topic);

// The commands, for completion and for mistyped ones.
const std::vector<std::string>& commands();

// Returns a script for a shell, bash, zsh or fish, or for "man" a manual page. Throws usage for any other name.
std::string completion(const std::string& shell);
} // namespace cli
