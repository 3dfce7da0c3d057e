// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "options.h"

namespace cli {

// `stratus sort`: cuts a grid into leaves, sorts it from the views of record, and checks the order along rays.
void print_sort(const options& o);
} // namespace cli
