// SPDX-License-Identifier: BSD-3-Clause
// Checks of the host, each a function of data read from the system.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tools/doctor/finding.hpp"

namespace nodmap::doctor {

/// Checks for a file or program; `command` installs it. At most WARN, because the robot runs
/// without it.
[[nodiscard]] Finding check_present(const std::string& check, const std::string& what,
                                    bool is_present, const std::string& purpose,
                                    const std::string& command);

/// Checks whether lcm-spy's start script works with current versions of Java. Empty: not installed.
[[nodiscard]] Finding check_spy_script(const std::optional<std::string>& script);

/// Checks the disk space for recordings, and how long it lasts at our rates.
[[nodiscard]] Finding check_disk(const std::string& dir, std::int64_t available_bytes);

/// Checks whether programs may have real-time priority (SCHED_RR), as the drivers and the navigator
/// need.
[[nodiscard]] Finding check_realtime(bool is_permitted);

/// Checks whether the deputy may raise the priority of the kernel threads that transfer the bytes
/// of serial ports.
[[nodiscard]] Finding check_serial_workers(bool may_raise);

/// Checks whether the clock is synchronised, because the stamps of several hosts must agree.
[[nodiscard]] Finding check_clock(bool is_synchronized);

}  // namespace nodmap::doctor
