// SPDX-License-Identifier: BSD-3-Clause
#include "bench/loop_clique.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>

namespace nodmap::bench {
namespace {

using geometry::SE2;
using registration::PoseEdge2d;

// A relative pose and its covariance in the frame of its first pose: (x, y in m, yaw in rad).
struct Motion {
  SE2 T;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// How the end of a motion moves with its own first part, and with what follows.
Eigen::Matrix3d with_first(const SE2& first, const SE2& then) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  const Eigen::Vector2d offset = first.rotation() * then.translation();
  J(0, 2) = -offset.y();
  J(1, 2) = offset.x();
  return J;
}

Eigen::Matrix3d rotated(const SE2& by) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = by.rotation();
  return R;
}

Motion operator*(const Motion& first, const Motion& then) {
  const Eigen::Matrix3d J = with_first(first.T, then.T);
  const Eigen::Matrix3d R = rotated(first.T);
  return {first.T * then.T,
          J * first.covariance * J.transpose() + R * then.covariance * R.transpose()};
}

Motion inverse(const Motion& motion) {
  const SE2 back = motion.T.inverse();
  // T * back = identity: a motion of T's end moves the end of `back` by the opposite.
  const Eigen::Matrix3d J = -rotated(back) * with_first(motion.T, back).inverse();
  return {back, J * motion.covariance * J.transpose()};
}

Motion motion_of(const PoseEdge2d& edge) {
  return {edge.T_from_to, edge.information.inverse()};
}

// The motion along the steps between any two nodes.
class Steps {
 public:
  explicit Steps(std::span<const PoseEdge2d> steps) : steps_(steps) {}

  [[nodiscard]] Motion between(std::size_t from, std::size_t to) const {
    if (from > to) {
      return inverse(between(to, from));
    }
    Motion motion;
    for (std::size_t k = from; k < to; ++k) {
      motion = motion * motion_of(steps_[k]);
    }
    return motion;
  }

 private:
  std::span<const PoseEdge2d> steps_;
};

bool are_consistent(const PoseEdge2d& a, const PoseEdge2d& b, const Steps& steps,
                    double max_chi_squared) {
  const Motion round = motion_of(a) * steps.between(a.to, b.to) * inverse(motion_of(b)) *
                       steps.between(b.from, a.from);
  const Eigen::Vector3d off(round.T.x, round.T.y, round.T.yaw);
  return off.dot(round.covariance.inverse() * off) < max_chi_squared;
}

using Consistency = std::vector<std::vector<bool>>;

// A clique with `first`, to which the loop that agrees with most of the others is added each time.
std::vector<std::size_t> clique_with(std::size_t first, const Consistency& consistent) {
  std::vector<std::size_t> clique{first};
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < consistent.size(); ++k) {
    if (k != first && consistent[first][k]) {
      open.push_back(k);
    }
  }
  const auto num_agreeing = [&](std::size_t k) {
    return std::count_if(open.begin(), open.end(), [&](std::size_t o) { return consistent[k][o]; });
  };
  while (!open.empty()) {
    const std::size_t best = *std::max_element(
        open.begin(), open.end(),
        [&](std::size_t a, std::size_t b) { return num_agreeing(a) < num_agreeing(b); });
    clique.push_back(best);
    std::erase_if(open, [&](std::size_t k) { return k == best || !consistent[best][k]; });
  }
  return clique;
}

}  // namespace

std::vector<PoseEdge2d> largest_clique(std::span<const PoseEdge2d> steps,
                                       std::span<const PoseEdge2d> loops, double max_chi_squared) {
  const Steps along(steps);
  Consistency consistent(loops.size(), std::vector<bool>(loops.size(), true));
  for (std::size_t a = 0; a < loops.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      consistent[a][b] = consistent[b][a] =
          are_consistent(loops[a], loops[b], along, max_chi_squared);
    }
  }
  std::vector<std::size_t> largest;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    std::vector<std::size_t> clique = clique_with(k, consistent);
    if (clique.size() > largest.size()) {
      largest = std::move(clique);
    }
  }
  std::vector<PoseEdge2d> kept;
  for (const std::size_t k : largest) {
    kept.push_back(loops[k]);
  }
  return kept;
}

}  // namespace nodmap::bench
