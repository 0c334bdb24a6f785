// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/geometry/time.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::foxglove {

/// Whether the robot is stopped, as far as STOP tells: a STOP says only that somebody wants it to
/// stop, a confirmation of the base driver that it has stopped. One message of STOP is not enough
/// to know, because a viewer repeats its own in between.
class StopState {
 public:
  enum class State : std::uint8_t {
    kReleased,
    kSent,          ///< the base driver, which speaks once a second, has not had time to confirm it
    kStopped,       ///< the base driver has confirmed it
    kNotConfirmed,  ///< the base driver is silent about it
  };

  /// `arrived`: when this host received it, or in replay when it was logged.
  void take(const nodmap::stop_t& message, time::SteadyTime arrived);

  /// Lets time pass without a message on STOP, as when the base driver has died: a state lasts only
  /// as long as it is confirmed. `now`: by the clock of `arrived`. Returns whether the state has
  /// changed.
  bool pass(time::SteadyTime now);

  [[nodiscard]] State state() const;

  /// {timestamp, state, by}: the state in capitals, and the name of the requester.
  [[nodiscard]] Json to_json() const;

 private:
  time::Timestamp stamp_{};  // of the newest message
  time::SteadyTime now_{};   // when it arrived, or that has passed since
  std::string by_;
  std::optional<time::SteadyTime> asked_;      // first STOP since the release
  std::optional<time::SteadyTime> confirmed_;  // last confirmation since then
};

}  // namespace nodmap::foxglove
