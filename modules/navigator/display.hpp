// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/bus/bus.hpp"
#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/inputs/inputs.hpp"
#include "modules/navigator/navigator.hpp"

namespace nodmap::navigator {

/// Publishes PATH, TRACKS and LOCAL_MAP, less often than DRIVE: they are shown, and PATH also tells
/// the explorer and `nodmap-goal` whether there is a path.
class Display {
 public:
  explicit Display(bus::Bus& bus) : bus_(bus) {}

  /// Publishes what is due. `stamp`: of the DRIVE that sends `decision`. `newest` must have
  /// odometry.
  void publish(time::Timestamp stamp, const Navigator& navigator, const Decision& decision,
               const Inputs& newest);

 private:
  void publish_path(time::Timestamp stamp, const Navigator& navigator, const Decision& decision,
                    const Inputs& newest);
  void publish_tracks(time::Timestamp stamp, const Navigator& navigator);
  void publish_local_map(time::Timestamp stamp, const LocalMap& local_map,
                         const geometry::SE2& T_odom_base);

  bus::Bus& bus_;
  std::optional<time::Timestamp> path_stamp_;    // of the last one with a goal, if it was the last
  std::optional<time::Timestamp> tracks_stamp_;  // of the last one, if it had tracks
  std::optional<time::Timestamp> local_map_stamp_;
};

}  // namespace nodmap::navigator
