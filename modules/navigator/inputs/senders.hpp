// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/sender.hpp"
#include "common/bus/sender_watch.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::navigator {

/// Follows one sender for each input. Two senders mean that one is forged, or that a process runs
/// twice; which of them is right is not known.
class InputSenders {
 public:
  enum class Input : std::uint8_t {
    kScan,
    kOdometry,
    kPitchCommand,
    kPitchState,
    kObstacleMap,
    kBaseSensors
  };

  /// Takes a message. Returns false if it comes from a sender other than the one followed.
  [[nodiscard]] bool follow(Input input, const bus::Origin& origin);

  /// Takes a message that is refused for another reason: it may reveal a second sender.
  void refuse(Input input, const bus::Origin& origin);

  /// The name under which messages of other senders are counted.
  [[nodiscard]] static const char* cause_of(Input input);

  /// The channel of an input that two processes send; empty if there is none. `now`: by the clock
  /// of Origin::arrived.
  [[nodiscard]] std::optional<std::string> contested_channel(time::SteadyTime now) const;

 private:
  std::array<bus::SenderWatch, 6> watches_;  // by input
};

}  // namespace nodmap::navigator
