// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/waypoints.hpp"

#include <algorithm>
#include <iterator>

namespace nodmap::explorer {
namespace {

// A waypoint must be at least this far away to be kept, so that the robot never brakes for one.
constexpr double kAheadM = 1.2;
// Waypoints nearer to each other than this count as the same one.
constexpr double kSameWaypointM = 0.5;
// Added to the tolerance. A waypoint nearer than this is replaced before the navigator has arrived
// there and stops.
constexpr double kReachedM = 0.2;
// Added to the tolerance: a waypoint is at least this far away, even around a corner.
constexpr double kMinAheadM = 0.5;
// Cells within this distance of the robot must not be occupied, but may be near to what is.
constexpr double kAroundRobotM = 0.4;

// Whether a waypoint is on the path and far enough ahead that the robot does not brake for it.
bool is_ahead(const std::vector<Eigen::Vector2d>& path_map, const Eigen::Vector2d& waypoint_map,
              const Eigen::Vector2d& p_map) {
  return (waypoint_map - p_map).norm() > kAheadM &&
         std::ranges::any_of(path_map, [&](const Eigen::Vector2d& p) {
           return (p - waypoint_map).norm() < 0.5 * kSameWaypointM;
         });
}

}  // namespace

bool is_line_passable(const PlanningGrid& grid, const Eigen::Vector2d& from_map,
                      const Eigen::Vector2d& to_map) {
  const double length_m = (to_map - from_map).norm();
  const int num_steps = static_cast<int>(length_m / grid.cell_size_m());
  for (int i = 1; i <= num_steps; ++i) {
    const double ratio = i * grid.cell_size_m() / length_m;
    const Cell cell = grid.cell_of(from_map + ratio * (to_map - from_map));
    const bool is_around_robot = ratio * length_m <= kAroundRobotM;
    if (is_around_robot ? grid.ground_at(cell) == Ground::kOccupied : !grid.is_passable(cell)) {
      return false;
    }
  }
  return true;
}

std::size_t num_on_line(const PlanningGrid& grid, const std::vector<Viewpoint>& tour,
                        const Eigen::Vector2d& from_map, double tolerance_m) {
  std::size_t num = 1;
  for (std::size_t last = 1; last < tour.size(); ++last) {
    const Eigen::Vector2d along = tour[last].p_map - from_map;
    const Eigen::Vector2d direction = along.normalized();
    double passed_m = 0.0;
    const bool passes_all =
        std::all_of(tour.begin(), tour.begin() + static_cast<std::ptrdiff_t>(last),
                    [&](const Viewpoint& viewpoint) {
                      const Eigen::Vector2d to_it = viewpoint.p_map - from_map;
                      const double at_m = to_it.dot(direction);
                      const bool is_next = at_m >= passed_m && at_m <= along.norm();
                      passed_m = at_m;
                      return is_next && (to_it - at_m * direction).norm() <= tolerance_m;
                    });
    if (passes_all && is_line_passable(grid, from_map, tour[last].p_map)) {
      num = last + 1;
    }
  }
  return num;
}

Goal Waypoints::next(const PlanningGrid& grid, const std::vector<Eigen::Vector2d>& path_map,
                     const Eigen::Vector2d& p_map, double last_tolerance_m) {
  const Eigen::Vector2d& last = path_map.back();
  if (!waypoint_map_ || !is_ahead(path_map, *waypoint_map_, p_map)) {
    const auto far = std::ranges::find_if(path_map, [&](const Eigen::Vector2d& p) {
      return (p - p_map).norm() >= tolerance_m_ + kMinAheadM;
    });
    // Later points may be near again, behind a wall.
    const auto after =
        std::find_if(path_map.rbegin(), std::make_reverse_iterator(far), [&](const auto& p) {
          return is_line_passable(grid, p_map, p);
        }).base();
    const Eigen::Vector2d next_map = after == path_map.begin() ? last : *std::prev(after);
    const bool is_kept = waypoint_map_ && next_map != last &&
                         (*waypoint_map_ - p_map).norm() > tolerance_m_ + kReachedM &&
                         (*waypoint_map_ - next_map).norm() < kSameWaypointM;
    waypoint_map_ = is_kept ? *waypoint_map_ : next_map;
  }
  return {*waypoint_map_, *waypoint_map_ == last ? last_tolerance_m : tolerance_m_};
}

}  // namespace nodmap::explorer
