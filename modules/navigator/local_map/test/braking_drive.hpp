// SPDX-License-Identifier: BSD-3-Clause
// For tests: a robot that drives straight ahead as fast as Brake allows, over level floor or a
// profile, with the noise of the laser and of the body's tilt.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <utility>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/behaviours/brake.hpp"
#include "modules/navigator/local_map/local_map.hpp"
#include "tests/support/commanded_sweeps.hpp"

namespace nodmap::navigator::test {

/// The sweep at a speed: linear between those that are known.
inline nodmap::test::CommandedSweep sweep_at(double forward_mps) {
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

/// A drive along the x axis of odom. The head nods as the pitch controller commands; the seed also
/// chooses the moment of the nod at the start.
class BrakingDrive {
 public:
  /// Range from an origin along a ray to the first surface, metres; beyond that of the laser there
  /// is no echo.
  using Range = std::function<double(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray)>;
  /// The true pose of base in odom at a place on the x axis.
  using PoseAt = std::function<geometry::SE3(double x)>;

  BrakingDrive(Range range_m, double speed_mps, std::uint32_t seed, PoseAt pose_at = on_floor)
      : range_m_(std::move(range_m)),
        pose_at_(std::move(pose_at)),
        limit_mps_(speed_mps),
        engine_(seed) {
    const nodmap::test::CommandedSweep sweep = sweep_at(speed_mps);
    pitch_deg_ = std::uniform_real_distribution(sweep.low_deg, sweep.high_deg)(engine_);
    step_ = engine_() % 2 == 0 ? 1.0 : -1.0;
  }

  /// Drives until base is at `end_m`, the robot has stopped for good, or 40 s are over. Returns how
  /// far base is from `end_m` then, metres; 0 or less: it got there.
  double until(double end_m) {
    constexpr int kMaxScans = 3000;
    constexpr int kForGood = 150;  // 2 s, two sweeps of a stationary robot
    for (int stationary = 0; num_scans_ < kMaxScans && x_m_ < end_m && stationary < kForGood;) {
      scan_once();
      // The robot has come over floor that it had seen: Brake limits its speed only after the first
      // second.
      accelerate_to(num_scans_ < 75 ? limit_mps_ : allowed_mps());
      x_m_ += v_mps_ * kScanS;
      stationary = v_mps_ < 0.01 ? stationary + 1 : 0;
      ++num_scans_;
    }
    return end_m - x_m_;
  }

  [[nodiscard]] const robot::Footprint& body() const { return body_; }
  [[nodiscard]] const LocalMap& map() const { return map_; }

 private:
  static constexpr double kScanS = 0.01332;
  static constexpr double kRangeSigmaM = 0.01;  // SICK LMS200

  // As fast as Brake allows on the straight line ahead.
  [[nodiscard]] double allowed_mps() {
    Situation now;
    now.T_odom_base = {x_m_, 0.0, 0.0};
    now.points_base = map_.points_base(now.T_odom_base, 1.6);  // a stop takes up to 1 m
    now.possible_ramps_down_base = map_.possible_ramps_down_base(now.T_odom_base, 1.6);
    now.local_map = &map_;
    now.forward_mps = v_mps_;
    const double sloped_mps =
        map_.ground().is_level() ? limit_mps_ : params_.local_map.ground.sloped_mps;
    const double arc_mps = brake_.measure_arc(0.0, now).speed_mps;
    // Slower than this the robot does not start to drive.
    return std::min({limit_mps_, sloped_mps, arc_mps < kMinSpeedMps ? 0.0 : arc_mps,
                     brake_.speed_on_present_arc(now)});
  }

  void accelerate_to(double wanted_mps) {
    const double before_mps = v_mps_;
    v_mps_ += std::clamp(wanted_mps - v_mps_, -3.0 * kScanS, 1.5 * kScanS);
    acceleration_mps2_ = (v_mps_ - before_mps) / kScanS;
  }

  void scan_once() {
    const double tilt_sigma_rad = geometry::deg_to_rad(0.1);  // on uneven ground
    const double tilt_per_mps2 = geometry::deg_to_rad(0.1);   // the body tilts on its tyres
    const nodmap::test::CommandedSweep sweep = sweep_at(v_mps_);
    if (pitch_deg_ > sweep.high_deg) {
      step_ = -1.0;
    } else if (pitch_deg_ < sweep.low_deg) {
      step_ = 1.0;
    }
    pitch_deg_ += step_ * sweep.line_deg;
    // The tilt changes with the uneven ground, about every 20 cm.
    const double keep = std::exp(-v_mps_ * kScanS / 0.2);
    tilt_rad_ = keep * tilt_rad_ + std::sqrt(1.0 - keep * keep) * tilt_sigma_rad * normal_(engine_);
    const double up_rad = tilt_rad_ + tilt_per_mps2 * acceleration_mps2_;
    scan::Scan scan;
    scan.duration = 6660us;
    scan.angle_first_rad = -0.5 * geometry::kPi;
    scan.angle_step_rad = geometry::deg_to_rad(1.0);
    scan.pitch_first_rad = scan.pitch_last_rad = geometry::deg_to_rad(pitch_deg_);
    scan.range_min_m = 0.05;
    scan.range_max_m = 80.0;
    const robot::Mount& mount = params_.robot.mount;
    scan.T_base_mount.translation() = Eigen::Vector3d(mount.x_m, mount.y_m, mount.z_m);
    scan.ranges_m.resize(181);
    geometry::SE3 T_odom_base = pose_at_(x_m_);
    T_odom_base.linear() *= geometry::pitch_rotation(up_rad);
    const Eigen::Vector3d origin = T_odom_base * scan.T_base_mount.translation();
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const Eigen::Vector3d ray =
          T_odom_base.linear() * scan::beam_direction(scan.angle_rad(i), scan.pitch_first_rad);
      const double range_m = range_m_(origin, ray) + kRangeSigmaM * normal_(engine_);
      scan.ranges_m[i] = range_m < scan.range_max_m ? static_cast<float>(range_m)
                                                    : std::numeric_limits<float>::infinity();
    }
    map_.add_scan(scan, {x_m_, 0.0, 0.0});
  }

  static geometry::SE3 on_floor(double x) { return geometry::to_se3({x, 0.0, 0.0}); }

  NavigatorParams params_;
  Range range_m_;
  PoseAt pose_at_;
  double limit_mps_;
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
  robot::Footprint body_ = params_.robot.body.footprint();
  LocalMap map_{params_.robot, params_.local_map};
  Brake brake_{params_};
  int num_scans_ = 0;
  double x_m_ = 0.0;
  double v_mps_ = 0.0;
  double acceleration_mps2_ = 0.0;
  double pitch_deg_ = 0.0;
  double step_ = 1.0;
  double tilt_rad_ = 0.0;
};

}  // namespace nodmap::navigator::test
