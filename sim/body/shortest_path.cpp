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

// Margin of the grid for detours around all objects.
constexpr double kBorderM = 1.0;
constexpr int kMaxCells = 20'000'000;

using Cell = Eigen::Vector2i;

BodyParams point_body(BodyParams body) {
  body.length_m = body.width_m = 1e-6;
  return body;
}

// The cells in which the disc fits; computed on demand.
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
    const Eigen::Vector2d cells = (size / cell_m).array().ceil() + 1.0;
    if (cells.prod() <= kMaxCells) {  // before the conversion: a far goal is too many for an int
      size_ = cells.cast<int>();
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
  [[nodiscard]] bool is_free(const Cell& c) const {
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
  // Whether all cells along a straight line are free.
  [[nodiscard]] bool is_line_free(const Cell& from, const Cell& to) const {
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
  Eigen::Vector2i size_ = Eigen::Vector2i::Zero();
  mutable std::vector<Known> cells_;  // computed when asked for the first time
};

double distance(const Cell& a, const Cell& b) {
  return (a - b).cast<double>().norm();
}

// Theta*: A* in which the path to a cell may come straight from its neighbour's parent, if nothing
// is in between.
class ThetaStar {
 public:
  ThetaStar(FreeCells& cells, const Cell& goal)
      : cells_(cells), goal_(goal), visits_(cells.size()) {}

  // The length of the path in cells; empty if there is none.
  [[nodiscard]] std::optional<double> length_from(const Cell& start) {
    if (!cells_.is_free(start) || !cells_.is_free(goal_)) {
      return std::nullopt;
    }
    reach(start, 0.0, cells_.index_of(start));
    while (!open_.empty()) {
      const std::size_t index = open_.top().second;
      open_.pop();
      if (std::exchange(visits_[index].done, true)) {
        continue;
      }
      if (cells_.cell_at(index) == goal_) {
        return visits_[index].length;
      }
      expand(index);
    }
    return std::nullopt;
  }

 private:
  struct Visit {
    double length = kInfinity;
    std::size_t parent = 0;
    bool done = false;
  };
  using Entry = std::pair<double, std::size_t>;

  void expand(std::size_t index) {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const Cell next = cells_.cell_at(index) + Cell(dx, dy);
        if (cells_.is_free(next) && !visits_[cells_.index_of(next)].done) {
          go_to(next, index);
        }
      }
    }
  }

  // Reaches `next` from the cell beside it, or straight from that cell's parent.
  void go_to(const Cell& next, std::size_t beside) {
    const std::size_t parent = visits_[beside].parent;
    const bool is_straight = cells_.is_line_free(cells_.cell_at(parent), next);
    const std::size_t from = is_straight ? parent : beside;
    reach(next, visits_[from].length + distance(cells_.cell_at(from), next), from);
  }

  void reach(const Cell& cell, double length, std::size_t parent) {
    Visit& visit = visits_[cells_.index_of(cell)];
    if (length < visit.length) {
      visit.length = length;
      visit.parent = parent;
      open_.emplace(length + distance(cell, goal_), cells_.index_of(cell));
    }
  }

  FreeCells& cells_;
  Cell goal_;
  std::vector<Visit> visits_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
};

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
    const auto length = ThetaStar(cells, to).length_from(from);
    if (!length) {
      return std::nullopt;
    }
    length_m += *length * cell_m;
    from = to;
  }
  return length_m;
}

}  // namespace nodmap::sim
