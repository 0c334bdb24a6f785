// SPDX-License-Identifier: BSD-3-Clause
// Tests the rule on one stored point against a table, and against a simulation that keeps the whole
// history of the point in lists.
#include "modules/map_server/visibility_rule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace nodmap::map_server {
namespace visibility_rule_test {

using geometry::deg_to_rad;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kSigmaM = 0.01;
constexpr double kDistanceM = 2.0;
constexpr std::size_t kBeam = 100;  // the point is between this beam and the next
constexpr double kClockS = 77.0;
constexpr HeightBand kBand{.floor_m = 0.05, .floor_rise = 0.0, .ceiling_m = 0.5};

// Readings in the direction of the point, as ratios of its distance, so different that no two of
// them belong to the same surface. kOnIt: 2 cm behind the point, within the tolerance of 5 cm.
enum class Reading : std::uint8_t { kBefore, kOnIt, kBeyond, kNothingHit, kInvalid };

float range_of(Reading reading) {
  switch (reading) {
    case Reading::kBefore:
      return static_cast<float>(0.5 * kDistanceM);
    case Reading::kOnIt:
      return static_cast<float>(kDistanceM + 0.02);
    case Reading::kBeyond:
      return static_cast<float>(2.0 * kDistanceM);
    case Reading::kNothingHit:
      return kInfinity;
    case Reading::kInvalid:
      break;
  }
  return kNan;
}

bool passes(Reading reading) {
  return reading == Reading::kBeyond || reading == Reading::kNothingHit;
}

// What one scan of a level laser at this height measures on both sides of the point.
struct Look {
  double height_m = 0.3;
  Reading right = Reading::kInvalid;  // beam kBeam
  Reading left = Reading::kInvalid;   // and the next
  std::int64_t sweep = 1;
  double elapsed_s = 0.01;
};

// One stored point and the scans that cross it.
class OnePoint {
 public:
  // `between`: the point is this fraction of a degree to the left of beam kBeam.
  OnePoint(const UpdateParams& params, double between, Relevance relevance = Relevance::kNearest)
      : rule_(params, kBand, kSigmaM, {0.2, 0.2}),
        map_(AngleBins(2.0 * geometry::kPi, deg_to_rad(1)), relevance) {
    const double bearing_rad = deg_to_rad(-90.0 + static_cast<double>(kBeam) + between);
    p_base_ = kDistanceM * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
    bin_ = *map_.bins().index(bearing_rad);
  }

  // Stores the point as just measured at these heights.
  EgoPoint& store(double lowest_m, double highest_m) {
    map_[bin_] = EgoPoint::at(p_base_, 0.5 * (lowest_m + highest_m));
    map_[bin_].lowest_m = lowest_m;
    map_[bin_].highest_m = highest_m;
    return map_[bin_];
  }

  // Sets the heights at the point that the sweeps cover; NaN: not known yet.
  void sweeps_cover(double lowest_m, double highest_m) {
    lowest_m_ = lowest_m;
    highest_m_ = highest_m;
  }

  // Performs step 2 with this scan; returns the number of removed points.
  std::size_t look(const Look& look) {
    scan::Scan scan;
    scan.angle_first_rad = deg_to_rad(-90);
    scan.angle_step_rad = deg_to_rad(1);
    scan.range_min_m = 0.05;
    scan.range_max_m = 32.0;
    scan.T_base_mount.translation() = Eigen::Vector3d(0.0, 0.0, look.height_m);
    scan.ranges_m.assign(181, kNan);
    scan.ranges_m[kBeam] = range_of(look.right);
    scan.ranges_m[kBeam + 1] = range_of(look.left);
    NewScan now = new_scan(scan);
    now.sweep = look.sweep;
    now.elapsed_s = look.elapsed_s;
    return rule_.remove_obsolete(map_, now);
  }

  // Performs step 3 with one hit at this distance in the point's direction.
  void replace(double distance_m, double height_m) {
    const scan::Scan no_scan;
    const Eigen::Vector2d q_base = distance_m / kDistanceM * p_base_;
    const std::vector<Hit> hits{{EgoPoint::at(q_base, height_m), bin_}};
    NewScan now = new_scan(no_scan);
    now.hits = hits;
    now.sweep = 9;
    rule_.replace(map_, now);
  }

  [[nodiscard]] const EgoPoint& point() const { return map_[bin_]; }

 private:
  [[nodiscard]] NewScan new_scan(const scan::Scan& scan) const {
    NewScan now{.hits = {},
                .line = ScanLine(scan),
                .sweep = 1,
                .lowest_plane = std::nullopt,
                .highest_plane = std::nullopt,
                .elapsed_s = 0.0,
                .clock_s = kClockS};
    if (!std::isnan(lowest_m_)) {
      now.lowest_plane = SlantedPlane{lowest_m_, {0.0, 0.0}};
      now.highest_plane = SlantedPlane{highest_m_, {0.0, 0.0}};
    }
    return now;
  }

  VisibilityRule rule_;
  ExtendedScan map_;
  Eigen::Vector2d p_base_;
  std::size_t bin_ = 0;
  double lowest_m_ = 0.0;  // by default in full view
  double highest_m_ = 1.0;
};

constexpr std::array kReadings{Reading::kBefore, Reading::kOnIt, Reading::kBeyond,
                               Reading::kNothingHit, Reading::kInvalid};

// All pairs of readings: a reading of the nearer beam on the point confirms it, two readings beyond
// it remove it, an edge between the beams proves nothing, and in all other cases it ages.
TEST(VisibilityRule, OneScanConfirmsRemovesOrAgesAPointAsInTheTable) {
  UpdateParams params;
  params.misses_to_remove = 1;
  for (const double between : {0.2, 0.8}) {
    for (const Reading right : kReadings) {
      for (const Reading left : kReadings) {
        OnePoint dut(params, between);
        dut.store(0.3, 0.3).aged_s = 2.0;
        const std::size_t removed = dut.look({.right = right, .left = left});
        const std::string name = "between " + std::to_string(between) + ", readings " +
                                 std::to_string(static_cast<int>(right)) + " and " +
                                 std::to_string(static_cast<int>(left));
        const bool is_confirmed = (between < 0.5 ? right : left) == Reading::kOnIt;
        const bool is_removed = passes(right) && passes(left);
        const auto is_behind = [](Reading r) { return r == Reading::kOnIt || passes(r); };
        const auto is_hit = [](Reading r) { return r <= Reading::kBeyond; };
        const bool is_edge =
            is_hit(right) && is_hit(left) && is_behind(right) != is_behind(left) && !is_confirmed;
        EXPECT_EQ(removed, is_removed ? 1U : 0U) << name;
        EXPECT_EQ(dut.point().valid, !is_removed) << name;
        if (!is_removed) {
          EXPECT_EQ(dut.point().aged_s, is_confirmed || is_edge ? 0.0 : 2.0 + 0.01) << name;
          EXPECT_EQ(dut.point().confirmed_at_s, is_confirmed ? kClockS : 0.0) << name;
        }
      }
    }
  }
}

// The history of the point in lists: the rule as its docstring states it, for a point that is
// always in view.
struct History {
  double lowest_m = 0.0;
  double highest_m = 0.0;
  std::set<std::int64_t> missed_sweeps;
  std::vector<double> passed_heights_m;

  // Whether the point is gone after this look.
  bool add(const Look& look, const UpdateParams& params, double between) {
    const double tolerance_m = params.height_tolerance_m;
    if ((between < 0.5 ? look.right : look.left) == Reading::kOnIt &&
        kBand.contains(look.height_m, kDistanceM)) {
      *this = {std::min(lowest_m, look.height_m), std::max(highest_m, look.height_m), {}, {}};
      return false;
    }
    if (passes(look.right) && passes(look.left)) {
      passed_heights_m.push_back(look.height_m);
      if (look.height_m >= lowest_m - tolerance_m && look.height_m <= highest_m + tolerance_m) {
        missed_sweeps.insert(look.sweep);
      }
    }
    // Beams must pass at both ends of its heights; for a flat point both are in its middle.
    const double middle_m = 0.5 * (lowest_m + highest_m);
    const double low_end_m = std::min(lowest_m + tolerance_m, middle_m);
    const double high_end_m = std::max(highest_m - tolerance_m, middle_m);
    constexpr double kRoundingM = 1e-3;
    const auto is_at_or_below = [&](double h) { return h <= low_end_m + kRoundingM; };
    const auto is_at_or_above = [&](double h) { return h >= high_end_m - kRoundingM; };
    return std::ssize(missed_sweeps) >= params.misses_to_remove &&
           std::ranges::any_of(passed_heights_m, is_at_or_below) &&
           std::ranges::any_of(passed_heights_m, is_at_or_above);
  }
};

// Random looks, most of them beyond the point, at the heights of the point, below and above it.
TEST(VisibilityRule, RemovesWhenEnoughSweepsHavePassedAtAllItsHeights) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> height(0.1, 0.45);
  std::uniform_real_distribution<double> fraction(0.1, 0.9);
  std::uniform_int_distribution<int> number(0, 9);
  int num_removed = 0;
  int num_confirmed = 0;
  for (int i = 0; i < 2000; ++i) {
    UpdateParams params;
    params.expiry_s = 1e6;
    params.misses_to_remove = 1 + number(random) % 4;
    const double between = fraction(random) < 0.5 ? 0.3 : 0.7;
    OnePoint dut(params, between);
    History oracle;
    oracle.lowest_m = height(random);
    oracle.highest_m = number(random) < 3 ? oracle.lowest_m : oracle.lowest_m + 0.05;
    dut.store(oracle.lowest_m, oracle.highest_m);
    Look look;
    for (int k = 0; k < 30; ++k) {
      look.sweep += number(random) < 5 ? 1 : 0;
      look.height_m = height(random);
      const int kind = number(random);
      look.right = kind == 0 ? Reading::kInvalid : kind == 1 ? Reading::kOnIt : Reading::kBeyond;
      look.left = kind == 1 ? Reading::kOnIt : kind < 5 ? Reading::kNothingHit : Reading::kBeyond;
      num_confirmed += kind == 1 ? 1 : 0;
      const bool is_gone = oracle.add(look, params, between);
      ASSERT_EQ(dut.look(look), is_gone ? 1U : 0U) << "point " << i << ", look " << k;
      if (is_gone) {
        ++num_removed;
        break;
      }
      ASSERT_EQ(dut.point().lowest_m, oracle.lowest_m);
      ASSERT_EQ(dut.point().highest_m, oracle.highest_m);
    }
  }
  // Both outcomes are frequent among the 2000 points, and most points were confirmed before.
  EXPECT_GT(num_removed, 200);
  EXPECT_LT(num_removed, 1800);
  EXPECT_GT(num_confirmed, 2000) << "looks";
}

// A point that is neither measured nor passed: each scan adds at most 0.5 s to its age, and two
// complete sweeps are required since its last measurement.
TEST(VisibilityRule, ExpiresByTheTimeInViewAndNotBeforeTwoCompleteSweeps) {
  const Look occluded{.right = Reading::kBefore, .left = Reading::kBefore};
  for (const double period_s : {0.01, 0.1, 0.5, 3.0}) {
    for (const int scans_a_sweep : {1, 40}) {
      UpdateParams params;
      params.expiry_s = 5.0;
      OnePoint dut(params, 0.3);
      dut.store(0.3, 0.3);
      int num_looks = 0;
      Look look = occluded;
      look.elapsed_s = period_s;
      do {
        look.sweep = num_looks++ / scans_a_sweep;
      } while (dut.look(look) == 0 && num_looks < 10'000);
      double aged_s = 0.0;
      int expected = 0;
      while (aged_s <= params.expiry_s || (expected - 1) / scans_a_sweep <= 2) {
        aged_s += std::min(period_s, 0.5);
        ++expected;
      }
      EXPECT_EQ(num_looks, expected) << period_s << " s, " << scans_a_sweep << " scans a sweep";
    }
  }
}

// A point is out of view before two sweeps are known, and if one of its heights is outside what the
// sweeps cover. In the structure map one height in view suffices.
TEST(VisibilityRule, PointsOutOfViewDoNotChange) {
  UpdateParams params;
  params.misses_to_remove = 1;
  const Look passing{.height_m = 0.2, .right = Reading::kBeyond, .left = Reading::kBeyond};
  const auto is_removed = [&](Relevance relevance, double covered_from_m, double covered_to_m) {
    OnePoint dut(params, 0.3, relevance);
    dut.store(0.2, 0.2);
    dut.sweeps_cover(covered_from_m, covered_to_m);
    const bool removed = dut.look(passing) == 1;
    EXPECT_TRUE(removed || dut.point().aged_s == 0.0 || relevance == Relevance::kFarthest);
    return removed;
  };
  for (const Relevance relevance : {Relevance::kNearest, Relevance::kFarthest}) {
    EXPECT_FALSE(is_removed(relevance, std::nan(""), std::nan("")));
    EXPECT_FALSE(is_removed(relevance, 0.25, 0.6));
    EXPECT_FALSE(is_removed(relevance, 0.0, 0.15));
    EXPECT_TRUE(is_removed(relevance, 0.0, 0.6));
  }
  const auto ages = [&](Relevance relevance) {
    OnePoint dut(params, 0.3, relevance);
    dut.store(0.1, 0.4);
    dut.sweeps_cover(0.2, 0.6);  // not its foot
    dut.look(passing);
    return dut.point().aged_s > 0.0;
  };
  EXPECT_FALSE(ages(Relevance::kNearest));
  EXPECT_TRUE(ages(Relevance::kFarthest));
}

TEST(VisibilityRule, TheBodyOfTheRobotRemovesPointsInsideIt) {
  // 5 cm of the body's outer 20 cm allow for the error of odometry.
  for (const auto& [x_m, is_kept] : {std::pair(0.14, false), std::pair(0.16, true)}) {
    VisibilityRule rule({}, kBand, kSigmaM, {0.2, 0.2});
    ExtendedScan map(AngleBins(2.0 * geometry::kPi, deg_to_rad(1)), Relevance::kNearest);
    const std::size_t bin = *map.bins().index(0.0);
    map[bin] = EgoPoint::at({x_m, 0.0}, 0.1);
    const scan::Scan no_scan;
    const NewScan now{.hits = {},
                      .line = ScanLine(no_scan),
                      .sweep = 1,
                      .lowest_plane = std::nullopt,
                      .highest_plane = std::nullopt,
                      .elapsed_s = 0.0,
                      .clock_s = 0.0};
    EXPECT_EQ(rule.remove_obsolete(map, now), is_kept ? 0U : 1U);
    EXPECT_EQ(map[bin].valid, is_kept);
  }
}

// Step 3 over a range of distances and heights: nearer points replace at once; points within 5 cm
// are the same surface, whose heights are merged and whose age is reset.
TEST(VisibilityRule, ReplacesAndConfirmsByDistance) {
  for (const Relevance relevance : {Relevance::kNearest, Relevance::kFarthest}) {
    for (double offset_m = -0.105; offset_m < 0.11; offset_m += 0.01) {
      for (const double height_m : {0.04, 0.2, 0.45, 0.55}) {
        OnePoint dut({}, 0.3, relevance);
        EgoPoint& stored = dut.store(0.25, 0.35);
        stored.aged_s = 3.0;
        const double distance_m = stored.distance_m + offset_m;
        dut.replace(distance_m, height_m);
        const EgoPoint& now = dut.point();
        const bool counts = height_m >= 0.05 && height_m <= 0.5;
        const bool replaces =
            counts && (relevance == Relevance::kNearest ? offset_m < 0.0 : offset_m > 0.0);
        const bool is_same_surface = counts && std::abs(offset_m) < 0.05;
        EXPECT_NEAR(now.distance_m, kDistanceM + (replaces ? offset_m : 0.0), 1e-12);
        EXPECT_EQ(now.aged_s, replaces || is_same_surface ? 0.0 : 3.0);
        EXPECT_EQ(now.lowest_m, is_same_surface ? std::min(0.25, height_m)
                                : replaces      ? height_m
                                                : 0.25);
        EXPECT_EQ(now.highest_m, is_same_surface ? std::max(0.35, height_m)
                                 : replaces      ? height_m
                                                 : 0.35);
      }
    }
  }
}

}  // namespace visibility_rule_test
}  // namespace nodmap::map_server
