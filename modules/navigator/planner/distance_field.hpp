// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

namespace nodmap::navigator {

/// The exact distance from each cell of a grid to the nearest occupied one (Felzenszwalb and
/// Huttenlocher 2012: lower envelopes of parabolas, first along rows, then along columns).
class DistanceField {
 public:
  /// `origin` is the outer corner of cell (0, 0).
  void begin(const Eigen::Vector2d& origin, double cell_size_m, int width, int height);
  /// Ignores places outside the grid.
  void occupy(const Eigen::Vector2d& p);
  void occupy(int column, int row) { squared_[index_of(column, row)] = 0.0F; }
  void compute() {
    while (compute_line()) {
    }
  }
  /// The same in portions: one more row or column. Returns false when it was the last one.
  bool compute_line();

  /// Distance (m) from the middle of the cell of `p` to the middle of the nearest occupied cell;
  /// kFarM if there is none, or if `p` is outside.
  [[nodiscard]] double at(const Eigen::Vector2d& p) const {
    const auto column = static_cast<int>(std::floor((p.x() - origin_.x()) * cells_per_m_));
    const auto row = static_cast<int>(std::floor((p.y() - origin_.y()) * cells_per_m_));
    return column < 0 || row < 0 || column >= width_ || row >= height_
               ? kFarM
               : static_cast<double>(distance_m_[index_of(column, row)]);
  }
  [[nodiscard]] double at(int column, int row) const {
    return static_cast<double>(distance_m_[index_of(column, row)]);
  }

  static constexpr double kFarM = 1e3;

 private:
  [[nodiscard]] std::size_t index_of(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }
  void transform(float* line, int stride, int n);
  void take_root(int row);

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double cell_size_m_ = 1.0;
  double cells_per_m_ = 1.0;
  int width_ = 0;
  int height_ = 0;
  int num_lines_ = 0;           // computed: all rows, all columns, and the rows of distance_m_
  std::vector<float> squared_;  // cells^2
  std::vector<float> distance_m_;
  std::vector<float> values_;   // of the line being transformed
  std::vector<int> vertices_;   // of the parabolas of the lower envelope
  std::vector<float> borders_;  // between them
};

}  // namespace nodmap::navigator
