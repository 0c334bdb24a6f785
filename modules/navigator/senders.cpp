// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/senders.hpp"

#include <utility>

namespace nodmap::navigator {
namespace {

using Input = InputSenders::Input;

/// The time by which an input is watched. Odometry comes all the time, so its stamps are the clock
/// of the other inputs; for odometry itself it is the readings of the servo. A step back begins
/// anew.
time::SteadyTime clock_of(Input input, time::Timestamp otherwise, const InputStamps& stamps) {
  const auto& newest = input == Input::kOdometry ? stamps.pitch_state : stamps.odometry;
  return time::SteadyTime(newest.value_or(otherwise).time_since_epoch());
}

}  // namespace

bool InputSenders::follow(Input input, std::int64_t seq, time::Timestamp stamp,
                          const InputStamps& stamps) {
  return watches_[static_cast<std::size_t>(input)].follow(seq, clock_of(input, stamp, stamps));
}

void InputSenders::refuse(Input input, std::int64_t seq, time::Timestamp stamp,
                          const InputStamps& stamps) {
  watches_[static_cast<std::size_t>(input)].refuse(seq, clock_of(input, stamp, stamps));
}

std::optional<std::string> InputSenders::contested_channel(const InputStamps& stamps) const {
  for (const auto& [input, channel] : {std::pair(Input::kPitchCommand, "PITCH_COMMAND"),
                                       {Input::kPitchState, "PITCH_STATE"},
                                       {Input::kScan, "SCAN"},
                                       {Input::kOdometry, "ODOMETRY"},
                                       {Input::kObstacleMap, "OBSTACLE_MAP"},
                                       {Input::kBaseSensors, "BASE_SENSORS"}}) {
    const node::SenderWatch& watch = watches_[static_cast<std::size_t>(input)];
    if (watch.is_contested(clock_of(input, {}, stamps))) {
      return channel;
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::navigator
