// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/viewer/options.hpp"
#include "modules/viewer/params.hpp"

namespace nodmap::viewer {

/// Plays recordings, as clients say, until a stop signal.
void run_replay(const Options& options, const ViewerParams& params);

}  // namespace nodmap::viewer
