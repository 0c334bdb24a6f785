// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/ever_free.hpp"

#include <algorithm>
#include <cmath>

#include "modules/navigator/travel.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kCellM = 0.1;
constexpr double kLayerM = 0.1;
constexpr std::uint8_t kMaxFree = 12;
// A layer is free after this many scans with a pass. At 3 m a sweep has about one line in each
// layer.
constexpr std::uint8_t kEnough = 2;
// A held laser knows space to be free for this long after it has seen it. After that, and when the
// robot has travelled so far, something else may have its place in odom there: a cell, 10 cm, is 3
// degrees at 2 m, or 3 % of 3 m. In a second even somebody who walks at 0.4 m/s comes to where he
// had hidden nothing.
constexpr double kKnownForM = 2.0;
constexpr time::Duration kKnownFor = 1s;

}  // namespace

EverFree::EverFree(double range_m)
    : grid_(kCellM, static_cast<int>(std::ceil(std::log2(2.0 * range_m / kCellM + 1.0)))) {}

int EverFree::layer_of(double height_m) {
  return static_cast<int>(std::floor((height_m - kLowestM) / kLayerM)) + 1;
}

void EverFree::begin_scan(time::Timestamp stamp, const geometry::SE2& T_odom_base) {
  stamp_ = stamp;
  travelled_m_ += scan_ == 0 ? 0.0 : travel_m(T_odom_base_, T_odom_base);
  T_odom_base_ = T_odom_base;
  grid_.center_on(T_odom_base.translation());
  ++scan_;
}

void EverFree::hit(const Eigen::Vector2d& p_odom, double height_m) {
  const int layer = layer_of(height_m);
  const Eigen::Vector2i index = grid_.index_of(p_odom);
  if (layer < 0 || layer >= kLayers || !grid_.contains(index)) {
    return;
  }
  Column& column = grid_.at(index);
  if (column.changed != scan_) {
    std::uint8_t& free = column.free[static_cast<std::size_t>(layer)];
    free = free == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(free - 1);
    column.changed = scan_;
  }
}

void EverFree::pass(const Eigen::Vector2d& from_odom, double from_height_m,
                    const Eigen::Vector2d& to_odom, double to_height_m) {
  const int steps = static_cast<int>((to_odom - from_odom).norm() / kCellM) + 1;
  const Eigen::Vector2d step = (to_odom - from_odom) / steps;
  const double rise_m = (to_height_m - from_height_m) / steps;
  for (int i = 0; i <= steps; ++i) {
    const int layer = layer_of(from_height_m + i * rise_m);
    const Eigen::Vector2i index = grid_.index_of(from_odom + i * step);
    if (layer < 0 || layer >= kLayers || !grid_.contains(index)) {
      continue;
    }
    Column& column = grid_.at(index);
    if (column.changed == scan_) {
      continue;
    }
    std::uint8_t& free = column.free[static_cast<std::size_t>(layer)];
    free = std::min<std::uint8_t>(kMaxFree, static_cast<std::uint8_t>(free + 1));
    column.changed = column.passed = scan_;
    column.passed_at = stamp_;
    column.passed_at_m = static_cast<float>(travelled_m_);
  }
}

bool EverFree::is_free(const Eigen::Vector2i& index, int lowest, int highest) const {
  if (!grid_.contains(index)) {
    return false;
  }
  const Column& column = grid_.at(index);
  return std::all_of(column.free.begin() + lowest, column.free.begin() + highest + 1,
                     [](std::uint8_t free) { return free >= kEnough; });
}

bool EverFree::was_in_view(const Eigen::Vector2i& index) const {
  const Column& column = grid_.at(index);
  // abs(): a stamp that stepped back must not make a place known for ever.
  return std::chrono::abs(stamp_ - column.passed_at) < kKnownFor ||
         travelled_m_ - static_cast<double>(column.passed_at_m) < kKnownForM;
}

bool EverFree::is_free(const Eigen::Vector2d& p_odom, double height_m, bool laser_is_held) const {
  const int layer = std::clamp(layer_of(height_m), 1, kLayers - 2);
  const int beside = laser_is_held ? 0 : 1;
  const Eigen::Vector2i middle = grid_.index_of(p_odom);
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const Eigen::Vector2i index = middle + Eigen::Vector2i(dx, dy);
      if (!is_free(index, layer - beside, layer + beside) ||
          (laser_is_held && !was_in_view(index))) {
        return false;
      }
    }
  }
  return true;
}

bool EverFree::is_passed_now(const Eigen::Vector2d& p_odom) const {
  const Eigen::Vector2i index = grid_.index_of(p_odom);
  return grid_.contains(index) && grid_.at(index).passed == scan_;
}

}  // namespace nodmap::navigator
