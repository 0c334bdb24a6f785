// SPDX-License-Identifier: BSD-3-Clause
// Messages field by field, under the names of their .lcm files: what plots and tables read. Numbers
// that JSON has not (NaN, infinity) become null.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/foxglove/foxglove.hpp"
#include "nodmap/base_sensors_t.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"
#include "nodmap/truth_t.hpp"

namespace nodmap::foxglove {

/// Without the raw readings.
[[nodiscard]] Json fields_of(const nodmap::base_sensors_t& message);
[[nodiscard]] Json fields_of(const nodmap::drive_t& message);
[[nodiscard]] Json fields_of(const nodmap::goal_t& message);
/// Besides: `behaviour_name`.
[[nodiscard]] Json fields_of(const nodmap::navigation_t& message);
/// Without the covariance.
[[nodiscard]] Json fields_of(const nodmap::odometry_t& message);
[[nodiscard]] Json fields_of(const nodmap::pitch_command_t& message);
[[nodiscard]] Json fields_of(const nodmap::pitch_state_t& message);
[[nodiscard]] Json fields_of(const nodmap::pose_t& message);
[[nodiscard]] Json fields_of(const nodmap::status_t& message);
[[nodiscard]] Json fields_of(const nodmap::stop_t& message);
/// Without the actors.
[[nodiscard]] Json fields_of(const nodmap::truth_t& message);

/// The newest STATUS of each process, in the order of their names: one message for all, since a
/// reader may see only the newest message of a topic.
class ProcessTable {
 public:
  /// More processes than any robot of ours has; names beyond are not taken.
  static constexpr std::size_t kMaxProcesses = 64;

  struct Change {
    bool taken = false;
    bool health_changed = false;
  };
  Change update(const nodmap::status_t& status);
  void clear() { processes_.clear(); }

  /// {timestamp, processes: [fields of status_t]}.
  [[nodiscard]] Json processes() const;

 private:
  std::map<std::string, nodmap::status_t> processes_;
};

/// foxglove.Log of what a process says of its health.
[[nodiscard]] Json health_log(const nodmap::status_t& status);

}  // namespace nodmap::foxglove
