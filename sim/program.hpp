// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::sim {

/// The life of nodmap-sim. Returns the exit code: 0 done, 1 failed, 2 wrong command line,
/// configuration, world or fault.
int run_sim(int argc, char** argv);

}  // namespace nodmap::sim
