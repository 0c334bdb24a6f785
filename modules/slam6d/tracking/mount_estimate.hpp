// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "modules/slam6d/sweep/mount_error.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// Whether, and which, errors of the laser's mount are corrected.
struct MountParams {
  bool use = true;
  double min_error_rad = geometry::deg_to_rad(0.15);
  double max_error_rad = geometry::deg_to_rad(2.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("use_floor", use,
           "Correct a constant pitch and roll of the laser that its description does not have, as "
           "the floor around the robot shows them at the beginning of a drive.");
    v.angle("min_error_deg", min_error_rad, {0.0, 10.0},
            "A pitch or roll of the laser by less than this is not corrected.");
    v.angle("max_error_deg", max_error_rad, {0.0, 10.0},
            "Nor is one above this, which is only reported.");
  }
};

/// The error of the laser's mount by which the floor right around the robot would be the plane
/// z = 0 of base, as it is for wheels that stand on it, whatever the slope. One sweep tells it no
/// better than the ground is even.
///
/// Empty if the sweep sees too little floor, or too much else near it.
[[nodiscard]] std::optional<MountError> mount_error_by_floor(const PlacedSweep& sweep);

/// Learns how the laser is mounted other than described, while the robot drives: the median of what
/// single sweeps show, which differ by how uneven the ground is. Sweeps that see a slope ahead, or
/// furniture, are outliers. What is learned is believed once it is too large for chance.
class MountEstimate {
 public:
  explicit MountEstimate(const MountParams& params) : params_(params) {}

  /// Learns from a sweep (mount_error_by_floor()), unless the robot has hardly moved since the last
  /// one: it would see the same ground.
  void learn(const PlacedSweep& sweep);
  /// Learns what one sweep has shown.
  void learn(const MountError& by_floor);

  /// What is to be corrected: of pitch and roll what is believed. Zero until then, and if it is too
  /// large or not to be corrected.
  [[nodiscard]] MountError error() const;
  /// Whether this differs from what is corrected by more than `corrected` may be off.
  [[nodiscard]] bool is_corrected_anew(const MountError& corrected) const;

  /// What is believed, to be corrected or not.
  [[nodiscard]] const MountError& believed() const { return believed_; }
  /// Whether the mount is certainly off by more than is corrected.
  [[nodiscard]] bool is_too_large() const;
  /// The median so far, zero without sweeps, and its standard deviation.
  [[nodiscard]] const MountError& median() const { return median_; }
  [[nodiscard]] const MountError& sigma() const { return sigma_; }
  [[nodiscard]] std::size_t num_sweeps() const { return pitch_rad_.size(); }

 private:
  MountParams params_;
  std::vector<double> pitch_rad_;  // of each sweep
  std::vector<double> roll_rad_;
  MountError median_;
  MountError sigma_;
  MountError believed_;
  std::optional<geometry::SE3> T_odom_last_;  // where it learned last
};

}  // namespace nodmap::slam6d
