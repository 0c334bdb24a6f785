// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/stop_state.hpp"

#include <gtest/gtest.h>

#include "common/node/stop_latch.hpp"

namespace nodmap::foxglove {
namespace stop_state_test {

using State = StopState::State;

constexpr time::SteadyTime kStart{5h};

nodmap::stop_t stop_by(const std::string& by) {
  nodmap::stop_t message{};
  message.is_stopped = 1;
  message.requested_by = by;
  return message;
}

nodmap::stop_t release() {
  nodmap::stop_t message{};
  message.requested_by = "operator";
  return message;
}

nodmap::stop_t confirmation() {
  return stop_by(node::confirmed_name("viewer"));
}

// A viewer that repeats its STOP five times a second, from one time after the start to another.
void repeat(StopState& stop, time::Duration from, time::Duration to) {
  for (time::Duration passed = from; passed <= to; passed += 200ms) {
    stop.take(stop_by("viewer"), kStart + passed);
  }
}

TEST(StopState, WithoutAStopTheRobotIsFree) {
  EXPECT_EQ(StopState().state(), State::kReleased);
}

TEST(StopState, IsStoppedOnlyWhenTheBaseDriverSaysSo) {
  StopState stop;
  repeat(stop, 0s, 1s);
  EXPECT_EQ(stop.state(), State::kSent);
  stop.take(confirmation(), kStart + 1100ms);
  EXPECT_EQ(stop.state(), State::kStopped);
  repeat(stop, 1200ms, 2s);
  EXPECT_EQ(stop.state(), State::kStopped) << "a repetition takes nothing back";
  EXPECT_EQ(stop.to_json()["by"], "nodmap-kurt, for viewer");
  stop.take(release(), kStart + 2100ms);
  EXPECT_EQ(stop.state(), State::kReleased);
}

// The base driver alone has sent STOP, and dies.
TEST(StopState, AConfirmationDoesNotOutliveItsBaseDriver) {
  StopState stop;
  stop.take(confirmation(), kStart);
  EXPECT_FALSE(stop.pass(kStart + 2400ms));
  EXPECT_EQ(stop.state(), State::kStopped);
  EXPECT_TRUE(stop.pass(kStart + 2500ms));
  EXPECT_EQ(stop.state(), State::kNotConfirmed);
  EXPECT_FALSE(stop.pass(kStart + 3s));
  stop.take(confirmation(), kStart + 4s);
  EXPECT_EQ(stop.state(), State::kStopped);
}

TEST(StopState, IsNotConfirmedIfNoBaseDriverSpeaks) {
  StopState stop;
  repeat(stop, 0s, 5s);
  EXPECT_EQ(stop.state(), State::kNotConfirmed);
  EXPECT_EQ(stop.to_json()["state"], "NOT_CONFIRMED");
  EXPECT_EQ(stop.to_json()["by"], "viewer");
}

TEST(StopState, IsNoLongerConfirmedIfTheBaseDriverFallsSilent) {
  StopState stop;
  stop.take(confirmation(), kStart);
  repeat(stop, 200ms, 2s);
  EXPECT_EQ(stop.state(), State::kStopped);
  repeat(stop, 2200ms, 4s);
  EXPECT_EQ(stop.state(), State::kNotConfirmed);
  EXPECT_EQ(stop.to_json()["by"], "viewer");
  stop.take(confirmation(), kStart + 4100ms);
  EXPECT_EQ(stop.state(), State::kStopped);
}

TEST(StopState, AConfirmationIsForgottenWithTheRelease) {
  StopState stop;
  stop.take(confirmation(), kStart);
  stop.take(release(), kStart + 100ms);
  stop.take(stop_by("viewer"), kStart + 200ms);
  EXPECT_EQ(stop.state(), State::kSent);
}

TEST(StopState, AStopOfTheBaseDriversOwnIsConfirmedAtOnce) {
  StopState stop;
  stop.take(stop_by(node::confirmed_name("its start")), kStart);
  EXPECT_EQ(stop.state(), State::kStopped);
}

}  // namespace stop_state_test
}  // namespace nodmap::foxglove
