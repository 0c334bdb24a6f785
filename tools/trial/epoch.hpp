// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace nodmap::trial {

/// The simulation's start in microseconds since the epoch: 2008-07-01 in UTC, when the paper was
/// presented.
inline constexpr std::int64_t kEpochUs = 1'214'870'400'000'000;

}  // namespace nodmap::trial
