// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/correlative_matcher.hpp"

#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <utility>

namespace nodmap::slam2d {
namespace {

constexpr int kStampCells = 2;  // on each side of the one a point lies in
constexpr double kStampSigmaCells = 1.0;
constexpr std::size_t kMaxSearchPoints = 250;  // their sums fit into 16 bits
constexpr double kDownsamplingM = 0.2;
constexpr double kMaxRangeM = 25.0;
// Points and rotations are taken in strides, so that the first few already tell much.
constexpr std::size_t kStride = 16;
constexpr std::size_t kMaxExpanded = 400'000;  // nodes: bounds the time of a search
// Poses farther apart than this, or rotated more, are two peaks.
constexpr double kPeakDistanceM = 0.6;
constexpr double kPeakRotationRad = 0.15;
constexpr int kTopLevel = LikelihoodGrid::kTopLevel;
constexpr int kTopCells = LikelihoodGrid::kTopCells;
constexpr double kMaxMomentArmM = 15.0;  // points beyond may move by more than a cell

/// 16 bytes that are added at once. Eigen has no such type of bytes.
using Bytes = std::uint8_t __attribute__((vector_size(LikelihoodGrid::kRowChunk)));
constexpr int kTopStep = 17;  // 255 in 15 steps

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

/// One search: the queue of the nodes, the largest bound first, so that the first single pose that
/// comes out is the best of all.
class Search {
 public:
  Search(const LikelihoodGrid& grid, std::span<const Eigen::Vector2d> points_base,
         const SearchWindow& window)
      : grid_(grid), window_(window), middle_(grid.cell_of(window.T_map_base.translation())) {
    rotation_step_rad_ = CorrelativeMatcher::rotation_step_rad(points_base, grid.cell_size_m());
    rotations_ = static_cast<int>(std::ceil(window.rotation_rad / rotation_step_rad_));
    steps_ = static_cast<int>(std::ceil(window.distance_m / grid.cell_size_m()));
    allowed_chunks_ = allowed_chunks();
    // Points far apart first: a sum over a few of them already tells a bad pose.
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

  /// `ratio`: poses that score less than this part of the best are not asked for.
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
    std::erase_if(nodes_, [this](const Node& node) { return node.bound < min_sum_; });
    std::make_heap(nodes_.begin(), nodes_.end(), IsWorse());
  }

  /// The next best single pose, or one with bound 0 when none is left above the minimum. Squares
  /// for which `skip` holds are left out.
  template <typename Skip>
  Node next_pose(Skip skip) {
    while (!nodes_.empty() && is_complete()) {
      std::pop_heap(nodes_.begin(), nodes_.end(), IsWorse());
      const Node node = nodes_.back();
      nodes_.pop_back();
      if (node.bound < min_sum_) {
        break;
      }
      if (skip(node)) {
        continue;
      }
      if (node.level == 0) {
        return node;
      }
      ++expanded_;
      for (const Node& child : children_of(node)) {
        nodes_.push_back(child);
        std::push_heap(nodes_.begin(), nodes_.end(), IsWorse());
      }
    }
    return {};
  }

  void set_min_sum(int min_sum) { min_sum_ = min_sum; }
  [[nodiscard]] std::size_t expanded() const { return expanded_; }
  [[nodiscard]] bool is_complete() const { return expanded_ < kMaxExpanded; }
  [[nodiscard]] double rotation_step_rad() const { return rotation_step_rad_; }

  [[nodiscard]] geometry::SE2 pose_of(const Node& node) const {
    return {window_.T_map_base.x + node.x * grid_.cell_size_m(),
            window_.T_map_base.y + node.y * grid_.cell_size_m(),
            geometry::normalize_angle(window_.T_map_base.yaw + node.rotation * rotation_step_rad_)};
  }

 private:
  [[nodiscard]] Cells cells_at(const std::vector<Eigen::Vector2d>& points, int rotation) const {
    const geometry::SE2 pose{window_.T_map_base.x, window_.T_map_base.y,
                             window_.T_map_base.yaw + rotation * rotation_step_rad_};
    const Eigen::Matrix2d R = pose.rotation();
    Cells cells;
    cells.reserve(points.size());
    for (const Eigen::Vector2d& p : points) {
      cells.push_back(grid_.cell_of(R * p + pose.translation()));
    }
    return cells;
  }

  /// Keeps the squares of the top level that reach the minimum; returns the best of them.
  [[nodiscard]] std::optional<Node> push_all(int rotation) {
    std::optional<Node> best;
    const Cells& cells = rotated_[static_cast<std::size_t>(rotation + rotations_)];
    for (const Eigen::Vector2i& first : allowed_chunks_) {
      const LikelihoodGrid::RowChunk bounds = grid_.top_bounds(cells, first.x(), first.y());
      for (int i = 0; i < LikelihoodGrid::kRowChunk; ++i) {
        const int x = first.x() + i * kTopCells;
        const int bound = bounds[static_cast<std::size_t>(i)];
        if (bound < min_sum_ || x > steps_ || !is_allowed(kTopLevel, x, first.y())) {
          continue;
        }
        nodes_.push_back(make_node(bound, kTopLevel, rotation, x, first.y()));
        if (!best || IsWorse()(*best, nodes_.back())) {
          best = nodes_.back();
        }
      }
    }
    return best;
  }

  [[nodiscard]] bool is_allowed(int level, int x, int y) const {
    return grid_.is_allowed(level, middle_.x() + x, middle_.y() + y);
  }

  /// The first squares of rows of squares side by side, some of which are allowed.
  [[nodiscard]] std::vector<Eigen::Vector2i> allowed_chunks() const {
    std::vector<Eigen::Vector2i> chunks;
    for (int y = -steps_; y <= steps_; y += kTopCells) {
      for (int x = -steps_; x <= steps_; x += LikelihoodGrid::kRowChunk * kTopCells) {
        for (int i = 0; i < LikelihoodGrid::kRowChunk; ++i) {
          if (is_allowed(kTopLevel, x + i * kTopCells, y)) {
            chunks.emplace_back(x, y);
            break;
          }
        }
      }
    }
    return chunks;
  }

  [[nodiscard]] Node make_node(int bound, int level, int rotation, int x, int y) {
    return {bound,
            order_++,
            static_cast<std::int16_t>(level),
            static_cast<std::int16_t>(rotation),
            static_cast<std::int16_t>(x),
            static_cast<std::int16_t>(y)};
  }

  [[nodiscard]] std::optional<Node> node_at(int level, int rotation, int x, int y) {
    if (!is_allowed(level, x, y)) {
      return std::nullopt;
    }
    const int bound = grid_.sum_of_largest(
        level, rotated_[static_cast<std::size_t>(rotation + rotations_)], x, y, min_sum_);
    if (bound < min_sum_) {
      return std::nullopt;
    }
    return make_node(bound, level, rotation, x, y);
  }

  /// The quarters of a square that reach the minimum.
  [[nodiscard]] boost::container::static_vector<Node, 4> children_of(const Node& node) {
    boost::container::static_vector<Node, 4> children;
    const int half = 1 << (node.level - 1);
    for (const int x : {node.x + 0, node.x + half}) {
      for (const int y : {node.y + 0, node.y + half}) {
        if (x > steps_ || y > steps_) {
          continue;
        }
        if (const auto child = node_at(node.level - 1, node.rotation, x, y)) {
          children.push_back(*child);
        }
      }
    }
    return children;
  }

  /// The sum at a good pose in a square: the best quarter of the best quarter. 0 when none reaches
  /// the minimum.
  [[nodiscard]] int dive(Node node) {
    while (node.level > 0) {
      const auto children = children_of(node);
      if (children.empty()) {
        return 0;
      }
      node = *std::min_element(children.begin(), children.end(),
                               [](const Node& a, const Node& b) { return IsWorse()(b, a); });
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
  std::uint32_t order_ = 0;
  std::size_t expanded_ = 0;
  std::vector<Cells> rotated_;
  std::vector<Eigen::Vector2i> allowed_chunks_;
  std::vector<Node> nodes_;  // from begin() on a heap
};

/// Whether all poses of a square are near a peak.
bool is_near(const Node& node, const Node& peak, double distance_cells, double rotation_steps) {
  const int last = (1 << node.level) - 1;
  const double x = std::max(std::abs(node.x - peak.x), std::abs(node.x + last - peak.x));
  const double y = std::max(std::abs(node.y - peak.y), std::abs(node.y + last - peak.y));
  return std::hypot(x, y) <= distance_cells &&
         std::abs(node.rotation - peak.rotation) <= rotation_steps;
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
  add_windows(levels_);
  add_top_rows();
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
void LikelihoodGrid::add_windows(std::vector<Level>& levels) const {
  const auto width = static_cast<std::size_t>(width_);
  const auto height = static_cast<std::size_t>(height_);
  while (levels.size() < kLevels) {
    const Level& below = levels.back();
    const auto half = static_cast<std::size_t>(1) << (levels.size() - 1);
    Level rows = below;  // the largest of two beside each other
    for (std::size_t y = 0; y < height; ++y) {
      std::uint8_t* row = rows.data() + y * width;
      for (std::size_t x = 0; x + half < width; ++x) {
        row[x] = std::max(row[x], below[y * width + x + half]);
      }
    }
    Level level = rows;
    for (std::size_t i = 0; i + half * width < level.size(); ++i) {
      level[i] = std::max(rows[i], rows[i + half * width]);
    }
    levels.push_back(std::move(level));
  }
}

void LikelihoodGrid::set_allowed(std::span<const Eigen::Vector2d> places) {
  Level allowed(levels_[0].size());
  for (const Eigen::Vector2d& place : places) {
    const Eigen::Vector2i cell = cell_of(place);
    // Windows that hold it begin in the grid, too.
    constexpr int kFirst = 1 << kTopLevel;
    if (cell.x() >= kFirst && cell.y() >= kFirst && cell.x() < width_ && cell.y() < height_) {
      allowed[static_cast<std::size_t>(cell.y()) * static_cast<std::size_t>(width_) +
              static_cast<std::size_t>(cell.x())] = 1;
    }
  }
  allowed_.assign(1, std::move(allowed));
  add_windows(allowed_);
}

void LikelihoodGrid::add_top_rows() {
  const int columns = (width_ + kTopCells - 1) / kTopCells;
  top_width_ = kRowChunk + columns + kRowChunk;
  top_rows_.assign(
      static_cast<std::size_t>(top_width_) * kTopCells * static_cast<std::size_t>(height_), 0);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const int row = y * kTopCells + x % kTopCells;
      top_rows_[static_cast<std::size_t>(row) * static_cast<std::size_t>(top_width_) +
                static_cast<std::size_t>(kRowChunk + x / kTopCells)] =
          static_cast<std::uint8_t>((largest(kTopLevel, x, y) + kTopStep - 1) / kTopStep);
    }
  }
}

// Sums of as many values of 4 bits as a byte holds, then of 16 bits.
LikelihoodGrid::RowChunk LikelihoodGrid::top_bounds(std::span<const Eigen::Vector2i> cells, int x,
                                                    int y) const {
  constexpr std::size_t kInByte = 17;  // times 15 is 255
  RowChunk sums{};
  for (std::size_t begin = 0; begin < cells.size(); begin += kInByte) {
    Bytes bytes{};
    for (const Eigen::Vector2i& cell :
         cells.subspan(begin, std::min(kInByte, cells.size() - begin))) {
      const int cell_x = cell.x() + x;
      const int cell_y = cell.y() + y;
      const int column = kRowChunk + (cell_x >> kTopLevel);  // rounds down, below zero too
      if (cell_y < 0 || cell_y >= height_ || column < 0 || column > top_width_ - kRowChunk) {
        continue;
      }
      const int row = cell_y * kTopCells + (cell_x & (kTopCells - 1));
      Bytes values;
      std::memcpy(&values,
                  top_rows_.data() + static_cast<std::ptrdiff_t>(row) * top_width_ + column,
                  sizeof(values));
      bytes += values;
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      sums[i] = static_cast<std::uint16_t>(sums[i] + kTopStep * bytes[i]);
    }
  }
  return sums;
}

int LikelihoodGrid::sum_of_largest(int level, std::span<const Eigen::Vector2i> cells, int x, int y,
                                   int min_sum) const {
  constexpr std::size_t kCheckEvery = 16;
  const std::uint8_t* values = levels_[static_cast<std::size_t>(level)].data();
  const auto width = static_cast<unsigned>(width_);
  const auto height = static_cast<unsigned>(height_);
  int sum = 0;
  for (std::size_t begin = 0; begin < cells.size(); begin += kCheckEvery) {
    const std::size_t end = std::min(begin + kCheckEvery, cells.size());
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<unsigned>(cells[i].x() + x);
      const auto row = static_cast<unsigned>(cells[i].y() + y);
      sum += column < width && row < height ? values[std::size_t{row} * width + column] : 0;
    }
    if (sum + 255 * static_cast<int>(cells.size() - end) < min_sum) {
      break;
    }
  }
  return sum;
}

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

namespace {

/// At most `kMaxSearchPoints` of the points, spread over all.
std::vector<Eigen::Vector2d> some_of(std::span<const Eigen::Vector2d> points) {
  const std::size_t num_points = std::min(points.size(), kMaxSearchPoints);
  std::vector<Eigen::Vector2d> some;
  some.reserve(num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    some.push_back(points[i * points.size() / num_points]);
  }
  return some;
}

}  // namespace

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
                                            const SearchWindow& window,
                                            std::size_t max_peaks) const {
  CorrelativeMatch match;
  if (points_base.empty()) {
    return match;
  }
  const std::vector<Eigen::Vector2d> points = some_of(points_base);
  const double full = 255.0 * static_cast<double>(points.size());
  Search search(grid, points, window);
  search.begin(static_cast<int>(params_.min_score * full), params_.max_runner_up_ratio);
  const double near_cells = kPeakDistanceM / grid.cell_size_m();
  const double near_rotations = kPeakRotationRad / search.rotation_step_rad();
  std::vector<Node> peaks;
  while (peaks.size() < max_peaks) {
    const Node next = search.next_pose([&](const Node& node) {
      return std::any_of(peaks.begin(), peaks.end(), [&](const Node& peak) {
        return is_near(node, peak, near_cells, near_rotations);
      });
    });
    if (next.bound == 0) {
      break;
    }
    if (peaks.empty()) {
      search.set_min_sum(static_cast<int>(params_.max_runner_up_ratio * next.bound));
    }
    peaks.push_back(next);
    match.peaks.push_back({search.pose_of(next), next.bound / full});
  }
  match.expanded = search.expanded();
  match.complete = search.is_complete();
  return match;
}

}  // namespace nodmap::slam2d
