// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>
#include <sys/ioctl.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "common/bus/loop_bus.hpp"
#include "common/node/status.hpp"
#include "drivers/kurt/node.hpp"
#include "drivers/kurt/test/kurt_emulator.hpp"
#include "nodmap/base_sensors_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/status_t.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/pty_pair.hpp"

namespace nodmap::kurt {
namespace node_test {

inline constexpr time::Timestamp kStart{1'700'000'000s};
inline constexpr std::size_t kCommandBytes = 22;

/// Waits until `count` bytes have made it through the terminal.
inline void await_input(int fd, std::size_t count) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  int waiting = 0;
  while (::ioctl(fd, FIONREAD, &waiting) == 0 && static_cast<std::size_t>(waiting) < count &&
         std::chrono::steady_clock::now() < deadline) {
    pollfd entry{fd, POLLIN, 0};
    ::poll(&entry, 1, 1);
  }
}

/// The whole driver in one process: messages over a simulated network, bytes over a
/// pseudo-terminal, the emulated base behind it. The test sets the time; it waits only for bytes to
/// pass through the terminal.
class Bench {
 public:
  Bench() : odometry(bus, "ODOMETRY"), sensors(bus, "BASE_SENSORS"), status(bus, "STATUS") {
    network.set_time({clock.now(), now});
  }

  /// 10 ms pass. The driver does nothing, as one that is frozen.
  void pass() {
    now += 10ms;
    clock.advance(10ms);
    network.set_time({clock.now(), now});
  }

  void step() {
    pass();
    const std::string to_driver = answer_ + (pty ? base.tick() : "");
    answer_.clear();
    if (pty && node->poll_handles()[0] >= 0 && !to_driver.empty()) {
      pty->send(to_driver);
      await_input(node->poll_handles()[0], to_driver.size());
    }
    network.deliver();
    node->spin_once();
    reporter.publish_if_due(*node);
    network.deliver();
    if (pty) {
      // Once the bus is open there is a command in every period.
      const bool command_comes = base.channel_open() && node->poll_handles()[0] >= 0;
      answer_ = base.take(pty->receive_text(command_comes ? kCommandBytes : 0,
                                            std::chrono::milliseconds(command_comes ? 100 : 1)));
    }
  }

  template <class Condition>
  bool step_until(Condition condition, time::Duration at_most) {
    for (const time::SteadyTime end = now + at_most; now < end && !condition();) {
      step();
    }
    return condition();
  }

  [[nodiscard]] nodmap::drive_t drive(double forward_mps, double yaw_rate_rad_s) const {
    nodmap::drive_t message{};
    message.utime = time::to_utime(clock.now());
    message.forward_mps = forward_mps;
    message.yaw_rate_rad_s = yaw_rate_rad_s;
    message.valid_us = 1'000'000;
    return message;
  }

  void publish_drive(double forward_mps, double yaw_rate_rad_s) {
    nodmap::drive_t message = drive(forward_mps, yaw_rate_rad_s);
    message.drive_seq = drive_seq++;
    bus.publish("DRIVE", message);
  }

  void drive_for(double forward_mps, double yaw_rate_rad_s, time::Duration duration) {
    for (const time::SteadyTime end = now + duration; now < end;) {
      publish_drive(forward_mps, yaw_rate_rad_s);
      step();
    }
  }

  void publish_stop(bool is_stopped, const std::string& by = "test") {
    nodmap::stop_t message{};
    message.utime = ++stop_utime;
    message.is_stopped = static_cast<std::int8_t>(is_stopped);
    message.requested_by = by;
    bus.publish("STOP", message);
  }

  void restart() {
    node.reset();
    base = {};
    node.emplace(context, KurtParams{}, open, [this] { return time::Moment{clock.now(), now}; });
  }

  /// The line is open, and the robot is free to drive.
  bool becomes_ready() {
    publish_stop(false);
    return step_until([this] { return node->health().state == node::HealthState::kDegraded; }, 1s);
  }

  time::SteadyTime now;
  std::int64_t drive_seq = 0;
  std::int64_t stop_utime = 0;
  test::ManualClock clock{kStart};
  std::optional<test::PtyPair> pty{std::in_place};
  test::KurtEmulator base;
  test::TemporaryDir dir;
  bus::LoopNetwork network{dir.path() / "log", {}};
  bus::LoopBus bus{network};
  bus::Latest<nodmap::odometry_t> odometry;
  bus::Latest<nodmap::base_sensors_t> sensors;
  bus::Latest<nodmap::status_t> status;
  node::MessageCounts counts;
  node::Context context{bus, counts, {}};
  serial::SerialLink::Opener open = [this]() -> serial::OpenResult {
    if (!pty) {
      return {nullptr, "/dev/kurt: No such file or directory"};
    }
    return serial::open_serial_port({pty->name()});
  };
  std::optional<KurtNode> node{std::in_place, context, KurtParams{}, open, [this] {
                                 return time::Moment{clock.now(), now};
                               }};
  node::StatusReporter reporter{"nodmap-kurt", bus, counts, clock};

 private:
  std::string answer_;
};

}  // namespace node_test
}  // namespace nodmap::kurt
