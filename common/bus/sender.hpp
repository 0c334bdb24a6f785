// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>

#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// The UDP socket that a message was sent from. LCM keeps one socket for as long as a process uses
/// it, and no other process of that host can send from the same port, so this identifies the sender
/// whatever its messages contain. All unknown senders are equal.
struct Sender {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  auto operator<=>(const Sender&) const = default;  // NOLINT: clang-tidy 14 sees a null here
};

/// Where a message came from, and when.
struct Origin {
  Sender sender;               ///< unknown in replay and with memq://: then all are one
  time::Timestamp received{};  ///< when this host received it; the epoch in replay by a node
  /// The same by the steady clock, to tell how long a sender has been silent; see ArrivalClock.
  /// Zero in replay by a node.
  time::SteadyTime arrived{};
};

}  // namespace nodmap::bus
