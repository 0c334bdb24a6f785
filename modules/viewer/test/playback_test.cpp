// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/playback.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "common/bus/codec.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::viewer {
namespace playback_test {

TEST(Playback, IsControlledByParameters) {
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
  EXPECT_EQ(player.position(), 500ms);
  EXPECT_NE(set_playback_parameter(player, "playback.position_s", "x").refusal, "");
  EXPECT_NE(set_playback_parameter(player, "playback.position_s", 1e300).refusal, "");
  EXPECT_NE(set_playback_parameter(player, "playback.duration_s", 1).refusal, "");
  EXPECT_EQ(playback_parameters(player)[1]["value"], 2.0);
  EXPECT_EQ(playback_parameters(player)[2], Json({{"name", "playback.begin_s"}, {"value", 0.0}}))
      << "whatever is being played";
}

TEST(Playback, EventsMarkTheBeginningsOfStopsKeyframesAndFaults) {
  const test::TemporaryDir dir;
  {
    bus::LogWriter log(dir.path() / "log");
    std::vector<std::byte> bytes;
    const auto add = [&](double time_s, const char* channel, const auto& message) {
      bus::encode_into(bytes, message);
      ASSERT_TRUE(log.write(std::llround(1e6 * (100 + time_s)), channel, bytes));
    };
    nodmap::stop_t stop{};
    nodmap::status_t status{};
    nodmap::cloud_chunk_t chunk{};
    stop.requested_by = "me";
    status.process_name = "nodmap-kurt";
    add(0.0, "STOP", stop);
    stop.is_stopped = true;
    add(1.0, "STOP", stop);
    add(1.5, "STOP", stop);  // the same stop
    chunk.keyframe_id = 7;
    add(2.0, "CLOUD", chunk);
    add(2.1, "CLOUD", chunk);  // its second part
    status.health = nodmap::status_t::FAILED;
    status.health_reason = "no answer";
    add(3.0, "STATUS", status);
    add(4.0, "STATUS", status);
    status.health = nodmap::status_t::OK;
    add(5.0, "STATUS", status);
    add(3'605.0, "STATUS", status);  // the clock was set
    status.health = nodmap::status_t::FAILED;
    status.health_reason = "no answer\nfrom the base";
    add(3'606.25, "STATUS", status);
    ASSERT_TRUE(log.write(200'000'000, "STOP", std::span(bytes).first(9)));  // damaged
  }
  const std::vector<std::string> expected = {"1.000 stop by me", "2.000 keyframe 7",
                                             "3.000 fault nodmap-kurt: no answer",
                                             "6.250 fault nodmap-kurt: no answer?from the base"};
  EXPECT_EQ(playback_events({dir.path() / "log"}), expected);
}

}  // namespace playback_test
}  // namespace nodmap::viewer
