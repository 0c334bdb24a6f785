// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::logger {

/// main() of nodmap-logger: records until SIGINT or SIGTERM. Returns the exit code: 0 stopped with
/// everything received in the files, 1 not (no room, or it never began), 2 wrong command line or
/// configuration.
int run(int argc, char** argv);

}  // namespace nodmap::logger
