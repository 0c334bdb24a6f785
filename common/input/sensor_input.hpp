// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/se3.hpp"
#include "common/node/tally.hpp"
#include "common/scan/scan.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::input {

/// The way in for SCAN and ODOMETRY, the same for every module: notices losses, refuses what cannot
/// be used and tallies the cause. Accepting a message does not yet count it as used.
///
/// Causes: `implausible_scan` (geometry, stamp or counts that make no sense), `empty_scan` (no
/// beams), `implausible_odometry`.
class SensorInput {
 public:
  explicit SensorInput(node::Tally& tally) : tally_(tally) {}

  /// Reads into `scan`, reusing its memory; false when the message was refused.
  [[nodiscard]] bool read(const nodmap::scan_t& message, scan::Scan& scan);

  /// T_odom_base at the message's utime; empty when the message was refused.
  [[nodiscard]] std::optional<geometry::SE3> read(const nodmap::odometry_t& message);

  /// Whether the odometry last accepted is the first of a new odom frame: its publisher counts
  /// anew, so it was started again and its pose began anew. Nothing but the robot's own pose leads
  /// from the old frame to the new, and none may be interpolated between them.
  [[nodiscard]] bool odometry_began_anew() const { return odometry_began_anew_; }

 private:
  node::Tally& tally_;
  node::SequenceWatch scans_;
  node::SequenceWatch odometry_;
  bool fell_back_ = false;  // since the last accepted odometry
  bool odometry_began_anew_ = false;
};

}  // namespace nodmap::input
