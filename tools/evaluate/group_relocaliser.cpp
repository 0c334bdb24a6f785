// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/group_relocaliser.hpp"

#include <vector>

#include "common/geometry/pose_tolerance.hpp"
#include "modules/slam2d/matching/best_place.hpp"

namespace nodmap::evaluate {

using slam2d::KnownMap;
using slam2d::LevelScan;
using slam2d::Relocalisation;
using slam2d::Relocaliser;

namespace {

// Matches of successive scans, moved by odometry, agree on the place within this. Odometry may be a
// quarter of a second late, at 2 m/s and 1.5 rad/s.
constexpr geometry::PoseTolerance kMaxDisagreement{.distance_m = 0.5,
                                                   .rotation_rad = geometry::deg_to_rad(21.0)};

// The mean wall score of scans if the last one was taken at a pose, and odometry is right.
Relocaliser::WallScore mean_wall_score(const KnownMap& map, std::span<const LevelScan> scans) {
  return [&map, scans](const geometry::SE2& T_map_last) {
    double sum = 0.0;
    for (const LevelScan& scan : scans) {
      const geometry::SE2 T_map_base =
          T_map_last * (scans.back().T_odom_base.inverse() * scan.T_odom_base);
      sum += map.fit_walls(scan.points_base, scan.sensor_origin_base, T_map_base).score();
    }
    return sum / static_cast<double>(scans.size());
  };
}

// The best of some places that agree with a pose.
std::optional<Relocaliser::Candidate> best_near(std::span<const Relocaliser::Candidate> candidates,
                                                const geometry::SE2& T_map_base) {
  std::optional<Relocaliser::Candidate> best;
  for (const Relocaliser::Candidate& candidate : candidates) {
    if (geometry::is_within(candidate.T_map_base, T_map_base, kMaxDisagreement) &&
        (!best || candidate.match_score > best->match_score)) {
      best = candidate;
    }
  }
  return best;
}

}  // namespace

Relocalisation GroupRelocaliser::locate(const KnownMap& map,
                                        std::span<const LevelScan> scans) const {
  std::vector<Alone> alone;
  for (const LevelScan& scan : scans) {
    const Relocaliser::Candidates fits = relocaliser_.find_candidates(map, map.window(), scan);
    alone.push_back({fits, relocaliser_.choose(fits, mean_wall_score(map, {&scan, 1}))});
  }
  return scans.size() == 1 ? alone.front().result : join(map, scans, alone);
}

Relocalisation GroupRelocaliser::join(const KnownMap& map, std::span<const LevelScan> scans,
                                      std::span<const Alone> alone) const {
  std::vector<GroupFit> fits;
  Relocaliser::Candidates found{.is_complete = false};
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const geometry::SE2 T_base_last = scans[i].T_odom_base.inverse() * scans.back().T_odom_base;
    for (const Candidate& candidate : alone[i].fits.all) {
      fits.push_back(fit(map, scans, alone, candidate.T_map_base * T_base_last));
      found.all.push_back(fits.back().candidate);
    }
    found.is_complete = found.is_complete || alone[i].fits.is_complete;
  }
  const Relocaliser::WallScore wall_score = mean_wall_score(map, scans);
  Relocalisation result = relocaliser_.choose(found, wall_score);
  if (found.all.empty()) {
    return result;
  }
  const GroupFit& best = fits[Relocaliser::best_of(found.all)];
  const slam2d::BestPlace beside{
      .score = best.candidate.wall_score,
      .runner_up_score = Relocaliser::score_beside(best.candidate, wall_score)};
  if (!best.agrees) {
    result.status = Relocalisation::Status::kNowhere;
  } else if (best.is_sure && beside.is_clear(params_.min_misfit_ratio)) {
    result.status = Relocalisation::Status::kFound;
  }
  return result;
}

// The scan's own place near there counts if it has one, otherwise a match from there.
GroupRelocaliser::ScanFit GroupRelocaliser::fit(const KnownMap& map, const LevelScan& scan,
                                                const Alone& alone,
                                                const geometry::SE2& T_map_base) const {
  const std::optional<Candidate> own = best_near(alone.fits.all, T_map_base);
  const bool is_sure = alone.result.status == Relocalisation::Status::kFound;
  const bool is_sure_of_this =
      is_sure && own && slam2d::is_same_place(own->T_map_base, alone.result.T_map_base);
  ScanFit fit{.match = own ? own : relocaliser_.match(map, scan, T_map_base),
              .is_sure = is_sure_of_this};
  fit.agrees = is_sure == is_sure_of_this && fit.match &&
               fit.match->match_score >= params_.min_score &&
               geometry::is_within(fit.match->T_map_base, T_map_base, kMaxDisagreement);
  return fit;
}

GroupRelocaliser::GroupFit GroupRelocaliser::fit(const KnownMap& map,
                                                 std::span<const LevelScan> scans,
                                                 std::span<const Alone> alone,
                                                 const geometry::SE2& T_map_last) const {
  GroupFit group{.candidate = {T_map_last}};
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const geometry::SE2 T_last_base = scans.back().T_odom_base.inverse() * scans[i].T_odom_base;
    const ScanFit one = fit(map, scans[i], alone[i], T_map_last * T_last_base);
    group.agrees = group.agrees && one.agrees;
    group.is_sure = group.is_sure || one.is_sure;
    if (one.match) {
      group.candidate.match_score += one.match->match_score / static_cast<double>(scans.size());
      group.candidate.wall_score += one.match->wall_score / static_cast<double>(scans.size());
    }
    if (one.match && i + 1 == scans.size()) {
      group.candidate.T_map_base = one.match->T_map_base;
      group.candidate.least_determined = one.match->least_determined;
    }
  }
  return group;
}

}  // namespace nodmap::evaluate
