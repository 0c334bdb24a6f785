// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::laser3d {

/// The life of the process nodmap-laser3d: command line, loop, STATUS, end. Returns the exit code:
/// 0 done, 1 failed, 2 wrong command line or configuration.
int run_laser3d(int argc, char** argv);

}  // namespace nodmap::laser3d
