// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/possible_ramp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::navigator {
namespace possible_ramp_test {

// A grid whose floor was seen up to x = 1 m.
class PossibleRampTest : public ::testing::Test {
 protected:
  void SetUp() override {
    grid_.center_on({0.0, 0.0});
    for (double x = 0.0; x < 1.0; x += 0.5 * grid_.cell_size_m()) {
      for (double y = -0.3; y < 0.3; y += 0.5 * grid_.cell_size_m()) {
        grid_.find({x, y})->is_floor = true;
      }
    }
    ground_.move({});
  }

  LocalMapParams params_;
  LocalGrid grid_{0.025, 9};
  TrackedGround ground_{params_.ground};
};

// The ground beyond the floor's end may be a ramp if it is no lower than a ramp of 14 degrees would
// be. A kerb of 8 cm is lower than that close to the edge; the same height farther away may be the
// end of a ramp.
TEST_F(PossibleRampTest, GroundBelowTheSteepestRampIsNotARampDown) {
  const PossibleRamp ramp(grid_, ground_, params_, {0.0, 0.0});
  const double steepest = std::tan(params_.ground.max_slope_rad);
  const Eigen::Vector2d crossing(1.1, 0.0);
  constexpr double kToleranceM = 0.03;
  for (const double beyond_m : {0.2, 0.4, 0.6}) {
    // Floor ends within a cell of 1 m.
    const double lowest_m = -kToleranceM - steepest * beyond_m;
    const auto leads_down = [&](double height_m) {
      return ramp.leads_down({1.0 + beyond_m, 0.0, height_m}, crossing, ground_.plane(0),
                             kToleranceM);
    };
    EXPECT_TRUE(leads_down(lowest_m + 0.01)) << beyond_m;
    EXPECT_FALSE(leads_down(lowest_m - 0.01)) << beyond_m;
  }
}

// Away from slopes anything that is higher counts as an obstacle at once.
TEST_F(PossibleRampTest, OnLevelGroundNothingIsARampUp) {
  const PossibleRamp ramp(grid_, ground_, params_, {0.0, 0.0});
  ASSERT_TRUE(ground_.is_level());
  EXPECT_FALSE(ramp.leads_up({2.0, 0.0, 0.05}, 0.05, 0.03));
}

// From afar, anything that rises from the floor's end no more steeply than the steepest ramp could
// be one, also on level ground.
TEST_F(PossibleRampTest, FromAfarWhatIsNoSteeperThanARampCouldBeOne) {
  const PossibleRamp ramp(grid_, ground_, params_, {0.0, 0.0});
  const double steepest = std::tan(params_.ground.max_slope_rad);
  constexpr double kToleranceM = 0.03;
  for (const double beyond_m : {0.6, 1.0, 2.0}) {
    // Floor ends within a cell of 1 m, and the tolerance counts twice.
    const double highest_m = steepest * beyond_m + 2.0 * kToleranceM;
    const auto could = [&](double height_m) {
      return ramp.could_lead_up({1.0 + beyond_m, 0.0, height_m}, height_m, kToleranceM);
    };
    EXPECT_TRUE(could(highest_m - 0.01)) << beyond_m;
    EXPECT_FALSE(could(highest_m + 0.02)) << beyond_m;
  }
}

TEST_F(PossibleRampTest, FromNearNothingCouldBeARamp) {
  const PossibleRamp ramp(grid_, ground_, params_, {0.0, 0.0});
  EXPECT_TRUE(ramp.could_lead_up({params_.ground.doubt_from_m + 0.01, 0.0, 0.08}, 0.08, 0.03));
  EXPECT_FALSE(ramp.could_lead_up({params_.ground.doubt_from_m - 0.01, 0.0, 0.08}, 0.08, 0.03));
}

}  // namespace possible_ramp_test
}  // namespace nodmap::navigator
