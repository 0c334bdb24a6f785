// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/ground/facet_finder.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

// The strip ahead of base in which facets are searched for.
constexpr double kNearestM = 0.3;
constexpr double kFarthestM = 3.0;
constexpr double kHalfWidthM = 0.35;
// A patch has at least this many points. They lie along a line: not on a face, nor on both sides
// of an edge.
constexpr int kMinPoints = 4;
constexpr double kLongestPatchM = 0.25;
constexpr double kHighestPatchM = 0.04;
// A patch farther than this from the ground is not part of it; the error of the tilt is added. The
// mean of its points is twice as accurate as one of them.
constexpr double kPatchToleranceM = 0.012;
// About ten sweeps: each sweep sees two lines of a flat ramp 2 m ahead.
constexpr int kOldestScans = 600;
constexpr std::size_t kMaxPatches = 256;
// A change of the tilt from one scan to the next that is only rounding.
constexpr double kSteadyRad = 1e-6;
// A surface extends far enough ahead, twice as far as a plank, without gaps, was measured in scans
// of several pitches, and is as wide as the body.
constexpr double kMinLengthM = 0.4;
constexpr double kWidestGapM = 0.25;
constexpr std::size_t kMinPatches = 12;
constexpr std::size_t kMinScans = 6;
constexpr std::size_t kMinColumns = 3;
// A surface is flat: a step of 3 cm in the middle of 0.4 m is 0.75 cm off even the best plane.
constexpr double kFirstResidualM = 0.02;
constexpr double kResidualM = 0.015;
constexpr double kRmsM = 0.007;
constexpr double kMinShare = 0.8;
// The kink lies no farther than this before the first patch. A ramp of 5 degrees is 3 cm high 0.35
// m behind its kink, and the next line on it may be 0.25 m farther. A plank 6 cm high would have
// to slope by 6 degrees.
constexpr double kFarthestKinkM = 0.6;
// The slope of the flattest ramp, less the error of a measured slope.
const double kMinKink = std::tan(geometry::deg_to_rad(4.0));
// A surface reaches at least this far above or below the ground before it. Sills and planks, which
// may look flat together with the floor around them, do not.
constexpr double kMinRiseM = 0.07;

}  // namespace

FacetFinder::FacetFinder(const LocalMapParams& params) : params_(params) {}

void FacetFinder::add(const Eigen::Vector3d& p_odom, const Eigen::Vector2d& p_base) {
  if (p_base.x() < kNearestM || p_base.x() > kFarthestM || std::abs(p_base.y()) >= kHalfWidthM) {
    return;
  }
  const double share = 0.5 + 0.5 * p_base.y() / kHalfWidthM;
  const auto number = static_cast<std::size_t>(share * static_cast<double>(kColumns));
  Column& column = columns_[std::min(number, kColumns - 1)];  // a share may be rounded to 1
  if (column.num_points == 0) {
    column.min_odom = column.max_odom = p_odom;
  }
  ++column.num_points;
  column.sum_odom += p_odom;
  column.min_odom = column.min_odom.cwiseMin(p_odom);
  column.max_odom = column.max_odom.cwiseMax(p_odom);
}

void FacetFinder::end_scan(TrackedGround& ground, const geometry::SE2& T_odom_base) {
  ++scan_;
  const std::array<Column, kColumns> columns = std::exchange(columns_, {});
  const Eigen::Vector3d up_odom = ground.T_odom_base().linear().col(2);
  const double tilted_rad = (up_odom - std::exchange(up_odom_, up_odom)).norm();
  // On a facet the tilt does not change. While it does, over a kink, it is as wrong as the place of
  // the kink.
  if (tilted_rad > kSteadyRad) {
    return;
  }
  bool has_new = false;
  for (std::size_t i = 0; i < kColumns; ++i) {
    has_new |= add_patch(columns[i], i, ground, T_odom_base);
  }
  while (!patches_.empty() &&
         (patches_.size() > kMaxPatches || patches_.front().scan < scan_ - kOldestScans)) {
    patches_.pop_front();
  }
  if (has_new && patches_.size() >= kMinPatches &&
      (find(true, ground, T_odom_base) || find(false, ground, T_odom_base))) {
    patches_.clear();  // they were compared with the ground as known before
  }
}

// Adds a patch that could be ground but is not known as such. Returns whether it is one.
bool FacetFinder::add_patch(const Column& column, std::size_t number, TrackedGround& ground,
                            const geometry::SE2& T_odom_base) {
  const Eigen::Vector3d size = column.max_odom - column.min_odom;
  if (column.num_points < kMinPoints || size.z() > kHighestPatchM ||
      size.head<2>().norm() > kLongestPatchM) {
    return false;
  }
  const Eigen::Vector3d p_odom = column.sum_odom / column.num_points;
  const double range_m = (p_odom.head<2>() - T_odom_base.translation()).norm();
  const double rise_m = p_odom.z() - ground.T_odom_base().translation().z();
  if (std::abs(rise_m) > kPatchToleranceM + ground.max_slope() * range_m) {
    return false;
  }
  using Place = TrackedGround::Place;
  const Place place = ground.look(p_odom, kPatchToleranceM + params_.tilt_tolerance_rad * range_m);
  if (place.kind == Place::Kind::kGround) {
    ground.refine(place.facet, p_odom);
    return false;
  }
  patches_.push_back({p_odom, number, scan_, place.kind == Place::Kind::kAbove, 0.0});
  return true;
}

// Joins the nearest new facet above, or below, the known ground to it. Returns whether there is
// one.
bool FacetFinder::find(bool is_above, TrackedGround& ground, const geometry::SE2& T_odom_base) {
  const Eigen::Vector2d ahead = T_odom_base.rotation().col(0);
  std::vector<Patch> patches;
  for (const Patch& patch : patches_) {
    if (patch.is_above == is_above) {
      patches.push_back(patch);
      patches.back().ahead_m = ahead.dot(patch.p_odom.head<2>() - T_odom_base.translation());
    }
  }
  std::ranges::sort(patches, {}, &Patch::ahead_m);
  // Anything may lie before the ramp, so the search is begun at several places.
  for (std::size_t eighth = 0; eighth < 4; ++eighth) {
    const std::size_t first = eighth * patches.size() / 8;
    const auto surface = surface_from(std::span(patches).subspan(first));
    const auto before = surface ? facet_before(*surface, is_above, ground, T_odom_base)
                                : std::optional<std::size_t>{};
    if (before) {
      const std::size_t facet = ground.add_facet(surface->fit, *before, is_above);
      for (const Patch& patch : surface->patches) {
        ground.join(patch.p_odom.head<2>(), facet);
      }
      return true;
    }
  }
  return false;
}

// The surface that begins at the first of these patches, which are sorted by `ahead_m`; empty if
// they form none. Its plane is fitted to the nearest patches, then twice to those that lie on it.
std::optional<FacetFinder::Surface> FacetFinder::surface_from(std::span<const Patch> patches) {
  Surface surface;
  for (const Patch& patch : patches) {
    if (patch.ahead_m > patches.front().ahead_m + kMinLengthM) {
      break;
    }
    surface.fit.add(patch.p_odom);
  }
  for (const double residual_m : {kFirstResidualM, kResidualM}) {
    const auto plane = surface.fit.solve();
    if (!plane) {
      return std::nullopt;
    }
    surface = surface_on(*plane, residual_m, patches);
  }
  if (!is_large(surface) || !is_flat(surface) || !surface.fit.solve()) {
    return std::nullopt;
  }
  return surface;
}

// The patches on a plane, up to the first gap between them.
FacetFinder::Surface FacetFinder::surface_on(const Plane& plane, double residual_m,
                                             std::span<const Patch> patches) {
  Surface surface;
  std::size_t num_others = 0;
  for (const Patch& patch : patches) {
    if (!surface.patches.empty() && patch.ahead_m > surface.patches.back().ahead_m + kWidestGapM) {
      break;
    }
    const double off_m = patch.p_odom.z() - plane.at(patch.p_odom.head<2>());
    if (std::abs(off_m) > residual_m) {
      ++num_others;
      continue;
    }
    surface.fit.add(patch.p_odom);
    surface.patches.push_back(patch);
    surface.num_within = surface.patches.size() + num_others;
    surface.sum_square_m2 += off_m * off_m;
  }
  return surface;
}

// Whether a surface is long and wide enough for a facet, and was measured in enough scans.
bool FacetFinder::is_large(const Surface& surface) {
  if (surface.patches.size() < kMinPatches) {
    return false;
  }
  std::set<int> scans;
  std::set<std::size_t> columns;
  for (const Patch& patch : surface.patches) {
    scans.insert(patch.scan);
    columns.insert(patch.column);
  }
  const double length_m = surface.patches.back().ahead_m - surface.patches.front().ahead_m;
  return length_m >= kMinLengthM && columns.size() >= kMinColumns && scans.size() >= kMinScans;
}

// Whether a surface has no steps: its patches lie on its plane, and few others are among them.
bool FacetFinder::is_flat(const Surface& surface) {
  const auto num_patches = static_cast<double>(surface.patches.size());
  return surface.sum_square_m2 <= kRmsM * kRmsM * num_patches &&
         num_patches >= kMinShare * static_cast<double>(surface.num_within);
}

// The facet that a surface meets in a kink before it; empty if there is none, or the surface is
// too steep.
std::optional<std::size_t> FacetFinder::facet_before(const Surface& surface, bool is_above,
                                                     const TrackedGround& ground,
                                                     const geometry::SE2& T_odom_base) {
  constexpr double kStepM = 0.02;
  const Plane plane = *surface.fit.solve();
  if (plane.slope.norm() > ground.max_slope()) {
    return std::nullopt;
  }
  Eigen::Vector2d nearest = Eigen::Vector2d::Zero();
  double num_nearest = 0.0;
  for (const Patch& patch : surface.patches) {
    if (patch.ahead_m < surface.patches.front().ahead_m + 0.1) {
      nearest += patch.p_odom.head<2>();
      num_nearest += 1.0;
    }
  }
  nearest /= num_nearest;
  const Eigen::Vector2d back = -T_odom_base.rotation().col(0);
  for (double s = 0.0; s < kFarthestKinkM; s += kStepM) {
    const Eigen::Vector2d p = nearest + s * back;
    if ((plane.at(p) > ground.height_m(p)) != is_above) {
      const std::size_t before = ground.look({p.x(), p.y(), ground.height_m(p)}, 0.0).facet;
      const double kink = (plane.slope - ground.plane(before).slope).norm();
      const Eigen::Vector2d farthest = surface.patches.back().p_odom.head<2>();
      const double higher_m = plane.at(farthest) - ground.plane(before).at(farthest);
      // Where the known ground changes from one facet to another the surface meets neither.
      const double rise_m = is_above ? higher_m : -higher_m;
      const bool is_ramp = kink > kMinKink && rise_m > kMinRiseM;
      return s > 0.0 && ground.is_known(p) && is_ramp ? std::optional(before) : std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::navigator
