// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

#include "tools/doctor/network.hpp"

namespace nodmap::doctor {

/// Sends a message on the URL, listens for `duration`, and reports what was received. Runs in a
/// process of its own, because LCM may block for longer or write to stderr if the network is
/// faulty.
[[nodiscard]] SelfTest run_self_test(const std::string& url, std::chrono::milliseconds duration);

}  // namespace nodmap::doctor
