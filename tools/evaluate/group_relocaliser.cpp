// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/group_relocaliser.hpp"

#include <vector>

#include "modules/slam2d/matching/best_place.hpp"

namespace nodmap::evaluate {

using slam2d::KnownMap;
using slam2d::LevelScan;
using slam2d::Relocalisation;
using slam2d::Relocaliser;

namespace {

// Matches of successive scans, moved by odometry, agree on the place within this. Odometry may be a
// quarter of a second late, at 2 m/s and 1.5 rad/s.
constexpr double kMaxDisagreementM = 0.5;
constexpr double kMaxDisagreementRad = geometry::deg_to_rad(21.0);

bool agree(const geometry::SE2& a, const geometry::SE2& b) {
  return geometry::distance_m(a, b) < kMaxDisagreementM &&
         geometry::rotation_rad(a, b) < kMaxDisagreementRad;
}

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
std::optional<Relocaliser::Place> best_near(std::span<const Relocaliser::Place> places,
                                            const geometry::SE2& T_map_base) {
  std::optional<Relocaliser::Place> best;
  for (const Relocaliser::Place& place : places) {
    if (agree(place.T_map_base, T_map_base) && (!best || place.match_score > best->match_score)) {
      best = place;
    }
  }
  return best;
}

}  // namespace

Relocalisation GroupRelocaliser::locate(const KnownMap& map,
                                        std::span<const LevelScan> scans) const {
  std::vector<Alone> alone;
  for (const LevelScan& scan : scans) {
    const Relocaliser::Candidates fits = relocaliser_.find_places(map, map.window(), scan);
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
    for (const Place& place : alone[i].fits.places) {
      fits.push_back(fit(map, scans, alone, place.T_map_base * T_base_last));
      found.places.push_back(fits.back().place);
    }
    found.is_complete = found.is_complete || alone[i].fits.is_complete;
  }
  const Relocaliser::WallScore wall_score = mean_wall_score(map, scans);
  Relocalisation result = relocaliser_.choose(found, wall_score);
  if (found.places.empty()) {
    return result;
  }
  const GroupFit& best = fits[Relocaliser::best_of(found.places)];
  const slam2d::BestPlace beside{
      .score = best.place.wall_score,
      .runner_up_score = Relocaliser::score_beside(best.place, wall_score)};
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
  const std::optional<Place> own = best_near(alone.fits.places, T_map_base);
  const bool is_sure = alone.result.status == Relocalisation::Status::kFound;
  const bool is_sure_of_this =
      is_sure && own && slam2d::is_same_place(own->T_map_base, alone.result.T_map_base);
  ScanFit fit{.match = own ? own : relocaliser_.match(map, scan, T_map_base),
              .is_sure = is_sure_of_this};
  fit.agrees = is_sure == is_sure_of_this && fit.match &&
               fit.match->match_score >= params_.min_score &&
               agree(fit.match->T_map_base, T_map_base);
  return fit;
}

GroupRelocaliser::GroupFit GroupRelocaliser::fit(const KnownMap& map,
                                                 std::span<const LevelScan> scans,
                                                 std::span<const Alone> alone,
                                                 const geometry::SE2& T_map_last) const {
  GroupFit group{.place = {T_map_last}};
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const geometry::SE2 T_last_base = scans.back().T_odom_base.inverse() * scans[i].T_odom_base;
    const ScanFit one = fit(map, scans[i], alone[i], T_map_last * T_last_base);
    group.agrees = group.agrees && one.agrees;
    group.is_sure = group.is_sure || one.is_sure;
    if (one.match) {
      group.place.match_score += one.match->match_score / static_cast<double>(scans.size());
      group.place.wall_score += one.match->wall_score / static_cast<double>(scans.size());
    }
    if (one.match && i + 1 == scans.size()) {
      group.place.T_map_base = one.match->T_map_base;
      group.place.least_determined = one.match->least_determined;
    }
  }
  return group;
}

}  // namespace nodmap::evaluate
