// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/followed_sender.hpp"
#include "common/bus/sender_watch.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/node/message_counts.hpp"
#include "common/scan/scan.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::node {

/// Converts SCAN, ODOMETRY and STRUCTURE_MAP messages to values, in the same way for every module.
/// Counts lost messages and rejects unusable ones, including all but those of one sender on each
/// channel. An accepted message is not yet counted as used.
///
/// Causes of rejection: `other_sender_of_scan`, `other_sender_of_odometry`,
/// `other_sender_of_structure_map`, `implausible_structure_map`, `implausible_scan`
/// (geometry, stamp or counts that make no sense), `empty_scan` (no beams), `implausible_odometry`
/// (pose, stamp or speeds that make no sense), `unconfirmed_odometry` (another sequence or far from
/// the last stamp, and the message before was not).
class SensorInput {
 public:
  /// `bus`: delivers the messages, and knows their senders; null if nobody does.
  explicit SensorInput(node::MessageCounts& counts, const bus::Bus* bus = nullptr)
      : counts_(counts), bus_(bus) {}

  /// Reads into `scan`, reusing its memory; false when the message was rejected.
  [[nodiscard]] bool read(const nodmap::scan_t& message, scan::Scan& scan);

  /// The points of a structure map, in base at the message's utime and in the order of their
  /// directions; empty when the message was rejected.
  [[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> read(const nodmap::egomap_t& message);

  /// T_odom_base at the message's utime; empty when the message was rejected.
  ///
  /// A message that begins a new sequence, is stamped more than 10 s before or after the last one,
  /// or has a pose that no robot can have reached since, is not used: anybody can send one. If the
  /// next message continues it, the driver has restarted, its clock was set, or its pose was.
  [[nodiscard]] std::optional<geometry::SE3> read(const nodmap::odometry_t& message);

  /// Whether the last accepted odometry is the first of a new odom frame: its sequence number has
  /// decreased, so the driver has restarted, and the pose starts at the origin again; or the pose
  /// has jumped, as when a gyro is zeroed or a fused pose is corrected. Do not interpolate between
  /// poses of the two frames: the transform between them is unknown.
  [[nodiscard]] bool odometry_restarted() const { return odometry_restarted_; }

  /// The time, before the last accepted odometry, whose messages were sent but lost on the way. The
  /// pose includes the motion in that time; the motion while the driver is silent it may not.
  [[nodiscard]] time::Duration odometry_lost() const { return odometry_lost_; }

 private:
  struct Odometry {
    std::int64_t seq = 0;
    time::Timestamp stamp;
    geometry::SE3 T_odom_base;
    double forward_mps = 0.0;
    double yaw_rate_rad_s = 0.0;
    time::Duration period{};  // since the message accepted before it
  };

  [[nodiscard]] bool follows(bus::FollowedSender& sender, const char* cause);
  [[nodiscard]] bool accept(const Odometry& odometry);
  [[nodiscard]] time::Duration lost_before(const Odometry& odometry) const;
  [[nodiscard]] bool continues(const Odometry& odometry) const;
  [[nodiscard]] static bool can_follow(const Odometry& odometry, const Odometry& other);
  [[nodiscard]] static bool is_reachable(const Odometry& odometry, const Odometry& other);

  node::MessageCounts& counts_;
  const bus::Bus* bus_;
  bus::FollowedSender scan_sender_{bus::SenderWatch::kSilence};
  bus::FollowedSender odometry_sender_{bus::SenderWatch::kSilence};
  bus::FollowedSender structure_map_sender_{bus::SenderWatch::kSilence};
  node::SequenceCounter scans_;
  node::SequenceCounter odometry_;
  std::optional<Odometry> first_odometry_;  // first accepted of its sequence
  std::optional<Odometry> last_odometry_;   // last accepted
  std::int64_t seq_before_ = 0;             // of the odometry accepted before that
  std::optional<Odometry> new_odometry_;    // rejected; becomes usable when the next continues it
  bool odometry_restarted_ = false;
  time::Duration odometry_lost_{};
};

}  // namespace nodmap::node
