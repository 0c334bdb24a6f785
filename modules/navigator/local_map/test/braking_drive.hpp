// SPDX-License-Identifier: BSD-3-Clause
// For tests: a robot that drives straight ahead as fast as Brake allows, with the noise of the
// laser and of the body's tilt.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <utility>

#include "common/geometry/angle.hpp"
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
  /// Range from an origin along a ray to the first surface, metres.
  using Range = std::function<double(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray)>;

  BrakingDrive(Range range_m, double speed_mps, std::uint32_t seed)
      : range_m_(std::move(range_m)), limit_mps_(speed_mps), engine_(seed) {
    const nodmap::test::CommandedSweep sweep = sweep_at(speed_mps);
    pitch_deg_ = std::uniform_real_distribution(sweep.low_deg, sweep.high_deg)(engine_);
    step_ = engine_() % 2 == 0 ? 1.0 : -1.0;
  }

  /// Drives until base is at `end_m`, the robot stops, or 10 s are over. Returns how far base is
  /// from `end_m` then, metres; 0 or less: it got there.
  double until(double end_m) {
    constexpr int kScans = 750;
    for (int i = 0; i < kScans && x_m_ < end_m; ++i) {
      scan_once();
      // The robot has come over floor that it had seen: Brake limits its speed only after the first
      // second.
      accelerate_to(i < 75 ? limit_mps_ : allowed_mps());
      x_m_ += v_mps_ * kScanS;
      if (i > 150 && v_mps_ < 0.01) {
        break;
      }
    }
    return end_m - x_m_;
  }

  [[nodiscard]] const robot::Footprint& body() const { return body_; }

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
    return std::min(
        {limit_mps_, brake_.measure_arc(0.0, now).speed_mps, brake_.speed_on_present_arc(now)});
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
    scan.T_base_mount.translation() = Eigen::Vector3d(0.15, 0.0, 0.38);
    scan.ranges_m.resize(181);
    const Eigen::Vector3d mount(x_m_ + 0.15, 0.0, 0.38 + 0.15 * up_rad);
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const Eigen::Vector3d ray =
          scan::beam_direction(scan.angle_rad(i), scan.pitch_first_rad + up_rad);
      const double range_m = std::min(range_m_(mount, ray), 6.0);
      scan.ranges_m[i] = static_cast<float>(range_m + kRangeSigmaM * normal_(engine_));
    }
    map_.add_scan(scan, {x_m_, 0.0, 0.0});
  }

  Range range_m_;
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

}  // namespace nodmap::navigator::test
