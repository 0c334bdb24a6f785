// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/submap_grids.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace nodmap::slam2d {
namespace {

constexpr double kSearchCellM = 0.1;
constexpr double kGridRangeM = 25.0;

}  // namespace

const LikelihoodGrid& SubmapGrids::of(std::size_t submap_index, const Submap& submap) {
  ++uses_;
  const std::size_t num_points = submap.points.points().size();
  if (const auto found = grids_.find(submap_index);
      found != grids_.end() && found->second.num_points == num_points) {
    found->second.last_use = uses_;
    return found->second.grid;
  }
  if (grids_.size() >= max_grids_) {
    grids_.erase(std::min_element(grids_.begin(), grids_.end(), [](const auto& a, const auto& b) {
      return a.second.last_use < b.second.last_use;
    }));
  }
  std::vector<Eigen::Vector2d> points;
  points.reserve(num_points);
  for (const MapPoint& point : submap.points.points()) {
    points.push_back(point.point.p);
  }
  grids_.erase(submap_index);
  return grids_
      .emplace(submap_index,
               Cached{num_points, uses_, LikelihoodGrid(points, kSearchCellM, kGridRangeM)})
      .first->second.grid;
}

}  // namespace nodmap::slam2d
