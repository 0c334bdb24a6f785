// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::node {

/// From now on SIGINT and SIGTERM ask the process to stop instead of killing it.
void catch_stop_signals();

/// Whether one of them has come.
[[nodiscard]] bool stop_requested();

}  // namespace nodmap::node
