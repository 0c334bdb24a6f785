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
  /// A log of one-byte messages on channel A at these times after the common begin.
  std::filesystem::path log(const std::string& name, const std::vector<int>& times_us, char first) {
    const std::filesystem::path path = dir_.path() / name;
    LogWriter writer(path);
    for (const int time_us : times_us) {
      const std::string text(1, first++);
      EXPECT_TRUE(writer.write(1'000'000 + time_us, "A", std::as_bytes(std::span(text))));
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
  LogPlayer player({log("a", {0, 100, 200}, 'a')});
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

TEST_F(LogPlayerTest, MergesLogsByTime) {
  LogPlayer player({log("a", {0, 100, 200}, 'a'), log("b", {50, 100, 150}, 'x')});
  receive_from(player);
  player.advance(200us);
  player.catch_up(kMany);
  EXPECT_EQ(received_, "axbyzc");
}

TEST_F(LogPlayerTest, SpeedAndPause) {
  LogPlayer player({log("a", {0, 1000}, 'a')});
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
  LogPlayer player({log("a", {0, 100, 200}, 'a')});
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
  LogPlayer player({log("a", {0, 1, 2, 3}, 'a')});
  receive_from(player);
  player.advance(10us);
  EXPECT_FALSE(player.catch_up(3));
  EXPECT_EQ(received_, "abc");
  EXPECT_TRUE(player.catch_up(3));
  EXPECT_EQ(received_, "abcd");
}

TEST_F(LogPlayerTest, SendsNothingAnywhere) {
  LogPlayer player({log("a", {0}, 'a')});
  player.publish("DRIVE", nodmap::drive_t{});
  EXPECT_EQ(player.counts().published, 0);
}

TEST_F(LogPlayerTest, AnEmptyLogIsAnError) {
  EXPECT_THROW(LogPlayer({log("a", {}, 'a')}), std::runtime_error);
  EXPECT_THROW(LogPlayer({dir_.path() / "missing"}), std::runtime_error);
}

}  // namespace log_player_test
}  // namespace nodmap::bus
