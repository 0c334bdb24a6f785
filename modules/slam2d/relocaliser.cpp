// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/relocaliser.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
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

// Along the direction that a match determines least. Farther off is another place; a pose that is
// nearer is right.
constexpr std::array kBesideM{-0.45, -0.35, -0.25, 0.25, 0.35, 0.45};

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

// How well scans lie on the walls of the map, and not behind walls, if the last one was taken at
// `T_map_last` and odometry is right.
double mean_wall_score(const KnownMap& map, std::span<const LevelScan> scans,
                       const geometry::SE2& T_map_last) {
  double sum = 0.0;
  for (const LevelScan& scan : scans) {
    const geometry::SE2 T_map_base =
        T_map_last * (scans.back().T_odom_base.inverse() * scan.T_odom_base);
    sum += map.fit_walls(scan.points_base, scan.sensor_origin_base, T_map_base).score();
  }
  return sum / static_cast<double>(scans.size());
}

}  // namespace

Relocaliser::Relocaliser(const RelocaliserParams& params, const MatcherParams& matcher)
    : params_(params), correlative_(search_params(params)), matcher_(matcher_params(matcher)) {}

bool Relocaliser::agree(const geometry::SE2& a, const geometry::SE2& b) const {
  return geometry::distance_m(a, b) < params_.same_place_distance_m &&
         std::abs(geometry::angle_difference(a.yaw, b.yaw)) < params_.same_place_rotation_rad;
}

Relocalisation Relocaliser::locate(const KnownMap& map, const LevelScan& scan) const {
  return locate(map, map.window(), scan);
}

Relocalisation Relocaliser::locate(const KnownMap& map, const SearchWindow& window,
                                   const LevelScan& scan) const {
  return find_places(map, window, scan).alone;
}

Relocalisation Relocaliser::locate(const KnownMap& map, std::span<const LevelScan> scans) const {
  std::vector<Places> found;
  for (const LevelScan& scan : scans) {
    found.push_back(find_places(map, map.window(), scan));
  }
  return scans.size() == 1 ? found.front().alone : join(map, scans, found);
}

Relocaliser::Places Relocaliser::find_places(const KnownMap& map, const SearchWindow& window,
                                             const LevelScan& scan) const {
  const CorrelativeMatch search =
      correlative_.search(map.likelihood(), points_to_search(scan.points_base), window, kMaxPeaks);
  Places found;
  for (const Peak& peak : search.peaks) {
    if (const std::optional<Place> place = match(map, scan, peak.T_target_base)) {
      found.places.push_back(*place);
    }
  }
  found.is_complete = search.complete && search.peaks.size() < kMaxPeaks;
  found.alone = classify(map, {&scan, 1}, found.places, found.is_complete);
  return found;
}

std::optional<Relocaliser::Place> Relocaliser::match(const KnownMap& map, const LevelScan& scan,
                                                     const geometry::SE2& T_map_guess) const {
  const Match match = matcher_.match(map.points(), scan.points_base, T_map_guess);
  if (!match.found()) {
    return std::nullopt;
  }
  const geometry::SE2& T_map_base = match.T_target_base;
  const WallFit walls = map.fit_walls(scan.points_base, scan.sensor_origin_base, T_map_base);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
      match.information.topLeftCorner<2, 2>());
  return Place{T_map_base, match.score - walls.through_walls, walls.score(),
               solver.eigenvectors().col(0)};
}

std::size_t Relocaliser::best_of(std::span<const Place> places) {
  const auto best = std::max_element(
      places.begin(), places.end(),
      [](const Place& a, const Place& b) { return a.match_score < b.match_score; });
  return static_cast<std::size_t>(best - places.begin());
}

// Along a corridor with few features a scan fits as well a little farther on.
double Relocaliser::score_beside(const KnownMap& map, std::span<const LevelScan> scans,
                                 const Place& place) {
  double score = 0.0;
  for (const double distance_m : kBesideM) {
    const Eigen::Vector2d beside =
        place.T_map_base.translation() + distance_m * place.least_determined;
    score = std::max(score,
                     mean_wall_score(map, scans, {beside.x(), beside.y(), place.T_map_base.yaw}));
  }
  return score;
}

// Elsewhere is any other place, and beside the best one.
BestPlace Relocaliser::compare(const KnownMap& map, std::span<const LevelScan> scans,
                               std::span<const Place> places) {
  const std::size_t index = best_of(places);
  BestPlace best{.index = index,
                 .score = places[index].wall_score,
                 .runner_up_score = score_beside(map, scans, places[index])};
  for (const Place& place : places) {
    if (!is_same_place(place.T_map_base, places[index].T_map_base)) {
      best.runner_up_score = std::max(best.runner_up_score, place.wall_score);
    }
  }
  return best;
}

Relocalisation Relocaliser::classify(const KnownMap& map, std::span<const LevelScan> scans,
                                     std::span<const Place> places, bool is_complete) const {
  Relocalisation result;
  if (places.empty()) {
    return result;
  }
  const BestPlace best = compare(map, scans, places);
  result.T_map_base = places[best.index].T_map_base;
  result.score = best.score;
  result.runner_up_score = best.runner_up_score;
  if (places[best.index].match_score < params_.min_score) {
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
  std::vector<Place> places;
  bool is_complete = false;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const geometry::SE2 T_base_last = scans[i].T_odom_base.inverse() * scans.back().T_odom_base;
    for (const Place& place : found[i].places) {
      fits.push_back(fit(map, scans, found, place.T_map_base * T_base_last));
      places.push_back(fits.back().place);
    }
    is_complete = is_complete || found[i].is_complete;
  }
  Relocalisation result = classify(map, scans, places, is_complete);
  if (places.empty()) {
    return result;
  }
  const JointFit& best = fits[best_of(places)];
  if (!best.agrees) {
    result.status = Relocalisation::Status::kNowhere;
  } else if (best.is_sure && BestPlace{.score = best.place.wall_score,
                                       .runner_up_score = score_beside(map, scans, best.place)}
                                 .is_clear(params_.min_misfit_ratio)) {
    result.status = Relocalisation::Status::kFound;
  }
  return result;
}

std::optional<Relocaliser::Place> Relocaliser::best_near(std::span<const Place> places,
                                                         const geometry::SE2& T_map_base) const {
  std::optional<Place> best;
  for (const Place& place : places) {
    if (agree(place.T_map_base, T_map_base) && (!best || place.match_score > best->match_score)) {
      best = place;
    }
  }
  return best;
}

// The scan's own place near there counts if it has one, otherwise a match from there.
Relocaliser::ScanFit Relocaliser::fit(const KnownMap& map, const LevelScan& scan,
                                      const Places& found, const geometry::SE2& T_map_base) const {
  const std::optional<Place> own = best_near(found.places, T_map_base);
  const bool is_sure = found.alone.status == Relocalisation::Status::kFound;
  const bool is_sure_of_this =
      is_sure && own && is_same_place(own->T_map_base, found.alone.T_map_base);
  ScanFit fit{.match = own ? own : match(map, scan, T_map_base), .is_sure = is_sure_of_this};
  fit.agrees = is_sure == is_sure_of_this && fit.match &&
               fit.match->match_score >= params_.min_score &&
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
      joint.place.match_score += one.match->match_score / static_cast<double>(scans.size());
      joint.place.wall_score += one.match->wall_score / static_cast<double>(scans.size());
    }
    if (one.match && i + 1 == scans.size()) {
      joint.place.T_map_base = one.match->T_map_base;
      joint.place.least_determined = one.match->least_determined;
    }
  }
  return joint;
}

}  // namespace nodmap::slam2d
