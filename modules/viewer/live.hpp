// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/viewer/options.hpp"
#include "modules/viewer/params.hpp"

namespace nodmap::viewer {

/// Shows what LCM brings, and carries out what clients with control ask for, until a stop signal.
void run_live(const Options& options, const ViewerParams& params);

}  // namespace nodmap::viewer
