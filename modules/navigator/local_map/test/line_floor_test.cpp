// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/line_floor.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::navigator {
namespace line_floor_test {

// A line with a brick on it, measured 1.2 cm too high because of a tilt, with a noise of 4 mm. The
// lower quartile of a normal distribution is 0.67 standard deviations below its mean. The quartile
// of 51 values has an error of 0.19 standard deviations, that of the 26 values at the end of the
// line 1.4 times as much; the tolerance is four times that.
TEST(LineFloor, FindsTheHeightOfTheFloorBesideABrick) {
  constexpr double kTiltM = 0.012;
  constexpr double kNoiseM = 0.004;
  std::mt19937 engine(7);
  std::normal_distribution<double> noise_m(0.0, kNoiseM);
  LineFloor line;
  line.begin_scan(181);
  for (std::size_t beam = 0; beam < 181; ++beam) {
    const bool is_brick = beam >= 90 && beam < 96;
    line.add(beam, kTiltM + (is_brick ? 0.03 : 0.0) + noise_m(engine));
  }
  for (const std::size_t beam : {0UL, 40UL, 92UL, 180UL}) {
    const auto level_m = line.level_around(beam);
    ASSERT_TRUE(level_m) << beam;
    EXPECT_NEAR(*level_m, kTiltM - 0.67 * kNoiseM, 4.0 * 0.19 * kNoiseM * 1.4) << beam;
  }
}

TEST(LineFloor, TooFewBeamsGiveNoHeight) {
  LineFloor line;
  line.begin_scan(181);
  for (std::size_t beam = 90; beam < 101; ++beam) {
    line.add(beam, 0.0);
  }
  EXPECT_FALSE(line.level_around(95));
  line.add(101, 0.0);
  EXPECT_TRUE(line.level_around(95));
  line.begin_scan(181);
  EXPECT_FALSE(line.level_around(95));
}

}  // namespace line_floor_test
}  // namespace nodmap::navigator
