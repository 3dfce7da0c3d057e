// SPDX-License-Identifier: BSD-3-Clause
// The part of stratus-bench that measures the plugin in ParaView.
#pragma once

namespace bench {

int paraview_main(int argc, char* argv[]);
} // namespace bench
