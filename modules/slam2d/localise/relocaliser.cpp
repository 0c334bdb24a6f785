// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/localise/relocaliser.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <vector>

#include "modules/slam2d/matching/best_place.hpp"

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

MatcherParams matcher_params(MatcherParams params) {
  params.max_correspondence_distance_m =
      std::min(params.max_correspondence_distance_m, kMaxCorrespondenceDistanceM);
  params.min_correspondence_distance_m =
      std::min(params.min_correspondence_distance_m, kMinCorrespondenceDistanceM);
  return params;
}

}  // namespace

Relocaliser::Relocaliser(const RelocaliserParams& params, const MatcherParams& matcher)
    : params_(params), matcher_(matcher_params(matcher)) {}

Relocalisation Relocaliser::locate(const KnownMap& map, const LevelScan& scan) const {
  return locate(map, map.window(), scan);
}

Relocalisation Relocaliser::locate(const KnownMap& map, const SearchWindow& window,
                                   const LevelScan& scan) const {
  return choose(find_candidates(map, window, scan), [&](const geometry::SE2& T_map_base) {
    return map.fit_walls(scan.points_base, scan.sensor_origin_base, T_map_base).score();
  });
}

Relocaliser::Candidates Relocaliser::find_candidates(const KnownMap& map,
                                                     const SearchWindow& window,
                                                     const LevelScan& scan) const {
  const CorrelativeMatch search =
      match_in_window(map.likelihood(), points_to_search(scan.points_base), window,
                      {.min_score = params_.min_search_score,
                       .min_peak_ratio = params_.min_peak_ratio,
                       .max_peaks = kMaxPeaks});
  Candidates found{.is_complete = search.complete && search.peaks.size() < kMaxPeaks};
  for (const Peak& peak : search.peaks) {
    if (const std::optional<Candidate> candidate = match(map, scan, peak.T_target_base)) {
      found.all.push_back(*candidate);
    }
  }
  return found;
}

std::optional<Relocaliser::Candidate> Relocaliser::match(const KnownMap& map, const LevelScan& scan,
                                                         const geometry::SE2& T_map_guess) const {
  const Match match = matcher_.match(map.points(), scan.points_base, T_map_guess);
  if (!match.found()) {
    return std::nullopt;
  }
  const geometry::SE2& T_map_base = match.T_target_base;
  const WallFit walls = map.fit_walls(scan.points_base, scan.sensor_origin_base, T_map_base);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
      match.information.topLeftCorner<2, 2>());
  return Candidate{T_map_base, match.score - walls.through_walls, walls.score(),
                   solver.eigenvectors().col(0)};
}

// The wall scores at all other places, and beside the best one, tell how clear it is.
Relocalisation Relocaliser::choose(const Candidates& found, const WallScore& wall_score) const {
  if (found.all.empty()) {
    return {};
  }
  const Candidate& best = found.all[best_of(found.all)];
  BestPlace clear{.score = best.wall_score, .runner_up_score = score_beside(best, wall_score)};
  for (const Candidate& candidate : found.all) {
    if (!is_same_place(candidate.T_map_base, best.T_map_base)) {
      clear.runner_up_score = std::max(clear.runner_up_score, candidate.wall_score);
    }
  }
  Relocalisation result{.T_map_base = best.T_map_base,
                        .score = clear.score,
                        .runner_up_score = clear.runner_up_score};
  if (best.match_score < params_.min_score) {
    result.status = Relocalisation::Status::kNowhere;
  } else if (!clear.is_clear(params_.min_misfit_ratio) || !found.is_complete) {
    result.status = Relocalisation::Status::kAmbiguous;
  } else {
    result.status = Relocalisation::Status::kFound;
  }
  return result;
}

std::size_t Relocaliser::best_of(std::span<const Candidate> candidates) {
  const auto best = std::max_element(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.match_score < b.match_score; });
  return static_cast<std::size_t>(best - candidates.begin());
}

// Along a corridor with few features a scan fits as well a little farther on.
double Relocaliser::score_beside(const Candidate& candidate, const WallScore& wall_score) {
  double score = 0.0;
  for (const double distance_m : kBesideM) {
    const Eigen::Vector2d beside =
        candidate.T_map_base.translation() + distance_m * candidate.least_determined;
    score = std::max(score, wall_score({beside.x(), beside.y(), candidate.T_map_base.yaw}));
  }
  return score;
}

}  // namespace nodmap::slam2d
