// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/visibility_rule.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::map_server {
namespace {

// Longest time that one scan can add to a point's age: during a gap in the scans the point was not
// in view.
constexpr double kLongestLookS = 0.5;
// A point counts as inside the robot only if it is deeper inside than the odometry error of the
// last metres can explain.
constexpr double kSkinM = 0.05;

}  // namespace

VisibilityRule::VisibilityRule(const UpdateParams& params, const HeightBand& band,
                               double range_sigma_m, const robot::Footprint& body)
    : params_(params),
      band_(band),
      same_surface_m_(std::max(3.0 * range_sigma_m, 0.05)),
      passing_m_(3.0 * range_sigma_m + 0.05),
      inner_body_(body.grown(-kSkinM, -kSkinM)) {}

std::size_t VisibilityRule::remove_obsolete(ExtendedScan& map, const NewScan& scan) {
  std::size_t removed = 0;
  for (EgoPoint& point : map.points()) {
    if (point.valid && examine(point, map, scan)) {
      point = map.dummy();
      ++removed;
    }
  }
  return removed;
}

bool VisibilityRule::examine(EgoPoint& point, const ExtendedScan& map, const NewScan& scan) const {
  // No obstacle can be inside the body, and such a point would hide the obstacles behind it.
  if (inner_body_.contains(point.p_base)) {
    return true;
  }
  const auto crossing = scan.line.crossing_at(point.p_base);
  if (!crossing) {
    return false;
  }
  if (band_.contains(crossing->height_m, point.distance_m) && is_measured_again(scan, *crossing)) {
    confirm(point, crossing->height_m, scan);
    return false;
  }
  if (!is_in_view(point, map.relevance(), scan)) {
    return false;
  }
  note_passing_beams(point, scan, *crossing);
  point.aged_s += std::min(scan.elapsed_s, kLongestLookS);
  if (is_at_its_heights(point, *crossing) && scan.line.ends_on_either_side(*crossing)) {
    point.aged_s = 0.0;  // an edge or corner between the two beams: they prove nothing
  }
  return is_contradicted(point) || has_expired(point, scan);
}

bool VisibilityRule::is_measured_again(const NewScan& scan,
                                       const ScanLine::Crossing& crossing) const {
  const auto range_m = scan.line.measured_range_m(crossing);
  return range_m && std::abs(*range_m - crossing.range_m) <= same_surface_m_;
}

// Whether the sweeps could measure the point again. This is safe because it requires that ALL
// heights at which an obstacle was measured lie between the ends of the sweeps. Right in front of
// the robot the laser looks over a low box and under a table top; neither means that they are gone.
// In the structure map, which does not control the robot, one height suffices.
bool VisibilityRule::is_in_view(const EgoPoint& point, Relevance relevance,
                                const NewScan& scan) const {
  if (!scan.lowest_plane || !scan.highest_plane) {
    return false;
  }
  const auto [low, high] = std::minmax(
      {scan.lowest_plane->height_m(point.p_base), scan.highest_plane->height_m(point.p_base)});
  if (relevance == Relevance::kFarthest) {
    return low <= point.highest_m && high >= point.lowest_m;
  }
  return spans(point, low, high);
}

// Whether an interval of heights contains all those at which a point was measured, up to the
// tolerance at either end.
bool VisibilityRule::spans(const EgoPoint& point, double lowest_m, double highest_m) const {
  // A stationary scanner sees a single height; one millimetre absorbs rounding errors.
  constexpr double kRoundingM = 1e-3;
  const double middle = 0.5 * (point.lowest_m + point.highest_m);
  return lowest_m <= std::min(point.lowest_m + params_.height_tolerance_m, middle) + kRoundingM &&
         highest_m >= std::max(point.highest_m - params_.height_tolerance_m, middle) - kRoundingM;
}

bool VisibilityRule::is_at_its_heights(const EgoPoint& point,
                                       const ScanLine::Crossing& crossing) const {
  return crossing.height_m >= point.lowest_m - params_.height_tolerance_m &&
         crossing.height_m <= point.highest_m + params_.height_tolerance_m;
}

// Records that beams have passed through the point. This is safe because the beams on both sides
// must pass, so that a wall at a grazing angle or the corner of a cupboard does not count, and
// because a beam without a reading (dirt, sun) does not count either.
void VisibilityRule::note_passing_beams(EgoPoint& point, const NewScan& scan,
                                        const ScanLine::Crossing& crossing) const {
  if (!scan.line.both_reach_beyond(crossing, crossing.range_m + passing_m_)) {
    return;
  }
  PassedBeams& passed = point.passed;
  passed.lowest_m = std::min(passed.lowest_m, crossing.height_m);
  passed.highest_m = std::max(passed.highest_m, crossing.height_m);
  if (is_at_its_heights(point, crossing) && passed.last_missed_sweep != scan.sweep) {
    passed.last_missed_sweep = scan.sweep;
    ++passed.missed_sweeps;
  }
}

// Whether passing beams prove that the point is gone. This is safe because beams must have passed
// at ALL of its heights since its last measurement: beams under a table top, or just above a box,
// do not remove it. It is also safe because each sweep counts only once: a single lost reading does
// not remove a point, since the next sweep can measure it again.
bool VisibilityRule::is_contradicted(const EgoPoint& point) const {
  return point.passed.missed_sweeps >= params_.misses_to_remove &&
         spans(point, point.passed.lowest_m, point.passed.highest_m);
}

bool VisibilityRule::has_expired(const EgoPoint& point, const NewScan& scan) const {
  // Two complete sweeps: the sweep of its last measurement and the present one are incomplete.
  return point.aged_s > params_.expiry_s && scan.sweep - point.confirmed_sweep > 2;
}

void VisibilityRule::confirm(EgoPoint& point, double height_m, const NewScan& scan) {
  point.lowest_m = std::min(point.lowest_m, height_m);
  point.highest_m = std::max(point.highest_m, height_m);
  point.confirmed_at_s = scan.clock_s;
  point.confirmed_sweep = scan.sweep;
  point.aged_s = 0.0;
  point.passed = {};
}

// In the obstacle map a single nearer reading replaces the point at once, which is the safe choice.
// As in the paper, the stored distance is the extreme of many readings, which noise keeps about two
// sigma on the safe side. Averaging would not be safe: as the robot approaches a box, the lowest
// beam moves along its top away from the robot, and would drag the averaged point along.
void VisibilityRule::replace(ExtendedScan& map, const NewScan& scan) {
  for (const Hit& hit : scan.hits) {
    if (!band_.contains(hit.point.height_m, hit.point.distance_m)) {
      continue;
    }
    EgoPoint& stored = map[hit.bin];
    const bool is_same_surface =
        std::abs(hit.point.distance_m - stored.distance_m) <= same_surface_m_;
    if (map.prefers(hit.point.distance_m, stored.distance_m)) {
      const EgoPoint before = stored;
      stored = hit.point;
      stored.confirmed_sweep = scan.sweep;
      if (is_same_surface) {  // another reading of the same object: keep its measured heights
        stored.lowest_m = std::min(stored.lowest_m, before.lowest_m);
        stored.highest_m = std::max(stored.highest_m, before.highest_m);
      }
    } else if (is_same_surface) {
      confirm(stored, hit.point.height_m, scan);
    }
  }
}

}  // namespace nodmap::map_server
