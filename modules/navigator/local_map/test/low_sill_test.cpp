// SPDX-License-Identifier: BSD-3-Clause
// Tests that the robot stops before low sills of 3 to 4 cm, anywhere across its path and at any
// moment of the nod, with the noise of the laser and of the body's tilt.
#include <gtest/gtest.h>

#include <random>

#include "modules/navigator/behaviours/brake.hpp"
#include "modules/navigator/local_map/local_map.hpp"
#include "tests/support/commanded_sweeps.hpp"

namespace nodmap::navigator {
namespace low_sill_test {

using geometry::deg_to_rad;

constexpr double kScanS = 0.01332;
constexpr double kRangeSigmaM = 0.01;         // SICK LMS200
const double kTiltRad = deg_to_rad(0.1);      // standard deviation on uneven ground
const double kTiltPerMps2 = deg_to_rad(0.1);  // the body tilts on its tyres

// A box on the floor, rotated about its middle.
struct Sill {
  geometry::SE2 T_odom_sill;
  Eigen::Vector2d half_m;
  double height_m;

  // Range at which a ray hits the sill; +infinity if it misses.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    const geometry::SE2 T_sill_odom = T_odom_sill.inverse();
    const Eigen::Vector2d o = T_sill_odom * Eigen::Vector2d(origin.head<2>());
    const Eigen::Vector2d d = T_sill_odom.rotation() * ray.head<2>();
    const Eigen::Vector3d from(o.x(), o.y(), origin.z() - 0.5 * height_m);
    const Eigen::Vector3d along(d.x(), d.y(), ray.z());
    const Eigen::Vector3d half(half_m.x(), half_m.y(), 0.5 * height_m);
    double enters = 0.0;
    double leaves = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (-half[axis] - from[axis]) / along[axis];
      const double b = (half[axis] - from[axis]) / along[axis];
      enters = std::max(enters, std::min(a, b));
      leaves = std::min(leaves, std::max(a, b));
    }
    return enters <= leaves ? enters : std::numeric_limits<double>::infinity();
  }

  // The smallest x of the sill within `half_width_m` of the x axis, along which the body drives.
  [[nodiscard]] double begins_m(double half_width_m) const {
    double x = std::numeric_limits<double>::infinity();
    for (double u = -1.0; u <= 1.0; u += 0.004) {
      for (double v = -1.0; v <= 1.0; v += 0.05) {
        const Eigen::Vector2d p = T_odom_sill * Eigen::Vector2d(v * half_m.x(), u * half_m.y());
        if (std::abs(p.y()) <= half_width_m) {
          x = std::min(x, p.x());
        }
      }
    }
    return x;
  }
};

// The sweep at a speed: linear between those that are known.
nodmap::test::CommandedSweep sweep_at(double forward_mps) {
  constexpr double kSpacingMps = 0.5;
  const auto& sweeps = nodmap::test::kCommandedSweeps;
  const double place = std::clamp(forward_mps / kSpacingMps, 0.0, sweeps.size() - 1.001);
  const auto i = static_cast<std::size_t>(place);
  const double w = place - static_cast<double>(i);
  const auto between = [&](double a, double b) { return a + w * (b - a); };
  return {forward_mps, between(sweeps[i].low_deg, sweeps[i + 1].low_deg),
          between(sweeps[i].high_deg, sweeps[i + 1].high_deg),
          between(sweeps[i].line_deg, sweeps[i + 1].line_deg)};
}

class SillApproach {
 public:
  SillApproach(const Sill& sill, double speed_mps, std::uint32_t seed)
      : sill_(sill), limit_mps_(speed_mps), engine_(seed) {
    const nodmap::test::CommandedSweep sweep = sweep_at(speed_mps);
    pitch_deg_ = std::uniform_real_distribution(sweep.low_deg, sweep.high_deg)(engine_);
    step_ = engine_() % 2 == 0 ? 1.0 : -1.0;
  }

  // Distance from the body's front to the sill when the robot stops, or after 10 s, metres; 0 or
  // less: it was touched.
  double drive() {
    const double end_m = sill_.begins_m(body_.half_width_m) - body_.half_length_m;
    for (int i = 0; i < 750 && x_m_ < end_m; ++i) {
      scan_once();
      Situation now;
      now.T_odom_base = {x_m_, 0.0, 0.0};
      now.points_base = map_.points_base(now.T_odom_base, 1.6);  // a stop takes up to 1 m
      now.local_map = &map_;
      now.forward_mps = v_mps_;
      // The robot has come over floor that it had seen: Brake limits its speed only after the first
      // second.
      double wanted_mps = limit_mps_;
      if (i >= 75) {
        wanted_mps = std::min(
            {limit_mps_, brake_.measure_arc(0.0, now).speed_mps, brake_.speed_on_present_arc(now)});
      }
      const double before_mps = v_mps_;
      v_mps_ += std::clamp(wanted_mps - v_mps_, -3.0 * kScanS, 1.5 * kScanS);
      acceleration_mps2_ = (v_mps_ - before_mps) / kScanS;
      x_m_ += v_mps_ * kScanS;
      if (i > 150 && v_mps_ < 0.01) {
        break;
      }
    }
    return end_m - x_m_;
  }

 private:
  void scan_once() {
    const nodmap::test::CommandedSweep sweep = sweep_at(v_mps_);
    if (pitch_deg_ > sweep.high_deg) {
      step_ = -1.0;
    } else if (pitch_deg_ < sweep.low_deg) {
      step_ = 1.0;
    }
    pitch_deg_ += step_ * sweep.line_deg;
    // The tilt changes with the uneven ground, about every 20 cm.
    const double keep = std::exp(-v_mps_ * kScanS / 0.2);
    tilt_rad_ = keep * tilt_rad_ + std::sqrt(1.0 - keep * keep) * kTiltRad * normal_(engine_);
    const double up_rad = tilt_rad_ + kTiltPerMps2 * acceleration_mps2_;
    scan::Scan scan;
    scan.duration = 6660us;
    scan.angle_first_rad = -0.5 * geometry::kPi;
    scan.angle_step_rad = deg_to_rad(1.0);
    scan.pitch_first_rad = scan.pitch_last_rad = deg_to_rad(pitch_deg_);
    scan.range_min_m = 0.05;
    scan.range_max_m = 80.0;
    scan.T_base_mount.translation() = Eigen::Vector3d(0.15, 0.0, 0.38);
    scan.ranges_m.resize(181);
    const Eigen::Vector3d mount(x_m_ + 0.15, 0.0, 0.38 + 0.15 * up_rad);
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const Eigen::Vector3d ray =
          scan::beam_direction(scan.angle_rad(i), scan.pitch_first_rad + up_rad);
      const double floor_m = ray.z() < 0.0 ? -mount.z() / ray.z() : 1e9;
      const double range_m = std::min({floor_m, sill_.range_m(mount, ray), 6.0});
      scan.ranges_m[i] = static_cast<float>(range_m + kRangeSigmaM * normal_(engine_));
    }
    map_.add_scan(scan, {x_m_, 0.0, 0.0});
  }

  Sill sill_;
  double limit_mps_;
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
  robot::Footprint body_{0.225, 0.165};
  LocalMap map_{{}, {}};
  Brake brake_{NavigatorParams{}};
  double x_m_ = 0.0;
  double v_mps_ = 0.0;
  double acceleration_mps2_ = 0.0;
  double pitch_deg_ = 0.0;
  double step_ = 1.0;
  double tilt_rad_ = 0.0;
};

// Range of the half width of a sill, metres.
struct Widths {
  double least_m;
  double most_m;
};

// At these speeds the lines of a sweep are farther apart than cells. If each cell needed two hits,
// the robot would hit four of these sills. By heights above the ground alone it would hit 2 of 400
// sills and 14 of 400 bricks: only compared with the floor on the same line are they high enough.
TEST(LowSill, TheRobotStopsBeforeItAtAnySpeedAndMomentOfTheNod) {
  std::mt19937 engine(1);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution(a, b)(engine);
  };
  for (int run = 0; run < 96; ++run) {
    const Widths widths = run < 64 ? Widths{0.1, 1.5} : Widths{0.03, 0.1};
    const double speed_mps = between(1.0, 1.5);
    const double yaw_rad = between(-0.5, 0.5);
    const double half_width_m = between(widths.least_m, widths.most_m);
    // It covers at least 8 cm of the body's width.
    const double aside_m = between(0.0, half_width_m + 0.085) * (run % 2 == 0 ? 1.0 : -1.0);
    const double x_m = between(2.5, 4.0);
    const double half_depth_m = 0.5 * between(0.02, 0.25);
    const double height_m = between(0.03, 0.04);
    const Sill sill{{x_m, aside_m, yaw_rad}, {half_depth_m, half_width_m}, height_m};
    EXPECT_GT(SillApproach(sill, speed_mps, static_cast<std::uint32_t>(run)).drive(), 0.0)
        << "run " << run << ": " << height_m << " m high, at " << speed_mps << " m/s";
  }
}

}  // namespace low_sill_test
}  // namespace nodmap::navigator
