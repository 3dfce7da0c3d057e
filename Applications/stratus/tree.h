// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "options.h"

namespace cli {

// `stratus tree`: builds the tree of a volume, prints its statistics, and writes the boxes of its nodes where the options say so.
void print_tree(const options& o);
} // namespace cli
