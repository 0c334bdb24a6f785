// SPDX-License-Identifier: BSD-3-Clause
// The loop as on the robot: nodmap-kurt as a process, DRIVE and ODOMETRY over LCM's multicast,
// bytes over a pseudo-terminal. Run by tests/support/private_network.sh.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <optional>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "drivers/kurt/test/kurt_emulator.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::kurt {
namespace network_test {

constexpr std::chrono::milliseconds kNoWait{0};

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

class Network {
 public:
  Network() : odometry(bus, "ODOMETRY"), status(bus, "STATUS") {
    std::filesystem::create_symlink(pty->name(), device);
    process.emplace(std::vector<std::string>{NODMAP_KURT_PROGRAM, "--lcm-url", kUrl, "--set",
                                             "device=" + device.string(), "--log-level", "off"});
  }

  // Runs in real time until `done`.
  template <class Condition>
  bool play(Condition done) {
    return test::play(*pty, base, [&] {
      bus.handle(std::chrono::milliseconds(0));
      if (drives) {
        nodmap::drive_t message{};
        message.utime = time::to_utime(time::SystemClock().now());
        message.drive_seq = drive_seq++;
        message.forward_mps = 0.5;
        message.valid_us = 200'000;
        bus.publish("DRIVE", message);
        nodmap::stop_t go{};
        go.utime = message.utime;
        bus.publish("STOP", go);
      }
      return done();
    });
  }

  // Passes what the driver has sent so far to the base.
  void drain() { pty->send(base.take(pty->receive_text(0, kNoWait))); }

  [[nodiscard]] bool has_status(int health) const {
    return status.get() && status.get()->health == health;
  }

  test::TemporaryDir dir;
  std::filesystem::path device = dir.path() / "kurt";
  std::optional<test::PtyPair> pty{std::in_place};
  test::KurtEmulator base;
  bus::LiveBus bus{kUrl};
  bus::Latest<nodmap::odometry_t> odometry;
  bus::Latest<nodmap::status_t> status;
  std::optional<test::ChildProcess> process;
  bool drives = false;
  std::int64_t drive_seq = 0;
};

TEST(KurtNetwork, DrivesStopsWithoutDriveAndEndsWithAHardStop) {
  Network network;
  network.drives = true;
  ASSERT_TRUE(network.play([&] { return network.base.left_cm_s() == 50; }));
  ASSERT_TRUE(network.play(
      [&] { return network.odometry.get() && network.odometry.get()->forward_mps > 0.49; }));
  EXPECT_TRUE(network.play([&] { return network.has_status(nodmap::status_t::OK); }));

  network.drives = false;
  network.drain();
  const int commands = network.base.commands();
  ASSERT_TRUE(network.play([&] { return network.base.left_cm_s() == 0; }));
  // Counted in commands, one each 10 ms: 20 until the time-out, one for the frame, and those that
  // were inside the terminal when the count began.
  EXPECT_LE(network.base.commands() - commands, 25);

  network.process->send_signal(SIGTERM);
  ASSERT_TRUE(network.play(
      [&] { return network.process->wait_for_end(kNoWait).has_value() && network.base.braked(); }));
  EXPECT_EQ(network.process->wait_for_end(kNoWait), 0);
  EXPECT_EQ(network.base.nonsense(), 0);
}

TEST(KurtNetwork, APulledPlugIsReportedAndRecoveredFrom) {
  Network network;
  network.drives = true;
  ASSERT_TRUE(network.play([&] { return network.base.left_cm_s() == 50; }));
  std::filesystem::remove(network.device);
  network.pty.emplace();
  network.base = {};
  ASSERT_TRUE(network.play([&] { return network.has_status(nodmap::status_t::FAILED); }));
  std::filesystem::create_symlink(network.pty->name(), network.device);
  ASSERT_TRUE(network.play([&] { return network.base.left_cm_s() == 50; }));
  EXPECT_TRUE(network.play([&] { return network.has_status(nodmap::status_t::OK); }));
}

}  // namespace network_test
}  // namespace nodmap::kurt
