// SPDX-License-Identifier: BSD-3-Clause
// Findings about the host, each a function of what was read from the system.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tools/doctor/finding.hpp"

namespace nodmap::doctor {

/// A file or program that should be there; `command` gets it. Never worse than WARN: the robot runs
/// without.
[[nodiscard]] Finding check_present(const std::string& check, const std::string& what,
                                    bool is_present, const std::string& purpose,
                                    const std::string& command);

/// Whether the start script of lcm-spy works with the Java of today. No text: not installed.
[[nodiscard]] Finding check_spy_script(const std::optional<std::string>& script);

/// Room for recordings, with how long it lasts at our rates.
[[nodiscard]] Finding check_disk(const std::string& dir, std::int64_t available_bytes);

/// Whether programs may go before all others (SCHED_RR), as the drivers and the navigator want to.
[[nodiscard]] Finding check_realtime(bool is_permitted);

/// Whether the deputy may raise the kernel's threads that carry the bytes of serial ports.
[[nodiscard]] Finding check_serial_workers(bool may_raise);

/// Whether the clock follows a reference: stamps of several hosts must agree.
[[nodiscard]] Finding check_clock(bool is_synchronized);

}  // namespace nodmap::doctor
