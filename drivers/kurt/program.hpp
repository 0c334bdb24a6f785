// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::kurt {

/// The life of the process nodmap-kurt: command line, loop, STATUS, end. Returns the exit code: 0
/// done, 1 failed, 2 wrong command line or configuration.
int run_kurt(int argc, char** argv);

}  // namespace nodmap::kurt
