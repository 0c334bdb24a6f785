// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/stop_latch.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::node {

/// Publishes STOP for one requester, repeats it, because a message may be lost, and knows from STOP
/// whether the base driver has confirmed that it is stopped.
class StopSender {
 public:
  static constexpr time::Duration kPeriod = 200ms;
  /// How many times a release is sent. A base driver that repeats an older STOP at that moment, and
  /// whoever has missed a copy, gets the next one.
  static constexpr int kNumCopies = 4;

  StopSender(bus::Bus& bus, std::string requested_by);

  /// Stops the robot: from now on STOP is due every period until anybody releases it.
  void stop(time::Timestamp now) { decide(true, now); }

  /// Releases the robot.
  void release(time::Timestamp now) { decide(false, now); }

  /// Publishes the message that is due now, if any. A copy has the time of its decision, by which
  /// it is recognised.
  void repeat_if_due(time::Timestamp now);

  /// Takes a message on STOP. The bus delivers our own as well.
  void take(const nodmap::stop_t& message);

  /// Whether the present decision has been sent as often as a release is.
  [[nodiscard]] bool is_sent() const { return num_sent_ >= kNumCopies; }

  /// Who has stopped the robot, as the base driver has reported since the present decision; empty:
  /// it has not reported that the robot is stopped. After a release only reports since its last
  /// copy count, because before that the base driver may not have received it.
  [[nodiscard]] const std::optional<std::string>& confirmed_by() const { return confirmed_by_; }

 private:
  void decide(bool is_stopped, time::Timestamp now);
  void publish(time::Timestamp now);

  bus::Bus& bus_;
  nodmap::stop_t message_{};   // of the newest decision, with the number of the last message
  StopLatch latch_;            // what all requesters have decided
  int num_sent_ = kNumCopies;  // of this decision, up to kNumCopies; none is due before the first
  std::optional<time::Timestamp> sent_;
  std::optional<std::string> confirmed_by_;
};

}  // namespace nodmap::node
