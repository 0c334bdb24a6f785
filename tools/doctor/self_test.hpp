// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/doctor/network.hpp"

namespace nodmap::doctor {

/// Sends a message on the URL, listens for a second, and tells what came. Done in a process of its
/// own, as LCM itself may wait longer or write to stderr when the network is ill.
[[nodiscard]] SelfTest run_self_test(const std::string& url);

}  // namespace nodmap::doctor
