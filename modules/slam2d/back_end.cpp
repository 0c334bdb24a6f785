// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "modules/slam2d/keyframe_graph.hpp"

namespace nodmap::slam2d {
namespace {

using registration::PoseEdge2d;

// The work on one keyframe is bounded.
constexpr std::size_t kMaxTracked = 2;
constexpr std::size_t kMaxSearches = 2;
constexpr std::size_t kSearchEvery = 3;  // keyframes
// The graph is solved every few keyframes, and less often as it grows: its solution takes a time in
// proportion to its submaps.
constexpr std::size_t kMinOptimiseEvery = 3;
constexpr std::size_t kSubmapsPerKeyframe = 40;
constexpr double kSigmas = 3.0;
// Nearer than this by the graph, a match finds the place without a search.
constexpr double kTrackDistanceM = 0.35;
constexpr double kTrackRotationRad = 0.1;
// Of three degrees of freedom, one true loop of a thousand is beyond.
constexpr double kMaxLoopChiSquared = 16.3;

// Both ends of a step are matched against the same submap, and most of their errors are alike. With
// this factor the standard deviation over half a submap is twice that of one match.
constexpr double kStepInformationFactor = 5.0;

// A robot that was found in a saved map is known to a cell or two of the map: x, y in m, yaw in
// rad.
const Eigen::Vector3d kFoundSigmas(0.1, 0.1, 0.02);

/// The information of odometry on a step, in the frame of its start. The errors of wheels are
/// systematic, not white noise: the numbers hold for 30 m.
Eigen::Matrix3d odometry_information(const geometry::SE2& step) {
  const double distance_m = std::hypot(step.x, step.y);
  const double sigma_m = 0.01 + 0.2 * distance_m;
  const double sigma_rad = 0.02 + 0.1 * std::abs(step.yaw) + 0.05 * distance_m;
  return Eigen::Vector3d(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m),
                         1.0 / (sigma_rad * sigma_rad))
      .asDiagonal();
}

}  // namespace

BackEnd::BackEnd(const BackEndParams& params, const MapParams& map, const MatcherParams& matcher)
    : params_(params), map_params_(map), closer_(params.loop, matcher) {}

SavedMap BackEnd::save() const {
  SavedMap map;
  map.keyframes = keyframes_;
  map.steps = chain_;
  for (const Submap& submap : submaps_) {
    map.submaps.push_back({submap.first_keyframe, submap.end_keyframe()});
  }
  for (const PoseEdge2d& edge : graph_.loops()) {
    map.loops.push_back({edge, loops_.at({edge.from, edge.to}).score});
  }
  return map;
}

void BackEnd::restore(SavedMap map) {
  keyframes_ = std::move(map.keyframes);
  chain_ = std::move(map.steps);
  for (const SavedMap::Submap& submap : map.submaps) {
    submap_of_.resize(submap.end_keyframe, submaps_.size());
    submaps_.push_back(build_submap(submap.first_keyframe, submap.end_keyframe));
    if (submaps_.size() > 1) {
      graph_.add_chain_edge(chain_of_submaps(submaps_.size() - 1));
    }
  }
  for (const SavedMap::Loop& loop : map.loops) {
    const PoseEdge2d& edge = loop.edge;
    graph_.add_loop(edge.from, edge.to, edge.T_from_to, edge.information);
    loops_[{edge.from, edge.to}] = {edge.from, edge.to, LoopState::kAccepted, loop.score};
  }
  begin_anew(kFoundSigmas);
  ++graph_revision_;
}

void BackEnd::begin_anew(const Eigen::Vector3d& sigmas) {
  local_ = submaps_.size();
  num_separate_ = submaps_.size();
  begin_sigmas_ = sigmas;
}

std::size_t BackEnd::num_points() const {
  std::size_t sum = 0;
  for (const Submap& submap : submaps_) {
    sum += submap.points.points().size();
  }
  return sum;
}

bool BackEnd::is_full(const Submap& submap, double ratio) const {
  return static_cast<double>(submap.T_submap_keyframe.size()) >=
         ratio * params_.submap.num_keyframes;
}

std::optional<geometry::SE2> BackEnd::find_in_local(std::span<const OrientedPoint> scan,
                                                    const SearchWindow& window, double min_score) {
  const CorrelativeMatch found = closer_.find(local_, submaps_[local_], scan, window, min_score);
  return found.is_unique() ? std::optional(found.peaks.front().T_map_base) : std::nullopt;
}

void BackEnd::add_keyframe(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
                           const Eigen::Matrix3d& information) {
  const std::size_t added = keyframes_.size();
  keyframes_.push_back(std::move(keyframe));
  submap_of_.push_back(local_);
  if (!has_local()) {
    begin_local();
  } else {
    keyframes_[added].T_map_base = submaps_[local_].T_map_submap * T_local_keyframe;
    add_chain_edge(added, T_local_keyframe, information);
    insert_into_submaps(T_local_keyframe);
  }
  const bool is_finished = is_full(submaps_[local_], 1.0);
  local_ += is_finished ? 1 : 0;
  close_loops();
  // One at a time; as long as there are more, with the next keyframe.
  const bool may_be_more = dropped_.has_value();
  dropped_.reset();
  if (is_finished || may_be_more) {
    drop_replaced_submap();
  }
}

void BackEnd::begin_local() {
  const std::size_t added = keyframes_.size() - 1;
  const Keyframe& keyframe = keyframes_[added];
  if (added > 0) {
    PoseEdge2d edge;
    edge.from = added - 1;
    edge.to = added;
    edge.T_from_to = keyframes_[added - 1].T_map_base.inverse() * keyframe.T_map_base;
    edge.information = begin_sigmas_.cwiseAbs2().cwiseInverse().asDiagonal();
    chain_.push_back(edge);
  }
  submaps_.emplace_back(added, keyframe.T_map_base, map_params_);
  submaps_.back().add({}, oriented_points(keyframe));
  if (local_ > 0) {
    graph_.add_chain_edge(chain_of_submaps(local_));
    ++graph_revision_;
  }
}

// Places within the submaps follow from the match alone: what the graph does to the submaps does
// not matter.
void BackEnd::insert_into_submaps(const geometry::SE2& T_local_keyframe) {
  const std::size_t added = keyframes_.size() - 1;
  const std::vector<OrientedPoint> points = oriented_points(keyframes_[added]);
  submaps_[local_].add(T_local_keyframe, points);
  if (submaps_.size() == local_ + 1 && is_full(submaps_[local_], 0.5)) {
    submaps_.emplace_back(added, keyframes_[added].T_map_base, map_params_);
    ++graph_revision_;
    submaps_.back().add({}, points);
    graph_.add_chain_edge(chain_of_submaps(local_ + 1));
  } else if (submaps_.size() > local_ + 1) {
    Submap& next = submaps_[local_ + 1];
    const geometry::SE2& T_local_next = submaps_[local_].pose_of(next.first_keyframe);
    next.add(T_local_next.inverse() * T_local_keyframe, points);
  }
}

void BackEnd::add_chain_edge(std::size_t keyframe, const geometry::SE2& T_local_keyframe,
                             const Eigen::Matrix3d& information) {
  const geometry::SE2& T_local_last = submaps_[local_].pose_of(keyframe - 1);
  PoseEdge2d edge;
  edge.from = keyframe - 1;
  edge.to = keyframe;
  edge.T_from_to = T_local_last.inverse() * T_local_keyframe;
  const geometry::SE2 T_odom_step =
      keyframes_[keyframe - 1].T_odom_base.inverse() * keyframes_[keyframe].T_odom_base;
  edge.information = kStepInformationFactor * rotated(information, -T_local_last.yaw) +
                     odometry_information(T_odom_step);
  chain_.push_back(edge);
}

registration::PoseEdge2d BackEnd::chain_of_submaps(std::size_t submap) const {
  const Submap& from = submaps_[submap - 1];
  PoseEdge2d edge;
  edge.from = submap - 1;
  edge.to = submap;
  // A submap that begins anew shares no keyframe with the last.
  const auto pose_in_from = [this, &from](std::size_t k) {
    return from.has(k) ? from.pose_of(k) : from.pose_of(k - 1) * chain_[k - 1].T_from_to;
  };
  edge.T_from_to = pose_in_from(submaps_[submap].first_keyframe);
  // The covariances of the steps between, at the end of their moment arms.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = from.first_keyframe; k < submaps_[submap].first_keyframe; ++k) {
    const Eigen::Vector2d moment_arm =
        edge.T_from_to.translation() - pose_in_from(k + 1).translation();
    const Eigen::Matrix3d J = moment_arm_jacobian(moment_arm);
    const Eigen::Matrix3d step = rotated(chain_[k].information.inverse(), from.pose_of(k).yaw);
    covariance += J * step * J.transpose();
  }
  edge.information = covariance.inverse();
  return edge;
}

// The two submaps before the local one were made along with it.
std::size_t BackEnd::end_finished() const {
  return std::max(num_separate_, std::max<std::size_t>(local_, 2) - 2);
}

void BackEnd::close_loops() {
  ++keyframes_since_optimised_;
  const std::size_t last = keyframes_.size() - 1;
  const bool is_search_due = last % kSearchEvery == 0;
  if (is_search_due || uncertainty_.size() != submaps_.size()) {
    uncertainty_ = graph_.uncertainties(submaps_, local_);
    // The same relative pose, seen from its other end.
    const Eigen::Matrix3d J = moment_arm_jacobian(submaps_[local_].T_map_submap.translation() -
                                                  submaps_[0].T_map_submap.translation());
    drift_covariance_ = J * uncertainty_[0] * J.transpose();
  }
  const std::size_t end_submap = end_finished();
  if (end_submap == 0) {
    return;
  }
  const double match_distance_m = params_.loop.match.max_distance_m;
  const std::vector<OrientedPoint> scan = some_points(keyframes_[last]);
  std::size_t tracked = 0;
  std::size_t searched = 0;
  for (const NearbySubmap& near :
       nearest_submaps(submaps_, keyframes_, keyframes_[last].T_map_base.translation(),
                       match_distance_m + params_.loop.search.max_distance_m, end_submap)) {
    const Eigen::Matrix3d& covariance = uncertainty_[near.submap];
    const double reach_m = kSigmas * std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
    const double reach_rad = kSigmas * std::sqrt(covariance(2, 2));
    if (near.distance_m > match_distance_m + reach_m) {
      continue;
    }
    if (reach_m <= kTrackDistanceM && reach_rad <= kTrackRotationRad) {
      if (tracked < kMaxTracked) {
        ++tracked;
        track_loop(near.submap, scan);
      }
    } else if (is_search_due && searched < kMaxSearches) {
      ++searched;
      search_loop(near.submap, scan, reach_m, reach_rad);
    }
  }
  const std::size_t optimise_every =
      std::max(kMinOptimiseEvery, submaps_.size() / kSubmapsPerKeyframe);
  if (has_searched_loops_ || (has_new_loops_ && keyframes_since_optimised_ >= optimise_every)) {
    optimise();
  }
}

void BackEnd::track_loop(std::size_t submap_index, std::span<const OrientedPoint> scan) {
  const Submap& submap = submaps_[submap_index];
  const geometry::SE2 T_submap_guess = submap.T_map_submap.inverse() * keyframes_.back().T_map_base;
  LoopAttempt attempt = closer_.track(submap, scan, T_submap_guess);
  Loop& loop = attempt.loop;
  loop.submap = submap_index;
  loop.keyframe = keyframes_.size() - 1;
  if (attempt.state != LoopState::kAccepted) {
    ++metrics_.refused_match;
    record(loop, attempt.state);
    return;
  }
  const Eigen::Vector3d off(
      loop.T_submap_keyframe.x - T_submap_guess.x, loop.T_submap_keyframe.y - T_submap_guess.y,
      geometry::angle_difference(loop.T_submap_keyframe.yaw, T_submap_guess.yaw));
  const Eigen::Matrix3d expected = rotated(uncertainty_[submap_index], -submap.T_map_submap.yaw) +
                                   covariance_of(loop.information);
  if (off.dot(expected.inverse() * off) > kMaxLoopChiSquared) {
    ++metrics_.refused_by_graph;
    accept_by_consensus(loop);
    return;
  }
  ++metrics_.loops_tracked;
  accept(loop);
}

void BackEnd::search_loop(std::size_t submap_index, std::span<const OrientedPoint> scan,
                          double reach_m, double reach_rad) {
  const Submap& submap = submaps_[submap_index];
  const SearchWindow window{
      submap.T_map_submap.inverse() * keyframes_.back().T_map_base,
      std::min(reach_m + kTrackDistanceM, params_.loop.search.max_distance_m),
      std::min(reach_rad + kTrackRotationRad, params_.loop.search.max_rotation_rad)};
  ++metrics_.searches;
  LoopAttempt attempt = closer_.search(submap_index, submap, scan, window);
  attempt.loop.submap = submap_index;
  attempt.loop.keyframe = keyframes_.size() - 1;
  if (attempt.state == LoopState::kAccepted) {
    accept_by_consensus(attempt.loop);
    return;
  }
  metrics_.refused_ambiguous += attempt.state == LoopState::kAmbiguous ? 1 : 0;
  metrics_.refused_match += attempt.state == LoopState::kLowScore ? 1 : 0;
  record(attempt.loop, attempt.state);
}

void BackEnd::accept_by_consensus(const Loop& loop) {
  record(loop, LoopState::kInconsistent);  // until others agree
  for (const Loop& accepted : closer_.add_pending(loop, submaps_, keyframes_)) {
    ++metrics_.loops_searched;
    accept(accepted);
    has_searched_loops_ = true;
  }
}

void BackEnd::accept(const Loop& loop) {
  // Between the submaps: the keyframe's own is as rigid as the one it was found in.
  const std::size_t own = submap_of_[loop.keyframe];
  const geometry::SE2 T_own_keyframe = submaps_[own].pose_of(loop.keyframe);
  const geometry::SE2 T_from_to = loop.T_submap_keyframe * T_own_keyframe.inverse();
  const Eigen::Matrix3d J =
      moment_arm_jacobian(loop.T_submap_keyframe.translation() - T_from_to.translation());
  const Eigen::Matrix3d information = J.transpose() * loop.information * J;
  graph_.add_loop(loop.submap, own, T_from_to, information);
  has_new_loops_ = true;
  record(loop, LoopState::kAccepted);
}

void BackEnd::record(const Loop& loop, LoopState state) {
  const std::size_t own = submap_of_[loop.keyframe];
  const auto [place, is_new] = loops_.try_emplace({loop.submap, own});
  SubmapLoop& known = place->second;
  if (is_new || state == LoopState::kAccepted || known.state != LoopState::kAccepted) {
    graph_revision_ += is_new || known.state != state ? 1 : 0;
    known = {loop.submap, own, state, loop.score};
  }
}

std::vector<SubmapLoop> BackEnd::loops() const {
  auto known = loops_;
  for (const PoseEdge2d& edge : graph_.loops()) {
    if (SubmapGraph::is_outlier(edge, submaps_)) {
      known.at({edge.from, edge.to}).state = LoopState::kOutlier;
    }
  }
  std::vector<SubmapLoop> loops;
  loops.reserve(known.size());
  for (const auto& [submaps, loop] : known) {
    loops.push_back(loop);
  }
  return loops;
}

void BackEnd::drop_replaced_submap() {
  const int num_newer = params_.submap.max_keyframes_per_place;
  if (num_newer == 0) {
    return;
  }
  if (const auto replaced =
          oldest_replaced_submap(submaps_, keyframes_, end_finished(), num_newer)) {
    drop_submap(*replaced);
  }
}

void BackEnd::drop_submap(std::size_t dropped) {
  graph_.drop_submap(dropped, submaps_);
  // Neighbours overlap: only keyframes that are in neither go with it.
  const std::size_t end_before = dropped > 0 ? submaps_[dropped - 1].end_keyframe() : 0;
  const std::size_t first = std::max(submaps_[dropped].first_keyframe, end_before);
  const std::size_t end = std::max(
      first, std::min(submaps_[dropped].end_keyframe(), submaps_[dropped + 1].first_keyframe));
  for (std::size_t k = submaps_[dropped].first_keyframe; k < submap_of_.size(); ++k) {
    const bool goes_to_next = submap_of_[k] == dropped && submaps_[dropped + 1].has(k);
    if (submap_of_[k] > 0 && submap_of_[k] >= dropped && !goes_to_next) {
      --submap_of_[k];
    }
  }
  dropped_ = drop_keyframes(first, end);
  submaps_.erase(submaps_.begin() + static_cast<std::ptrdiff_t>(dropped));
  for (std::size_t s = dropped; s < submaps_.size(); ++s) {
    submaps_[s].first_keyframe -= end - first;
  }
  --local_;
  num_separate_ -= dropped < num_separate_ ? 1 : 0;
  closer_.drop_submap(dropped, first, end);
  drop_from_loops(dropped);
  uncertainty_.clear();
  move_keyframes();
  ++graph_revision_;
  ++metrics_.submaps_dropped;
}

DroppedKeyframes BackEnd::drop_keyframes(std::size_t first, std::size_t end) {
  const auto at = [](auto& values, std::size_t index) {
    return values.begin() + static_cast<std::ptrdiff_t>(index);
  };
  // The steps over the gap become one.
  for (std::size_t k = first; first > 0 && k < end; ++k) {
    chain_[first - 1] = composed(chain_[first - 1], chain_[k]);
  }
  chain_.erase(at(chain_, first), at(chain_, end));
  for (std::size_t k = 0; k < chain_.size(); ++k) {
    chain_[k].from = k;
    chain_[k].to = k + 1;
  }
  DroppedKeyframes dropped{first,
                           {std::make_move_iterator(at(keyframes_, first)),
                            std::make_move_iterator(at(keyframes_, end))}};
  keyframes_.erase(at(keyframes_, first), at(keyframes_, end));
  submap_of_.erase(at(submap_of_, first), at(submap_of_, end));
  return dropped;
}

void BackEnd::drop_from_loops(std::size_t dropped) {
  std::map<std::pair<std::size_t, std::size_t>, SubmapLoop> kept;
  double score = 0.0;  // of the loops that have got a new end
  for (auto [pair, loop] : loops_) {
    if (loop.from == dropped || loop.to == dropped) {
      score = std::max(score, loop.state == LoopState::kAccepted ? loop.score : 0.0);
      continue;
    }
    loop.from -= loop.from > dropped ? 1 : 0;
    loop.to -= loop.to > dropped ? 1 : 0;
    kept[{loop.from, loop.to}] = loop;
  }
  for (const PoseEdge2d& edge : graph_.loops()) {
    SubmapLoop& loop = kept[{edge.from, edge.to}];
    if (loop.state != LoopState::kAccepted) {
      loop = {edge.from, edge.to, LoopState::kAccepted, score};
    }
  }
  loops_ = std::move(kept);
}

void BackEnd::optimise() {
  graph_.optimise(submaps_, has_searched_loops_);
  move_keyframes();
  ++metrics_.optimisations;
  ++graph_revision_;
  keyframes_since_optimised_ = 0;
  has_new_loops_ = false;
  has_searched_loops_ = false;
}

void BackEnd::move_keyframes() {
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    const Submap& submap = submaps_[submap_of_[k]];
    keyframes_[k].T_map_base = submap.T_map_submap * submap.pose_of(k);
  }
}

void BackEnd::polish() {
  for (int round = 0; round < params_.polish.rounds; ++round) {
    if (round > 0) {
      rebuild_submaps();
    }
    const KeyframeGraph graph{keyframes_, submaps_, chain_};
    const std::vector<geometry::SE2> poses =
        graph.polished(closer_, params_.loop.match.max_distance_m);
    for (std::size_t k = 0; k < keyframes_.size(); ++k) {
      keyframes_[k].T_map_base = poses[k];
    }
  }
}

void BackEnd::rebuild_submaps() {
  for (Submap& submap : submaps_) {
    submap = build_submap(submap.first_keyframe, submap.end_keyframe());
  }
}

Submap BackEnd::build_submap(std::size_t first_keyframe, std::size_t end_keyframe) const {
  Submap submap(first_keyframe, keyframes_[first_keyframe].T_map_base, map_params_);
  for (std::size_t k = first_keyframe; k < end_keyframe; ++k) {
    submap.add(submap.T_map_submap.inverse() * keyframes_[k].T_map_base,
               oriented_points(keyframes_[k]));
  }
  return submap;
}

}  // namespace nodmap::slam2d
