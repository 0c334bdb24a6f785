// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/sloped_points.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {
namespace {

// More than the noise of an encoder, less than the pitch step of the slowest nod (0.25 deg).
constexpr double kMinStepRad = geometry::deg_to_rad(0.1);
// A wall seen by a robot that tilts by 12 degrees, or leaning by as much, recedes by 0.2 of the
// rise, a ramp of 14 degrees by 4.
constexpr double kMinRecessionRatio = 0.5;
// Several times the noise of a range.
constexpr double kMinRecessionM = 0.04;
// A slope is plane over three scans; an edge is not.
constexpr double kPlaneM = 0.02;
constexpr double kPlaneRatio = 0.25;
// The lines of beams so near count, too: while the robot rotates, the same beam meets another part
// of a bent wall or passes a door's edge.
constexpr std::size_t kBesideBeams = 2;
// A slope is wide: most of the beams so near have to agree.
constexpr std::size_t kAgreeBeams = 5;
constexpr int kMinAgreeing = 5;
constexpr double kMinAgreeingRatio = 0.6;

struct Window {
  std::size_t begin = 0;
  std::size_t end = 0;
};

Window window_around(std::size_t beam, std::size_t beams_aside, std::size_t num_beams) {
  return {beam > beams_aside ? beam - beams_aside : 0, std::min(num_beams, beam + beams_aside + 1)};
}

}  // namespace

void SlopedPoints::find_lines(std::span<const OrientedPoint> points_base) {
  const BeamHits& level = hits_[kLevel];
  lines_.assign(level.size(), {});
  std::size_t point = 0;
  for (std::size_t beam = 0; beam < level.size(); ++beam) {
    if (level[beam]) {
      lines_[beam] = points_base[point++];
    }
  }
}

// How far a point is behind the nearest of the lines that the level scan shows beside this beam.
double SlopedPoints::recession_m(std::size_t beam, const Eigen::Vector2d& p_base) const {
  const OrientedPoint& own = lines_[beam];
  double least_m = own.normal.dot(own.p - p_base);
  const auto [begin, end] = window_around(beam, kBesideBeams, lines_.size());
  for (std::size_t i = begin; i < end; ++i) {
    if (!lines_[i].has_normal()) {
      continue;
    }
    const double distance_m = lines_[i].normal.dot(lines_[i].p - p_base);
    least_m = std::abs(distance_m) < std::abs(least_m) ? distance_m : least_m;
  }
  return least_m;
}

// Not known where a scan has no echo, or the level scan no line.
std::optional<bool> SlopedPoints::is_on_slope(std::size_t beam) const {
  const auto& low = hits_[0][beam];
  const auto& middle = hits_[1][beam];
  const auto& high = hits_[2][beam];
  if (!low || !middle || !high || !lines_[beam].has_normal()) {
    return std::nullopt;
  }
  const double rise_m = high->z() - low->z();
  const double low_m = recession_m(beam, low->head<2>());
  const double recession_m = this->recession_m(beam, high->head<2>()) - low_m;
  if (!(rise_m > 0.0) || recession_m < std::max(kMinRecessionM, kMinRecessionRatio * rise_m)) {
    return false;
  }
  const double expected_m = low_m + recession_m * (middle->z() - low->z()) / rise_m;
  return std::abs(this->recession_m(beam, middle->head<2>()) - expected_m) <
         std::max(kPlaneM, kPlaneRatio * recession_m);
}

bool SlopedPoints::is_agreed(std::size_t beam) const {
  const auto [begin, end] = window_around(beam, kAgreeBeams, findings_.size());
  int known = 0;
  int agreeing = 0;
  for (std::size_t i = begin; i < end; ++i) {
    known += findings_[i] ? 1 : 0;
    agreeing += findings_[i].value_or(false) ? 1 : 0;
  }
  return agreeing >= kMinAgreeing && agreeing >= kMinAgreeingRatio * known;
}

bool SlopedPoints::find(std::span<const OrientedPoint> points_base, const SweepScan& level,
                        const std::array<SweepScan, 2>& below) {
  const std::array<const SweepScan*, 3> scans{&below.back(), &below.front(), &level};
  const auto pitch_of = [&](std::size_t i) { return scans[i]->scan.pitch_mid_rad(); };
  const std::size_t num_beams = level.scan.ranges_m.size();
  if (pitch_of(1) - pitch_of(0) < kMinStepRad || pitch_of(2) - pitch_of(1) < kMinStepRad ||
      std::ranges::any_of(
          scans, [&](const SweepScan* s) { return s->scan.ranges_m.size() != num_beams; })) {
    return false;
  }
  for (std::size_t i = 0; i < scans.size(); ++i) {
    hits_[i] = deskewed(*scans[i], projector_);
  }
  find_lines(points_base);
  findings_.resize(num_beams);
  for (std::size_t beam = 0; beam < num_beams; ++beam) {
    findings_[beam] = is_on_slope(beam);
  }
  are_on_slopes_.resize(num_beams);
  for (std::size_t beam = 0; beam < num_beams; ++beam) {
    are_on_slopes_[beam] = findings_[beam].value_or(false) && is_agreed(beam);
  }
  return std::ranges::find(are_on_slopes_, true) != are_on_slopes_.end();
}

}  // namespace nodmap::slam2d
