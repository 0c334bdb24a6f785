// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/relocaliser.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "modules/slam2d/best_place.hpp"

namespace nodmap::slam2d {
namespace {

// If there are more peaks, the scan determines nothing. In the search, with cells of 10 cm, a bare
// wall fits most walls of a building nearly as well; only the exact match distinguishes them.
constexpr std::size_t kMaxPeaks = 256;
constexpr double kMaxCorrespondenceDistanceM = 0.4;   // the search is off by up to a cell of 10 cm
constexpr double kMinCorrespondenceDistanceM = 0.15;  // wrong places fit only roughly

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

Relocaliser::Relocaliser(const RelocaliserParams& params, const MatcherParams& matcher)
    : params_(params), correlative_(search_params(params)), matcher_(matcher_params(matcher)) {}

bool Relocaliser::agree(const geometry::SE2& a, const geometry::SE2& b) const {
  return geometry::distance_m(a, b) < params_.same_place_distance_m &&
         std::abs(geometry::angle_difference(a.yaw, b.yaw)) < params_.same_place_rotation_rad;
}

Relocalisation Relocaliser::locate(const KnownMap& map, const LevelScan& scan) const {
  return locate(map, {&scan, 1});
}

Relocalisation Relocaliser::locate(const KnownMap& map, std::span<const LevelScan> scans) const {
  std::vector<Places> found;
  for (const LevelScan& scan : scans) {
    found.push_back(find_places(map, scan));
  }
  return scans.size() == 1 ? found.front().alone : join(map, scans, found);
}

Relocaliser::Places Relocaliser::find_places(const KnownMap& map, const LevelScan& scan) const {
  const CorrelativeMatch search = correlative_.search(
      map.likelihood(), points_to_search(scan.points_base), map.window(), kMaxPeaks);
  Places found;
  for (const Peak& peak : search.peaks) {
    if (const std::optional<Peak> place = match(map, scan, peak.T_map_base)) {
      found.peaks.push_back(*place);
    }
  }
  found.is_complete = search.complete && search.peaks.size() < kMaxPeaks;
  found.alone = classify(found.peaks, found.is_complete);
  return found;
}

std::optional<Peak> Relocaliser::match(const KnownMap& map, const LevelScan& scan,
                                       const geometry::SE2& T_map_base) const {
  const Match match = matcher_.match(map.points(), scan.points_base, T_map_base);
  if (!match.found()) {
    return std::nullopt;
  }
  const double through_walls =
      map.through_walls(scan.points_base, scan.sensor_origin_base, match.T_map_base);
  return Peak{match.T_map_base, match.score - through_walls};
}

Relocalisation Relocaliser::classify(std::span<const Peak> places, bool is_complete) const {
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
  } else if (!best.is_clear(params_.min_misfit_ratio) || !is_complete) {
    result.status = Relocalisation::Status::kAmbiguous;
  } else {
    result.status = Relocalisation::Status::kFound;
  }
  return result;
}

Relocalisation Relocaliser::join(const KnownMap& map, std::span<const LevelScan> scans,
                                 std::span<const Places> found) const {
  std::vector<JointFit> fits;
  std::vector<Peak> places;
  bool is_complete = false;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const geometry::SE2 T_base_last = scans[i].T_odom_base.inverse() * scans.back().T_odom_base;
    for (const Peak& peak : found[i].peaks) {
      fits.push_back(fit(map, scans, found, peak.T_map_base * T_base_last));
      places.push_back(fits.back().place);
    }
    is_complete = is_complete || found[i].is_complete;
  }
  Relocalisation result = classify(places, is_complete);
  if (places.empty()) {
    return result;
  }
  const JointFit& best = fits[best_of(places).index];
  if (!best.agrees) {
    result.status = Relocalisation::Status::kNowhere;
  } else if (best.is_sure) {
    result.status = Relocalisation::Status::kFound;
  }
  return result;
}

std::optional<Peak> Relocaliser::best_near(std::span<const Peak> places,
                                           const geometry::SE2& T_map_base) const {
  std::optional<Peak> best;
  for (const Peak& place : places) {
    if (agree(place.T_map_base, T_map_base) && (!best || place.score > best->score)) {
      best = place;
    }
  }
  return best;
}

// The scan's own place near there counts if it has one, otherwise a match from there.
Relocaliser::ScanFit Relocaliser::fit(const KnownMap& map, const LevelScan& scan,
                                      const Places& found, const geometry::SE2& T_map_base) const {
  const std::optional<Peak> own = best_near(found.peaks, T_map_base);
  const bool is_sure = found.alone.status == Relocalisation::Status::kFound;
  const bool is_sure_of_this =
      is_sure && own && is_same_place(own->T_map_base, found.alone.T_map_base);
  ScanFit fit{.match = own ? own : match(map, scan, T_map_base), .is_sure = is_sure_of_this};
  fit.agrees = is_sure == is_sure_of_this && fit.match && fit.match->score >= params_.min_score &&
               agree(fit.match->T_map_base, T_map_base);
  return fit;
}

Relocaliser::JointFit Relocaliser::fit(const KnownMap& map, std::span<const LevelScan> scans,
                                       std::span<const Places> found,
                                       const geometry::SE2& T_map_last) const {
  JointFit joint{.place = {T_map_last}};
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const geometry::SE2 T_last_base = scans.back().T_odom_base.inverse() * scans[i].T_odom_base;
    const ScanFit one = fit(map, scans[i], found[i], T_map_last * T_last_base);
    joint.agrees = joint.agrees && one.agrees;
    joint.is_sure = joint.is_sure || one.is_sure;
    if (one.match) {
      joint.place.score += one.match->score / static_cast<double>(scans.size());
    }
    if (one.match && i + 1 == scans.size()) {
      joint.place.T_map_base = one.match->T_map_base;
    }
  }
  return joint;
}

}  // namespace nodmap::slam2d
