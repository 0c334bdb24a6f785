// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace nodmap::slam2d {

/// Walks along a ray from cell to cell of a grid (Amanatides and Woo 1987). Each step crosses one
/// grid line.
///
/// Coordinates along the ray are integers, 2^16 to a cell, so that the walk is exact and ends in
/// the right cell. They are odd: no ray lies on a grid line.
class RayWalk {
 public:
  /// Takes both ends in cells, with coordinates of less than 10^9.
  RayWalk(const Eigen::Vector2d& from_cells, const Eigen::Vector2d& to_cells)
      : RayWalk(Axis(from_cells.x(), to_cells.x()), Axis(from_cells.y(), to_cells.y())) {}

  [[nodiscard]] const Eigen::Vector2i& first_cell() const { return first_cell_; }
  [[nodiscard]] const Eigen::Vector2i& last_cell() const { return last_cell_; }
  /// The direction of the walk along each axis, -1 or 1.
  [[nodiscard]] const Eigen::Vector2i& direction() const { return direction_; }

  /// How many grid lines across x and across y the ray has crossed when it has first crossed
  /// `lines.x()` across x or `lines.y()` across y, however long it is. Both must be at least 1 and,
  /// as in any grid of 64 million cells, so few that their products with the length of the ray fit
  /// into 64 bits.
  [[nodiscard]] Eigen::Vector2i crossings_until(const Eigen::Vector2i& lines) const {
    // How many lines across y come before the last of those across x.
    const std::int64_t before_last_x = next_ + (lines.x() - 1) * per_x_;
    if (before_last_x < 0) {
      return {lines.x(), 0};
    }
    if (per_y_ > 0 && before_last_x / per_y_ + 1 < lines.y()) {
      return {lines.x(), static_cast<int>(before_last_x / per_y_) + 1};
    }
    // And how many across x before the last of those across y.
    const std::int64_t before_last_y = (lines.y() - 1) * per_y_ - next_;
    return {before_last_y <= 0 ? 0 : static_cast<int>((before_last_y - 1) / per_x_) + 1, lines.y()};
  }

  /// Takes `steps` steps. Calls `visit` with the index of each cell that it leaves. `place`: the
  /// index of the present cell in memory; `row`: the length of a row there. The rows must contain
  /// all cells.
  template <typename Visit>
  void advance(int steps, std::ptrdiff_t place, std::ptrdiff_t row, Visit visit) {
    const std::ptrdiff_t step_y = direction_.y() * row;
    const std::ptrdiff_t x_not_y = direction_.x() - step_y;
    for (; steps > 0; --steps) {
      visit(static_cast<std::size_t>(place));
      // Branch-free, because the branch would be unpredictable: all bits are set if the next line
      // is one across x, none otherwise.
      const std::int64_t along_x = next_ >> 63;
      place += step_y + (along_x & x_not_y);
      next_ += (along_x & (per_x_ + per_y_)) - per_y_;
    }
  }

 private:
  static constexpr std::int64_t kCellUnits = 1 << 16;

  static std::int64_t to_units(double cells) {
    const double pairs = 0.5 * kCellUnits * cells;
    const auto truncated = static_cast<std::int64_t>(pairs);  // std::floor is a call
    return 2 * (truncated - (static_cast<double>(truncated) > pairs ? 1 : 0)) + 1;
  }
  static int cell_of(std::int64_t units) { return static_cast<int>(units >> 16); }

  struct Axis {
    int first_cell;
    int last_cell;
    int direction;
    std::int64_t length;  // of the ray, units
    std::int64_t first;   // from its origin to the first grid line in its direction, units

    Axis(double from_cells, double to_cells) : Axis(to_units(from_cells), to_units(to_cells)) {}
    Axis(std::int64_t from, std::int64_t to)
        : first_cell(cell_of(from)),
          last_cell(cell_of(to)),
          direction(to > from ? 1 : -1),
          length(std::abs(to - from)),
          first(direction > 0 ? kCellUnits - (from & (kCellUnits - 1)) : from & (kCellUnits - 1)) {}
  };

  RayWalk(const Axis& x, const Axis& y)
      : first_cell_(x.first_cell, y.first_cell),
        last_cell_(x.last_cell, y.last_cell),
        direction_(x.direction, y.direction),
        per_x_(kCellUnits * y.length),
        per_y_(kCellUnits * x.length),
        next_(x.first * y.length - y.first * x.length) {}

  Eigen::Vector2i first_cell_;
  Eigen::Vector2i last_cell_;
  Eigen::Vector2i direction_;
  // The places where the ray crosses the next line across x and across y, scaled by the lengths
  // along both axes to avoid divisions: how much each changes with a crossing, and their
  // difference, negative when the line across x comes first.
  std::int64_t per_x_;
  std::int64_t per_y_;
  std::int64_t next_;
};

}  // namespace nodmap::slam2d
