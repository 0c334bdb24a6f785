// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/node/messages.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::pitch_controller {
namespace node_test {

class PitchControllerNodeTest : public ::testing::Test {
 protected:
  explicit PitchControllerNodeTest(const PitchControllerParams& params = {})
      : node_(context_, params) {}

  void give_odometry(double forward_mps) {
    auto message = node::write_odometry(time::from_utime(now_us_), geometry::SE3::Identity());
    message.odometry_seq = odometry_seq_++;
    message.forward_mps = forward_mps;
    bus_.deliver("ODOMETRY", message);
  }

  nodmap::pitch_state_t next_state() {
    // Back and forth between -60 and 60 degrees in a second each.
    const double phase = 1e-6 * static_cast<double>(now_us_);
    const auto sweep = static_cast<std::int64_t>(phase);
    const double share = phase - static_cast<double>(sweep);
    nodmap::pitch_state_t message{};
    message.utime = now_us_;
    message.state_seq = state_seq_++;
    message.pitch_rad = geometry::kPi / 3.0 * (sweep % 2 == 0 ? 2 * share - 1 : 1 - 2 * share);
    message.pitch_rate_rad_s = 2.0 * geometry::kPi / 3.0;
    message.pitch_is_measured = 1;
    message.sweep_count = sweep;
    return message;
  }

  void run(double seconds, double forward_mps) {
    for (int i = 0; i < static_cast<int>(std::lround(200 * seconds)); ++i) {
      now_us_ += 5000;
      if (i % 2 == 0) {
        give_odometry(forward_mps);
      }
      bus_.deliver("PITCH_STATE", next_state());
    }
  }

  std::int64_t rejected(const std::string& cause) {
    const auto found = counts_.rejected().find(cause);
    return found == counts_.rejected().end() ? 0 : found->second;
  }

  [[nodiscard]] std::vector<nodmap::pitch_command_t> commands() const {
    return bus_.sent<nodmap::pitch_command_t>("PITCH_COMMAND");
  }

  nodmap::test::MemoryBus bus_;
  node::MessageCounts counts_;
  node::Context context_{bus_, counts_, {}};
  PitchControllerNode node_;
  std::int64_t now_us_ = 0;
  std::int64_t odometry_seq_ = 0;
  std::int64_t state_seq_ = 0;
};

TEST_F(PitchControllerNodeTest, CommandsTheNodAndTheSpeedBound) {
  run(5.0, 0.0);
  ASSERT_FALSE(commands().empty());
  const nodmap::pitch_command_t last = commands().back();
  EXPECT_NEAR(last.pitch_min_rad, -geometry::kPi / 3.0, 1e-9);
  EXPECT_NEAR(last.pitch_max_rad, geometry::kPi / 3.0, 1e-9);
  EXPECT_GT(last.sweep_s, 0.5);
  EXPECT_GT(last.max_forward_mps, 0.15);
  EXPECT_LE(std::abs(last.utime - now_us_), 20'000);
  const auto all = commands();
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].command_seq, static_cast<std::int64_t>(i));
  }
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
  EXPECT_EQ(counts_.total_rejected(), 0);
  EXPECT_EQ(node_.metrics()["commands"], commands().size());
}

TEST_F(PitchControllerNodeTest, AMissingInputInhibitsDriving) {
  give_odometry(0.0);
  ASSERT_EQ(commands().size(), 1U);
  EXPECT_EQ(commands().back().max_forward_mps, 0.0);
  EXPECT_NE(node_.health().reason.find("PITCH_STATE"), std::string::npos);
  run(5.0, 0.0);
  now_us_ += 250'000;
  bus_.deliver("PITCH_STATE", next_state());
  EXPECT_EQ(commands().back().max_forward_mps, 0.0);
  EXPECT_NE(node_.health().reason.find("ODOMETRY"), std::string::npos);
}

// A head that reports its pitch ten times a second.
TEST_F(PitchControllerNodeTest, AHeadThatReportsTooRarelyIsNamed) {
  for (int i = 0; i < 100; ++i) {
    now_us_ += 100'000;
    bus_.deliver("PITCH_STATE", next_state());
    give_odometry(0.0);
  }
  EXPECT_EQ(commands().back().max_forward_mps, 0.0);
  EXPECT_NE(node_.health().reason.find("60 ms apart"), std::string::npos) << node_.health().reason;
  run(5.0, 0.0);
  EXPECT_EQ(node_.health().reason, "");
}

TEST_F(PitchControllerNodeTest, InvalidMessagesAreCountedAndChangeNothing) {
  run(5.0, 0.0);
  const std::size_t before = commands().size();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  now_us_ += 30'000;
  give_odometry(nan);
  nodmap::pitch_state_t state = next_state();
  state.pitch_rad = nan;
  bus_.deliver("PITCH_STATE", state);
  state = next_state();
  state.pitch_rate_rad_s = std::numeric_limits<double>::infinity();
  bus_.deliver("PITCH_STATE", state);
  state = next_state();
  state.utime = std::numeric_limits<std::int64_t>::min();
  bus_.deliver("PITCH_STATE", state);
  state = next_state();
  state.sweep_count = -1;
  bus_.deliver("PITCH_STATE", state);
  EXPECT_EQ(commands().size(), before);
  EXPECT_EQ(rejected("implausible_odometry"), 1);
  EXPECT_EQ(rejected("implausible_pitch_state"), 4);
}

TEST_F(PitchControllerNodeTest, PitchStatesOfASecondProcessAreNotUsed) {
  const auto give = [this](std::uint16_t port, bool is_stalled) {
    auto state = next_state();
    state.is_stalled = is_stalled ? 1 : 0;
    bus_.set_origin({{0x7F000001, port}, {}, {}});
    bus_.deliver("PITCH_STATE", state);
  };
  give(40'000, false);
  give(40'001, true);
  EXPECT_EQ(rejected("other_sender_of_pitch_state"), 1);
  EXPECT_EQ(counts_.used(), 1);
}

TEST_F(PitchControllerNodeTest, ReportsAStalledServoAndAPitchThatIsNotMeasured) {
  run(5.0, 0.0);
  now_us_ += 20'000;
  nodmap::pitch_state_t state = next_state();
  state.is_stalled = 1;
  bus_.deliver("PITCH_STATE", state);
  EXPECT_EQ(commands().back().max_forward_mps, 0.0);
  EXPECT_NE(node_.health().reason.find("stalled"), std::string::npos);
  now_us_ += 20'000;
  state = next_state();
  state.pitch_is_measured = 0;
  bus_.deliver("PITCH_STATE", state);
  EXPECT_GT(commands().back().max_forward_mps, 0.0);
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
}

TEST_F(PitchControllerNodeTest, GapsInSequenceNumbersAreCountedAsLosses) {
  run(1.0, 0.0);
  state_seq_ += 3;
  bus_.deliver("PITCH_STATE", next_state());
  EXPECT_EQ(counts_.lost(), 3);
}

class FollowingNodeTest : public PitchControllerNodeTest {
 protected:
  FollowingNodeTest()
      : PitchControllerNodeTest([] {
          PitchControllerParams params;
          params.follows_path = true;
          return params;
        }()) {}

  nodmap::navigation_t navigation(double clear_m) {
    nodmap::navigation_t message{};
    message.utime = now_us_;
    message.behaviour = nodmap::navigation_t::STEER;
    message.clear_distance_m = clear_m;
    message.max_forward_mps = 1.5;
    return message;
  }

  // The sweep commanded at 1 m/s after `seconds` more, with a NAVIGATION every 10 ms if asked for.
  double sweep_s_after(double seconds, bool is_navigated) {
    for (int i = 0; i < static_cast<int>(std::lround(100 * seconds)); ++i) {
      if (is_navigated) {
        bus_.deliver("NAVIGATION", navigation(0.5));
      }
      run(0.01, 1.0);
    }
    return commands().back().sweep_s;
  }
};

TEST_F(FollowingNodeTest, OnAShortArcTheSweepsAreShorterAndWithoutNewsAsBefore) {
  const double by_speed_s = sweep_s_after(5.0, false);
  EXPECT_LT(sweep_s_after(0.1, true), 0.97 * by_speed_s);
  // Stale after 0.2 s. The head of this test does not obey, so its regulator is at a limit of the
  // duration.
  EXPECT_NEAR(sweep_s_after(0.3, false), by_speed_s, 0.01 * by_speed_s);
}

TEST_F(FollowingNodeTest, NavigationThatMakesNoSenseIsCountedAndNotUsed) {
  const double by_speed_s = sweep_s_after(5.0, false);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  bus_.deliver("NAVIGATION", navigation(nan));
  bus_.deliver("NAVIGATION", navigation(-1.0));
  nodmap::navigation_t message = navigation(0.5);
  message.max_forward_mps = nan;
  bus_.deliver("NAVIGATION", message);
  message = navigation(0.5);
  message.utime = std::numeric_limits<std::int64_t>::min();
  bus_.deliver("NAVIGATION", message);
  EXPECT_EQ(rejected("implausible_navigation"), 4);
  EXPECT_NEAR(sweep_s_after(0.1, false), by_speed_s, 0.01 * by_speed_s);
}

TEST_F(PitchControllerNodeTest, ByDefaultItDoesNotSubscribeToNavigation) {
  EXPECT_THROW(bus_.deliver("NAVIGATION", nodmap::navigation_t{}), std::out_of_range);
}

class FixedNodeTest : public PitchControllerNodeTest {
 protected:
  FixedNodeTest()
      : PitchControllerNodeTest([] {
          PitchControllerParams params;
          params.mode = Mode::kFixed;
          return params;
        }()) {}
};

TEST_F(FixedNodeTest, ReportsThatALevelLaserSeesNoLowObstacles) {
  nodmap::pitch_state_t state = next_state();
  state.pitch_rad = 0.0;
  bus_.deliver("PITCH_STATE", state);
  give_odometry(0.0);
  now_us_ += 20'000;
  give_odometry(0.0);
  EXPECT_EQ(commands().back().pitch_min_rad, 0.0);
  EXPECT_EQ(commands().back().pitch_max_rad, 0.0);
  EXPECT_GT(commands().back().max_forward_mps, 0.0);
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
}

}  // namespace node_test
}  // namespace nodmap::pitch_controller
