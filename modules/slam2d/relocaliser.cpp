// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/relocaliser.hpp"

#include <algorithm>
#include <vector>

#include "modules/slam2d/best_place.hpp"

namespace nodmap::slam2d {
namespace {

constexpr std::size_t kMaxPeaks = 24;                // more places mean that the scan tells nothing
constexpr double kMaxCorrespondenceDistanceM = 0.4;  // the search is a cell of 10 cm off
constexpr double kMinCorrespondenceDistanceM = 0.15;  // other places fit only roughly

LoopSearchParams search_params(const RelocaliserParams& params) {
  return {.min_score = params.min_search_score, .max_runner_up_ratio = params.min_peak_ratio};
}

MatcherParams matcher_params(MatcherParams params) {
  params.max_correspondence_distance_m =
      std::min(params.max_correspondence_distance_m, kMaxCorrespondenceDistanceM);
  params.min_correspondence_distance_m =
      std::min(params.min_correspondence_distance_m, kMinCorrespondenceDistanceM);
  return params;
}

}  // namespace

void RecentScans::add(const LevelScan& scan) {
  scans_.push_back({scan.T_odom_base, {scan.points_base.begin(), scan.points_base.end()}});
  if (scans_.size() > num_scans_) {
    scans_.pop_front();
  }
}

std::vector<OrientedPoint> RecentScans::points_base() const {
  std::vector<OrientedPoint> points;
  for (const PlacedScan& scan : scans_) {
    const geometry::SE2 T_last_base = scans_.back().T_odom_base.inverse() * scan.T_odom_base;
    const std::vector<OrientedPoint> placed = transformed(T_last_base, scan.points_base);
    points.insert(points.end(), placed.begin(), placed.end());
  }
  return points;
}

Relocaliser::Relocaliser(const RelocaliserParams& params, const MatcherParams& matcher)
    : params_(params), correlative_(search_params(params)), matcher_(matcher_params(matcher)) {}

Relocalisation Relocaliser::locate(const KnownMap& map, std::span<const OrientedPoint> scan,
                                   const Eigen::Vector2d& sensor_origin_base) const {
  const CorrelativeMatch search =
      correlative_.search(map.likelihood(), points_to_search(scan), map.window(), kMaxPeaks);
  std::vector<Peak> places;
  for (const Peak& peak : search.peaks) {
    const Match match = matcher_.match(map.points(), scan, peak.T_map_base);
    if (!match.found()) {
      continue;
    }
    const GridFit fit = map.fit(scan, sensor_origin_base, match.T_map_base);
    places.push_back({match.T_map_base, match.score - fit.through_walls});
  }
  Relocalisation result;
  if (places.empty()) {
    return result;
  }
  const BestPlace best = best_of(places);
  result.T_map_base = places[best.index].T_map_base;
  result.score = best.score;
  result.runner_up_score = best.runner_up_score;
  if (result.score < params_.min_score) {
    result.status = Relocalisation::Status::kNowhere;
  } else if (!best.is_clear(params_.min_misfit_ratio) || search.peaks.size() == kMaxPeaks ||
             !search.complete) {
    result.status = Relocalisation::Status::kAmbiguous;
  } else {
    result.status = Relocalisation::Status::kFound;
  }
  return result;
}

}  // namespace nodmap::slam2d
