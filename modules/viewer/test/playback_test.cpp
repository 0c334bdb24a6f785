// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/playback.hpp"

#include <gtest/gtest.h>

#include "tests/support/data_dir.hpp"

namespace nodmap::viewer {
namespace {

TEST(Playback, ParametersSteerIt) {
  const test::TemporaryDir dir;
  {
    bus::LogWriter log(dir.path() / "log");
    EXPECT_TRUE(log.write(0, "A", {}) && log.write(2'000'000, "A", {}));
  }
  bus::LogPlayer player({dir.path() / "log"});
  EXPECT_EQ(set_playback_parameter(player, "playback.paused", true).refusal, "");
  EXPECT_TRUE(player.paused());
  EXPECT_EQ(set_playback_parameter(player, "playback.speed", 4).refusal, "");
  EXPECT_EQ(player.speed(), 4.0);
  EXPECT_FALSE(set_playback_parameter(player, "playback.position_s", 1.5).went_back);
  EXPECT_TRUE(set_playback_parameter(player, "playback.position_s", 0.5).went_back);
  EXPECT_EQ(player.position_us(), 500'000);
  EXPECT_NE(set_playback_parameter(player, "playback.position_s", "x").refusal, "");
  EXPECT_NE(set_playback_parameter(player, "playback.position_s", 1e300).refusal, "");
  EXPECT_NE(set_playback_parameter(player, "playback.duration_s", 1).refusal, "");
  EXPECT_EQ(playback_parameters(player)[1]["value"], 2.0);
  EXPECT_EQ(playback_parameters(player)[2], Json({{"name", "playback.begin_s"}, {"value", 0.0}}))
      << "wherever it plays";
}

}  // namespace
}  // namespace nodmap::viewer
