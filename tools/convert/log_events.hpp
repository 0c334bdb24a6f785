// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "common/bus/event_log.hpp"

namespace nodmap::convert {

/// Calls `handle` for each event of a log, with a progress bar on the terminal. Returns the number
/// of bytes that belong to no event, after a warning. Throws std::runtime_error if the log cannot
/// be read or contains no event, or if the user has asked to stop.
std::int64_t for_each_event(const std::filesystem::path& log,
                            const std::function<void(const bus::LogEvent&)>& handle);

}  // namespace nodmap::convert
