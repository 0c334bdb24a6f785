// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/confirmed_rule.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::map_server {
namespace {

// After a gap in the scans a point has not been looked for in vain for all of the gap.
constexpr double kLongestLookS = 0.5;
// A point is inside the robot only when odometry's error of the last metres cannot have put it
// there.
constexpr double kSkinM = 0.05;

}  // namespace

ConfirmedRule::ConfirmedRule(const MapServerParams& params)
    : expiry_s_(params.expiry_s),
      agreement_m_(std::max(3.0 * params.range_sigma_m, 0.05)),
      passing_m_(3.0 * params.range_sigma_m + 0.05),
      height_tolerance_m_(params.height_tolerance_m),
      misses_to_remove_(params.misses_to_remove),
      robot_(params.robot.body.footprint()) {}

std::size_t ConfirmedRule::remove_obsolete(ExtendedScan& map, const HeightGate& gate,
                                           const ScanView& view) {
  std::size_t removed = 0;
  for (EgoPoint& point : map.points()) {
    if (point.valid && is_obsolete(point, map, gate, view)) {
      point = map.dummy();
      ++removed;
    }
  }
  return removed;
}

bool ConfirmedRule::is_obsolete(EgoPoint& point, const ExtendedScan& map, const HeightGate& gate,
                                const ScanView& view) const {
  // Left alone it would hide what is behind it. The body itself is the proof that it is wrong.
  if (robot_.grown(-kSkinM, -kSkinM).contains(point.p_base)) {
    return true;
  }
  const auto look = view.line.look_at(point.p_base);
  if (!look) {
    return false;
  }
  if (gate.admits(look->height_m, point.distance_m) && is_met(view, *look)) {
    confirm(point, look->height_m, view);
    return false;
  }
  if (!is_in_view(point, map.relevance(), view)) {
    return false;
  }
  note_passing_beams(point, view, *look);
  point.aged_s += std::min(view.elapsed_s, kLongestLookS);
  if (is_at_its_heights(point, *look) && view.line.ends_on_either_side(*look)) {
    point.aged_s = 0.0;  // an edge or a corner between two beams: they cannot tell
  }
  return is_gone(point) || has_expired(point, view);
}

bool ConfirmedRule::is_met(const ScanView& view, const ScanLine::Look& look) const {
  const auto reached = view.line.reached_m(look);
  return reached && std::abs(*reached - look.range_m) <= agreement_m_;
}

// Safe because of what it refuses: nothing may be held against a point that the sweeps would not
// have found, were it still there. So all heights at which an obstacle was met must lie within the
// nod. Before the wheels the laser passes over a low box, and before the scanner under a table top:
// neither is a sign that they are gone. The structure map steers no wheels: there one height will
// do.
bool ConfirmedRule::is_in_view(const EgoPoint& point, Relevance relevance,
                               const ScanView& view) const {
  if (!view.lowest_plane || !view.highest_plane) {
    return false;
  }
  const auto [low, high] = std::minmax(
      {view.lowest_plane->height_m(point.p_base), view.highest_plane->height_m(point.p_base)});
  if (relevance == Relevance::kFarthest) {
    return low <= point.highest_m && high >= point.lowest_m;
  }
  return spans(point, low, high);
}

/// Whether an interval of heights holds all those at which a point was met, but for the tolerance
/// at either end.
bool ConfirmedRule::spans(const EgoPoint& point, double lowest_m, double highest_m) const {
  // A scanner that holds still looks at one height only; a millimetre lets rounding pass.
  constexpr double kRoundingM = 1e-3;
  const double middle = 0.5 * (point.lowest_m + point.highest_m);
  return lowest_m <= std::min(point.lowest_m + height_tolerance_m_, middle) + kRoundingM &&
         highest_m >= std::max(point.highest_m - height_tolerance_m_, middle) - kRoundingM;
}

bool ConfirmedRule::is_at_its_heights(const EgoPoint& point, const ScanLine::Look& look) const {
  return look.height_m >= point.lowest_m - height_tolerance_m_ &&
         look.height_m <= point.highest_m + height_tolerance_m_;
}

// Safe because both neighbouring beams must pass: a wall seen at a grazing angle or the corner of a
// cupboard is no contradiction; and because a beam without a reading (dirt, sun) says nothing.
void ConfirmedRule::note_passing_beams(EgoPoint& point, const ScanView& view,
                                       const ScanLine::Look& look) const {
  if (!view.line.both_reach_beyond(look, look.range_m + passing_m_)) {
    return;
  }
  Search& search = point.search;
  search.lowest_m = std::min(search.lowest_m, look.height_m);
  search.highest_m = std::max(search.highest_m, look.height_m);
  if (is_at_its_heights(point, look) && search.last_missed_pass != view.pass) {
    search.last_missed_pass = view.pass;
    ++search.missed_passes;
  }
}

// Safe because beams must have passed at ALL of its heights since it was last measured: those that
// pass through the gap under a table top, or just over a box, cannot outvote those that meet it.
// And because one sweep counts once: a reading lost to chance is made up for by the next sweep.
bool ConfirmedRule::is_gone(const EgoPoint& point) const {
  return point.search.missed_passes >= misses_to_remove_ &&
         spans(point, point.search.lowest_m, point.search.highest_m);
}

bool ConfirmedRule::has_expired(const EgoPoint& point, const ScanView& view) const {
  // The passes in which it was measured and in which it expires are not whole.
  return point.aged_s > expiry_s_ && view.pass - point.confirmed_pass > 2;
}

void ConfirmedRule::confirm(EgoPoint& point, double height_m, const ScanView& view) {
  point.lowest_m = std::min(point.lowest_m, height_m);
  point.highest_m = std::max(point.highest_m, height_m);
  point.confirmed_at_s = view.clock_s;
  point.confirmed_pass = view.pass;
  point.aged_s = 0.0;
  point.search = {};
}

// What is nearer counts at once: caution needs no second opinion. The distance stays the extreme of
// many readings, as in the paper: noise keeps it some two sigma on the safe side. Following the
// readings back would not be safe: the lowest beam slides along the top of a box as the robot
// approaches, and would carry the point away with it.
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
      stored.confirmed_pass = view.pass;
      if (agrees) {  // another reading of the same object: it keeps the heights it was met at
        stored.lowest_m = std::min(stored.lowest_m, before.lowest_m);
        stored.highest_m = std::max(stored.highest_m, before.highest_m);
      }
    } else if (agrees) {
      confirm(stored, hit.point.height_m, view);
    }
  }
}

}  // namespace nodmap::map_server
