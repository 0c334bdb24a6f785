// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/correlative_match.hpp"

#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace nodmap::slam2d {
namespace {

constexpr std::size_t kMaxSearchPoints = 250;  // their sums fit into 16 bits
constexpr double kDownsamplingM = 0.2;
constexpr double kMaxRangeM = 25.0;
// Points and rotations are taken in strides, so that the first few already tell much.
constexpr std::size_t kStride = 16;
constexpr std::size_t kMaxExpanded = 400'000;  // nodes; limits the time of a search
// Poses farther apart than this, or rotated by more, are separate peaks.
constexpr double kPeakDistanceM = 0.6;
constexpr double kPeakRotationRad = 0.15;
constexpr int kTopLevel = LikelihoodGrid::kTopLevel;
constexpr int kTopCells = LikelihoodGrid::kTopCells;
constexpr double kMaxMomentArmM = 15.0;  // points beyond may move by more than a cell

// The cells of the points of a scan, rotated by one angle, at the middle of the window.
using Cells = std::vector<Eigen::Vector2i>;

// A square of 2^level poses along each side, all rotated by the same angle.
struct Node {
  int bound = 0;  // no pose in it has a larger sum of likelihoods
  std::int16_t level = 0;
  std::int16_t rotation = 0;
  std::int16_t x = 0;  // cells from the middle of the window
  std::int16_t y = 0;
};

// Gives the node with the largest bound first, and of several the one that was pushed first.
// Bounds are whole numbers, so that a list for each of them takes the place of a heap, which would
// take half of the time of a large search.
class NodeQueue {
 public:
  explicit NodeQueue(int max_bound) : lists_(static_cast<std::size_t>(max_bound) + 1) {}

  void push(const Node& node) {
    const auto pushed = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({node});
    List& list = lists_[static_cast<std::size_t>(node.bound)];
    (list.first == kNone ? list.first : nodes_[list.last].next) = pushed;
    list.last = pushed;
    largest_ = std::max(largest_, static_cast<std::size_t>(node.bound));
  }

  // Empty when no node is left.
  [[nodiscard]] std::optional<Node> pop() {
    while (largest_ > 0 && lists_[largest_].first == kNone) {
      --largest_;
    }
    List& list = lists_[largest_];
    if (list.first == kNone) {
      return std::nullopt;
    }
    const Entry& entry = nodes_[list.first];
    list.first = entry.next;
    if (entry.next != kNone) {
      // Nodes are popped in another order than they were pushed in, so that each is a cache miss.
      __builtin_prefetch(&nodes_[entry.next]);
    }
    return entry.node;
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  struct Entry {
    Node node;
    std::uint32_t next = kNone;
  };
  struct List {
    std::uint32_t first = kNone;
    std::uint32_t last = kNone;
  };
  std::vector<Entry> nodes_;
  std::vector<List> lists_;  // of each bound
  std::size_t largest_ = 0;
};

// One search. Its queue holds the nodes with the largest bound first, so that the first single
// pose that it gives is the best of all.
class Search {
 public:
  Search(const LikelihoodGrid& grid, std::span<const Eigen::Vector2d> points_base,
         const SearchWindow& window)
      : grid_(grid),
        window_(window),
        middle_(grid.cell_of(window.T_target_base.translation())),
        queue_(255 * static_cast<int>(points_base.size())) {
    rotation_step_rad_ = slam2d::rotation_step_rad(points_base, grid.cell_size_m());
    rotations_ = static_cast<int>(std::ceil(window.rotation_rad / rotation_step_rad_));
    steps_ = static_cast<int>(std::ceil(window.distance_m / grid.cell_size_m()));
    allowed_chunks_ = allowed_chunks();
    // Points far apart come first: a sum over a few of them already rejects a bad pose.
    std::vector<Eigen::Vector2d> points;
    for (std::size_t first = 0; first < kStride; ++first) {
      for (std::size_t i = first; i < points_base.size(); i += kStride) {
        points.push_back(points_base[i]);
      }
    }
    for (int rotation = -rotations_; rotation <= rotations_; ++rotation) {
      rotated_.push_back(cells_at(points, rotation));
    }
  }

  // `ratio`: poses that score less than this part of the best are not needed.
  void begin(int min_sum, double ratio) {
    min_sum_ = min_sum;
    const int stride = static_cast<int>(kStride);
    for (int first = -rotations_; first < -rotations_ + stride; ++first) {
      for (int rotation = first; rotation <= rotations_; rotation += stride) {
        if (const auto best = push_all(rotation)) {
          min_sum_ = std::max(min_sum_, static_cast<int>(ratio * dive(*best)));
        }
      }
    }
    for (const Node& node : top_nodes_) {
      if (node.bound >= min_sum_) {
        queue_.push(node);
      }
    }
  }

  // The next best single pose, or one with bound 0 when none is left above the minimum. Squares
  // for which `skip` holds are left out.
  template <typename Skip>
  Node next_pose(Skip skip) {
    while (is_complete()) {
      const std::optional<Node> node = queue_.pop();
      if (!node || node->bound < min_sum_) {
        break;
      }
      if (skip(*node)) {
        continue;
      }
      if (node->level == 0) {
        return *node;
      }
      ++expanded_;
      for (const Node& child : children_of(*node)) {
        queue_.push(child);
      }
    }
    return {};
  }

  void set_min_sum(int min_sum) { min_sum_ = min_sum; }
  [[nodiscard]] bool is_complete() const { return expanded_ < kMaxExpanded; }
  [[nodiscard]] double rotation_step_rad() const { return rotation_step_rad_; }

  [[nodiscard]] geometry::SE2 pose_of(const Node& node) const {
    return {
        window_.T_target_base.x + node.x * grid_.cell_size_m(),
        window_.T_target_base.y + node.y * grid_.cell_size_m(),
        geometry::normalize_angle(window_.T_target_base.yaw + node.rotation * rotation_step_rad_)};
  }

 private:
  [[nodiscard]] Cells cells_at(const std::vector<Eigen::Vector2d>& points, int rotation) const {
    const geometry::SE2 pose{window_.T_target_base.x, window_.T_target_base.y,
                             window_.T_target_base.yaw + rotation * rotation_step_rad_};
    const Eigen::Matrix2d R = pose.rotation();
    Cells cells;
    cells.reserve(points.size());
    for (const Eigen::Vector2d& p : points) {
      cells.push_back(grid_.cell_of(R * p + pose.translation()));
    }
    return cells;
  }

  // The cells of the points at one of the angles, from -rotations_ to rotations_.
  [[nodiscard]] const Cells& rotated(int rotation) const {
    return rotated_[static_cast<std::size_t>(std::int64_t{rotation} + rotations_)];
  }

  // Keeps the squares of the top level that reach the minimum; returns the best of them.
  [[nodiscard]] std::optional<Node> push_all(int rotation) {
    std::optional<Node> best;
    const auto cells = grid_.top_cells(rotated(rotation), -steps_, -steps_);
    for (const Eigen::Vector2i& first : allowed_chunks_) {
      const LikelihoodGrid::RowChunk bounds = grid_.top_bounds(cells, first.x(), first.y());
      if (largest(bounds) < min_sum_) {
        continue;
      }
      const int y = first.y() * kTopCells - steps_;
      for (int i = 0; i < LikelihoodGrid::kRowChunk; ++i) {
        const int x = (first.x() + i) * kTopCells - steps_;
        const int bound = bounds[static_cast<std::size_t>(i)];
        if (bound < min_sum_ || x > steps_ || !is_allowed(kTopLevel, x, y)) {
          continue;
        }
        top_nodes_.push_back(make_node(bound, kTopLevel, rotation, x, y));
        if (!best || best->bound < bound) {
          best = top_nodes_.back();
        }
      }
    }
    return best;
  }

  // Without branches, so that the compiler compares many at once.
  [[nodiscard]] static int largest(const LikelihoodGrid::RowChunk& bounds) {
    std::uint16_t largest = 0;
    for (const std::uint16_t bound : bounds) {
      largest = std::max(largest, bound);
    }
    return largest;
  }

  [[nodiscard]] bool is_allowed(int level, int x, int y) const {
    return grid_.is_allowed(level, middle_.x() + x, middle_.y() + y);
  }

  // The first squares, counted from that at (-steps_, -steps_), of rows of squares side by side
  // that together hold all allowed ones.
  [[nodiscard]] std::vector<Eigen::Vector2i> allowed_chunks() const {
    std::vector<Eigen::Vector2i> chunks;
    const int squares = 2 * steps_ / kTopCells + 1;
    for (int row = 0; row < squares; ++row) {
      for (int column = 0; column < squares; ++column) {
        if (is_allowed(kTopLevel, column * kTopCells - steps_, row * kTopCells - steps_)) {
          chunks.emplace_back(column, row);
          column += LikelihoodGrid::kRowChunk - 1;
        }
      }
    }
    return chunks;
  }

  [[nodiscard]] static Node make_node(int bound, int level, int rotation, int x, int y) {
    return {bound, static_cast<std::int16_t>(level), static_cast<std::int16_t>(rotation),
            static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
  }

  // The quarters of a square that reach the minimum.
  [[nodiscard]] boost::container::static_vector<Node, 4> children_of(const Node& node) const {
    boost::container::static_vector<Node, 4> children;
    const int level = node.level - 1;
    const int half = 1 << level;
    const LikelihoodGrid::Quarters sums =
        grid_.sums_of_quarters(level, rotated(node.rotation), node.x, node.y, min_sum_);
    for (int quarter = 0; quarter < 4; ++quarter) {
      const int x = node.x + half * (quarter / 2);
      const int y = node.y + half * (quarter % 2);
      const int bound = sums[static_cast<std::size_t>(quarter)];
      if (bound >= min_sum_ && x <= steps_ && y <= steps_ && is_allowed(level, x, y)) {
        children.push_back(make_node(bound, level, node.rotation, x, y));
      }
    }
    return children;
  }

  // The sum at a good pose in a square: the best quarter of the best quarter. 0 when none reaches
  // the minimum.
  [[nodiscard]] int dive(Node node) const {
    while (node.level > 0) {
      const auto children = children_of(node);
      if (children.empty()) {
        return 0;
      }
      node = *std::max_element(children.begin(), children.end(),
                               [](const Node& a, const Node& b) { return a.bound < b.bound; });
    }
    return node.bound;
  }

  const LikelihoodGrid& grid_;
  SearchWindow window_;
  Eigen::Vector2i middle_;
  double rotation_step_rad_ = 0.0;
  int rotations_ = 0;
  int steps_ = 0;
  int min_sum_ = 0;
  std::size_t expanded_ = 0;
  std::vector<Cells> rotated_;
  std::vector<Eigen::Vector2i> allowed_chunks_;
  std::vector<Node> top_nodes_;  // the largest squares
  NodeQueue queue_;
};

// Whether all poses of a square are near a peak.
bool is_near(const Node& node, const Node& peak, double distance_cells, double rotation_step_rad) {
  const int last = (1 << node.level) - 1;
  const double x = std::max(std::abs(node.x - peak.x), std::abs(node.x + last - peak.x));
  const double y = std::max(std::abs(node.y - peak.y), std::abs(node.y + last - peak.y));
  // Modulo a full turn: a window of half a turn to either side ends where it begins.
  const double rotation_rad =
      geometry::normalize_angle((node.rotation - peak.rotation) * rotation_step_rad);
  return std::abs(rotation_rad) <= kPeakRotationRad &&
         x * x + y * y <= distance_cells * distance_cells;
}

// At most `kMaxSearchPoints` of the points, spread over all.
std::vector<Eigen::Vector2d> points_to_sum(std::span<const Eigen::Vector2d> points) {
  const std::size_t num_points = std::min(points.size(), kMaxSearchPoints);
  std::vector<Eigen::Vector2d> some;
  some.reserve(num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    some.push_back(points[i * points.size() / num_points]);
  }
  return some;
}

}  // namespace

std::vector<Eigen::Vector2d> points_to_search(std::span<const OrientedPoint> scan) {
  std::set<std::pair<int, int>> taken;
  std::vector<Eigen::Vector2d> points;
  for (const OrientedPoint& point : scan) {
    const Eigen::Vector2d cell = (point.p / kDownsamplingM).array().floor();
    if (point.p.norm() <= kMaxRangeM &&
        taken.emplace(static_cast<int>(cell.x()), static_cast<int>(cell.y())).second) {
      points.push_back(point.p);
    }
  }
  return points;
}

double rotation_step_rad(std::span<const Eigen::Vector2d> points_base, double cell_size_m) {
  double moment_arm_m = 1.0;
  for (const Eigen::Vector2d& p : points_base) {
    moment_arm_m = std::max(moment_arm_m, p.norm());
  }
  return cell_size_m / std::min(moment_arm_m, kMaxMomentArmM);
}

CorrelativeMatch match_in_window(const LikelihoodGrid& grid,
                                 std::span<const Eigen::Vector2d> points_base,
                                 const SearchWindow& window, const SearchLimits& limits) {
  CorrelativeMatch match;
  if (points_base.empty()) {
    return match;
  }
  const std::vector<Eigen::Vector2d> points = points_to_sum(points_base);
  const double full = 255.0 * static_cast<double>(points.size());
  Search search(grid, points, window);
  search.begin(static_cast<int>(limits.min_score * full), limits.min_peak_ratio);
  const double near_cells = kPeakDistanceM / grid.cell_size_m();
  std::vector<Node> peaks;
  while (peaks.size() < limits.max_peaks) {
    const Node next = search.next_pose([&](const Node& node) {
      return std::any_of(peaks.begin(), peaks.end(), [&](const Node& peak) {
        return is_near(node, peak, near_cells, search.rotation_step_rad());
      });
    });
    if (next.bound == 0) {
      break;
    }
    if (peaks.empty()) {
      search.set_min_sum(static_cast<int>(limits.min_peak_ratio * next.bound));
    }
    peaks.push_back(next);
    match.peaks.push_back({search.pose_of(next), next.bound / full});
  }
  match.complete = search.is_complete();
  return match;
}

}  // namespace nodmap::slam2d
