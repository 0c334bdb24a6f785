// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/se3.hpp"
#include "common/node/message_counts.hpp"
#include "common/node/node.hpp"
#include "common/scan/scan.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::node {

/// Turns SCAN and ODOMETRY messages into values, for every module alike: counts lost messages, and
/// rejects those that cannot be used. Accepting a message does not yet count it as used.
///
/// Causes of rejection: `implausible_scan` (geometry, stamp or counts that make no sense),
/// `empty_scan` (no beams), `implausible_odometry`.
class SensorInput {
 public:
  explicit SensorInput(node::MessageCounts& counts) : counts_(counts) {}

  /// Reads into `scan`, reusing its memory; false when the message was rejected.
  [[nodiscard]] bool read(const nodmap::scan_t& message, scan::Scan& scan);

  /// T_odom_base at the message's utime; empty when the message was rejected.
  [[nodiscard]] std::optional<geometry::SE3> read(const nodmap::odometry_t& message);

  /// Whether the last accepted odometry is the first of a new odom frame: its sequence number fell,
  /// so the driver was restarted and its pose begins at the origin again. The new frame is related
  /// to the old one only by the robot's own pose; do not interpolate between them.
  [[nodiscard]] bool odometry_restarted() const { return odometry_restarted_; }

 private:
  node::MessageCounts& counts_;
  node::SequenceCounter scans_;
  node::SequenceCounter odometry_;
  bool sequence_fell_ = false;  // since the last accepted odometry
  bool odometry_restarted_ = false;
};

/// Whether a SAVE_REQUEST is to be carried out: the process must have a folder for its map, else
/// the request is rejected (`save_request_without_out_dir`). Logs who asked.
[[nodiscard]] bool accept_save_request(const nodmap::save_request_t& request,
                                       const Context& context);

}  // namespace nodmap::node
