// SPDX-License-Identifier: BSD-3-Clause
// `stratus compare`: holds a picture to another one.
#pragma once

#include "options.h"

namespace cli {

// Prints how the images differ, writes the requested reports, and returns whether the images are within the limits. If they cannot be
// compared, throws failure after writing the reports.
bool compare(const options& o);
} // namespace cli
