// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/contact/scan_slip.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

// How much more odometry must count than the robot has moved: so far that a range error is no slip,
// and by more than wheels slip without any contact, on a smooth floor or in a bend.
constexpr double kMinSlipM = 0.12;
constexpr double kMinSlipShare = 0.25;
constexpr double kFarthestViewM = 1.2;
constexpr time::Duration kLongestView = 3s;
// Scans nearer to each other are not both kept.
constexpr double kViewSpacingM = 0.02;
// Odometry counts at least this much between two earlier scans that a scan is compared with.
constexpr double kPairSpacingM = 0.04;
constexpr int kMaxPairs = 6;
// Difference of their pitch. Farther apart they show different parts of the furniture.
constexpr double kMinPitchRad = geometry::deg_to_rad(1.0);
constexpr double kMaxPitchRad = geometry::deg_to_rad(25.0);

// Where upright surfaces are looked for: above what may be floor, below what may be a ceiling, and
// not on the robot itself.
constexpr double kLowestM = 0.15;
constexpr double kHighestM = 1.6;
constexpr double kNearestM = 0.5;
constexpr double kFarthestM = 20.0;
// Neighbouring points farther apart in range have nothing between them.
constexpr double kRangeGapM = 0.2;
// Range errors: what fits a hypothesis, and what clearly does not. The distances that are tried are
// so near to each other that the true one fits.
constexpr double kFitsM = 0.04;
constexpr double kMisfitM = 0.08;
constexpr double kStepM = 0.04;
// A smaller rotation moves what is 5 m away by less than kFitsM.
constexpr double kTurnsRad = geometry::deg_to_rad(0.5);

// A robot that moves as odometry says has dozens of votes for it and one or two against it. A
// single pair of scans, or a single scan, may err; several that agree hardly.
constexpr int kMinVotes = 30;
constexpr int kTimesMore = 4;
constexpr int kVotesForMotion = 5;
constexpr int kMinPairs = 3;
constexpr int kMinScans = 4;

bool fits(double error_m) {
  return std::abs(error_m) <= kFitsM;
}

bool misfits(double error_m) {
  return std::abs(error_m) > kMisfitM;
}

}  // namespace

std::optional<geometry::SE2> ScanSlip::update(const scan::Scan& scan,
                                              const geometry::SE2& T_odom_base) {
  View now = look(scan, T_odom_base);
  if (!views_.empty() && now.stamp <= views_.back().stamp) {
    reset();
  }
  while (!views_.empty() &&
         (now.stamp - views_.front().stamp > kLongestView ||
          geometry::distance_m(views_.front().T_odom_base, T_odom_base) > kFarthestViewM)) {
    views_.pop_front();
  }
  scans_with_slip_ = shows_slip(now) ? scans_with_slip_ + 1 : 0;
  if (scans_with_slip_ >= kMinScans) {
    const auto before = std::ranges::find_if(views_.rbegin(), views_.rend(), [&](const View& view) {
      return geometry::distance_m(view.T_odom_base, T_odom_base) >= kMinSlipM;
    });
    const geometry::SE2 T_odom_before = before->T_odom_base;
    reset();
    return T_odom_before;
  }
  if (views_.empty() ||
      geometry::distance_m(views_.back().T_odom_base, T_odom_base) >= kViewSpacingM) {
    views_.push_back(std::move(now));
  }
  return std::nullopt;
}

ScanSlip::View ScanSlip::look(const scan::Scan& scan, const geometry::SE2& T_odom_base) {
  View view{scan.mid_stamp(), T_odom_base, scan.pitch_mid_rad(), {}, {}, {}};
  const auto hits = projector_.hits(scan);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    // The beams of a laser that is mounted upside down are in clockwise order.
    const auto& p_base = hits[scan.angle_step_rad > 0.0 ? i : hits.size() - 1 - i].p_base;
    const double bearing_rad = std::atan2(p_base.y(), p_base.x());
    if (!view.bearings_rad.empty() && bearing_rad <= view.bearings_rad.back()) {
      continue;
    }
    const double range_m = p_base.head<2>().norm();
    const bool may_be_upright = p_base.z() >= kLowestM && p_base.z() <= kHighestM &&
                                range_m >= kNearestM && range_m <= kFarthestM;
    view.bearings_rad.push_back(bearing_rad);
    view.ranges_m.push_back(may_be_upright ? range_m : 0.0);
    if (may_be_upright) {
      view.points_base.emplace_back(p_base.head<2>());
    }
  }
  return view;
}

// Whether several earlier scans say so, and none that the robot has moved.
bool ScanSlip::shows_slip(const View& now) const {
  int pairs = 0;
  int with_slip = 0;
  const View* last = &now;
  for (auto before = views_.end(); before != views_.begin() && pairs < kMaxPairs;) {
    --before;
    const double turned_rad = std::abs(before->pitch_rad - now.pitch_rad);
    if (geometry::distance_m(before->T_odom_base, now.T_odom_base) < kMinSlipM ||
        geometry::distance_m(before->T_odom_base, last->T_odom_base) < kPairSpacingM ||
        turned_rad < kMinPitchRad || turned_rad > kMaxPitchRad) {
      continue;
    }
    const Evidence evidence = compare(before, now);
    if (evidence == Evidence::kMoved) {
      return false;
    }
    pairs += evidence == Evidence::kNone ? 0 : 1;
    with_slip += evidence == Evidence::kSlipped ? 1 : 0;
    last = &*before;
  }
  return with_slip >= kMinPairs;
}

// How far a place is behind what the earlier scan shows in its direction; empty if that shows
// nothing there.
std::optional<double> ScanSlip::behind_m(const View& before, const Eigen::Vector2d& p_before) {
  const double bearing_rad = std::atan2(p_before.y(), p_before.x());
  const auto next = std::ranges::lower_bound(before.bearings_rad, bearing_rad);
  if (next == before.bearings_rad.begin() || next == before.bearings_rad.end()) {
    return std::nullopt;
  }
  const auto i = static_cast<std::size_t>(next - before.bearings_rad.begin());
  const double right_m = before.ranges_m[i - 1];
  const double left_m = before.ranges_m[i];
  if (right_m == 0.0 || left_m == 0.0 || std::abs(right_m - left_m) > kRangeGapM) {
    return std::nullopt;
  }
  const double share = (bearing_rad - before.bearings_rad[i - 1]) /
                       (before.bearings_rad[i] - before.bearings_rad[i - 1]);
  return p_before.norm() - (right_m + share * (left_m - right_m));
}

// How many points the earlier scan shows in places that satisfy `holds`, if base has moved by
// `T_before_now` since.
template <class Holds>
int ScanSlip::count(const View& before, const geometry::SE2& T_before_now, const Points& points,
                    const Holds& holds) {
  return static_cast<int>(std::ranges::count_if(points, [&](const Eigen::Vector2d& p_base) {
    const auto error_m = behind_m(before, T_before_now * p_base);
    return error_m && holds(*error_m);
  }));
}

// The motion that explains most points if the robot followed odometry until one of the earlier
// scans and is still there. A base with a gyro counts how far it turns while it slips; one without
// may not turn at all.
ScanSlip::Explanation ScanSlip::explain_by_slip(const Views::const_iterator& before,
                                                const View& now, const Points& points) const {
  const geometry::SE2 T_before_odom = before->T_odom_base.inverse();
  const double least_slip_m = std::max(
      kMinSlipM, kMinSlipShare * geometry::distance_m(before->T_odom_base, now.T_odom_base));
  Explanation best;
  auto tried = views_.end();
  for (auto stopped = before; stopped != views_.end(); ++stopped) {
    const geometry::SE2& T_odom_stopped = stopped->T_odom_base;
    if (geometry::distance_m(T_odom_stopped, now.T_odom_base) < least_slip_m ||
        (tried != views_.end() &&
         geometry::distance_m(T_odom_stopped, tried->T_odom_base) < kStepM)) {
      continue;
    }
    tried = stopped;
    const double turned_rad = geometry::angle_difference(now.T_odom_base.yaw, T_odom_stopped.yaw);
    for (const double slip_rad : {0.0, turned_rad}) {
      if (slip_rad != 0.0 && std::abs(slip_rad) < kTurnsRad) {
        continue;
      }
      const geometry::SE2 T_before_now =
          T_before_odom * T_odom_stopped * geometry::SE2{0.0, 0.0, slip_rad};
      const int votes = count(*before, T_before_now, points, fits);
      if (votes > best.votes) {
        best = {T_before_now, votes};
      }
    }
  }
  return best;
}

ScanSlip::Evidence ScanSlip::compare(const Views::const_iterator& before, const View& now) const {
  const geometry::SE2 by_odometry = before->T_odom_base.inverse() * now.T_odom_base;
  Points fitting;
  Points misfitting;
  for (const Eigen::Vector2d& p_base : now.points_base) {
    const auto error_m = behind_m(*before, by_odometry * p_base);
    if (error_m && fits(*error_m)) {
      fitting.push_back(p_base);
    } else if (error_m && misfits(*error_m)) {
      misfitting.push_back(p_base);
    }
  }
  Explanation slip;
  if (misfitting.size() >= static_cast<std::size_t>(kMinVotes)) {
    slip = explain_by_slip(before, now, misfitting);
  }
  const int for_motion = count(*before, slip.T_before_now, fitting, misfits);
  if (slip.votes >= kMinVotes && slip.votes >= kTimesMore * for_motion) {
    return Evidence::kSlipped;
  }
  return for_motion >= kVotesForMotion && for_motion > slip.votes ? Evidence::kMoved
                                                                  : Evidence::kNone;
}

}  // namespace nodmap::navigator
