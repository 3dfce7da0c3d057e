// SPDX-License-Identifier: BSD-3-Clause
// `stratus compare`: holds a picture to another one.
#pragma once

#include "options.h"

namespace cli {

// Tells how the pictures differ, writes the reports that were asked for, and returns whether the pictures are alike. Throws failure where
// they cannot be compared, once the reports are written.
bool compare(const options& o);
} // namespace cli
