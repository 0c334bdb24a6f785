// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/shortest_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "sim/body/collision.hpp"
#include "sim/world/ray_caster.hpp"

namespace nodmap::sim {
namespace {

/// Margin of the grid for detours around all objects.
constexpr double kBorderM = 1.0;
constexpr int kMaxCells = 20'000'000;

using Cell = Eigen::Vector2i;

BodyParams point_body(BodyParams body) {
  body.length_m = body.width_m = 1e-6;
  return body;
}

/// The cells in which the disc fits; computed on demand.
class FreeCells {
 public:
  FreeCells(const World& world, const BodyParams& body, double cell_m)
      : collision_(world, point_body(body)), radius_m_(0.5 * body.width_m), cell_m_(cell_m) {
    Bounds bounds;
    for (const Object& object : world.objects) {
      bounds.extend(bounds_of(object));
    }
    for (const Pit& pit : world.pits) {
      extend(bounds, pit.min);
      extend(bounds, pit.max);
    }
    for (const Eigen::Vector2d& goal : world.goals) {
      extend(bounds, goal);
    }
    extend(bounds, world.T_world_start.translation());
    origin_ = bounds.min.head<2>().array() - kBorderM;
    const Eigen::Vector2d size = (bounds.max.head<2>().array() + kBorderM).matrix() - origin_;
    size_ = (size / cell_m).array().ceil().cast<int>() + 1;
    if (size_.cast<double>().prod() <= kMaxCells) {
      cells_.assign(static_cast<std::size_t>(size_.prod()), Known::kNot);
    }
  }

  [[nodiscard]] bool empty() const { return cells_.empty(); }
  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  [[nodiscard]] Cell cell_of(const Eigen::Vector2d& p) const {
    return ((p - origin_) / cell_m_).array().round().cast<int>();
  }
  [[nodiscard]] std::size_t index_of(const Cell& c) const {
    return static_cast<std::size_t>(c.y()) * static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(c.x());
  }
  [[nodiscard]] Cell cell_at(std::size_t index) const {
    const auto width = static_cast<std::size_t>(size_.x());
    return {static_cast<int>(index % width), static_cast<int>(index / width)};
  }
  [[nodiscard]] bool is_free(const Cell& c) {
    if ((c.array() < 0).any() || (c.array() >= size_.array()).any()) {
      return false;
    }
    Known& known = cells_[index_of(c)];
    if (known == Known::kNot) {
      const Eigen::Vector2d p = origin_ + cell_m_ * c.cast<double>();
      const BodyPose body{{p.x(), p.y(), 0.0}};
      known = collision_.clearance_m(body) > radius_m_ ? Known::kFree : Known::kTaken;
    }
    return known == Known::kFree;
  }
  /// Whether all cells along a straight line are free.
  [[nodiscard]] bool is_line_free(const Cell& from, const Cell& to) {
    const Eigen::Vector2d along = (to - from).cast<double>();
    const int steps = static_cast<int>(std::ceil(along.cwiseAbs().maxCoeff()));
    for (int i = 1; i <= steps; ++i) {
      const Eigen::Vector2d p = from.cast<double>() + along * i / steps;
      if (!is_free(p.array().round().cast<int>())) {
        return false;
      }
    }
    return true;
  }

 private:
  enum class Known : std::uint8_t { kNot, kFree, kTaken };

  static void extend(Bounds& bounds, const Eigen::Vector2d& p) {
    const Eigen::Vector3d corner(p.x(), p.y(), 0.0);
    bounds.extend({corner, corner});
  }

  Collision collision_;
  double radius_m_;
  double cell_m_;
  Eigen::Vector2d origin_;
  Eigen::Vector2i size_;
  std::vector<Known> cells_;
};

/// Theta* from one cell to another; returns the length in cells.
std::optional<double> search(FreeCells& cells, const Cell& start, const Cell& goal) {
  struct Visit {
    double length = kInfinity;
    std::size_t parent = 0;
    bool done = false;
  };
  std::vector<Visit> visits(cells.size());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto distance = [](const Cell& a, const Cell& b) { return (a - b).cast<double>().norm(); };
  if (!cells.is_free(start) || !cells.is_free(goal)) {
    return std::nullopt;
  }
  visits[cells.index_of(start)] = {0.0, cells.index_of(start), false};
  open.emplace(distance(start, goal), cells.index_of(start));
  while (!open.empty()) {
    const std::size_t index = open.top().second;
    open.pop();
    if (std::exchange(visits[index].done, true)) {
      continue;
    }
    const Cell cell = cells.cell_at(index);
    if (cell == goal) {
      return visits[index].length;
    }
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const Cell next = cell + Cell(dx, dy);
        if (next == cell || !cells.is_free(next) || visits[cells.index_of(next)].done) {
          continue;
        }
        const std::size_t parent = visits[index].parent;
        const bool straight = cells.is_line_free(cells.cell_at(parent), next);
        const std::size_t from = straight ? parent : index;
        const double length = visits[from].length + distance(cells.cell_at(from), next);
        Visit& visit = visits[cells.index_of(next)];
        if (length < visit.length) {
          visit.length = length;
          visit.parent = from;
          open.emplace(length + distance(next, goal), cells.index_of(next));
        }
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> shortest_path_m(const World& world, const BodyParams& body, double cell_m) {
  if (world.task.shortest_path_m || world.goals.empty()) {
    return world.task.shortest_path_m;
  }
  FreeCells cells(world, body, cell_m);
  if (cells.empty()) {
    return std::nullopt;
  }
  double length_m = 0.0;
  Cell from = cells.cell_of(world.T_world_start.translation());
  for (const Eigen::Vector2d& goal : world.goals) {
    const Cell to = cells.cell_of(goal);
    const auto length = search(cells, from, to);
    if (!length) {
      return std::nullopt;
    }
    length_m += *length * cell_m;
    from = to;
  }
  return length_m;
}

}  // namespace nodmap::sim
