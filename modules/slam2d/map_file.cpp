// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/map_file.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/drawing/plan_view.hpp"
#include "common/formats/atomic_file.hpp"

namespace nodmap::slam2d {
namespace {

using drawing::Extent;
using drawing::LegendEntry;
using drawing::PlanView;

// Grey values of map_server's trinary mode.
constexpr std::uint8_t kOccupiedGrey = 0;
constexpr std::uint8_t kUnknownGrey = 205;
constexpr std::uint8_t kFreeGrey = 254;

constexpr drawing::Rgb kPathColour{214, 69, 65};
constexpr drawing::Rgb kOdometryColour{170, 170, 170};
constexpr double kImagePx = 1200.0;
constexpr double kMaxPxPerM = 200.0;
constexpr double kBorderM = 1.0;

std::uint8_t grey(const OccupancyGrid& grid, int x, int y) {
  if (grid.occupancy(x, y) == OccupancyGrid::kUnknown) {
    return kUnknownGrey;
  }
  return grid.is_occupied(x, y) ? kOccupiedGrey : kFreeGrey;
}

std::string pgm_of(const OccupancyGrid& grid) {
  std::string bytes =
      "P5\n" + std::to_string(grid.width()) + " " + std::to_string(grid.height()) + "\n255\n";
  for (int y = grid.height() - 1; y >= 0; --y) {  // the first row of an image is its top
    for (int x = 0; x < grid.width(); ++x) {
      bytes.push_back(static_cast<char>(grey(grid, x, y)));
    }
  }
  return bytes;
}

std::string yaml_of(const OccupancyGrid& grid) {
  std::ostringstream text;
  text << "image: map.pgm\n"
       << "mode: trinary\n"
       << "resolution: " << grid.cell_size_m() << "\n"
       << "origin: [" << grid.origin().x() << ", " << grid.origin().y() << ", 0]\n"
       << "negate: 0\n"
       << "occupied_thresh: 0.65\n"
       << "free_thresh: 0.196\n";
  return text.str();
}

void write(const std::filesystem::path& file, const std::string& bytes) {
  if (const auto error = formats::replace_file(file, bytes)) {
    throw std::runtime_error(file.string() + ": " + error.message());
  }
}

std::vector<Eigen::Vector2d> positions_of(std::span<const geometry::SE2> path) {
  std::vector<Eigen::Vector2d> positions;
  positions.reserve(path.size());
  for (const geometry::SE2& pose : path) {
    positions.push_back(pose.translation());
  }
  return positions;
}

void draw_ends(PlanView& view, const std::vector<Eigen::Vector2d>& path) {
  if (!path.empty()) {
    view.draw_start(path.front(), kPathColour);
    view.draw_end(path.back(), kPathColour);
  }
}

}  // namespace

void write_ros_map(const std::filesystem::path& dir, const OccupancyGrid& grid) {
  write(dir / "map.pgm", pgm_of(grid));
  write(dir / "map.yaml", yaml_of(grid));
}

drawing::Image draw_map(const OccupancyGrid& grid, std::span<const geometry::SE2> path) {
  Extent extent;
  extent.add(grid.origin());
  extent.add(grid.origin() + grid.cell_size_m() * Eigen::Vector2d(grid.width(), grid.height()));
  // Each cell a pixel at least, and a small map as large as a screen.
  const double px_per_m =
      std::max(1.0 / grid.cell_size_m(), drawing::fitting_scale(extent, kImagePx, kMaxPxPerM));
  PlanView view(extent, px_per_m, {kUnknownGrey, kUnknownGrey, kUnknownGrey});
  view.draw_grid({.origin = grid.origin(),
                  .cell_size_m = grid.cell_size_m(),
                  .width = grid.width(),
                  .height = grid.height(),
                  .colour = [&grid](int x, int y) {
                    const std::uint8_t value = grey(grid, x, y);
                    return drawing::Rgb{value, value, value};
                  }});
  const std::vector<Eigen::Vector2d> positions = positions_of(path);
  view.draw_path(positions, kPathColour, 2.0);
  draw_ends(view, positions);
  view.draw_scale_bar();
  view.draw_legend(
      std::array{LegendEntry{"path, from disc to square", kPathColour},
                 LegendEntry{"occupied", {kOccupiedGrey, kOccupiedGrey, kOccupiedGrey}},
                 LegendEntry{"free", {kFreeGrey, kFreeGrey, kFreeGrey}}});
  return std::move(view).take();
}

drawing::Image draw_paths(std::span<const geometry::SE2> path,
                          std::span<const geometry::SE2> odometry) {
  const std::vector<Eigen::Vector2d> positions = positions_of(path);
  const std::vector<Eigen::Vector2d> by_odometry = positions_of(odometry);
  Extent extent;
  for (const auto* each : {&positions, &by_odometry}) {
    for (const Eigen::Vector2d& p : *each) {
      extent.add(p);
    }
  }
  extent.grow(kBorderM);
  PlanView view(extent, drawing::fitting_scale(extent, kImagePx, kMaxPxPerM));
  view.draw_path(by_odometry, kOdometryColour, 2.0);
  view.draw_path(positions, kPathColour, 2.0);
  draw_ends(view, positions);
  view.draw_scale_bar();
  view.draw_legend(std::array{LegendEntry{"2d slam, from disc to square", kPathColour},
                              LegendEntry{"odometry", kOdometryColour}});
  return std::move(view).take();
}

}  // namespace nodmap::slam2d
