// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::logger {

/// main() of nodmap-logger: records until SIGINT or SIGTERM. Returns the exit code: 0 no message
/// was dropped for lack of disk space, 1 some were, or recording could not start, 2 wrong command
/// line or configuration.
int run(int argc, char** argv);

}  // namespace nodmap::logger
