// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/path_progress.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kProgressM = 0.15;
// A plan that costs this much more than the last one leads elsewhere.
constexpr double kNewPathM = 1.0;
// So far the robot goes back and forth while its plan alternates.
constexpr double kBackAndForthM = 0.5;

}  // namespace

bool PathProgress::gives_up(time::Timestamp stamp, const Eigen::Vector2d& p_map, double cost_m) {
  patience_.record(stamp);
  if (!patience_.has_begun() || cost_m <= least_cost_m_ + kNewPathM) {
    is_longer_ = false;
  } else if (cost_m > last_cost_m_ + kNewPathM) {
    is_longer_ = true;
  }
  last_cost_m_ = cost_m;
  if (is_longer_ && (!longer_from_map_ || (p_map - *longer_from_map_).norm() > kBackAndForthM)) {
    longer_from_map_ = p_map;
    is_longer_ = false;
    patience_.end();
  }
  // While it alternates, the shorter path is the wrong one.
  const bool is_stuck = patience_.is_over(stamp) && !is_longer_;
  if (patience_.is_over(stamp) || !patience_.has_begun() || cost_m <= least_cost_m_ - kProgressM) {
    patience_.restart(stamp);
    least_cost_m_ = cost_m;
  }
  return is_stuck;
}

}  // namespace nodmap::navigator
