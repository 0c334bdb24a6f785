// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam2d/level_scan.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// Guesses of where the next scan was taken, before it is matched.
///
/// Mostly odometry tells. But its driver may hang: it repeats a pose while the robot drives on, and
/// catches up later in one jump. The robot itself does not jump: where odometry contradicts its
/// motion so far, that is a guess as well, and so is odometry since the last keyframe, which takes
/// in what was caught up.
class PoseGuesses {
 public:
  explicit PoseGuesses(const PeopleParams& params) : params_(params) {}

  /// The pose of a scan has been found: `T_last_base`, relative to the scan before, as measured.
  void add_scan(time::Timestamp stamp, const geometry::SE2& T_last_base);
  /// The last scan has become a keyframe at `T_odom_base`, and odom lies there in map.
  void add_keyframe(const geometry::SE2& T_map_odom, const geometry::SE2& T_odom_base) {
    T_map_odom_keyframe_ = T_map_odom;
    T_odom_keyframe_ = T_odom_base;
  }
  /// The pose of the last scan is not known: nor is the motion up to it.
  void forget_motion() { steps_.clear(); }
  /// Odometry continues in another frame; T_old_new is the new one in the old one.
  void change_odometry_frame(const geometry::SE2& T_old_new);

  /// T_map_base by odometry since the last keyframe, whatever was matched since.
  [[nodiscard]] geometry::SE2 since_keyframe(const LevelScan& scan) const {
    return T_map_odom_keyframe_ * scan.T_odom_base;
  }
  /// Whether scans come one after the other in so little time, at the last one and at the next,
  /// that from one to the next the robot cannot but go on as odometry says.
  [[nodiscard]] bool is_fast(time::Timestamp next_stamp) const;
  /// Whether a scan, which is fast, was found farther from odometry than wheels slip: from one scan
  /// to the next, and since the last keyframe. `T_map_guess`: by odometry since the last scan.
  [[nodiscard]] bool is_beyond_slip(const LevelScan& scan, const geometry::SE2& T_map_guess,
                                    const geometry::SE2& T_map_found) const;

  /// T_map_base of a scan, the likeliest guess first; only one where all agree to within what
  /// matching takes back. `T_map_odom` and `T_odom_last`: as of the last scan.
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
  geometry::SE2 T_map_odom_keyframe_;
  geometry::SE2 T_odom_keyframe_;
};

}  // namespace nodmap::slam2d
