// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/geometry/angle.hpp"
#include "common/geometry/whole_steps.hpp"
#include "common/node/messages.hpp"

namespace nodmap::navigator {
namespace {

// Length of the arc that is shown.
constexpr double kArcS = 1.6;
constexpr int kArcSteps = 8;

void add_arc(nodmap::path_t& message, geometry::SE2 T_odom_ahead, const Decision& decision) {
  for (int step = 0; step <= kArcSteps; ++step) {
    message.arc_x_m.push_back(T_odom_ahead.x);
    message.arc_y_m.push_back(T_odom_ahead.y);
    const double dt_s = kArcS / kArcSteps;
    const double half_rotation_rad = 0.5 * dt_s * decision.yaw_rate_rad_s;
    const double length_m = dt_s * decision.forward_mps;
    T_odom_ahead = T_odom_ahead * geometry::SE2{length_m * std::cos(half_rotation_rad),
                                                length_m * std::sin(half_rotation_rad),
                                                2.0 * half_rotation_rad};
  }
}

void add_track(nodmap::tracks_t& message, const Person& person, std::int8_t state) {
  message.track_id.push_back(person.track_id);
  message.position_m.push_back({person.position.x(), person.position.y()});
  message.velocity_mps.push_back({person.velocity.x(), person.velocity.y()});
  message.radius_m.push_back(person.radius_m);
  message.position_sigma_m.push_back(person.position_sigma_m);
  message.velocity_sigma_mps.push_back(person.velocity_sigma_mps);
  message.state.push_back(state);
  ++message.num_tracks;
}

std::int8_t kind_of(const LocalMap& local_map, const LocalCell& cell) {
  if (cell.is_hole()) {
    return nodmap::local_map_t::HOLE;
  }
  if (local_map.is_blocked(cell)) {
    return nodmap::local_map_t::OBSTACLE;
  }
  return cell.is_floor ? nodmap::local_map_t::FLOOR : nodmap::local_map_t::NOT_SEEN;
}

}  // namespace

bool is_plausible(const nodmap::goal_t& message) {
  const auto is_tolerance = [](double value) { return value > 0.0 && value <= node::kFarthestM; };
  const bool is_place = std::abs(message.position_m[0]) <= node::kFarthestM &&
                        std::abs(message.position_m[1]) <= node::kFarthestM &&
                        is_tolerance(message.tolerance_m);
  const bool is_heading = message.has_heading == 0 || (std::isfinite(message.heading_rad) &&
                                                       is_tolerance(message.heading_tolerance_rad));
  return message.is_active == 0 || (is_place && is_heading);
}

bool is_plausible(const nodmap::pitch_command_t& message) {
  const bool is_sweep = std::isfinite(message.pitch_min_rad) &&
                        std::isfinite(message.pitch_max_rad) &&
                        message.pitch_min_rad <= message.pitch_max_rad && message.sweep_s > 0.0;
  return is_sweep && time::is_plausible(node::stamp_of(message)) &&
         std::isfinite(message.max_forward_mps) && message.max_forward_mps >= 0.0;
}

std::optional<GoalInMap> read_goal(const nodmap::goal_t& message) {
  if (message.is_active == 0) {
    return std::nullopt;
  }
  GoalInMap goal;
  goal.T_map_goal = {message.position_m[0], message.position_m[1], 0.0};
  goal.tolerance_m = message.tolerance_m;
  goal.utime = message.utime;
  if (message.has_heading != 0) {
    goal.T_map_goal.yaw = geometry::normalize_angle(message.heading_rad);
    goal.heading_tolerance_rad = message.heading_tolerance_rad;
  }
  return goal;
}

double position_sigma_m(const nodmap::pose_t& message) {
  const double xx = message.covariance[0][0];
  const double xy = 0.5 * (message.covariance[0][1] + message.covariance[1][0]);
  const double yy = message.covariance[1][1];
  const double largest = 0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy);
  return largest > 0.0 && std::isfinite(largest) ? std::sqrt(largest)
                                                 : std::numeric_limits<double>::infinity();
}

std::int8_t code_of(Behaviour behaviour) {
  switch (behaviour) {
    case Behaviour::kSteer:
      return nodmap::navigation_t::STEER;
    case Behaviour::kBrake:
      return nodmap::navigation_t::BRAKE;
    case Behaviour::kTurn:
      return nodmap::navigation_t::TURN;
    case Behaviour::kArrived:
      return nodmap::navigation_t::ARRIVED;
    case Behaviour::kHalt:
      break;
  }
  return nodmap::navigation_t::HALT;
}

nodmap::path_t path_message(const std::vector<Eigen::Vector2d>& path_map,
                            const geometry::SE2& T_odom_map, const geometry::SE2& T_odom_base,
                            const Decision& decision) {
  nodmap::path_t message{};
  message.state = path_map.empty() ? nodmap::path_t::NO_PATH : nodmap::path_t::PLANNED;
  for (const Eigen::Vector2d& p_map : path_map) {
    const Eigen::Vector2d p_odom = T_odom_map * p_map;
    message.x_m.push_back(p_odom.x());
    message.y_m.push_back(p_odom.y());
  }
  add_arc(message, T_odom_base, decision);
  message.num_points = static_cast<std::int32_t>(message.x_m.size());
  message.num_arc_points = static_cast<std::int32_t>(message.arc_x_m.size());
  return message;
}

nodmap::tracks_t tracks_message(const People& people, const People& newcomers) {
  nodmap::tracks_t message{};
  for (const Person& person : people) {
    add_track(message, person,
              person.is_in_sight ? nodmap::tracks_t::WALKS : nodmap::tracks_t::OUT_OF_SIGHT);
  }
  for (const Person& person : newcomers) {
    add_track(message, person, nodmap::tracks_t::NEW);
  }
  return message;
}

nodmap::local_map_t local_map_message(const LocalMap& local_map, const Eigen::Vector2d& p_odom,
                                      double half_size_m) {
  constexpr int kPerCell = 2;
  const LocalGrid& grid = local_map.grid();
  const double cell_size_m = kPerCell * grid.cell_size_m();
  const int size = 2 * geometry::whole_steps(half_size_m, cell_size_m);
  // A multiple of kPerCell: a cell of the message is the same ground in the next one.
  const Eigen::Vector2i middle = grid.index_of(p_odom);
  const Eigen::Vector2i first = Eigen::Vector2i(middle.x() & -kPerCell, middle.y() & -kPerCell) -
                                Eigen::Vector2i::Constant(kPerCell * size / 2);
  const Eigen::Vector2d corner_odom = grid.cell_size_m() * first.cast<double>();
  nodmap::local_map_t message{};
  message.cell_size_m = cell_size_m;
  message.origin_m[0] = corner_odom.x();
  message.origin_m[1] = corner_odom.y();
  message.width = size;
  message.height = size;
  message.num_cells = size * size;
  message.cells.assign(static_cast<std::size_t>(message.num_cells), nodmap::local_map_t::NOT_SEEN);
  const Eigen::Vector2i end = grid.first() + Eigen::Vector2i::Constant(grid.size());
  const Eigen::Vector2i from = first.cwiseMax(grid.first());
  const Eigen::Vector2i to = (first + Eigen::Vector2i::Constant(kPerCell * size)).cwiseMin(end);
  for (int y = from.y(); y < to.y(); ++y) {
    for (int x = from.x(); x < to.x(); ++x) {
      const int place = (y - first.y()) / kPerCell * size + (x - first.x()) / kPerCell;
      std::int8_t& kind = message.cells[static_cast<std::size_t>(place)];
      kind = std::max(kind, kind_of(local_map, grid.at({x, y})));
    }
  }
  return message;
}

// A raw reading tells a range finder with nothing in its measuring range from one that is silent.
Proximity::Ranges ranges_of(const nodmap::base_sensors_t& message) {
  Proximity::Ranges ranges_m;
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    const bool measures_nothing = std::isnan(message.infrared_m[i]) && message.infrared_raw[i] >= 0;
    ranges_m[i] = measures_nothing ? std::numeric_limits<double>::infinity()
                                   : static_cast<double>(message.infrared_m[i]);
  }
  return ranges_m;
}

}  // namespace nodmap::navigator
