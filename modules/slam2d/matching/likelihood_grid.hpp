// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace nodmap::slam2d {

/// The likelihood of measuring a point in each cell of a map and, for w = 1, 2, 4 and 8, its
/// maximum over the window of w x w cells that begins at each cell: the upper bounds of a
/// branch-and-bound search (Hess et al. 2016, section V-B).
class LikelihoodGrid {
 public:
  /// The widest window has 2^(kLevels - 1) cells along each side. Wider ones contain a wall almost
  /// everywhere, and so exclude nothing.
  static constexpr int kLevels = 4;
  static constexpr int kTopLevel = kLevels - 1;
  static constexpr int kTopCells = 1 << kTopLevel;

  /// `points`: of walls and objects, in metres in the frame of the map. Points that are not finite,
  /// or farther than `max_range_m` from the mean of all, are left out.
  LikelihoodGrid(std::span<const Eigen::Vector2d> points, double cell_size_m, double max_range_m);
  /// The same for a map in which the robot can only be in the cells of the places `allowed`. All
  /// points and places must be finite.
  LikelihoodGrid(std::span<const Eigen::Vector2d> points, double cell_size_m,
                 std::span<const Eigen::Vector2d> allowed);

  [[nodiscard]] double cell_size_m() const { return cell_size_m_; }
  /// The cell that a point lies in, counted from the first cell of the grid.
  [[nodiscard]] Eigen::Vector2i cell_of(const Eigen::Vector2d& p) const;
  /// The largest likelihood, 0..255, in the window of 2^level cells that begins at a cell.
  [[nodiscard]] int largest(int level, int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < width_ && y < height_;
    return inside ? levels_[static_cast<std::size_t>(level)]
                           [static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(x)]
                  : 0;
  }
  /// The sums of largest() over `cells` for the four quarters, of 2^level cells, of windows twice
  /// as wide. The cells are shifted by (x, y), (x, y + 2^level), (x + 2^level, y) and (x + 2^level,
  /// y + 2^level). As soon as no sum can reach `min_sum`, returns some values below it.
  using Quarters = std::array<int, 4>;
  [[nodiscard]] Quarters sums_of_quarters(int level, std::span<const Eigen::Vector2i> cells, int x,
                                          int y, int min_sum) const;

  /// Cells for top_bounds(), with the place of each in the table that it reads.
  struct TopCell {
    int column = 0;
    int row = 0;
    std::ptrdiff_t offset = 0;
  };
  /// `cells`, all shifted by (x, y).
  [[nodiscard]] std::vector<TopCell> top_cells(std::span<const Eigen::Vector2i> cells, int x,
                                               int y) const;
  /// Upper bounds of the sum of largest() at the top level over `cells`, shifted by `column` and
  /// `row` windows of the top level, and for kRowChunk shifts at once: each next one is a column
  /// farther. That takes a tenth of the time.
  using RowChunk = std::array<std::uint16_t, 16>;
  static constexpr int kRowChunk = 16;
  [[nodiscard]] RowChunk top_bounds(std::span<const TopCell> cells, int column, int row) const;

  /// Whether a place is allowed in the window of 2^level cells that begins at a cell.
  [[nodiscard]] bool is_allowed(int level, int x, int y) const {
    return allowed_.empty() || is_set(allowed_[static_cast<std::size_t>(level)], x, y);
  }

 private:
  using Level = std::vector<std::uint8_t>;  // row by row, x fastest

  [[nodiscard]] bool is_set(const Level& level, int x, int y) const {
    return x >= 0 && y >= 0 && x < width_ && y < height_ &&
           level[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                 static_cast<std::size_t>(x)] != 0;
  }
  void draw(std::span<const Eigen::Vector2d> points, const Eigen::AlignedBox2d& box);
  void set_allowed(std::span<const Eigen::Vector2d> places);
  void stamp(const Eigen::Vector2d& p);
  void add_top_table();
  [[nodiscard]] TopCell top_cell(int x, int y) const;
  void add_windows(std::vector<Level>& levels) const;

  double cell_size_m_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int width_ = 0;
  int height_ = 0;
  std::vector<Level> levels_;
  /// The top level in 16 steps, rounded up. Shifts by whole windows stay in one of kTopCells x
  /// kTopCells tables, each of every kTopCells-th cell in x and in y: row by row, with zeros before
  /// and after each row.
  Level top_table_;
  int top_width_ = 0;
  int top_height_ = 0;
  std::vector<Level> allowed_;  // empty: everywhere
};

}  // namespace nodmap::slam2d
