// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace nodmap::slam2d {

/// 99.9 % of right loops have a chi-squared below this (three degrees of freedom).
inline constexpr double kMaxLoopChiSquared = 16.3;

/// How much larger the covariances of the pose graph are than assumed, at least 1.
///
/// They are right for scans in quick succession in rooms; where scans are far apart or have few
/// points, matches err more. Each new loop tells how far the graph was off, in units of its own
/// covariance; the mean over all loops is the factor. So a graph that has been too certain soon
/// searches farther, and no longer refuses right loops.
class VarianceFactor {
 public:
  /// For a new map.
  VarianceFactor() = default;
  /// As it was saved with a map.
  VarianceFactor(double chi_squared_sum, double num_loops)
      : sum_(chi_squared_sum), num_loops_(num_loops), value_(mean()) {}

  /// `chi_squared`: of a loop, by the assumed covariances of graph and loop.
  void add(double chi_squared) {
    // A wrong loop must not count for more than the most that a right one would.
    sum_ += std::min(chi_squared, kMaxLoopChiSquared * value_);
    ++num_loops_;
    value_ = mean();
  }
  [[nodiscard]] double value() const { return value_; }

  /// What is saved; both include the loops that count from the start.
  [[nodiscard]] double chi_squared_sum() const { return sum_; }
  [[nodiscard]] double num_loops() const { return num_loops_; }

 private:
  [[nodiscard]] double mean() const { return std::max(1.0, sum_ / (kExpected * num_loops_)); }

  static constexpr double kExpected = 3.0;    // the mean of chi-squared, three degrees of freedom
  static constexpr double kFirstLoops = 8.0;  // so many loops as expected count from the start

  double sum_ = kFirstLoops * kExpected;
  double num_loops_ = kFirstLoops;
  double value_ = 1.0;
};

}  // namespace nodmap::slam2d
