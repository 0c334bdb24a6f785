// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "common/bus/event_log.hpp"

namespace nodmap::convert {

/// Calls `handle` for each event of a log, with a bar on the terminal; returns the bytes that
/// belonged to no event, after a warning. Throws std::runtime_error when the log cannot be read,
/// holds no event or the user has asked to stop.
std::int64_t for_each_event(const std::filesystem::path& log,
                            const std::function<void(const bus::LogEvent&)>& handle);

}  // namespace nodmap::convert
