// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/contact/scan_slip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace nodmap::navigator {
namespace scan_slip_test {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kMountM = 0.4;

// A hall with its axis along x.
struct Hall {
  double half_width_m = 2.5;
  double end_m = kNone;
  double ceiling_m = 2.5;
};

// The laser nods between -20 and 12 degrees in 0.35 s, as on the way. The range noise is 1 cm.
class Robot {
 public:
  // `side`: -1.0 for a laser that is mounted upside down, whose beams come in the opposite order.
  explicit Robot(const Hall& hall, double side = 1.0) : hall_(hall) {
    scan_.duration = 13'333us;
    scan_.angle_first_rad = -0.5 * side * geometry::kPi;
    scan_.angle_step_rad = side * geometry::deg_to_rad(1.0);
    scan_.range_min_m = 0.05;
    scan_.range_max_m = 30.0;
    scan_.T_base_mount.translation().z() = kMountM;
    scan_.ranges_m.resize(181);
  }

  // Drives for some seconds. Returns after how many slip is noticed; negative if never.
  double noticed_after_s(double duration_s, double wheels_mps, double robot_mps) {
    constexpr double kPeriodS = 1.0 / 75.0;
    for (double t = kPeriodS; t <= duration_s; t += kPeriodS) {
      time_s_ += kPeriodS;
      odom_m_ += kPeriodS * wheels_mps;
      true_m_ += kPeriodS * robot_mps;
      measure();
      if (monitor_.update(scan_, {odom_m_, 0.0, 0.0})) {
        return t;
      }
    }
    return -1.0;
  }

 private:
  void measure() {
    const double phase = std::fmod(time_s_ / 0.35, 2.0);
    const double pitch_rad = geometry::deg_to_rad(-20.0 + 32.0 * std::min(phase, 2.0 - phase));
    scan_.stamp = time::Timestamp(time::from_seconds(time_s_));
    scan_.pitch_first_rad = scan_.pitch_last_rad = pitch_rad;
    for (std::size_t i = 0; i < scan_.ranges_m.size(); ++i) {
      const Eigen::Vector3d d = scan::beam_direction(scan_.angle_rad(i), pitch_rad);
      const auto meets_m = [](double distance_m, double along) {
        return along * distance_m > 0.0 ? distance_m / along : kNone;
      };
      const double range_m =
          std::min({meets_m(hall_.end_m - true_m_, d.x()), meets_m(hall_.half_width_m, d.y()),
                    meets_m(-hall_.half_width_m, d.y()), meets_m(-kMountM, d.z()),
                    meets_m(hall_.ceiling_m - kMountM, d.z())});
      scan_.ranges_m[i] = static_cast<float>(range_m + error_m_(random_));
    }
  }

  Hall hall_;
  scan::Scan scan_;
  ScanSlip monitor_;
  double time_s_ = 0.0;
  double odom_m_ = 0.0;
  double true_m_ = 0.0;
  std::mt19937 random_{5};
  std::normal_distribution<double> error_m_{0.0, 0.01};
};

// Whenever in the nod the robot runs into something. At most 0.53 s were measured, of which 40 ms
// are for the four scans that must agree; without them a robot between doors noticed slip where
// there was none.
TEST(ScanSlip, IsNoticedWithinAboutHalfASecond) {
  for (double before_s = 1.0; before_s < 1.7; before_s += 0.1) {
    for (const double mps : {1.2, 1.5}) {
      Robot robot({2.5, 6.0});
      ASSERT_LT(robot.noticed_after_s(before_s, mps, mps), 0.0);
      const double after_s = robot.noticed_after_s(2.0, mps, 0.0);
      EXPECT_GT(after_s, 0.0) << before_s << " s, " << mps << " m/s";
      EXPECT_LE(after_s, 0.55) << before_s << " s, " << mps << " m/s";
    }
  }
}

TEST(ScanSlip, ALaserThatIsMountedUpsideDownShowsItAsWell) {
  Robot robot({2.5, 6.0}, -1.0);
  ASSERT_LT(robot.noticed_after_s(1.0, 1.5, 1.5), 0.0);
  EXPECT_GT(robot.noticed_after_s(2.0, 1.5, 0.0), 0.0);
}

TEST(ScanSlip, IsSilentWhileTheRobotMovesOrIsStationary) {
  for (const double mps : {0.0, 0.1, 0.5, 1.5}) {
    for (const double share : {1.0, 0.97, 0.9}) {
      Robot robot({2.5, 9.0});
      EXPECT_LT(robot.noticed_after_s(5.0, mps, share * mps), 0.0) << mps << " m/s, " << share;
    }
  }
}

// There nothing says how far the robot moves. At one pitch the floor and a low ceiling are at the
// same range for ever.
TEST(ScanSlip, InABareCorridorNothingIsDecided) {
  for (const double ceiling_m : {2.5, 1.4}) {
    Robot robot({1.0, kNone, ceiling_m});
    EXPECT_LT(robot.noticed_after_s(5.0, 1.5, 1.5), 0.0);
    EXPECT_LT(robot.noticed_after_s(5.0, 1.5, 0.0), 0.0);
  }
}

}  // namespace scan_slip_test
}  // namespace nodmap::navigator
