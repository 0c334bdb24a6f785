// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace nodmap::node {

enum class HealthState : std::uint8_t { kOk, kDegraded, kFailed };

struct Health {
  HealthState state = HealthState::kOk;
  std::string reason;  ///< why it is not OK, else empty
  /// Whether a second without messages is a fault. False where the input is a device (laser3d), or
  /// where none is expected (a deputy without a sheriff).
  bool needs_messages = true;
};

}  // namespace nodmap::node
