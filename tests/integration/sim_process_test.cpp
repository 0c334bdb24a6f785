// SPDX-License-Identifier: BSD-3-Clause
// nodmap-sim and the drivers as processes, connected by pseudo-terminals, on a real network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/bus/live_bus.hpp"
#include "common/geometry/time.hpp"
#include "common/statistics/quantile.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/truth_t.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap {
namespace sim_process_test {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;
using test::ChildProcess;
using test::kPatience;
using ::testing::HasSubstr;

constexpr const char* kUrl = "udpm://239.255.76.67:7693?ttl=0&recv_buf_size=4000000";

constexpr const char* kRoom = R"(name: room
objects:
  - wall: {from: [-4, -3], to: [4, -3], z: [0, 2.5], thickness: 0.1}
  - wall: {from: [-4, 3], to: [4, 3], z: [0, 2.5], thickness: 0.1}
  - wall: {from: [-4, -3], to: [-4, 3], z: [0, 2.5], thickness: 0.1}
  - wall: {from: [4, -3], to: [4, 3], z: [0, 2.5], thickness: 0.1}
robot: {start: [0, 0, 0]}
)";

// The stamps of a stream of messages.
struct Stamps {
  std::vector<time::Timestamp> stamps;

  void clear() { stamps.clear(); }
  // From the median of the intervals, so that losses on a busy machine do not count.
  [[nodiscard]] double rate_hz() const {
    return 1.0 / time::seconds(statistics::quantile(intervals(), 0.5));
  }
  [[nodiscard]] double longest_gap_s() const {
    return time::seconds(std::ranges::max(intervals()));
  }
  [[nodiscard]] std::vector<time::Duration> intervals() const {
    std::vector<time::Duration> intervals;
    for (std::size_t i = 1; i < stamps.size(); ++i) {
      intervals.push_back(stamps[i] - stamps[i - 1]);
    }
    return intervals;
  }
};

class SimProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"NODMAP_SIM", "NODMAP_LASER3D", "NODMAP_KURT"}) {
      ASSERT_NE(std::getenv(program), nullptr) << program << " is set by ctest";
    }
    std::ofstream(world_) << kRoom;
    stamp<nodmap::scan_t>("SCAN", scans_);
    stamp<nodmap::pitch_state_t>("PITCH_STATE", pitches_);
    stamp<nodmap::odometry_t>("ODOMETRY", odometry_);
    stamp<nodmap::truth_t>("TRUTH", truths_);
  }

  template <class Message>
  void stamp(const std::string& channel, Stamps& stream) {
    bus_.subscribe<Message>(channel, [&stream](const Message& message) {
      stream.stamps.push_back(time::from_utime(message.utime));
    });
  }

  [[nodiscard]] std::vector<std::string> sim_command(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{
        std::getenv("NODMAP_SIM"), "--lcm-url", kUrl,           "--world",
        world_.string(),           "--links",   links_.string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  void start_drivers() {
    laser_.emplace(std::vector<std::string>{std::getenv("NODMAP_LASER3D"), "--lcm-url", kUrl,
                                            "--set", "laser.device=" + (links_ / "laser").string(),
                                            "--set",
                                            "servo.device=" + (links_ / "servo").string()});
    base_.emplace(std::vector<std::string>{std::getenv("NODMAP_KURT"), "--lcm-url", kUrl, "--set",
                                           "device=" + (links_ / "base").string()});
  }

  bool listen_until(const std::function<bool()>& done) {
    const auto deadline = SteadyClock::now() + kPatience;
    while (!done() && SteadyClock::now() < deadline) {
      bus_.handle(milliseconds(20));
    }
    return done();
  }

  void forget() {
    for (Stamps* stamps : {&scans_, &pitches_, &odometry_, &truths_}) {
      stamps->clear();
    }
  }

  test::TemporaryDir dir_;
  std::filesystem::path world_ = dir_.path() / "room.yaml";
  std::filesystem::path links_ = dir_.path() / "links";
  bus::LiveBus bus_{kUrl};
  Stamps scans_;
  Stamps pitches_;
  Stamps odometry_;
  Stamps truths_;
  std::optional<ChildProcess> laser_;
  std::optional<ChildProcess> base_;
};

TEST_F(SimProcess, TheDriversFindTheirDevicesAndPublishAtTheirRates) {
  const auto out = dir_.path() / "out";
  ChildProcess sim(sim_command({"--out", out.string()}));
  ASSERT_TRUE(sim.wait_for_stderr("devices in", kPatience)) << sim.said();
  start_drivers();
  ASSERT_TRUE(
      listen_until([this] { return scans_.stamps.size() > 10 && !odometry_.stamps.empty(); }));
  forget();
  ASSERT_TRUE(listen_until([this] {
    return scans_.stamps.size() > 350 && odometry_.stamps.size() > 350 &&
           truths_.stamps.size() > 200 && pitches_.stamps.size() > 350;
  }));
  // The clocks of mirror and base are slightly slow on purpose.
  EXPECT_NEAR(scans_.rate_hz(), 1e6 / 13'320.0, 0.5);
  EXPECT_NEAR(odometry_.rate_hz(), 100.0, 1.0);
  EXPECT_NEAR(truths_.rate_hz(), 50.0, 0.5);
  sim.send_signal(SIGINT);
  EXPECT_EQ(sim.wait_for_end(kPatience), 0);
  EXPECT_THAT(sim.said(), HasSubstr("0 collisions"));
  EXPECT_FALSE(std::filesystem::exists(links_)) << "links and folder have been removed";
  nlohmann::json result;
  std::ifstream(out / "result.json") >> result;
  EXPECT_EQ(result["collisions"], 0);
  EXPECT_GT(result["duration_s"], 4.0) << "350 scans take 4.7 s";
  EXPECT_NEAR(result["min_clearance_m"], 3.0 - 0.05 - 0.165, 1e-3);
}

TEST_F(SimProcess, TheDriversRecoverWhenTheirPortsComeBack) {
  // Every ten seconds, because it can take the drivers any number of seconds until they read.
  std::vector<std::string> faults;
  for (const char* window : {":unplug@6+2", ":unplug@16+2", ":unplug@26+2", ":unplug@36+2"}) {
    for (const std::string part : {"laser", "base", "servo"}) {
      faults.insert(faults.end(), {"--fault", part + window});
    }
  }
  ChildProcess sim(sim_command(faults));
  ASSERT_TRUE(sim.wait_for_stderr("devices in", kPatience)) << sim.said();
  start_drivers();
  ASSERT_TRUE(listen_until([this] { return !scans_.stamps.empty() && !odometry_.stamps.empty(); }));
  const auto is_plugged = [this] { return std::filesystem::exists(links_ / "laser"); };
  ASSERT_TRUE(listen_until([&] { return !is_plugged(); })) << "unplugged, its link is gone";
  ASSERT_TRUE(listen_until(is_plugged));
  const std::size_t num_scans = scans_.stamps.size();
  const std::size_t num_odometry = odometry_.stamps.size();
  ASSERT_TRUE(listen_until([&] {
    return scans_.stamps.size() > num_scans + 100 && odometry_.stamps.size() > num_odometry + 100;
  }));
  // By the stamps, in which the 2 s without devices are less than 0.1 s shorter.
  EXPECT_GT(scans_.longest_gap_s(), 1.9);
  EXPECT_GT(odometry_.longest_gap_s(), 1.9);
  sim.send_signal(SIGTERM);
  EXPECT_EQ(sim.wait_for_end(kPatience), 0);
}

TEST_F(SimProcess, PublishesStatus) {
  bus::Latest<nodmap::status_t> status(bus_, "STATUS");
  ChildProcess sim(sim_command({"--duration", "3"}));
  ASSERT_TRUE(listen_until([&status] { return status.get().has_value(); }));
  EXPECT_EQ(status.get()->process_name, "nodmap-sim");
  EXPECT_EQ(sim.wait_for_end(kPatience), 0) << "it ends after its duration";
}

TEST_F(SimProcess, LeavesForeignFilesAndTheLinksOfAnotherSimulatorAlone) {
  std::filesystem::create_directory(links_);
  std::ofstream(links_ / "servo") << "precious";
  ChildProcess sim(sim_command());
  EXPECT_EQ(sim.wait_for_end(kPatience), 1);
  EXPECT_THAT(sim.said(), HasSubstr("servo: exists and is not a link of the simulator"));
  EXPECT_EQ(std::filesystem::file_size(links_ / "servo"), 8U);
  std::filesystem::remove(links_ / "servo");
  // It replaces the links of a simulator that was killed, but not those of one that runs.
  std::filesystem::create_symlink("/dev/pts/1000000", links_ / "laser");
  ChildProcess first(sim_command());
  ASSERT_TRUE(first.wait_for_stderr("devices in", kPatience)) << first.said();
  ChildProcess second(sim_command());
  EXPECT_EQ(second.wait_for_end(kPatience), 1);
  EXPECT_THAT(second.said(), HasSubstr("in use by another simulator"));
  EXPECT_TRUE(std::filesystem::is_symlink(links_ / "laser"));
}

TEST_F(SimProcess, RefusesUnknownFaultsAndInvalidWorlds) {
  ChildProcess fault(sim_command({"--fault", "laser:melt@1+1"}));
  EXPECT_EQ(fault.wait_for_end(kPatience), 2);
  EXPECT_THAT(fault.said(), HasSubstr("'melt' is not one of drop"));
  std::ofstream(world_) << "objects: 5\n";
  ChildProcess world(sim_command());
  EXPECT_EQ(world.wait_for_end(kPatience), 2);
}

}  // namespace sim_process_test
}  // namespace nodmap
