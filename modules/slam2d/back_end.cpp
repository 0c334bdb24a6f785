// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace nodmap::slam2d {
namespace {

using registration::PoseEdge2d;
using registration::PoseGraph2d;

constexpr std::size_t kNeighbours = 3;  // submaps that a keyframe is matched against
// The work on one keyframe is bounded.
constexpr std::size_t kMaxTracked = 2;
constexpr std::size_t kMaxSearches = 2;
constexpr std::size_t kSearchEvery = 3;      // keyframes
constexpr std::size_t kMaxScanPoints = 120;  // enough to match one scan
constexpr std::size_t kOptimiseEvery = 3;
constexpr double kSigmas = 3.0;
// Nearer than this by the graph, a match finds the place without a search.
constexpr double kTrackDistanceM = 0.35;
constexpr double kTrackRotationRad = 0.1;
// Of three degrees of freedom, one true loop of a thousand is beyond.
constexpr double kMaxLoopChiSquared = 16.3;

// Both ends of a step are matched against the same submap, and most of their errors are alike. By
// this the steps through half a submap are twice as unsure as one match.
constexpr double kStepSharpness = 5.0;

double distance(const geometry::SE2& a, const geometry::SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

Eigen::Matrix3d rotated(const Eigen::Matrix3d& information, double yaw) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = geometry::SE2{0.0, 0.0, yaw}.rotation();
  return R * information * R.transpose();
}

/// Finite also where a direction is open.
Eigen::Matrix3d covariance_of(const Eigen::Matrix3d& information) {
  return (information + 1e-6 * Eigen::Matrix3d::Identity()).inverse();
}

/// What odometry alone says on a step, in the frame of its start. Errors of wheels are no white
/// noise but go on the same distance_m: the figures hold for 30 m.
Eigen::Matrix3d odometry_information(const geometry::SE2& step) {
  const double distance_m = std::hypot(step.x, step.y);
  const double sigma_m = 0.01 + 0.2 * distance_m;
  const double sigma_rad = 0.02 + 0.1 * std::abs(step.yaw) + 0.05 * distance_m;
  return Eigen::Vector3d(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m),
                         1.0 / (sigma_rad * sigma_rad))
      .asDiagonal();
}

/// At most `kMaxScanPoints` of the points of a keyframe, spread over the scan.
std::vector<OrientedPoint> some_points(const Keyframe& keyframe) {
  const std::vector<OrientedPoint> all = oriented_points(keyframe);
  const std::size_t stride = (all.size() + kMaxScanPoints - 1) / kMaxScanPoints;
  std::vector<OrientedPoint> some;
  for (std::size_t i = 0; i < all.size(); i += stride) {
    some.push_back(all[i]);
  }
  return some;
}

/// How a change of the pose at the start of a moment_arm moves its end.
Eigen::Matrix3d along_moment_arm(const Eigen::Vector2d& moment_arm) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = -moment_arm.y();
  J(1, 2) = moment_arm.x();
  return J;
}

}  // namespace

BackEnd::BackEnd(const BackEndParams& params, const MapParams& map, const MatcherParams& matcher)
    : params_(params), map_params_(map), closer_(params.loop, matcher) {
  submaps_.emplace_back(0, geometry::SE2{}, map);
}

std::size_t BackEnd::num_points() const {
  std::size_t sum = 0;
  for (const Submap& submap : submaps_) {
    sum += submap.points.points().size();
  }
  return sum;
}

bool BackEnd::is_full(const Submap& submap, double share) const {
  return static_cast<double>(submap.T_submap_keyframe.size()) >=
         share * params_.submap.num_keyframes;
}

void BackEnd::add_keyframe(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
                           const Eigen::Matrix3d& information) {
  const std::size_t added = keyframes_.size();
  keyframes_.push_back(std::move(keyframe));
  if (added == 0) {
    submaps_[0].T_map_submap = keyframes_[0].T_map_base;
  } else {
    keyframes_[added].T_map_base = submaps_[local_].T_map_submap * T_local_keyframe;
    add_chain_edge(added, T_local_keyframe, information);
  }
  submap_of_.push_back(local_);
  insert_into_submaps(T_local_keyframe);
  if (is_full(submaps_[local_], 1.0)) {
    ++local_;
  }
  close_loops();
}

// Places within the submaps follow from the match alone: what the graph does to the submaps does
// not matter.
void BackEnd::insert_into_submaps(const geometry::SE2& T_local_keyframe) {
  const std::size_t added = keyframes_.size() - 1;
  const std::vector<OrientedPoint> points = oriented_points(keyframes_[added]);
  submaps_[local_].add(T_local_keyframe, points);
  if (submaps_.size() == local_ + 1 && is_full(submaps_[local_], 0.5)) {
    submaps_.emplace_back(added, keyframes_[added].T_map_base, map_params_);
    submaps_.back().add({}, points);
    submap_chain_.push_back(chain_of_submaps(local_ + 1));
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
  edge.information =
      kStepSharpness * rotated(information, -T_local_last.yaw) + odometry_information(T_odom_step);
  chain_.push_back(edge);
}

registration::PoseEdge2d BackEnd::chain_of_submaps(std::size_t submap) const {
  const Submap& from = submaps_[submap - 1];
  PoseEdge2d edge;
  edge.from = submap - 1;
  edge.to = submap;
  edge.T_from_to = from.pose_of(submaps_[submap].first_keyframe);
  // The covariances of the steps between, at the far end of their moment arms.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = from.first_keyframe; k < submaps_[submap].first_keyframe; ++k) {
    const Eigen::Vector2d moment_arm =
        edge.T_from_to.translation() - from.pose_of(k + 1).translation();
    const Eigen::Matrix3d J = along_moment_arm(moment_arm);
    const Eigen::Matrix3d step = rotated(chain_[k].information.inverse(), from.pose_of(k).yaw);
    covariance += J * step * J.transpose();
  }
  edge.information = covariance.inverse();
  return edge;
}

// Dijkstra's algorithm on the graph of the submaps, by the size of the covariance (Olson 2008,
// section 4.2.3). Paths are not fused: what comes out is never too sure.
std::vector<Eigen::Matrix3d> BackEnd::uncertainties() const {
  struct Neighbour {
    std::size_t submap;
    Eigen::Matrix3d covariance_map;  // of the step, turned into the map
  };
  std::vector<std::vector<Neighbour>> neighbours(submaps_.size());
  const auto join = [&](std::size_t from, std::size_t to, const Eigen::Matrix3d& information) {
    const Eigen::Matrix3d covariance =
        rotated(covariance_of(information), submaps_[from].T_map_submap.yaw);
    neighbours[from].push_back({to, covariance});
    neighbours[to].push_back({from, covariance});
  };
  for (const PoseEdge2d& edge : submap_chain_) {
    join(edge.from, edge.to, edge.information);
  }
  for (const auto& [pair, loop] : loops_) {
    join(pair.first, pair.second, loop.information);
  }
  constexpr double kYawMomentArmM = 5.0;
  const auto size_of = [](const Eigen::Matrix3d& covariance) {
    return covariance(0, 0) + covariance(1, 1) + kYawMomentArmM * kYawMomentArmM * covariance(2, 2);
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<Eigen::Matrix3d> found(submaps_.size(), Eigen::Matrix3d::Identity() * 1e6);
  std::vector<double> size(submaps_.size(), kInfinity);
  std::vector<bool> done(submaps_.size(), false);
  std::vector<std::pair<double, std::size_t>> open;  // a heap, the smallest on top
  found[local_].setZero();
  size[local_] = 0.0;
  open.emplace_back(0.0, local_);
  while (!open.empty()) {
    std::pop_heap(open.begin(), open.end(), std::greater<>());
    const std::size_t at = open.back().second;
    open.pop_back();
    if (done[at]) {
      continue;
    }
    done[at] = true;
    for (const Neighbour& next : neighbours[at]) {
      const Eigen::Matrix3d J = along_moment_arm(submaps_[next.submap].T_map_submap.translation() -
                                                 submaps_[at].T_map_submap.translation());
      const Eigen::Matrix3d covariance = J * found[at] * J.transpose() + next.covariance_map;
      if (size_of(covariance) < size[next.submap]) {
        size[next.submap] = size_of(covariance);
        found[next.submap] = covariance;
        open.emplace_back(size[next.submap], next.submap);
        std::push_heap(open.begin(), open.end(), std::greater<>());
      }
    }
  }
  return found;
}

std::vector<BackEnd::Nearby> BackEnd::nearest_submaps(std::size_t keyframe, double distance_m,
                                                      std::size_t end_submap) const {
  std::vector<Nearby> found;
  const Eigen::Vector2d here = keyframes_[keyframe].T_map_base.translation();
  // Overlapping submaps see the same: every other one is enough.
  for (std::size_t s = 0; s < end_submap; s += 2) {
    double nearest_m2 = std::numeric_limits<double>::infinity();
    for (std::size_t k = submaps_[s].first_keyframe; k < submaps_[s].end_keyframe(); ++k) {
      nearest_m2 =
          std::min(nearest_m2, (keyframes_[k].T_map_base.translation() - here).squaredNorm());
    }
    if (nearest_m2 < distance_m * distance_m) {
      found.push_back({std::sqrt(nearest_m2), s});
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

void BackEnd::close_loops() {
  ++keyframes_since_optimised_;
  if (local_ < 3) {
    return;
  }
  const std::size_t last = keyframes_.size() - 1;
  const bool is_search_due = last % kSearchEvery == 0;
  if (is_search_due || uncertainty_.size() != submaps_.size()) {
    uncertainty_ = uncertainties();
  }
  const double match_distance_m = params_.loop.match.max_distance_m;
  const std::vector<OrientedPoint> scan = some_points(keyframes_[last]);
  std::size_t tracked = 0;
  std::size_t searched = 0;
  for (const Nearby& near :
       nearest_submaps(last, match_distance_m + params_.loop.search.max_distance_m, local_ - 2)) {
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
  if (has_searched_loops_ || (has_new_loops_ && keyframes_since_optimised_ >= kOptimiseEvery)) {
    optimise();
  }
}

void BackEnd::track_loop(std::size_t submap_index, std::span<const OrientedPoint> scan) {
  const Submap& submap = submaps_[submap_index];
  const geometry::SE2 T_submap_guess = submap.T_map_submap.inverse() * keyframes_.back().T_map_base;
  auto loop = closer_.track(submap, scan, T_submap_guess);
  if (!loop) {
    ++metrics_.refused_match;
    return;
  }
  loop->submap = submap_index;
  loop->keyframe = keyframes_.size() - 1;
  const Eigen::Vector3d off(
      loop->T_submap_keyframe.x - T_submap_guess.x, loop->T_submap_keyframe.y - T_submap_guess.y,
      geometry::angle_difference(loop->T_submap_keyframe.yaw, T_submap_guess.yaw));
  const Eigen::Matrix3d expected = rotated(uncertainty_[submap_index], -submap.T_map_submap.yaw) +
                                   covariance_of(loop->information);
  if (off.dot(expected.inverse() * off) > kMaxLoopChiSquared) {
    ++metrics_.refused_by_graph;
    accept_if_agreed(*loop);
    return;
  }
  ++metrics_.loops_tracked;
  accept(*loop);
}

void BackEnd::search_loop(std::size_t submap_index, std::span<const OrientedPoint> scan,
                          double reach_m, double reach_rad) {
  const Submap& submap = submaps_[submap_index];
  const SearchWindow window{
      submap.T_map_submap.inverse() * keyframes_.back().T_map_base,
      std::min(reach_m + kTrackDistanceM, params_.loop.search.max_distance_m),
      std::min(reach_rad + kTrackRotationRad, params_.loop.search.max_rotation_rad)};
  ++metrics_.searches;
  LoopRefusal refusal = LoopRefusal::kNone;
  auto loop = closer_.search(submap_index, submap, scan, window, refusal);
  metrics_.refused_ambiguous += refusal == LoopRefusal::kAmbiguous ? 1 : 0;
  metrics_.refused_match += refusal == LoopRefusal::kPoorMatch ? 1 : 0;
  if (loop) {
    loop->keyframe = keyframes_.size() - 1;
    accept_if_agreed(*loop);
  }
}

void BackEnd::accept_if_agreed(const Loop& loop) {
  for (const Loop& agreed : closer_.add_pending(loop, submaps_, keyframes_)) {
    ++metrics_.loops_searched;
    accept(agreed);
    has_searched_loops_ = true;
  }
}

void BackEnd::accept(const Loop& loop) {
  // Between the submaps: the keyframe's own is as rigid as the one it was found in.
  const std::size_t own = submap_of_[loop.keyframe];
  const geometry::SE2 T_own_keyframe = submaps_[own].pose_of(loop.keyframe);
  const geometry::SE2 T_from_to = loop.T_submap_keyframe * T_own_keyframe.inverse();
  const Eigen::Matrix3d J =
      along_moment_arm(loop.T_submap_keyframe.translation() - T_from_to.translation());
  const Eigen::Matrix3d information = J.transpose() * loop.information * J;
  auto [place, is_new] = loops_.try_emplace({loop.submap, own});
  LoopSum& sum = place->second;
  if (is_new) {
    sum.T_from_to = T_from_to;
  }
  const Eigen::Vector3d offset(T_from_to.x - sum.T_from_to.x, T_from_to.y - sum.T_from_to.y,
                               geometry::angle_difference(T_from_to.yaw, sum.T_from_to.yaw));
  sum.information += information;
  sum.weighted_offset += information * offset;
  has_new_loops_ = true;
}

void BackEnd::optimise() {
  PoseGraph2d graph;
  for (const Submap& submap : submaps_) {
    graph.add_node(submap.T_map_submap);
  }
  for (const PoseEdge2d& edge : submap_chain_) {
    graph.add_edge(edge);
  }
  for (const auto& [pair, loop] : loops_) {
    const Eigen::Vector3d offset = covariance_of(loop.information) * loop.weighted_offset;
    PoseEdge2d edge;
    edge.from = pair.first;
    edge.to = pair.second;
    edge.T_from_to = {loop.T_from_to.x + offset.x(), loop.T_from_to.y + offset.y(),
                      geometry::normalize_angle(loop.T_from_to.yaw + offset.z())};
    edge.information = loop.information;
    edge.may_be_wrong = true;
    graph.add_edge(edge);
  }
  graph.optimise(has_searched_loops_, has_searched_loops_ ? 60 : 2);
  for (std::size_t s = 0; s < submaps_.size(); ++s) {
    submaps_[s].T_map_submap = graph.nodes()[s];
  }
  move_keyframes();
  ++metrics_.optimisations;
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
    PoseGraph2d graph;
    for (const Keyframe& keyframe : keyframes_) {
      graph.add_node(keyframe.T_map_base);
    }
    for (const PoseEdge2d& edge : chain_) {
      graph.add_edge(edge);
    }
    for (const PoseEdge2d& edge : matches_all_around()) {
      graph.add_edge(edge);
    }
    graph.optimise(false, 20);
    for (std::size_t k = 0; k < keyframes_.size(); ++k) {
      keyframes_[k].T_map_base = graph.nodes()[k];
    }
  }
}

std::vector<PoseEdge2d> BackEnd::matches_all_around() const {
  std::vector<PoseEdge2d> edges;
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    const std::vector<OrientedPoint> scan = some_points(keyframes_[k]);
    std::size_t matched = 0;
    for (const Nearby& near :
         nearest_submaps(k, params_.loop.match.max_distance_m, submaps_.size())) {
      const Submap& submap = submaps_[near.submap];
      if (submap.has(k) || matched == kNeighbours) {
        continue;
      }
      ++matched;
      const auto loop =
          closer_.track(submap, scan, submap.T_map_submap.inverse() * keyframes_[k].T_map_base);
      if (loop) {
        edges.push_back(edge_to_nearest(submap, *loop, k));
      }
    }
  }
  return edges;
}

// From the nearest keyframe of the submap: what lies between may bend.
PoseEdge2d BackEnd::edge_to_nearest(const Submap& submap, const Loop& loop, std::size_t keyframe) {
  std::size_t nearest = submap.first_keyframe;
  for (std::size_t k = nearest; k < submap.end_keyframe(); ++k) {
    if (distance(submap.pose_of(k), loop.T_submap_keyframe) <
        distance(submap.pose_of(nearest), loop.T_submap_keyframe)) {
      nearest = k;
    }
  }
  PoseEdge2d edge;
  edge.from = nearest;
  edge.to = keyframe;
  edge.T_from_to = submap.pose_of(nearest).inverse() * loop.T_submap_keyframe;
  edge.information = rotated(loop.information, -submap.pose_of(nearest).yaw);
  edge.may_be_wrong = true;
  return edge;
}

void BackEnd::rebuild_submaps() {
  for (Submap& submap : submaps_) {
    Submap anew(submap.first_keyframe, keyframes_[submap.first_keyframe].T_map_base, map_params_);
    for (std::size_t k = submap.first_keyframe; k < submap.end_keyframe(); ++k) {
      anew.add(anew.T_map_submap.inverse() * keyframes_[k].T_map_base,
               oriented_points(keyframes_[k]));
    }
    submap = std::move(anew);
  }
}

}  // namespace nodmap::slam2d
