// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/correlative_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace nodmap::slam2d {
namespace {

constexpr int kStampCells = 2;  // on each side of the one a point lies in
constexpr double kStampSigmaCells = 1.0;
constexpr std::size_t kMaxExpanded = 400'000;  // nodes: bounds the time of a search
// Poses farther apart than this, or rotated more, are two peaks.
constexpr double kPeakDistanceM = 0.6;
constexpr double kPeakRotationRad = 0.15;
constexpr int kTopLevel = LikelihoodGrid::kLevels - 1;
constexpr double kMaxMomentArmM = 15.0;  // points beyond may move by more than a cell

/// The cells of the points of a scan, rotated by one angle, at the middle of the window.
using Cells = std::vector<Eigen::Vector2i>;

/// A square of 2^level poses along each side, all rotated by the same angle.
struct Node {
  int bound = 0;  ///< no pose in it has a larger sum of likelihoods
  std::uint32_t order = 0;
  std::int16_t level = 0;
  std::int16_t rotation = 0;
  std::int16_t x = 0;  ///< cells from the middle of the window
  std::int16_t y = 0;
};

struct IsWorse {
  bool operator()(const Node& a, const Node& b) const {
    return a.bound != b.bound ? a.bound < b.bound : a.order > b.order;
  }
};

int sum_of_largest(const LikelihoodGrid& grid, const Cells& cells, int level, int x, int y) {
  int sum = 0;
  for (const Eigen::Vector2i& cell : cells) {
    sum += grid.largest(level, cell.x() + x, cell.y() + y);
  }
  return sum;
}

/// One search: the queue of the nodes, the largest bound first, so that the first single pose that
/// comes out is the best of all.
class Search {
 public:
  Search(const LikelihoodGrid& grid, std::span<const Eigen::Vector2d> points_base,
         const SearchWindow& window)
      : grid_(grid), points_(points_base), window_(window) {
    rotation_step_rad_ = CorrelativeMatcher::rotation_step_rad(points_base, grid.cell_size_m());
    rotations_ = static_cast<int>(std::ceil(window.rotation_rad / rotation_step_rad_));
    steps_ = static_cast<int>(std::ceil(window.distance_m / grid.cell_size_m()));
    for (int rotation = -rotations_; rotation <= rotations_; ++rotation) {
      rotated_.push_back(cells_at(rotation));
    }
  }

  void begin(int min_sum) {
    min_sum_ = min_sum;
    for (int rotation = -rotations_; rotation <= rotations_; ++rotation) {
      for (int x = -steps_; x <= steps_; x += 1 << kTopLevel) {
        for (int y = -steps_; y <= steps_; y += 1 << kTopLevel) {
          push(kTopLevel, rotation, x, y);
        }
      }
    }
  }

  /// The next best single pose, or one with bound 0 when none is left above the minimum. Squares
  /// for which `skip` holds are left out.
  template <typename Skip>
  Node next_pose(std::size_t max_expanded, Skip skip) {
    while (!queue_.empty() && expanded_ < max_expanded) {
      const Node node = queue_.top();
      queue_.pop();
      if (skip(node)) {
        continue;
      }
      if (node.level == 0) {
        return node;
      }
      ++expanded_;
      const int half = 1 << (node.level - 1);
      for (const int x : {node.x + 0, node.x + half}) {
        for (const int y : {node.y + 0, node.y + half}) {
          if (x <= steps_ && y <= steps_) {
            push(node.level - 1, node.rotation, x, y);
          }
        }
      }
    }
    return {};
  }

  void set_min_sum(int min_sum) { min_sum_ = min_sum; }
  [[nodiscard]] std::size_t expanded() const { return expanded_; }
  [[nodiscard]] int sum_at(int rotation, int x, int y) const {
    return sum_of_largest(grid_, rotated_[static_cast<std::size_t>(rotation + rotations_)], 0, x,
                          y);
  }
  [[nodiscard]] bool has_rotation(int rotation) const { return std::abs(rotation) <= rotations_; }
  [[nodiscard]] double rotation_step_rad() const { return rotation_step_rad_; }

  [[nodiscard]] geometry::SE2 pose_of(const Node& node) const {
    return {window_.T_map_base.x + node.x * grid_.cell_size_m(),
            window_.T_map_base.y + node.y * grid_.cell_size_m(),
            geometry::normalize_angle(window_.T_map_base.yaw + node.rotation * rotation_step_rad_)};
  }

 private:
  [[nodiscard]] Cells cells_at(int rotation) const {
    const geometry::SE2 pose{window_.T_map_base.x, window_.T_map_base.y,
                             window_.T_map_base.yaw + rotation * rotation_step_rad_};
    const Eigen::Matrix2d R = pose.rotation();
    Cells cells;
    cells.reserve(points_.size());
    for (const Eigen::Vector2d& p : points_) {
      cells.push_back(grid_.cell_of(R * p + pose.translation()));
    }
    return cells;
  }

  void push(int level, int rotation, int x, int y) {
    const int bound = sum_of_largest(
        grid_, rotated_[static_cast<std::size_t>(rotation + rotations_)], level, x, y);
    if (bound >= min_sum_) {
      queue_.push({bound, order_++, static_cast<std::int16_t>(level),
                   static_cast<std::int16_t>(rotation), static_cast<std::int16_t>(x),
                   static_cast<std::int16_t>(y)});
    }
  }

  const LikelihoodGrid& grid_;
  std::span<const Eigen::Vector2d> points_;
  SearchWindow window_;
  double rotation_step_rad_ = 0.0;
  int rotations_ = 0;
  int steps_ = 0;
  int min_sum_ = 0;
  std::uint32_t order_ = 0;
  std::size_t expanded_ = 0;
  std::vector<Cells> rotated_;
  std::priority_queue<Node, std::vector<Node>, IsWorse> queue_;
};

/// The spread of the poses around the best, each weighted by its likelihood.
Eigen::Matrix3d covariance_around(const Search& search, const Node& best, double cell_size_m,
                                  std::size_t num_points) {
  constexpr int kReach = 3;
  // The points of a scan are no independent measurements: a tenth of them counts.
  const double sharpness = 0.1 * static_cast<double>(num_points);
  const double full = 255.0 * static_cast<double>(num_points);
  Eigen::Matrix3d outer = Eigen::Matrix3d::Zero();
  double weights = 0.0;
  for (int rotation = -kReach; rotation <= kReach; ++rotation) {
    if (!search.has_rotation(best.rotation + rotation)) {
      continue;
    }
    for (int x = -kReach; x <= kReach; ++x) {
      for (int y = -kReach; y <= kReach; ++y) {
        const int sum = search.sum_at(best.rotation + rotation, best.x + x, best.y + y);
        const double weight = std::exp(sharpness * (sum - best.bound) / full);
        const Eigen::Vector3d d(x * cell_size_m, y * cell_size_m,
                                rotation * search.rotation_step_rad());
        outer += weight * d * d.transpose();
        weights += weight;
      }
    }
  }
  const Eigen::Vector3d step(cell_size_m, cell_size_m, search.rotation_step_rad());
  const Eigen::Vector3d rounding = step.cwiseAbs2() / 12.0;
  return outer / weights + Eigen::Matrix3d(rounding.asDiagonal());
}

}  // namespace

LikelihoodGrid::LikelihoodGrid(std::span<const Eigen::Vector2d> points, double cell_size_m,
                               double max_range_m)
    : cell_size_m_(cell_size_m) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double n = 0.0;
  for (const Eigen::Vector2d& p : points) {
    if (p.allFinite()) {
      mean += p;
      n += 1.0;
    }
  }
  mean /= std::max(1.0, n);
  Eigen::Vector2d low = mean;
  Eigen::Vector2d high = mean;
  const auto is_used = [&](const Eigen::Vector2d& p) {
    return p.allFinite() && (p - mean).norm() <= max_range_m;
  };
  for (const Eigen::Vector2d& p : points) {
    if (is_used(p)) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  // Windows that reach into the grid begin before it.
  const double before = ((1 << kTopLevel) + kStampCells) * cell_size_m;
  origin_ = low.array() - before;
  const Eigen::Vector2i size = cell_of(high).array() + kStampCells + 1;
  width_ = size.x();
  height_ = size.y();
  levels_.assign(1, std::vector<std::uint8_t>(static_cast<std::size_t>(width_) *
                                              static_cast<std::size_t>(height_)));
  for (const Eigen::Vector2d& p : points) {
    if (is_used(p)) {
      stamp(p);
    }
  }
  while (levels_.size() < kLevels) {
    add_level();
  }
}

Eigen::Vector2i LikelihoodGrid::cell_of(const Eigen::Vector2d& p) const {
  constexpr double kFar = 1e6;  // cells: no grid reaches there
  const Eigen::Vector2d cells = (p - origin_) / cell_size_m_;
  return cells.array().floor().max(-kFar).min(kFar).cast<int>();
}

void LikelihoodGrid::stamp(const Eigen::Vector2d& p) {
  const Eigen::Vector2i home = cell_of(p);
  for (int y = home.y() - kStampCells; y <= home.y() + kStampCells; ++y) {
    for (int x = home.x() - kStampCells; x <= home.x() + kStampCells; ++x) {
      const Eigen::Vector2d middle = origin_ + cell_size_m_ * Eigen::Vector2d(x + 0.5, y + 0.5);
      const double sigmas = (middle - p).norm() / (kStampSigmaCells * cell_size_m_);
      const auto value = static_cast<std::uint8_t>(255.0 * std::exp(-0.5 * sigmas * sigmas));
      std::uint8_t& cell =
          levels_[0][static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                     static_cast<std::size_t>(x)];
      cell = std::max(cell, value);
    }
  }
}

// A window is the four of half its width that begin in its quarters.
void LikelihoodGrid::add_level() {
  const std::vector<std::uint8_t>& below = levels_.back();
  const auto half = static_cast<std::size_t>(1) << (levels_.size() - 1);
  const auto width = static_cast<std::size_t>(width_);
  const auto height = static_cast<std::size_t>(height_);
  std::vector<std::uint8_t> rows = below;  // the largest of two beside each other
  for (std::size_t y = 0; y < height; ++y) {
    std::uint8_t* row = rows.data() + y * width;
    for (std::size_t x = 0; x + half < width; ++x) {
      row[x] = std::max(row[x], below[y * width + x + half]);
    }
  }
  std::vector<std::uint8_t> level = rows;
  for (std::size_t i = 0; i + half * width < level.size(); ++i) {
    level[i] = std::max(rows[i], rows[i + half * width]);
  }
  levels_.push_back(std::move(level));
}

double CorrelativeMatcher::rotation_step_rad(std::span<const Eigen::Vector2d> points_base,
                                             double cell_size_m) {
  double moment_arm_m = 1.0;
  for (const Eigen::Vector2d& p : points_base) {
    moment_arm_m = std::max(moment_arm_m, p.norm());
  }
  return cell_size_m / std::min(moment_arm_m, kMaxMomentArmM);
}

CorrelativeMatch CorrelativeMatcher::search(const LikelihoodGrid& grid,
                                            std::span<const Eigen::Vector2d> points_base,
                                            const SearchWindow& window) const {
  CorrelativeMatch match;
  match.T_map_base = window.T_map_base;
  if (points_base.empty()) {
    return match;
  }
  const double full = 255.0 * static_cast<double>(points_base.size());
  Search search(grid, points_base, window);
  search.begin(static_cast<int>(params_.min_score * full));
  const Node best = search.next_pose(kMaxExpanded, [](const Node&) { return false; });
  match.expanded = search.expanded();
  match.complete = search.expanded() < kMaxExpanded;
  if (best.bound == 0) {
    return match;
  }
  match.T_map_base = search.pose_of(best);
  match.score = best.bound / full;
  match.covariance = covariance_around(search, best, grid.cell_size_m(), points_base.size());

  // The runner-up: all poses that are no neighbours of the best.
  const double near_cells = kPeakDistanceM / grid.cell_size_m();
  const double near_rotations = kPeakRotationRad / search.rotation_step_rad();
  const auto is_neighbour = [&](const Node& node) {
    const int last = (1 << node.level) - 1;
    const double x = std::max(std::abs(node.x - best.x), std::abs(node.x + last - best.x));
    const double y = std::max(std::abs(node.y - best.y), std::abs(node.y + last - best.y));
    return std::hypot(x, y) <= near_cells &&
           std::abs(node.rotation - best.rotation) <= near_rotations;
  };
  search.set_min_sum(static_cast<int>(params_.max_runner_up_ratio * best.bound));
  const Node second = search.next_pose(kMaxExpanded, is_neighbour);
  match.expanded = search.expanded();
  match.complete = search.expanded() < kMaxExpanded;
  match.runner_up_score =
      second.bound > 0 ? second.bound / full : params_.max_runner_up_ratio * match.score;
  return match;
}

}  // namespace nodmap::slam2d
