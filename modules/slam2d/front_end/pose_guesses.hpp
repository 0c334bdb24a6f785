// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan/level_scan.hpp"

namespace nodmap::slam2d {

/// Guesses the pose of the next scan before it is matched.
///
/// Normally odometry gives the only guess. But its driver may hang: it repeats a pose while the
/// robot drives on, and later catches up in one jump. Where odometry contradicts the motion so far,
/// there are two more guesses: that motion, continued, and odometry since the last keyframe, which
/// includes the jump.
class PoseGuesses {
 public:
  explicit PoseGuesses(const PeopleParams& params) : params_(params) {}

  /// Adds a scan whose pose has been found. `T_last_base`: its pose relative to the previous scan.
  void add_scan(time::Timestamp stamp, const geometry::SE2& T_last_base);
  /// From here on odometry is counted: the last scan, taken at `T_odom_base`, is a keyframe, or its
  /// pose is sure again.
  void count_odometry_from(const geometry::SE2& T_map_odom, const geometry::SE2& T_odom_base) {
    T_map_odom_counted_ = T_map_odom;
    T_odom_counted_ = T_odom_base;
  }
  /// The map has moved under the robot: `T_new_old` is its old frame in the new one.
  void move_map(const geometry::SE2& T_new_old) {
    T_map_odom_counted_ = T_new_old * T_map_odom_counted_;
  }
  /// Forgets the motion up to the last scan, because its pose is not known.
  void forget_motion() { steps_.clear(); }

  /// T_map_base by the odometry that is counted, whatever was matched since.
  [[nodiscard]] geometry::SE2 by_counted_odometry(const LevelScan& scan) const {
    return T_map_odom_counted_ * scan.T_odom_base;
  }
  /// Whether scans follow one another so quickly (5 to 50 ms, now and up to `next_stamp`) that the
  /// robot cannot leave its course by odometry in between.
  [[nodiscard]] bool is_fast(time::Timestamp next_stamp) const;
  /// Whether the pose found for a scan is farther from odometry than slipping wheels explain, since
  /// the previous scan or since odometry is counted. `T_map_guess`: the pose by odometry since the
  /// previous scan. May be called only if is_fast().
  [[nodiscard]] bool is_beyond_slip(const LevelScan& scan, const geometry::SE2& T_map_guess,
                                    const geometry::SE2& T_map_found) const;

  /// Guesses T_map_base of a scan, the likeliest first. There is only one if all agree so closely
  /// that matching finds the same pose from each. `T_map_odom` and `T_odom_last`: of the last scan.
  [[nodiscard]] std::vector<geometry::SE2> guesses(const LevelScan& scan,
                                                   const geometry::SE2& T_map_odom,
                                                   const geometry::SE2& T_odom_last) const;

 private:
  struct Step {
    geometry::SE2 T_last_base;
    double duration_s = 0.0;
  };
  [[nodiscard]] bool is_fast_step(double step_s) const;
  /// The motion from the last scan to the next, if the robot goes on as it did.
  [[nodiscard]] std::optional<geometry::SE2> next_step(time::Timestamp next_stamp) const;
  [[nodiscard]] std::optional<geometry::SE2> mean_step_in_bursts() const;

  PeopleParams params_;
  std::deque<Step> steps_;  // between the last scans, the newest last
  std::optional<time::Timestamp> last_stamp_;
  geometry::SE2 T_map_odom_counted_;  // as it was where odometry is counted from
  geometry::SE2 T_odom_counted_;      // of that place
};

}  // namespace nodmap::slam2d
