// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/viewpoints.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::explorer {
namespace {

// Lookouts are examined in batches of this many, the nearest first, until a batch contains a
// candidate.
constexpr std::size_t kBatch = 200;

ViewParams looking_around(ViewParams params) {
  params.half_angle_rad = geometry::kPi;
  return params;
}

double area_m2(const PlanningGrid& grid, std::size_t num_cells) {
  return grid.cell_size_m() * grid.cell_size_m() * static_cast<double>(num_cells);
}

}  // namespace

ViewpointChooser::ViewpointChooser(const ExplorerParams& params)
    : params_(params),
      // The robot may stop before the viewpoint by the tolerance.
      ray_caster_(params.view, params.robot.mount.x_m - params.goal_tolerance_m),
      ray_caster_around_(looking_around(params.view), 0.0) {}

std::optional<Viewpoint> ViewpointChooser::nearest(const Reach& reach,
                                                   const std::vector<Cell>& lookouts) {
  for (const Cell& cell : lookouts) {
    const Eigen::Vector2d p_map = reach.grid.center_of(cell);
    const double gain_m2 =
        area_m2(reach.grid, ray_caster_around_.unknown_cells(reach.grid, p_map, 0.0).size());
    if (gain_m2 >= params_.view.min_gain_m2) {
      return Viewpoint{cell, p_map, gain_m2, reach.paths.length_m(cell)};
    }
  }
  return std::nullopt;
}

std::vector<ViewpointChooser::Candidate> ViewpointChooser::candidates_among(
    const Reach& reach, const std::vector<Cell>& lookouts, double yaw_rad) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < lookouts.size(); ++i) {
    if (i % kBatch == 0 && !candidates.empty()) {
      break;
    }
    const Cell& cell = lookouts[i];
    const Eigen::Vector2d p_map = reach.grid.center_of(cell);
    const auto& shows =
        ray_caster_.unknown_cells(reach.grid, p_map, reach.paths.heading_rad(cell, yaw_rad));
    const double gain_m2 = area_m2(reach.grid, shows.size());
    if (gain_m2 >= params_.view.min_gain_m2) {
      candidates.push_back({{cell, p_map, gain_m2, reach.paths.length_m(cell)}, shows});
    }
  }
  return candidates;
}

std::vector<Viewpoint> ViewpointChooser::choose(const Reach& reach,
                                                const std::vector<Cell>& lookouts, double yaw_rad) {
  std::vector<Candidate> candidates = candidates_among(reach, lookouts, yaw_rad);
  std::vector<bool> is_shown(reach.grid.ground().size(), false);
  std::vector<Viewpoint> chosen;
  const auto value = [&](const Candidate& candidate) {
    const Viewpoint& viewpoint = candidate.viewpoint;
    return viewpoint.gain_m2 * std::exp(-params_.tour.discount_per_m * viewpoint.length_m);
  };
  while (!candidates.empty() && std::ssize(chosen) < params_.tour.max_viewpoints) {
    const auto best = std::ranges::max_element(candidates, {}, value);
    chosen.push_back(best->viewpoint);
    for (const std::uint32_t cell : best->shows) {
      is_shown[cell] = true;
    }
    for (Candidate& candidate : candidates) {
      std::erase_if(candidate.shows, [&](std::uint32_t cell) { return is_shown[cell]; });
      candidate.viewpoint.gain_m2 = area_m2(reach.grid, candidate.shows.size());
    }
    std::erase_if(candidates, [&](const Candidate& candidate) {
      return candidate.viewpoint.gain_m2 < params_.view.min_gain_m2;
    });
  }
  return chosen;
}

}  // namespace nodmap::explorer
