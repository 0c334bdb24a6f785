// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"
#include "common/registration/pose_edges.hpp"
#include "modules/slam6d/registration/level_ground.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"
#include "modules/slam6d/registration/registration.hpp"

namespace nodmap::slam6d {

/// The errors of odometry, as standard deviations.
struct OdometryParams {
  double translation_m = 0.01;
  double translation_m_per_m = 0.1;
  double translation_m_per_rad = 0.05;
  double rotation_rad = geometry::deg_to_rad(0.3);
  double yaw_rad_per_m = geometry::deg_to_rad(2.0);
  double yaw_rad_per_rad = 0.25;
  double tilt_rad_per_m = geometry::deg_to_rad(4.0);
  double level_height_m = 0.005;
  double level_tilt_rad = geometry::deg_to_rad(0.1);
  double interruption_m = 0.3;
  double interruption_rad = geometry::deg_to_rad(8.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("translation_m", translation_m, {0.0001, 10.0},
             "Error of the position from sweep to sweep of a stationary robot.");
    v.number("translation_m_per_m", translation_m_per_m, {0.0, 10.0}, "The same for each metre.");
    v.number("translation_m_per_rad", translation_m_per_rad, {0.0, 10.0},
             "The same for each radian of rotation.");
    v.angle("rotation_deg", rotation_rad, {0.001, 180.0},
            "Error of the orientation from sweep to sweep of a stationary robot.");
    v.angle("yaw_per_m_deg", yaw_rad_per_m, {0.0, 180.0}, "Error of the heading for each metre.");
    v.number("yaw_rad_per_rad", yaw_rad_per_rad, {0.0, 10.0},
             "Error of the heading for each radian of rotation.");
    v.angle("tilt_per_m_deg", tilt_rad_per_m, {0.0, 180.0},
            "Change of roll and pitch for each metre, which wheels do not measure: ramps, sills.");
    v.number("level_height_m", level_height_m, {0.0001, 1000.0},
             "How level the ground is, if odometry is planar and nothing else is seen: height.");
    v.angle("level_tilt_deg", level_tilt_rad, {0.01, 360.0}, "The same for roll and pitch.");
    v.number("interruption_m", interruption_m, {0.0, 100.0},
             "Error of the position over an interruption of the stream.");
    v.angle("interruption_deg", interruption_rad, {0.0, 180.0},
            "Error of the orientation over an interruption of the stream.");
  }

  [[nodiscard]] LevelGround level_ground() const { return {level_height_m, level_tilt_rad}; }
};

/// Whether odometry comes from wheels alone, without height and tilt.
[[nodiscard]] inline bool is_planar(const geometry::SE3& T_odom_base) {
  return std::abs(T_odom_base.translation().z()) < 1e-6 && T_odom_base.linear()(2, 2) > 1.0 - 1e-12;
}

/// Whether a pose is on level ground: not on a ramp or on another storey.
[[nodiscard]] inline bool is_level(const geometry::SE3& T_map_base, const OdometryParams& params) {
  constexpr double kSigmas = 4.0;
  const LevelGround ground = params.level_ground();
  return std::abs(T_map_base.translation().z()) < kSigmas * ground.height_sigma_m &&
         T_map_base.linear().col(2).head<2>().norm() < kSigmas * ground.tilt_sigma_rad;
}

/// How level the ground is believed to be while the robot is tracked at this pose. Up or down a
/// slope the map bends, because nothing shows how steep the slope is. If all evidence counted where
/// the ground is level again, the map would be torn there, and no adjustment could mend it. So
/// there it counts little, until the adjustment at the end.
[[nodiscard]] inline LevelGround level_ground_at(const geometry::SE3& T_map_base,
                                                 const OdometryParams& params) {
  constexpr double kSigmas = 20.0;  // more than the map drifts on level ground
  constexpr double kAfterSlope = 5.0;
  LevelGround ground = params.level_ground();
  if (std::abs(T_map_base.translation().z()) > kSigmas * ground.height_sigma_m) {
    ground.tilt_sigma_rad *= kAfterSlope;
  }
  return ground;
}

/// A motion as measured by odometry.
struct OdometryMotion {
  double distance_m = 0.0;
  double rotation_rad = 0.0;
  bool is_interrupted = false;
  int lost_sweeps = 0;   ///< sweeps refused in a row during it
  double scatter = 1.0;  ///< OdometryScatter::factor()
};

/// The covariance of a motion: of position (m) and rotation vector (rad) in the axes of map. It
/// includes the error that even a stationary robot has from sweep to sweep. Each refused sweep
/// doubles the standard deviations, so that what is impossible at first, such as a robot that was
/// lifted, becomes possible.
[[nodiscard]] inline Matrix6d odometry_covariance(const geometry::SE3& T_map_base,
                                                  const OdometryMotion& motion,
                                                  const OdometryParams& params) {
  constexpr int kMaxDoublings = 5;
  const double translation_m =
      motion.scatter * (params.translation_m + params.translation_m_per_m * motion.distance_m +
                        params.translation_m_per_rad * motion.rotation_rad) +
      (motion.is_interrupted ? params.interruption_m : 0.0);
  const double rotation_rad =
      params.rotation_rad + (motion.is_interrupted ? params.interruption_rad : 0.0);
  const double tilt_rad = rotation_rad + params.tilt_rad_per_m * motion.distance_m;
  const double yaw_rad = rotation_rad + params.yaw_rad_per_m * motion.distance_m +
                         params.yaw_rad_per_rad * motion.rotation_rad;
  const double growth = std::ldexp(1.0, std::min(motion.lost_sweeps, kMaxDoublings));
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(translation_m), tilt_rad, tilt_rad, yaw_rad;
  sigma *= growth;
  return registration::rotated(sigma.cwiseAbs2().asDiagonal(), T_map_base.linear());
}

}  // namespace nodmap::slam6d
