// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/results.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "common/drawing/plan_view.hpp"
#include "common/formats/tum.hpp"
#include "common/node/log.hpp"
#include "common/node/results.hpp"
#include "modules/slam2d/grid/map_file.hpp"

namespace nodmap::slam2d {
namespace {

using drawing::Extent;
using drawing::LegendEntry;
using drawing::PlanView;

constexpr drawing::Rgb kPathColour{214, 69, 65};
constexpr drawing::Rgb kOdometryColour{170, 170, 170};
constexpr double kImagePx = 1200.0;
constexpr double kMaxPxPerM = 200.0;
constexpr double kBorderM = 1.0;

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

drawing::Image draw_map(const OccupancyGrid& grid, std::span<const geometry::SE2> path) {
  Extent extent;
  extent.add(grid.origin());
  extent.add(grid.origin() + grid.cell_size_m() * Eigen::Vector2d(grid.width(), grid.height()));
  // At least one pixel for each cell; a small map is enlarged to the size of a screen.
  const double px_per_m =
      std::max(1.0 / grid.cell_size_m(), drawing::fitting_scale(extent, kImagePx, kMaxPxPerM));
  PlanView view(extent, px_per_m, {kUnknownGrey, kUnknownGrey, kUnknownGrey});
  view.draw_grid({.origin = grid.origin(),
                  .cell_size_m = grid.cell_size_m(),
                  .width = grid.width(),
                  .height = grid.height(),
                  .colour = [&grid](int x, int y) {
                    const std::uint8_t value = grey_of(grid, x, y);
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

void write_trajectories(const std::filesystem::path& dir, std::span<const TrackedScan> scans,
                        std::span<const geometry::SE2> corrected) {
  formats::Trajectory trajectory;
  formats::Trajectory online;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    trajectory.push_back({scans[i].stamp, geometry::to_se3(corrected[i])});
    online.push_back({scans[i].stamp, geometry::to_se3(scans[i].T_map_base_online)});
  }
  node::write_each({[&] { formats::write_tum(dir / "trajectory.tum", trajectory); },
                    [&] { formats::write_tum(dir / "online.tum", online); }});
}

nlohmann::json scan_metrics(const ScansByState& scans, const ScanCounts& rejected) {
  return {{"scans_used", scans.all},          {"scans_tracked", scans.tracked},
          {"scans_degraded", scans.degraded}, {"scans_by_odometry", scans.by_odometry},
          {"scans_lost", scans.lost},         {"scans_not_level", rejected.not_level}};
}

void log_scans(const ScansByState& scans) {
  const bool is_mostly_lost = 2 * scans.lost > scans.all;
  log::get().log(is_mostly_lost ? spdlog::level::warn : spdlog::level::info,
                 "scans: {} tracked, {} degraded, {} lost of {}", scans.tracked,
                 scans.degraded + scans.by_odometry, scans.lost, scans.all);
}

}  // namespace nodmap::slam2d
