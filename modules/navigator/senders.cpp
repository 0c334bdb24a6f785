// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/senders.hpp"

namespace nodmap::navigator {
namespace {

using Input = InputSenders::Input;

struct Names {
  const char* channel;
  const char* cause;
};
constexpr std::array<Names, 6> kNames{
    {{"SCAN", "other_sender_of_scan"},
     {"ODOMETRY", "other_sender_of_odometry"},
     {"PITCH_COMMAND", "other_sender_of_pitch_command"},
     {"PITCH_STATE", "other_sender_of_pitch_state"},
     {"OBSTACLE_MAP", "other_sender_of_obstacle_map"},
     {"BASE_SENSORS", "other_sender_of_base_sensors"}}};  // by input

// The time by which an input is watched. Odometry comes all the time, so its stamps are the clock
// of the other inputs; for odometry itself it is the readings of the servo. A step back begins
// anew.
time::SteadyTime clock_of(Input input, time::Timestamp otherwise, const InputStamps& stamps) {
  const auto& newest = input == Input::kOdometry ? stamps.pitch_state : stamps.odometry;
  return time::SteadyTime(newest.value_or(otherwise).time_since_epoch());
}

}  // namespace

bool InputSenders::follow(Input input, const Message& message, const InputStamps& stamps) {
  return watches_[static_cast<std::size_t>(input)].follow(message.sender,
                                                          clock_of(input, message.stamp, stamps));
}

void InputSenders::refuse(Input input, const Message& message, const InputStamps& stamps) {
  watches_[static_cast<std::size_t>(input)].refuse(message.sender,
                                                   clock_of(input, message.stamp, stamps));
}

const char* InputSenders::cause_of(Input input) {
  return kNames[static_cast<std::size_t>(input)].cause;
}

std::optional<std::string> InputSenders::contested_channel(const InputStamps& stamps) const {
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    if (watches_[i].is_contested(clock_of(static_cast<Input>(i), {}, stamps))) {
      return kNames[i].channel;
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::navigator
