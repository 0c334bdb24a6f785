// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/known_ground.hpp"

#include <algorithm>
#include <array>

#include "common/geometry/whole_steps.hpp"
#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {
namespace {

// The local map is copied within this distance of the robot.
constexpr double kTakeOverM = 5.5;
// Within this distance it also knows what the body has driven over or touched.
constexpr double kBesideM = 0.6;
// An obstacle that a level laser has measured from no farther than this is in its place. From
// farther away odometry drifts by more than a cell (3 % of the distance) until the robot is there.
constexpr double kCloseM = 1.5;
// It is gone when so many updates in succession, half a second apart, have shown that. The noise of
// ranges occupies cells in front of a surface for a moment, again and again: a plan that believed
// each moment would lead into a narrow gap, out of it, and back.
constexpr std::uint8_t kUntilGone = 4;
// Margin around robot, goal and all known ground, for detours over unknown ground.
constexpr double kAroundM = 3.0;

// What is nearer to a cell than this is beside it: more than half the body's width, so that ground
// that was seen is not blocked from beyond.
constexpr int kNearCells = 4;

// A window has at most so many cells a side: a plan takes two seconds then.
constexpr int kWindowCells = 1024;
// The greatest edge of a cell in the window of all ground, in cells of the grid: so coarse a cell
// is still half as wide as the robot.
constexpr int kCoarsest = 4;
constexpr double kMaxCells = 1'100'000;

PlanWindow window_of(const Eigen::Vector2i& low, const Eigen::Vector2i& high) {
  const Eigen::Vector2i size = high - low + Eigen::Vector2i::Ones();
  return {KnownGround::kCellM * low.cast<double>(), std::max(1, size.x()), std::max(1, size.y())};
}

using Quarters = std::array<Eigen::Vector2d, 4>;

// The offsets from the middle of a cell to those of its quarters, each of which lies in another
// cell of the local map. `cells_R` converts metres in map to cells of the local map.
Quarters quarters_of_cell(const Eigen::Matrix2d& cells_R) {
  constexpr double kAsideM = 0.25 * KnownGround::kCellM;
  return {
      cells_R * Eigen::Vector2d(-kAsideM, -kAsideM), cells_R * Eigen::Vector2d(-kAsideM, kAsideM),
      cells_R * Eigen::Vector2d(kAsideM, -kAsideM), cells_R * Eigen::Vector2d(kAsideM, kAsideM)};
}

// All that is known of the local map's cells in the quarters of a cell.
unsigned bits_around(const LocalView& view, const Eigen::Vector2d& middle,
                     const Quarters& quarters) {
  unsigned bits = 0;
  for (const Eigen::Vector2d& quarter : quarters) {
    bits |= view.at(Eigen::Vector2d(middle + quarter));
  }
  return bits;
}

// How many updates must show that an obstacle at a place is gone. A nodding laser's floor shows it.
std::uint8_t updates_until_gone(const Situation& now, const Eigen::Vector2d& p_base) {
  return now.laser_is_held && p_base.norm() < kCloseM ? kUntilGone : std::uint8_t{0};
}

// Whether all obstacles in the quarters of a cell could be a ramp. The edge of a hole could not.
bool could_be_ramp_around(const LocalMap& local_map, const Eigen::Vector2d& q_odom,
                          const Quarters& quarters, double cells_per_m) {
  bool is_ramp = false;
  for (const Eigen::Vector2d& quarter : quarters) {
    const Eigen::Vector2d p_odom = q_odom + quarter / cells_per_m;
    const LocalCell* cell = local_map.cell_at(p_odom);
    if (cell != nullptr && local_map.is_blocked(*cell)) {
      if (!local_map.could_be_ramp(p_odom)) {
        return false;
      }
      is_ramp = true;
    }
  }
  return is_ramp;
}

// What the local map has shown, except that an obstacle is gone.
bool is_seen(KnownGround::Kind kind) {
  return kind == KnownGround::Kind::kFloor || kind == KnownGround::Kind::kBlocked ||
         kind == KnownGround::Kind::kPossibleRamp;
}

}  // namespace

void KnownGround::forget() {
  if (!is_empty_) {
    grid_.clear();
  }
  is_empty_ = true;
}

// What the local map does not know stays as it was. Two things stay as they were although it knows
// them, because odometry has drifted since they were seen: what is behind the laser, and obstacles
// that the local map has forgotten.
void KnownGround::update(const Situation& now) {
  const geometry::SE2 T_map_base = now.T_map_base();
  const Eigen::Vector2d p_map = T_map_base.translation();
  if (is_empty_) {
    grid_.center_empty_on(p_map);
    known_min_ = known_max_ = p_map;
    is_empty_ = false;
  }
  grid_.center_on(p_map);
  const geometry::SE2 T_odom_map = now.T_map_odom.inverse();
  const geometry::SE2 T_base_map = T_map_base.inverse();
  const Eigen::Matrix2d R_odom_map = T_odom_map.rotation();
  const Eigen::Matrix2d R_base_map = T_base_map.rotation();
  const LocalView view =
      now.local_map->view_around(now.T_odom_base.translation(), kTakeOverM + 2.0 * kCellM);
  const auto quarters = quarters_of_cell(view.cells_per_m() * R_odom_map);
  const int reach = geometry::whole_steps(kTakeOverM, kCellM);
  const Eigen::Vector2i middle = grid_.index_of(p_map);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Eigen::Vector2i index = middle + Eigen::Vector2i(dx, dy);
      if (dx * dx + dy * dy > reach * reach || !grid_.contains(index)) {
        continue;
      }
      const Eigen::Vector2d q_map = grid_.center_of(index);
      const Eigen::Vector2d p_base = R_base_map * q_map + T_base_map.translation();
      if (!is_seen(at(index)) || p_base.x() >= 0.0 || p_base.norm() <= kBesideM) {
        const Eigen::Vector2d q_odom = R_odom_map * q_map + T_odom_map.translation();
        const unsigned bits = bits_around(view, view.in_cells(q_odom), quarters);
        // A laser that is held never finds out.
        const bool could_be_ramp =
            now.needs_seen_floor() && (bits & LocalView::kBlocked) != 0U &&
            at(index) != Kind::kBlocked &&
            could_be_ramp_around(*now.local_map, q_odom, quarters, view.cells_per_m());
        update_cell(index, bits, could_be_ramp, updates_until_gone(now, p_base));
      }
    }
  }
}

// Updates a cell from `bits`, the joined states of the cells of the local map in it. `until_gone`:
// how many updates must show that what is there now is gone.
void KnownGround::update_cell(const Eigen::Vector2i& index, unsigned bits, bool could_be_ramp,
                              std::uint8_t until_gone) {
  Cell& cell = grid_.at(index);
  const bool is_blocked = (bits & LocalView::kBlocked) != 0U;
  const bool is_floor = (bits & LocalView::kFloor) != 0U && (bits & LocalView::kForgotten) == 0U;
  if (is_blocked || is_floor) {
    const Eigen::Vector2d q_map = grid_.center_of(index);
    known_min_ = known_min_.cwiseMin(q_map);
    known_max_ = known_max_.cwiseMax(q_map);
    cell.kind = could_be_ramp ? Kind::kPossibleRamp : is_blocked ? Kind::kBlocked : Kind::kFloor;
    cell.until_gone = is_blocked ? std::max(cell.until_gone, until_gone) : cell.until_gone;
  } else if ((bits & LocalView::kCleared) != 0U && cell.kind == Kind::kBlocked) {
    // A level laser sees no floor, but it does see that an obstacle is not there any more.
    cell.until_gone = static_cast<std::uint8_t>(std::max(0, cell.until_gone - 1));
    cell.kind = cell.until_gone == 0 ? Kind::kCleared : Kind::kBlocked;
  }
}

bool KnownGround::is_seen_near(const Eigen::Vector2i& index) const {
  const Eigen::Array2d p_map = grid_.center_of(index);
  constexpr double kNearM = (kNearCells + 0.5) * kCellM;
  if ((p_map < known_min_.array() - kNearM).any() || (p_map > known_max_.array() + kNearM).any()) {
    return false;  // most of a large map, at little cost
  }
  for (int dy = -kNearCells; dy <= kNearCells; ++dy) {
    for (int dx = -kNearCells; dx <= kNearCells; ++dx) {
      const Eigen::Vector2i near = index + Eigen::Vector2i(dx, dy);
      if (grid_.contains(near) && at(near) != Kind::kUnknown) {
        return true;
      }
    }
  }
  return false;
}

KnownGround::Extent KnownGround::extent(const Eigen::Vector2d& p_map,
                                        const Eigen::Vector2d& goal_map,
                                        const Map2d* map_2d) const {
  const int around = geometry::whole_steps(kAroundM, kCellM);
  const Eigen::Vector2i margin = Eigen::Vector2i::Constant(around);
  Extent all{grid_.index_of(known_min_.cwiseMin(p_map).cwiseMin(goal_map)) - margin,
             grid_.index_of(known_max_.cwiseMax(p_map).cwiseMax(goal_map)) + margin};
  if (map_2d != nullptr && map_2d->extent()) {
    all.low = all.low.cwiseMin(map_2d->extent()->first);
    all.high = all.high.cwiseMax(map_2d->extent()->last);
  }
  return all;
}

KnownGround::Extent KnownGround::around(const Eigen::Vector2d& p_map) const {
  const Eigen::Vector2i low = grid_.index_of(p_map) - Eigen::Vector2i::Constant(kWindowCells / 2);
  return {low, low + Eigen::Vector2i::Constant(kWindowCells - 1)};
}

PlanWindow KnownGround::window_around(const Eigen::Vector2d& p_map, const Eigen::Vector2d& goal_map,
                                      const Map2d* map_2d) const {
  const Extent window = extent(p_map, goal_map, map_2d).within(around(p_map));
  return window_of(window.low, window.high);
}

// As fine as possible: where both plans price the same cells they agree, and the robot does not
// turn back when a place enters or leaves the window. Coarser cells stay in their places while the
// robot drives.
std::optional<PlanWindow> KnownGround::window_of_all(const Eigen::Vector2d& p_map,
                                                     const Eigen::Vector2d& goal_map,
                                                     const Map2d* map_2d) const {
  const Extent all = extent(p_map, goal_map, map_2d);
  if (all == all.within(around(p_map))) {
    return std::nullopt;
  }
  const Eigen::Vector2i border = Eigen::Vector2i::Constant(kCoarsest);
  const Eigen::Vector2i last = grid_.first() + Eigen::Vector2i::Constant(grid_.size() - 1);
  const Extent known = all.within({grid_.first() + border, last - border});
  const Eigen::Array2d size = (known.high - known.low).cast<double>();
  int cells = 1;
  while (cells < kCoarsest && size.prod() > kMaxCells * cells * cells) {
    cells *= 2;
  }
  const auto floor_of = [cells](int index) { return index - (index % cells + cells) % cells; };
  const Eigen::Vector2i low = known.low.unaryExpr(floor_of);
  const Eigen::Vector2i num = (known.high.unaryExpr(floor_of) - low) / cells;
  return PlanWindow{kCellM * low.cast<double>(), num.x() + 1, num.y() + 1, cells * kCellM};
}

PlanWindow KnownGround::window_within(const Eigen::Vector2d& p_map, double half_size_m) const {
  const Eigen::Vector2d half_size = Eigen::Vector2d::Constant(half_size_m);
  return window_of(grid_.index_of(p_map - half_size), grid_.index_of(p_map + half_size));
}

}  // namespace nodmap::navigator
