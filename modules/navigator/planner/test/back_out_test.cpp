// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/back_out.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/robot/infrared.hpp"
#include "modules/navigator/surroundings/rear_view.hpp"

namespace nodmap::navigator {
namespace back_out_test {

constexpr double kStepS = 0.05;  // BASE_SENSORS
constexpr double kNothing = std::numeric_limits<double>::infinity();

// A robot that faces the end of a slot, 6 cm from its walls. Something may stand behind it.
class BackOutTest : public testing::Test {
 protected:
  // Drives for so long as it decides, and returns how far it has backed up.
  double back_up_for(double duration_s) {
    for (const double end_s = time_s_ + duration_s; time_s_ < end_s; time_s_ += kStepS) {
      const auto decision = step();
      const double forward_mps = decision ? decision->forward_mps : 0.0;
      EXPECT_LE(forward_mps, 0.0);
      EXPECT_GE(forward_mps, -0.05);
      T_odom_base_.x += kStepS * forward_mps;
    }
    return -T_odom_base_.x;
  }

  [[nodiscard]] Situation situation() const {
    Situation now;
    now.stamp = time::Timestamp(time::from_seconds(100.0 + time_s_));
    now.T_odom_base = T_odom_base_;
    now.people = people_;
    now.rear_view = &rear_;
    for (double x = -1.0; x <= kFrontM; x += 0.02) {
      // The laser sees the walls beside the front.
      if (x >= T_odom_base_.x && has_walls_) {
        now.points_base.push_back(T_odom_base_.inverse() * Eigen::Vector2d(x, kWallM));
        now.points_base.push_back(T_odom_base_.inverse() * Eigen::Vector2d(x, -kWallM));
      }
    }
    for (double y = -kWallM; y <= kWallM; y += 0.02) {
      now.points_base.push_back(T_odom_base_.inverse() * Eigen::Vector2d(kFrontM, y));
    }
    return now;
  }

  std::optional<Decision> step() {
    const Situation now = situation();
    rear_.add(now.stamp, ranges(), T_odom_base_);
    return back_out_.step(now);
  }

  [[nodiscard]] Proximity::Ranges ranges() const {
    Proximity::Ranges ranges_m;
    ranges_m.fill(kNothing);
    if (has_range_finders_ && has_walls_) {
      ranges_m[static_cast<std::size_t>(robot::Infrared::kLeft)] = kBesideM;
      ranges_m[static_cast<std::size_t>(robot::Infrared::kRight)] = kBesideM;
    }
    if (has_range_finders_) {
      ranges_m[static_cast<std::size_t>(robot::Infrared::kRightBack)] = right_back_m_;
      const double behind_m = T_odom_base_.x - body_.half_length_m + 0.008 - behind_x_m_;
      ranges_m[static_cast<std::size_t>(robot::Infrared::kBack)] =
          behind_m < 0.5 ? behind_m : kNothing;
    }
    return ranges_m;
  }

  static constexpr double kBesideM = 0.06;
  robot::Footprint body_ = NavigatorParams{}.robot.body.footprint();
  double kFrontM = body_.half_length_m + kBesideM;
  double kWallM = body_.half_width_m + kBesideM;
  RearView rear_{NavigatorParams{}};
  BackOut back_out_{NavigatorParams{}};
  geometry::SE2 T_odom_base_;
  double time_s_ = 0.0;
  People people_;
  bool has_walls_ = true;
  bool has_range_finders_ = true;
  double behind_x_m_ = -kNothing;  // in odom
  double right_back_m_ = kNothing;
};

TEST_F(BackOutTest, BacksOutWhenItHasBeenStuckForFiveSeconds) {
  EXPECT_EQ(back_up_for(4.9), 0.0);
  EXPECT_FALSE(back_out_.is_leaving(situation()));
  EXPECT_GT(back_up_for(2.0), 0.05);
  EXPECT_TRUE(back_out_.is_leaving(situation()));
}

TEST_F(BackOutTest, TimeInWhichItWasHaltedDoesNotCountAsStuck) {
  EXPECT_EQ(back_up_for(1.0), 0.0);
  time_s_ += 60.0;  // a STOP, during which nothing decides
  EXPECT_EQ(back_up_for(4.5), 0.0);
  EXPECT_GT(back_up_for(2.0), 0.05);
}

TEST_F(BackOutTest, StopsBeforeWhatTheRangeFindersShowBehindIt) {
  behind_x_m_ = -body_.half_length_m - 0.3;
  const double backed_up_m = back_up_for(30.0);
  EXPECT_GT(backed_up_m, 0.2);
  // The margin of 5 cm; less than a reading's 2.5 mm of motion is lost.
  EXPECT_LT(backed_up_m, 0.3 - 0.045);
}

TEST_F(BackOutTest, GoesNoFartherThanPermittedFromWhereItWasSetDown) {
  const double backed_up_m = back_up_for(60.0);
  EXPECT_GT(backed_up_m, 0.5);
  EXPECT_LT(backed_up_m, NavigatorParams{}.back_up.unseen_m);
}

// 1.5 cm from the right wall. On the arc that leads the rear away from it the front would touch it.
TEST_F(BackOutTest, BacksOutAlongANearWall) {
  T_odom_base_.y = -0.045;
  right_back_m_ = 0.08;
  EXPECT_GT(back_up_for(10.0), 0.15);  // 0.25 m at its speed
}

TEST_F(BackOutTest, WithoutRangeFindersItStays) {
  has_range_finders_ = false;
  EXPECT_EQ(back_up_for(20.0), 0.0);
}

TEST_F(BackOutTest, ARobotThatCanTurnRoundDoesNotBackOut) {
  has_walls_ = false;
  kFrontM += 0.1;
  behind_x_m_ = -body_.half_length_m - 0.4;  // what the range finders measure
  EXPECT_EQ(back_up_for(20.0), 0.0);
}

TEST_F(BackOutTest, WhileSomebodyIsAroundItStays) {
  people_.emplace_back();
  EXPECT_EQ(back_up_for(20.0), 0.0);
}

}  // namespace back_out_test
}  // namespace nodmap::navigator
