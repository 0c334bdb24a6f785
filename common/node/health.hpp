// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace nodmap::node {

enum class HealthState : std::uint8_t { kOk, kDegraded, kFailed };

struct Health {
  HealthState state = HealthState::kOk;
  std::string reason;  ///< why it is not OK, else empty
  /// Whether a second without messages is a fault. False for drivers, whose input is a device.
  bool needs_messages = true;
};

}  // namespace nodmap::node
