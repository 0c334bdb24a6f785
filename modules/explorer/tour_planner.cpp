// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/tour_planner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angle.hpp"
#include "modules/explorer/tour.hpp"

namespace nodmap::explorer {
namespace {

// Greatest distance of a lookout from its frontier: from farther away only a slit is visible
// through a door.
constexpr double kLookoutM = 2.0;
// The same for nearest_frontier, which drives to the frontier itself.
constexpr double kAtFrontierM = 0.4;
// Cost of rotating to the start of the path, in metres of driving.
constexpr double kRotationMPerRad = 0.5;
// Distance at which a path's direction is measured.
constexpr double kDirectionM = 0.4;

// The lengths of the paths; straight lines replace unknown paths.
std::vector<double> lengths_m(const Reach& reach, const Eigen::Vector2d& from_map,
                              const std::vector<Cell>& cells) {
  std::vector<double> lengths;
  lengths.reserve(cells.size());
  for (const Cell& cell : cells) {
    lengths.push_back(reach.paths.is_reached(cell)
                          ? reach.paths.length_m(cell)
                          : (reach.grid.center_of(cell) - from_map).norm());
  }
  return lengths;
}

// How far the robot must rotate to drive along the path to a viewpoint.
double rotation_rad(const Reach& reach, const Viewpoint& viewpoint,
                    const geometry::SE2& T_map_base) {
  const std::vector<Eigen::Vector2d> path_map = reach.path_to(viewpoint.cell);
  const auto ahead = std::ranges::find_if(path_map, [&](const Eigen::Vector2d& p) {
    return (p - T_map_base.translation()).norm() > kDirectionM;
  });
  const Eigen::Vector2d to =
      (ahead == path_map.end() ? viewpoint.p_map : *ahead) - T_map_base.translation();
  return std::abs(geometry::angle_difference(std::atan2(to.y(), to.x()), T_map_base.yaw));
}

// The index of the viewpoint that the robot drives to now, if it is among them.
std::optional<std::size_t> present_target(const TourRequest& request,
                                          const std::vector<Viewpoint>& viewpoints) {
  if (!request.target_map) {
    return std::nullopt;
  }
  const auto from_target_m = [&](const Viewpoint& viewpoint) {
    return (viewpoint.p_map - *request.target_map).norm();
  };
  const auto nearest = std::ranges::min_element(viewpoints, {}, from_target_m);
  if (nearest == viewpoints.end() || from_target_m(*nearest) >= kSameViewpointM) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(nearest - viewpoints.begin());
}

}  // namespace

TourPlanner::TourPlanner(const ExplorerParams& params) : params_(params), chooser_(params) {}

std::vector<Viewpoint> TourPlanner::plan(const Reach& reach, const TourRequest& request) {
  frontiers_.find(reach);
  const bool by_tour = params_.policy == Policy::kTour;
  std::vector<Cell> lookouts = frontiers_.lookouts(reach, by_tour ? kLookoutM : kAtFrontierM);
  const Eigen::Vector2d p_robot_map = request.T_map_base.translation();
  std::erase_if(lookouts, [&](const Cell& cell) {
    const Eigen::Vector2d p_map = reach.grid.center_of(cell);
    return (p_map - p_robot_map).norm() < params_.goal_tolerance_m ||
           (request.is_left_out && request.is_left_out(p_map));
  });
  std::vector<Viewpoint> found = by_tour ? chooser_.choose(reach, lookouts, request.T_map_base.yaw)
                                         : nearest_frontier(reach, request, lookouts);
  std::erase_if(found, [&](const Viewpoint& v) { return v.gain_m2 < request.min_gain_m2; });
  return by_tour && !found.empty() ? in_order(reach, request, found) : found;
}

// The nearest viewpoint. The previous one is kept until the robot is there, or until nothing is
// left to see from it.
std::vector<Viewpoint> TourPlanner::nearest_frontier(const Reach& reach, const TourRequest& request,
                                                     const std::vector<Cell>& lookouts) {
  const Eigen::Vector2d p_map = request.T_map_base.translation();
  const std::optional<Eigen::Vector2d>& target_map = request.target_map;
  if (target_map && (p_map - *target_map).norm() > params_.goal_tolerance_m &&
      reach.paths.is_reached(reach.grid.cell_of(*target_map))) {
    if (const auto same = chooser_.nearest(reach, {reach.grid.cell_of(*target_map)})) {
      return {*same};
    }
  }
  const auto nearest = chooser_.nearest(reach, lookouts);
  return nearest ? std::vector<Viewpoint>{*nearest} : std::vector<Viewpoint>{};
}

// Orders the viewpoints in the best tour; it starts with the present target unless another tour is
// clearly better.
std::vector<Viewpoint> TourPlanner::in_order(const Reach& reach, const TourRequest& request,
                                             const std::vector<Viewpoint>& viewpoints) {
  TourProblem problem;
  problem.length_weight = params_.tour.home_weight_m2;
  std::vector<Cell> cells;
  for (const Viewpoint& viewpoint : viewpoints) {
    cells.push_back(viewpoint.cell);
    problem.weight.push_back(viewpoint.gain_m2);
    problem.from_start_m.push_back(
        viewpoint.length_m + kRotationMPerRad * rotation_rad(reach, viewpoint, request.T_map_base));
  }
  for (const Viewpoint& viewpoint : viewpoints) {
    paths_between_.compute(reach.grid, viewpoint.p_map, cells);
    problem.between_m.push_back(lengths_m({reach.grid, paths_between_}, viewpoint.p_map, cells));
  }
  paths_between_.compute(reach.grid, request.home_map, cells);
  problem.to_end_m = lengths_m({reach.grid, paths_between_}, request.home_map, cells);
  problem.from_start_to_end_m =
      lengths_m(reach, request.T_map_base.translation(), {reach.grid.cell_of(request.home_map)})
          .front();
  Tour tour = shortest_tour(problem);
  const std::optional<std::size_t> present = present_target(request, viewpoints);
  if (present && tour.order.front() != *present) {
    const Tour same = shortest_tour(problem, present);
    if (same.cost < (1.0 + params_.tour.hysteresis_ratio) * tour.cost) {
      tour = same;
    }
  }
  leave_out_detours(problem, params_.tour.min_gain_m2_per_m, params_.tour.always_gain_m2,
                    tour.order);
  std::vector<Viewpoint> ordered;
  ordered.reserve(tour.order.size());
  for (const std::size_t stop : tour.order) {
    ordered.push_back(viewpoints[stop]);
  }
  return ordered;
}

}  // namespace nodmap::explorer
