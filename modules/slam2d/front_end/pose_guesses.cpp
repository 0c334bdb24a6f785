// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/pose_guesses.hpp"

#include <algorithm>
#include <utility>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam2d {
namespace {

// The motion is extrapolated only over this time. Level scans of a nodding laser are farther apart.
constexpr double kMaxStepS = 0.5;
// The ratio of successive intervals must be below this: stamps that come in bursts give no speed.
constexpr double kMaxStepRatio = 2.0;
// But the laser measures at an even rate: the mean over this many scans tells how far the robot
// moves from one to the next.
constexpr std::size_t kMeanSteps = 8;
// From guesses nearer than this, ICP finds the same pose. A robot that brakes at 2 m/s^2, or begins
// to rotate at 3 rad/s^2, is this far off after about a quarter of a second.
constexpr geometry::PoseTolerance kSame{.distance_m = 0.12, .rotation_rad = 0.12};

// The distance between two poses, in units of that.
double difference(const geometry::SE2& a, const geometry::SE2& b) {
  return distance_m(a, b) / kSame.distance_m + rotation_rad(a, b) / kSame.rotation_rad;
}

}  // namespace

void PoseGuesses::add_scan(time::Timestamp stamp, const geometry::SE2& T_last_base) {
  if (last_stamp_) {
    steps_.push_back({T_last_base, time::seconds(stamp - *last_stamp_)});
  }
  if (steps_.size() > kMeanSteps) {
    steps_.pop_front();
  }
  last_stamp_ = stamp;
}

bool PoseGuesses::is_fast_step(double step_s) const {
  return step_s >= params_.min_scan_period_s && step_s <= params_.max_scan_period_s;
}

bool PoseGuesses::is_fast(time::Timestamp next_stamp) const {
  return !steps_.empty() && is_fast_step(steps_.back().duration_s) &&
         is_fast_step(time::seconds(next_stamp - *last_stamp_));
}

bool PoseGuesses::is_beyond_slip(const LevelScan& scan, const geometry::SE2& T_map_guess,
                                 const geometry::SE2& T_map_found) const {
  const SlipParams& slip = params_.slip;
  const auto is_beyond = [&](const geometry::SE2& expected, double slip_m, double slip_rad) {
    return distance_m(T_map_found, expected) > slip.match_scatter_m + slip_m ||
           rotation_rad(T_map_found, expected) > slip.match_scatter_rad + slip_rad;
  };
  const double step_s = time::seconds(scan.stamp - *last_stamp_);
  const double slipped_m = slip.max_ratio * distance_m(T_odom_counted_, scan.T_odom_base);
  const double slipped_rad = slip.max_ratio * rotation_rad(T_odom_counted_, scan.T_odom_base) +
                             slipped_m / slip.effective_wheel_distance_m;
  return is_beyond(T_map_guess, slip.max_mps * step_s, slip.max_rad_s * step_s) ||
         is_beyond(by_counted_odometry(scan), slipped_m, slipped_rad);
}

std::optional<geometry::SE2> PoseGuesses::next_step(time::Timestamp next_stamp) const {
  if (steps_.empty()) {
    return std::nullopt;
  }
  const auto& [T_last_base, duration_s] = steps_.back();
  const double ratio = time::seconds(next_stamp - *last_stamp_) / duration_s;
  if (duration_s > 0.0 && duration_s <= kMaxStepS && ratio >= 1.0 / kMaxStepRatio &&
      ratio <= kMaxStepRatio) {
    return geometry::SE2{ratio * T_last_base.x, ratio * T_last_base.y, ratio * T_last_base.yaw};
  }
  return mean_step_in_bursts();
}

std::optional<geometry::SE2> PoseGuesses::mean_step_in_bursts() const {
  if (steps_.size() < kMeanSteps) {
    return std::nullopt;
  }
  double least_s = steps_.front().duration_s;
  double most_s = least_s;
  double total_s = 0.0;
  geometry::SE2 mean;
  for (const auto& [T_last_base, duration_s] : steps_) {
    least_s = std::min(least_s, duration_s);
    most_s = std::max(most_s, duration_s);
    total_s += duration_s;
    mean.x += T_last_base.x / kMeanSteps;
    mean.y += T_last_base.y / kMeanSteps;
    mean.yaw += T_last_base.yaw / kMeanSteps;
  }
  const bool are_bursts = most_s > kMaxStepRatio * least_s;
  const bool is_even_rate = total_s > 0.0 && total_s <= kMeanSteps * kMaxStepS;
  return are_bursts && is_even_rate ? std::optional(mean) : std::nullopt;
}

std::vector<geometry::SE2> PoseGuesses::guesses(const LevelScan& scan,
                                                const geometry::SE2& T_map_odom,
                                                const geometry::SE2& T_odom_last) const {
  geometry::SE2 by_odometry = T_map_odom * scan.T_odom_base;
  const std::optional<geometry::SE2> step = next_step(scan.stamp);
  if (!step || scan.follows_unseen_motion()) {
    return {by_odometry};
  }
  const geometry::SE2 by_motion = T_map_odom * T_odom_last * *step;
  geometry::SE2 by_counted_odometry = this->by_counted_odometry(scan);
  if (is_within(by_odometry, by_motion, kSame)) {
    return {by_odometry};
  }
  // When odometry catches up, one of its two guesses contains the same motion twice.
  if (difference(by_counted_odometry, by_motion) < difference(by_odometry, by_motion)) {
    std::swap(by_odometry, by_counted_odometry);
  }
  std::vector<geometry::SE2> guesses{by_odometry};
  for (const geometry::SE2& other : {by_counted_odometry, by_motion}) {
    if (std::none_of(guesses.begin(), guesses.end(),
                     [&](const geometry::SE2& guess) { return is_within(guess, other, kSame); })) {
      guesses.push_back(other);
    }
  }
  return guesses;
}

}  // namespace nodmap::slam2d
