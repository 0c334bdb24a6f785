// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/stopping.hpp"

#include <gtest/gtest.h>

#include <array>

namespace nodmap::pitch_controller {
namespace {

constexpr Stopping kStopping{1.5, 0.05, 0.15};
constexpr std::array<double, 5> kWaysM{1.0, 1.5, 2.0, 3.0, 4.0};

struct Row {
  double reaction_s;
  std::array<double, 5> speeds_mps;
};

TEST(Stopping, SpeedsOfTheReferenceTable) {
  const auto nodding = [](double sweep_s) { return kStopping.reaction_s(sweep_s); };
  const std::array<Row, 5> table{{{nodding(0.20), {1.06, 1.45, 1.78, 2.33, 2.79}},
                                  {nodding(0.35), {0.83, 1.18, 1.49, 2.01, 2.45}},
                                  {nodding(0.67), {0.54, 0.81, 1.06, 1.51, 1.90}},
                                  {nodding(1.33), {0.30, 0.47, 0.63, 0.94, 1.23}},
                                  {0.01332 + 0.05, {1.50, 1.92, 2.26, 2.83, 3.30}}}};
  for (const Row& row : table) {
    for (std::size_t i = 0; i < kWaysM.size(); ++i) {
      // The table is rounded to 0.01.
      EXPECT_NEAR(kStopping.speed_mps(kWaysM[i], row.reaction_s), row.speeds_mps[i], 0.01)
          << row.reaction_s << " s, " << kWaysM[i] << " m";
    }
  }
}

TEST(Stopping, DistanceAndSpeedAreInverse) {
  for (double v = 0.05; v < 5.0; v += 0.05) {
    EXPECT_NEAR(kStopping.speed_mps(kStopping.way_m(v, 0.7), 0.7), v, 1e-12);
  }
}

TEST(Stopping, ARobotDrivenStepByStepStandsAtTheMargin) {
  const double v = kStopping.speed_mps(2.0, 0.45);
  double way = 0.0;
  double speed = v;
  constexpr double kStepS = 1e-5;
  for (double t = 0.0; speed > 0.0; t += kStepS) {
    speed -= t < 0.45 ? 0.0 : 1.5 * kStepS;
    way += speed * kStepS;
  }
  // First-order integration: a step of the way at full speed, twice.
  EXPECT_NEAR(way, 2.0 - 0.15, 2.0 * v * kStepS);
}

TEST(Stopping, NoWayNoSpeed) {
  EXPECT_EQ(kStopping.speed_mps(0.15, 0.1), 0.0);
  EXPECT_EQ(kStopping.speed_mps(-1.0, 0.1), 0.0);
  EXPECT_EQ(kStopping.speed_mps(std::numeric_limits<double>::quiet_NaN(), 0.1), 0.0);
}

}  // namespace
}  // namespace nodmap::pitch_controller
