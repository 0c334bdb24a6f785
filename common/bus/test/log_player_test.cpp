// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/log_player.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "nodmap/drive_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::bus {
namespace log_player_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::int64_t kMany = 1'000'000;

class LogPlayerTest : public ::testing::Test {
 protected:
  // A log of one-byte messages on channel A at these times after the common begin.
  std::filesystem::path log(const std::string& name, const std::vector<time::Duration>& times,
                            char first) {
    const std::filesystem::path path = dir_.path() / name;
    LogWriter writer(path);
    for (const time::Duration time : times) {
      const std::string text(1, first++);
      EXPECT_TRUE(writer.write(time::to_us(1s + time), "A", std::as_bytes(std::span(text))));
    }
    return path;
  }

  void receive_from(LogPlayer& player) {
    player.subscribe_bytes("A", [this](std::span<const std::byte> bytes) {
      received_.push_back(static_cast<char>(bytes[0]));
    });
  }

  nodmap::test::TemporaryDir dir_;
  std::string received_;
};

TEST_F(LogPlayerTest, DeliversEventsUpToThePosition) {
  LogPlayer player({log("a", {0us, 100us, 200us}, 'a')});
  receive_from(player);
  EXPECT_TRUE(player.catch_up(kMany));
  EXPECT_EQ(received_, "a");
  player.advance(99us);
  player.catch_up(kMany);
  EXPECT_EQ(received_, "a");
  player.advance(1us);
  player.catch_up(kMany);
  EXPECT_EQ(received_, "ab");
  player.advance(10ms);
  player.catch_up(kMany);
  EXPECT_EQ(received_, "abc");
  EXPECT_TRUE(player.at_end());
  EXPECT_EQ(player.now(), time::Timestamp(1'000'200us));
}

TEST_F(LogPlayerTest, AMessageWasReceivedAtItsLogTime) {
  LogPlayer player({log("a", {0us, 100us}, 'a')});
  std::vector<time::Timestamp> received;
  player.subscribe_bytes("A", [&](std::span<const std::byte>) {
    received.push_back(player.origin().received);
    EXPECT_EQ(player.origin().arrived.time_since_epoch(), received.back().time_since_epoch());
  });
  player.advance(100us);
  EXPECT_TRUE(player.catch_up(kMany));
  EXPECT_THAT(received, ElementsAre(time::Timestamp(1'000'000us), time::Timestamp(1'000'100us)));
}

TEST_F(LogPlayerTest, MergesLogsByTime) {
  LogPlayer player({log("a", {0us, 100us, 200us}, 'a'), log("b", {50us, 100us, 150us}, 'x')});
  receive_from(player);
  player.advance(200us);
  player.catch_up(kMany);
  EXPECT_EQ(received_, "axbyzc");
}

// A computer without a clock of its own is set while the logger runs.
TEST_F(LogPlayerTest, AStepOfTheClockIsLeftOut) {
  for (const time::Duration step :
       {time::Duration(1h), time::Duration(-1h), time::Duration(500'000h)}) {
    LogPlayer player(
        {log("a" + std::to_string(step / 1h), {2h, 2h + 100us, 2h + step, 2h + step + 50us}, 'a')});
    EXPECT_EQ(player.duration(), 150us);
    received_.clear();
    receive_from(player);
    const auto received_at = [&](time::Duration position) {
      const bool went_back = player.seek(position);
      received_ = went_back ? "" : received_;
      player.catch_up(kMany);
      return received_;
    };
    EXPECT_EQ(received_at(99us), "a");
    EXPECT_EQ(received_at(100us), "abc");
    EXPECT_EQ(received_at(149us), "abc");
    EXPECT_EQ(received_at(150us), "abcd");
    EXPECT_EQ(player.event_time(), player.now());
    EXPECT_EQ(received_at(99us), "a");
    EXPECT_EQ(received_at(150us), "abcd");
  }
}

// The clock was set in the first of two logs that the logger split.
TEST_F(LogPlayerTest, AStepOfTheClockIsLeftOutInTheNextLogToo) {
  LogPlayer player({log("a", {0us, 100us, 1h + 100us}, 'a'), log("b", {1h + 200us}, 'x')});
  EXPECT_EQ(player.duration(), 200us);
}

TEST_F(LogPlayerTest, APauseOfAMinuteStays) {
  LogPlayer player({log("a", {0us, 60s}, 'a')});
  EXPECT_EQ(player.duration(), 60s);
}

TEST_F(LogPlayerTest, SpeedAndPause) {
  LogPlayer player({log("a", {0us, 1000us}, 'a')});
  player.set_speed(2.0);
  player.advance(100us);
  EXPECT_EQ(player.position(), 200us);
  player.set_paused(true);
  player.advance(100us);
  EXPECT_EQ(player.position(), 200us);
  player.set_speed(1e9);
  EXPECT_EQ(player.speed(), LogPlayer::kMaxSpeed);
  player.set_speed(-1.0);
  EXPECT_EQ(player.speed(), LogPlayer::kMinSpeed);
}

TEST_F(LogPlayerTest, SeekingBackStartsAgain) {
  LogPlayer player({log("a", {0us, 100us, 200us}, 'a')});
  receive_from(player);
  EXPECT_FALSE(player.seek(200us));
  player.catch_up(kMany);
  EXPECT_EQ(received_, "abc");
  EXPECT_TRUE(player.seek(100us));
  player.catch_up(kMany);
  EXPECT_EQ(received_, "abcab");
  EXPECT_FALSE(player.seek(5ms));
  EXPECT_EQ(player.position(), 200us);
}

TEST_F(LogPlayerTest, ManyEventsAreDeliveredInParts) {
  LogPlayer player({log("a", {0us, 1us, 2us, 3us}, 'a')});
  receive_from(player);
  player.advance(10us);
  EXPECT_FALSE(player.catch_up(3));
  EXPECT_EQ(received_, "abc");
  EXPECT_TRUE(player.catch_up(3));
  EXPECT_EQ(received_, "abcd");
}

TEST_F(LogPlayerTest, SendsNothingAnywhere) {
  LogPlayer player({log("a", {0us}, 'a')});
  player.publish("DRIVE", nodmap::drive_t{});
  EXPECT_EQ(player.counts().published, 0);
}

TEST_F(LogPlayerTest, AnEmptyLogIsAnError) {
  EXPECT_THROW(LogPlayer({log("a", {}, 'a')}), std::runtime_error);
  EXPECT_THROW(LogPlayer({dir_.path() / "missing"}), std::runtime_error);
}

}  // namespace log_player_test
}  // namespace nodmap::bus
