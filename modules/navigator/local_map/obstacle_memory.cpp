// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/obstacle_memory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/whole_steps.hpp"
#include "modules/navigator/travel.hpp"

namespace nodmap::navigator {
namespace {

// Within this distance of base an obstacle ages by one decimetre per this many decimetres of
// travel.
constexpr double kNearM = 0.5;
constexpr int kNearFactor = 5;
// The last part of a beam passes nothing, because of the range's noise and the size of a cell.
constexpr double kBeforeEndM = 0.03;
// The stamps of cells are 16 bits of decimetres.
constexpr double kLongestTravelM = 6553.6;
// The times of hits are 16 bits of this. They wrap around after 1.8 hours: then what was never hit
// in between counts for three seconds as something that has just come.
constexpr time::Duration kTimeStep = 100ms;
// Somebody who walks has not been in one place for as long as this. At 0.5 m/s a body of 0.5 m is
// there for 1 s, and its wake (people/wake.hpp) for 1 s more.
constexpr time::Duration kLongestWalk = 3s;
// What is hit again within this time is the same thing. Of a thin post, beams that pass beside it
// take the evidence away, and it may be several sweeps until one hits it again.
constexpr time::Duration kAgain = 4s;

}  // namespace

void ObstacleMemory::begin_scan(time::Timestamp stamp) {
  now_ds_ = static_cast<std::uint16_t>(stamp.time_since_epoch() / kTimeStep);
}

void ObstacleMemory::move(const geometry::SE2& from, const geometry::SE2& to) {
  travel_m_ = std::fmod(travel_m_ + travel_m(from, to), kLongestTravelM);
}

std::uint16_t ObstacleMemory::travel_dm() const {
  return static_cast<std::uint16_t>(std::lround(10.0 * travel_m_));
}

bool ObstacleMemory::is_forgotten(const LocalCell& cell) const {
  return 0.1 * static_cast<std::uint16_t>(travel_dm() - cell.seen_at_dm) > forget_after_m_;
}

void ObstacleMemory::keep_near(LocalGrid& grid, const Eigen::Vector2d& p_odom) {
  const std::uint16_t now_dm = travel_dm();
  const int travelled_dm = static_cast<std::uint16_t>(now_dm - kept_near_at_dm_);
  if (travelled_dm < kNearFactor) {
    return;
  }
  kept_near_at_dm_ = now_dm;
  keep_forgotten(grid);
  const int younger_dm = travelled_dm - travelled_dm / kNearFactor;
  const int reach = geometry::whole_steps(kNearM, grid.cell_size_m());
  const Eigen::Vector2i middle = grid.index_of(p_odom);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      LocalCell& cell = grid.at(middle + Eigen::Vector2i(dx, dy));
      if (dx * dx + dy * dy < reach * reach && is_remembered(cell)) {
        const int age_dm = static_cast<std::uint16_t>(now_dm - cell.seen_at_dm);
        cell.seen_at_dm =
            static_cast<std::uint16_t>(cell.seen_at_dm + std::min(younger_dm, age_dm));
      }
    }
  }
}

// Once a kilometre, whatever is older than 3 km becomes 3 km old. So nothing is older than 4 km,
// and no stamp comes to be young again after 6.5 km.
void ObstacleMemory::keep_forgotten(LocalGrid& grid) {
  constexpr int kEveryDm = 10'000;
  constexpr int kOldestDm = 30'000;
  const std::uint16_t now_dm = travel_dm();
  if (static_cast<std::uint16_t>(now_dm - kept_forgotten_at_dm_) < kEveryDm) {
    return;
  }
  kept_forgotten_at_dm_ = now_dm;
  for (int row = 0; row < grid.size(); ++row) {
    for (int column = 0; column < grid.size(); ++column) {
      LocalCell& cell = grid.at_offset(column, row);
      if (static_cast<std::uint16_t>(now_dm - cell.seen_at_dm) > kOldestDm) {
        cell.seen_at_dm = static_cast<std::uint16_t>(now_dm - kOldestDm);
      }
    }
  }
}

void ObstacleMemory::add_hit(LocalGrid& grid, const Eigen::Vector3d& p_odom, bool is_certain,
                             std::uint16_t scan) const {
  LocalCell* cell = grid.find(p_odom.head<2>());
  if (cell == nullptr) {
    return;
  }
  if (!is_remembered(*cell) && since(cell->hit_at_ds) > kAgain) {
    cell->hit_since_ds = now_ds_;
  }
  const std::int16_t height_cm = to_centimetres(p_odom.z());
  if (cell->obstacle == 0 || is_forgotten(*cell)) {
    cell->obstacle = 0;
    cell->low_cm = cell->high_cm = height_cm;
  }
  if (is_certain || cell->scan != scan) {
    cell->obstacle = evidence::more(cell->obstacle, is_certain);
  }
  cell->low_cm = std::min(cell->low_cm, height_cm);
  cell->high_cm = std::max(cell->high_cm, height_cm);
  cell->scan = scan;
  cell->seen_at_dm = travel_dm();
  cell->hit_at_ds = now_ds_;
}

bool ObstacleMemory::may_be_walker(const LocalCell& cell) const {
  return !cell.is_contact() && since(cell.hit_since_ds) < kLongestWalk;
}

void ObstacleMemory::remove_walker(LocalCell& cell) const {
  constexpr auto kLongAgo = static_cast<std::uint16_t>(kAgain / kTimeStep + 1);
  cell.obstacle = 0;
  cell.hit_at_ds = static_cast<std::uint16_t>(now_ds_ - kLongAgo);
}

time::Duration ObstacleMemory::since(std::uint16_t stamp_ds) const {
  return kTimeStep * static_cast<std::uint16_t>(now_ds_ - stamp_ds);
}

void ObstacleMemory::add_contact(LocalGrid& grid, const geometry::SE2& T_odom_base,
                                 const robot::Footprint& body, bool at_front) const {
  const double x = (at_front ? 1.0 : -1.0) * (body.half_length_m + grid.cell_size_m());
  for (double y = -body.half_width_m; y <= body.half_width_m; y += 0.5 * grid.cell_size_m()) {
    LocalCell* cell = grid.find(T_odom_base * Eigen::Vector2d(x, y));
    if (cell != nullptr) {
      cell->obstacle = evidence::kMost;
      // No beam is between these heights.
      cell->low_cm = std::numeric_limits<std::int16_t>::max();
      cell->high_cm = std::numeric_limits<std::int16_t>::min();
      cell->seen_at_dm = travel_dm();
    }
  }
}

void ObstacleMemory::pass(LocalGrid& grid, const Beam& beam, double until_m, double highest_m,
                          std::uint16_t scan) {
  const double flat = beam.direction.head<2>().norm();
  if (flat < 1e-3) {
    return;
  }
  double end_m = std::min(until_m - kBeforeEndM, kFarthestPassM);
  if (beam.direction.z() > 0.0) {
    end_m = std::min(end_m, (highest_m - beam.origin.z()) / beam.direction.z());
  }
  // In cells from the grid's first one: never negative, so that a cast rounds down. This loop is
  // most of the time that a scan takes.
  const double step_m = grid.cell_size_m() / flat;
  const double cells_per_m = 1.0 / grid.cell_size_m();
  const Eigen::Vector2d step = step_m * cells_per_m * beam.direction.head<2>();
  Eigen::Vector2d place = cells_per_m * beam.origin.head<2>() - grid.first().cast<double>();
  // At a pose so far away that its cells cannot be counted, the sensor is outside of the grid.
  if (!(place.minCoeff() >= 0.0 && place.maxCoeff() < grid.size())) {
    return;
  }
  const double rise_cm = 100.0 * step_m * beam.direction.z();
  double height_cm = 100.0 * beam.origin.z();
  const auto steps = static_cast<int>(end_m / step_m);
  for (int i = 0; i < steps; ++i) {
    place += step;
    height_cm += rise_cm;
    LocalCell& cell = grid.at_offset(static_cast<int>(place.x()), static_cast<int>(place.y()));
    // A level laser hits and passes at one height: that is whole centimetres, rounded down.
    if (cell.obstacle != 0 && cell.scan != scan && height_cm >= cell.low_cm &&
        height_cm < cell.high_cm + 1.0) {
      cell.obstacle = evidence::less(cell.obstacle);
      cell.scan = scan;
    }
  }
}

}  // namespace nodmap::navigator
