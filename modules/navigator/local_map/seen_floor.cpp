// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/seen_floor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "modules/navigator/local_map/holes.hpp"

namespace nodmap::navigator {
namespace {

// The floor is checked in columns this far apart across the body. It is unknown where this many
// columns are unknown; a single one may just lie between beams.
constexpr double kColumnM = 0.05;
constexpr int kUnknownColumns = 2;
// An obstacle this near beyond the nearest floor that the laser sees hides what is behind it.
constexpr double kHiddenM = 0.05;

// Pose of base after `distance_m` of an arc, negative backwards, in base at its beginning.
geometry::SE2 along_arc(double curvature, double distance_m) {
  const double yaw_rad = curvature * distance_m;
  return std::abs(curvature) < 1e-3 ? geometry::SE2{distance_m, 0.0, 0.0}
                                    : geometry::SE2{std::sin(yaw_rad) / curvature,
                                                    (1.0 - std::cos(yaw_rad)) / curvature, yaw_rad};
}

}  // namespace

// Floor must follow on floor in each column of the body's front, but for `kUnknownColumns`.
double SeenFloor::distance(const geometry::SE2& T_odom_base, double curvature, double max_m,
                           double max_gap_m, bool ends_at_obstacles) const {
  const double step_m = grid_.cell_size_m();
  const double first_m = std::max(0.0, blind_m_ - body_.half_length_m);
  // Rows nearer than the laser sees floor may hold an obstacle.
  const int num_blind = ends_at_obstacles ? static_cast<int>(first_m / step_m) : 0;
  const int num_rows = static_cast<int>(std::ceil((max_m + max_gap_m) / step_m));
  std::vector<Row> rows;
  double s_m = -step_m * num_blind;
  for (int row = -num_blind; row < num_rows; ++row, s_m += step_m) {
    const geometry::SE2 T_odom_row = T_odom_base * along_arc(curvature, first_m + step_m * row);
    const Eigen::Matrix2d R = T_odom_row.rotation();
    rows.push_back({s_m, T_odom_row.translation() + body_.half_length_m * R.col(0), R.col(1)});
  }
  const auto side = static_cast<int>(std::ceil(body_.half_width_m / kColumnM));
  std::vector<double> seen_m;  // by column
  for (int column = -side; column <= side; ++column) {
    const double left_m = body_.half_width_m * column / side;
    seen_m.push_back(distance_in_column(rows, left_m, max_gap_m, ends_at_obstacles));
  }
  std::ranges::nth_element(seen_m, seen_m.begin() + kUnknownColumns - 1);
  return std::min(seen_m[kUnknownColumns - 1], max_m);
}

// How far floor follows on floor in a column that is `left_m` beside the middle of the front;
// infinite if an obstacle hides what follows.
double SeenFloor::distance_in_column(const std::vector<Row>& rows, double left_m, double max_gap_m,
                                     bool ends_at_obstacles) const {
  double seen_m = 0.0;
  for (const Row& row : rows) {
    const LocalCell* cell = grid_.find(row.middle_odom + left_m * row.left_odom);
    if (ends_at_obstacles && row.s_m < kHiddenM && cell != nullptr &&
        obstacles_.is_remembered(*cell)) {
      return std::numeric_limits<double>::infinity();
    }
    if (row.s_m < 0.0) {
      continue;
    }
    if (cell != nullptr && cell->is_floor) {
      seen_m = row.s_m;
    } else if (row.s_m - seen_m > max_gap_m) {
      break;
    }
  }
  return seen_m;
}

double SeenFloor::distance_backwards(const geometry::SE2& T_odom_base, double curvature,
                                     double max_m) const {
  const double step_m = grid_.cell_size_m();
  for (double s = step_m; s < max_m; s += step_m) {
    const geometry::SE2 T_base_rear{-body_.half_length_m, 0.0, 0.0};
    if (!is_row_seen(T_odom_base * along_arc(curvature, -s) * T_base_rear)) {
      return s - step_m;
    }
  }
  return max_m;
}

// Whether floor was seen in a row across the body.
bool SeenFloor::is_row_seen(const geometry::SE2& T_odom_row) const {
  const auto columns =
      static_cast<int>(std::ceil(body_.half_width_m / (2.0 * grid_.cell_size_m())));
  int unknown = 0;
  for (int column = -columns; column <= columns; ++column) {
    const LocalCell* cell =
        grid_.find(T_odom_row * Eigen::Vector2d(0.0, body_.half_width_m * column / columns));
    unknown += cell != nullptr && cell->is_floor && !cell->is_assumed ? 0 : 1;
  }
  return unknown < kUnknownColumns;
}

bool SeenFloor::is_near(const Eigen::Vector2i& index) const {
  const auto is_floor = [&](const Eigen::Vector2i& at) {
    return grid_.contains(at) && grid_.at(at).is_floor;
  };
  return is_floor(index) || std::ranges::any_of(kAcrossEdge, [&](const Eigen::Vector2i& step) {
           return is_floor(index + step);
         });
}

bool SeenFloor::is_around(const Eigen::Vector2d& p_odom) const {
  constexpr int kEnoughOfNine = 8;
  int num_floor = 0;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const LocalCell* cell = grid_.find(p_odom + grid_.cell_size_m() * Eigen::Vector2d(dx, dy));
      num_floor += cell != nullptr && cell->is_floor && !cell->is_assumed ? 1 : 0;
    }
  }
  return num_floor >= kEnoughOfNine;
}

}  // namespace nodmap::navigator
