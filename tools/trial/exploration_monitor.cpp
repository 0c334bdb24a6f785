// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/exploration_monitor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "nodmap/exploration_t.hpp"
#include "sim/body/collision.hpp"

namespace nodmap::trial {
namespace {

constexpr double kCellM = 0.05;
constexpr double kOffWallsM = 0.1;
// Limit for open worlds, which are infinite.
constexpr std::size_t kMaxCells = 1'000'000;
constexpr std::int8_t kOccupiedPercent = 25;

// The floor of a world that can be seen from its start: cells of 5 cm, connected with the start, at
// least 10 cm from everything that the robot's body would touch. (Nearer to walls, beams hit a cell
// only by chance.) Returns the centres of the cells in map, metres.
std::vector<Eigen::Vector2d> seeable_floor_map(const sim::World& world,
                                               const sim::BodyParams& body) {
  sim::BodyParams point = body;
  point.length_m = point.width_m = 1e-6;
  const sim::Collision collision(world, point);
  std::set<std::pair<int, int>> visited{{0, 0}};
  std::vector<std::pair<int, int>> front{{0, 0}};
  std::vector<Eigen::Vector2d> floor;
  while (!front.empty() && visited.size() < kMaxCells) {
    const auto [column, row] = front.back();
    front.pop_back();
    const Eigen::Vector2d p_map = kCellM * Eigen::Vector2d(column + 0.5, row + 0.5);
    const Eigen::Vector2d p_world = world.T_world_start * p_map;
    const double clearance_m = collision.clearance_m({{p_world.x(), p_world.y(), 0.0}, 0.0, 0.0});
    if (clearance_m < 0.5 * kCellM) {
      continue;
    }
    if (clearance_m >= kOffWallsM) {
      floor.push_back(p_map);
    }
    for (const auto& [dx, dy] :
         std::array<std::pair<int, int>, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}) {
      if (visited.insert({column + dx, row + dy}).second) {
        front.emplace_back(column + dx, row + dy);
      }
    }
  }
  return floor;
}

}  // namespace

ExplorationMonitor::ExplorationMonitor(const sim::World& world, const sim::RobotModel& model,
                                       const sim::BodyParams& body, bus::LoopNetwork& network)
    : model_(model),
      bus_(network),
      floor_map_(seeable_floor_map(world, body)),
      is_seen_(floor_map_.size(), false) {
  bus_.subscribe<nodmap::grid_chunk_t>("MAP_2D", [this](const auto& m) { on_map(m); });
  bus_.subscribe<nodmap::exploration_t>("EXPLORATION", [this](const auto& m) {
    if (m.state == nodmap::exploration_t::HOME && !record_.home) {
      record_.home = model_.now();
    }
  });
}

void ExplorationMonitor::on_map(const nodmap::grid_chunk_t& message) {
  const Eigen::Vector2d origin(message.origin_x_m + message.cell_size_m * message.tile_x,
                               message.origin_y_m + message.cell_size_m * message.tile_y);
  for (std::size_t i = 0; i < floor_map_.size(); ++i) {
    const Eigen::Vector2d offset = (floor_map_[i] - origin) / message.cell_size_m;
    if (offset.x() >= 0.0 && offset.y() >= 0.0 && offset.x() < message.tile_width &&
        offset.y() < message.tile_height) {
      const auto cell =
          static_cast<std::size_t>(offset.y()) * static_cast<std::size_t>(message.tile_width) +
          static_cast<std::size_t>(offset.x());
      is_seen_[i] = message.cells[cell] >= 0 && message.cells[cell] < kOccupiedPercent;
    }
  }
  if (message.chunk_index + 1 == message.num_chunks) {
    const auto num_seen = std::ranges::count(is_seen_, true);
    record_.seen.push_back(
        {model_.now(), static_cast<double>(num_seen) / static_cast<double>(is_seen_.size())});
  }
}

}  // namespace nodmap::trial
