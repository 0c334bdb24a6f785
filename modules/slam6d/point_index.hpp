// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace nodmap::slam6d {

/// Finds nearest neighbours in a set of points that grows batch by batch.
///
/// Each batch becomes a kd-tree; neighbouring trees of like size are merged (Bentley and Saxe's
/// logarithmic method), so that a point is rebuilt O(log n) times however long the run.
class PointIndex {
 public:
  struct Neighbour {
    std::size_t index = 0;  ///< place of the point in the order of adding
    double sq_distance_m2 = 0.0;
  };

  PointIndex();
  ~PointIndex();
  PointIndex(PointIndex&&) noexcept;
  PointIndex& operator=(PointIndex&&) noexcept;
  PointIndex(const PointIndex&) = delete;
  PointIndex& operator=(const PointIndex&) = delete;

  void add(std::span<const Eigen::Vector3d> points);

  /// The point nearest to `p` and nearer than `max_distance_m`.
  [[nodiscard]] std::optional<Neighbour> nearest(const Eigen::Vector3d& p,
                                                 double max_distance_m) const;

  /// The `k` nearest points, fewer where there are no more, nearest first.
  [[nodiscard]] std::vector<Neighbour> nearest_k(const Eigen::Vector3d& p, std::size_t k) const;

  [[nodiscard]] std::span<const Eigen::Vector3d> points() const;

 private:
  struct Forest;
  std::unique_ptr<Forest> forest_;
};

}  // namespace nodmap::slam6d
