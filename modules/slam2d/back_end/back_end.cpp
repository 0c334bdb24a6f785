// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/back_end.hpp"

#include <algorithm>
#include <utility>

#include "modules/slam2d/back_end/polish_graph.hpp"

namespace nodmap::slam2d {
namespace {

constexpr std::size_t kCachedGrids = 24;

// Standard deviations of a pose found in a saved map, a cell or two: x, y in m, yaw in rad.
const Eigen::Vector3d kFoundSigmas(0.1, 0.1, 0.02);

}  // namespace

BackEnd::BackEnd(const BackEndParams& params, const MapParams& map, const MatcherParams& matcher)
    : params_(params),
      chain_(params.submap, map),
      loops_(params.loop, matcher),
      grids_(kCachedGrids) {}

SavedMap BackEnd::save() const {
  SavedMap map;
  chain_.save(map);
  map.loops = loops_.graph().accepted_loops();
  map.variance_factor = loops_.graph().variance_factor();
  return map;
}

void BackEnd::restore(SavedMap map) {
  const std::vector<SavedMap::Loop> loops = std::move(map.loops);
  const VarianceFactor variance_factor = map.variance_factor;
  chain_.restore(std::move(map));
  loops_.restore(chain_, loops, variance_factor);
  begin_anew(kFoundSigmas);
}

CorrelativeMatch BackEnd::find_in_local(std::span<const OrientedPoint> scan,
                                        const SearchWindow& window, double min_score,
                                        std::size_t max_places) {
  return match_in_window(local_grid_.of(chain_.local_index(), local()), points_to_search(scan),
                         window,
                         {.min_score = min_score,
                          .min_peak_ratio = params_.loop.search.max_runner_up_ratio,
                          .max_peaks = max_places});
}

void BackEnd::add_keyframe(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
                           const Eigen::Matrix3d& information) {
  const std::size_t num_submaps = submaps().size();
  const bool begins_anew = !has_local();
  const bool is_finished = chain_.add(std::move(keyframe), T_local_keyframe, information);
  if (submaps().size() > std::max<std::size_t>(num_submaps, 1)) {
    loops_.add_chain_edge(chain_);
  }
  may_be_replaced_ = is_finished || begins_anew;
}

void BackEnd::close_loops() {
  closed_ = {.loops = loops_, .T_map_submaps = {}};
  closed_->T_map_submaps = closed_->loops.close(chain_, grids_);
}

void BackEnd::apply_loops() {
  loops_ = std::move(closed_->loops);
  if (closed_->T_map_submaps) {
    chain_.move_submaps(*closed_->T_map_submaps);
  }
  closed_.reset();
  // One per keyframe; any others follow with the next ones.
  const bool may_be_more = dropped_.has_value();
  dropped_.reset();
  if (may_be_replaced_ || may_be_more) {
    drop_replaced_submap();
  }
}

void BackEnd::drop_replaced_submap() {
  const int num_newer = params_.submap.max_keyframes_per_place;
  if (num_newer == 0) {
    return;
  }
  if (const auto replaced =
          oldest_replaced_submap(submaps(), keyframes(), chain_.end_finished(), num_newer)) {
    dropped_ = loops_.drop_submap(*replaced, chain_);
    grids_.clear();
    local_grid_.clear();
    ++submaps_dropped_;
  }
}

void BackEnd::polish() {
  if (params_.polish.rounds > 0 && chain_.straighten_beginning()) {
    ++num_rebuilt_;
  }
  for (int round = 0; round < params_.polish.rounds; ++round) {
    if (round > 0) {
      chain_.rebuild_submaps();
      ++num_rebuilt_;
    }
    const PolishGraph graph{keyframes(), submaps(), chain_.steps()};
    chain_.set_poses(graph.polished(loops_.closer(), params_.loop.match.max_distance_m));
  }
}

}  // namespace nodmap::slam2d
