// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::viewer {

/// main() of nodmap-viewer: serves until SIGINT or SIGTERM. Returns the exit code: 0 stopped,
/// 1 failed, 2 wrong command line or configuration.
int run(int argc, char** argv);

}  // namespace nodmap::viewer
