// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/inputs/senders.hpp"

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

}  // namespace

bool InputSenders::follow(Input input, const bus::Origin& origin) {
  return watches_[static_cast<std::size_t>(input)].follow(origin.sender, origin.arrived);
}

void InputSenders::refuse(Input input, const bus::Origin& origin) {
  watches_[static_cast<std::size_t>(input)].refuse(origin.sender, origin.arrived);
}

const char* InputSenders::cause_of(Input input) {
  return kNames[static_cast<std::size_t>(input)].cause;
}

std::optional<std::string> InputSenders::contested_channel(time::SteadyTime now) const {
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    if (watches_[i].is_contested(now)) {
      return kNames[i].channel;
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::navigator
