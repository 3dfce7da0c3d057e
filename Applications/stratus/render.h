// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "options.h"

namespace cli {

// `stratus render`: a picture of a step, or a film of all.
void render(const options& o);
} // namespace cli
