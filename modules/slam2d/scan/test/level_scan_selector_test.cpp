// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/level_scan_selector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

namespace nodmap::slam2d {
namespace level_scan_selector_test {

scan::Scan at_pitch(double first_deg, double last_deg, std::int64_t seq) {
  scan::Scan scan;
  scan.seq = seq;
  scan.pitch_first_rad = geometry::deg_to_rad(first_deg);
  scan.pitch_last_rad = geometry::deg_to_rad(last_deg);
  return scan;
}

std::vector<std::int64_t> selected(const std::vector<double>& pitches_deg) {
  LevelScanSelector selector(LevelScanParams{});
  std::vector<std::int64_t> seqs;
  std::int64_t seq = 0;
  for (const double pitch : pitches_deg) {
    if (const scan::Scan* level = selector.add(at_pitch(pitch, pitch, seq++))) {
      seqs.push_back(level->seq);
    }
  }
  return seqs;
}

TEST(LevelScanSelector, R35_OneScanForEachSweep) {
  // The laser nods between -21 and 6 degrees, the area of interest in the paper's corridor.
  for (const double step_deg : {0.25, 0.4, 1.0, 1.7}) {
    LevelScanSelector selector(LevelScanParams{});
    double pitch = -21.0;
    double direction = 1.0;
    int sweeps = 0;
    int used = 0;
    for (std::int64_t seq = 0; seq < 5000; ++seq) {
      const double next = pitch + direction * step_deg;
      if (const scan::Scan* level = selector.add(at_pitch(pitch, next, seq))) {
        ++used;
        EXPECT_LE(std::abs(level->pitch_mid_rad()), geometry::deg_to_rad(0.5 * step_deg) + 1e-12);
      }
      pitch = next;
      if (pitch >= 6.0 || pitch <= -21.0) {
        direction = -direction;
        ++sweeps;
      }
    }
    EXPECT_NEAR(used, sweeps, 1);
  }
}

TEST(LevelScanSelector, R35_SelectsTheMoreLevelOfTwoNeighbours) {
  EXPECT_EQ(selected({-1.2, -0.4, 0.6, 1.4}), (std::vector<std::int64_t>{1}));
  EXPECT_EQ(selected({-1.4, -0.6, 0.4, 1.2}), (std::vector<std::int64_t>{2}));
  EXPECT_EQ(selected({-2, -1, 0, 1, 2}), (std::vector<std::int64_t>{2}));
  EXPECT_EQ(selected({2, 1, 0, -1, -2}), (std::vector<std::int64_t>{2}));
}

TEST(LevelScanSelector, AScanIsUsedOnlyOnce) {
  EXPECT_EQ(selected({-1, 0, -1, 0, -1}), (std::vector<std::int64_t>{1, 3}));
}

TEST(LevelScanSelector, SelectsEveryScanOfAScannerHeldLevel) {
  EXPECT_EQ(selected({0, 0, 0, 0}), (std::vector<std::int64_t>{0, 1, 2, 3}));
  EXPECT_EQ(selected({0.01, -0.01, 0.01}), (std::vector<std::int64_t>{0, 1, 2}));
}

TEST(LevelScanSelector, SelectsNothingOfAScannerThatIsNeverLevel) {
  EXPECT_TRUE(selected({-10, -10, -10}).empty());
  EXPECT_TRUE(selected({-20, -15, -10, -5, -10, -15}).empty());
}

TEST(LevelScanSelector, SelectsNothingIfTheScansNearestToLevelAreTooFarFromIt) {
  EXPECT_TRUE(selected({-10, -6, 7, 12}).empty());
}

}  // namespace level_scan_selector_test
}  // namespace nodmap::slam2d
