// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/confirmed_rule.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::map_server {
namespace {

// After a gap in the scans a point has not been looked for in vain for all of the gap.
constexpr double kLongestLook_s = 0.5;
// A point is inside the robot only when odometry's error of the last metres cannot have put it there.
constexpr double kSkin_m = 0.05;

}  // namespace

ConfirmedRule::ConfirmedRule(const MapServerParams& params)
    : expiry_s_(params.expiry_s),
      agreement_m_(std::max(3.0 * params.range_sigma_m, 0.05)),
      passing_m_(3.0 * params.range_sigma_m + 0.05),
      height_tolerance_m_(params.height_tolerance_m),
      misses_to_remove_(params.misses_to_remove),
      robot_half_length_m_(0.5 * params.robot_length_m),
      robot_half_width_m_(0.5 * params.robot_width_m) {}

std::size_t ConfirmedRule::remove_obsolete(ExtendedScan& map, const HeightGate& gate,
                                           const ScanView& view) {
  std::size_t removed = 0;
  for (EgoPoint& point : map.points()) {
    if (point.valid && is_obsolete(point, gate, view)) {
      point = map.dummy();
      ++removed;
    }
  }
  return removed;
}

bool ConfirmedRule::is_obsolete(EgoPoint& point, const HeightGate& gate,
                                const ScanView& view) const {
  // Left alone it would hide what is behind it. The body itself is the proof that it is wrong.
  if (is_inside_robot(point)) {
    return true;
  }
  const auto look = view.line.look_at(point.p_base);
  if (!look) {
    return false;
  }
  const auto reached = view.line.reached_m(*look);
  if (reached && std::abs(*reached - look->range_m) <= agreement_m_ &&
      gate.admits(look->height_m, point.distance_m)) {
    confirm(point, look->height_m, view.clock_s);
    renew_distance(point, view, *look, *reached);
    return false;
  }
  if (!is_in_full_view(point, view)) {
    return false;
  }
  if (point.missed_pass != view.pass && is_contradicted(point, view, *look)) {
    point.missed_pass = view.pass;
    ++point.misses;
  }
  point.aged_s += std::min(view.elapsed_s, kLongestLook_s);
  return point.misses >= misses_to_remove_ || point.aged_s > expiry_s_;
}

bool ConfirmedRule::is_inside_robot(const EgoPoint& point) const {
  return std::abs(point.p_base.x()) < robot_half_length_m_ - kSkin_m &&
         std::abs(point.p_base.y()) < robot_half_width_m_ - kSkin_m;
}

// Safe because of what it refuses: a point may only be missed in sweeps that would have found it, had
// it still been there. So all heights at which it was met must lie within the nod, but for the
// tolerance at either end. Before the wheels the laser passes over a low box, and before the scanner
// under a table top: neither is a sign that they are gone.
bool ConfirmedRule::is_in_full_view(const EgoPoint& point, const ScanView& view) const {
  if (!view.lowest_plane || !view.highest_plane) {
    return false;
  }
  const auto [low, high] = std::minmax(
      {view.lowest_plane->height_m(point.p_base), view.highest_plane->height_m(point.p_base)});
  const double middle = 0.5 * (point.lowest_m + point.highest_m);
  // A scanner that holds still sees one line; a millimetre lets rounding pass.
  constexpr double kRounding_m = 1e-3;
  return low <= std::min(point.lowest_m + height_tolerance_m_, middle) + kRounding_m &&
         high >= std::max(point.highest_m - height_tolerance_m_, middle) - kRounding_m;
}

// Safe because both neighbouring beams must pass, so a wall seen at a grazing angle and the corner of
// a cupboard are no contradictions; because one sweep counts once, so that the gap between a table
// top and a box below it cannot outvote them: either is met again in the same sweep; and because a
// beam without a reading (dirt, sun) says nothing.
bool ConfirmedRule::is_contradicted(const EgoPoint& point, const ScanView& view,
                                    const ScanLine::Look& look) const {
  return look.height_m >= point.lowest_m - height_tolerance_m_ &&
         look.height_m <= point.highest_m + height_tolerance_m_ &&
         view.line.both_reach_beyond(look, look.range_m + passing_m_);
}

void ConfirmedRule::confirm(EgoPoint& point, double height_m, double clock_s) const {
  point.lowest_m = std::min(point.lowest_m, height_m);
  point.highest_m = std::max(point.highest_m, height_m);
  point.confirmed_at_s = clock_s;
  point.aged_s = 0.0;
  point.misses = 0;
}

// The replacement of step 3 keeps the extreme of many readings, which noise pulls nearer by some two
// sigma. Measuring the same part of the object again undoes that, once a sweep. Other parts must
// not: a sweep up a slanted front would carry the point away from the robot step by step.
void ConfirmedRule::renew_distance(EgoPoint& point, const ScanView& view,
                                   const ScanLine::Look& look, double reached_m) const {
  if (std::abs(look.height_m - point.height_m) > height_tolerance_m_ ||
      point.distance_m < agreement_m_) {
    return;
  }
  const Eigen::Vector2d measured = view.line.along_sight(look, point.p_base, reached_m);
  point.set_distance(measured.dot(point.p_base) / point.distance_m);
}

// What is nearer counts at once: caution needs no second opinion.
void ConfirmedRule::replace(ExtendedScan& map, const HeightGate& gate, const ScanView& view) {
  for (const Hit& hit : view.hits) {
    if (!gate.admits(hit.point.height_m, hit.point.distance_m)) {
      continue;
    }
    EgoPoint& stored = map[hit.bin];
    const bool agrees = std::abs(hit.point.distance_m - stored.distance_m) <= agreement_m_;
    if (map.prefers(hit.point.distance_m, stored.distance_m)) {
      const EgoPoint before = stored;
      stored = hit.point;
      if (agrees) {  // another reading of the same object: it keeps the heights it was met at
        stored.lowest_m = std::min(stored.lowest_m, before.lowest_m);
        stored.highest_m = std::max(stored.highest_m, before.highest_m);
      }
    } else if (agrees) {
      confirm(stored, hit.point.height_m, view.clock_s);
    }
  }
}

}  // namespace nodmap::map_server
