// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/replay_bus.hpp"

#include <gtest/gtest.h>

#include "tests/support/data_dir.hpp"

namespace nodmap::bus {
namespace replay_bus_test {

void write_odometry_log(const std::filesystem::path& file, int num_messages) {
  LogWriter writer(file);
  std::vector<std::byte> bytes;
  for (int i = 0; i < num_messages; ++i) {
    nodmap::odometry_t message{};
    message.utime = 1'000'000 + 10'000 * i;
    encode_into(bytes, message);
    // Logged 3 ms after it was measured.
    ASSERT_TRUE(writer.write(message.utime + 3'000, "ODOMETRY", bytes));
  }
}

// Trap: LCM's file:// provider gives the wall clock of the replay as receive time, and its writer
// stamps with it; ReplayBus uses the time of the log.
TEST(ReplayBus, AnswersAreStampedWithTheTimeOfTheLog) {
  const test::TemporaryDir dir;
  write_odometry_log(dir.path() / "in", 5);
  {
    ReplayBus bus(dir.path() / "in", dir.path() / "out");
    bus.subscribe<nodmap::odometry_t>("ODOMETRY", [&](const nodmap::odometry_t& message) {
      EXPECT_EQ(bus.log_time(), time::from_utime(message.utime) + 3ms);
      bus.publish("ANSWER", message);
    });
    while (bus.step()) {
    }
    EXPECT_EQ(bus.events_read(), 5);
    EXPECT_EQ(bus.counts().received, 5);
    EXPECT_TRUE(bus.flush());
  }
  LogReader reader(dir.path() / "out");
  for (int i = 0; i < 5; ++i) {
    const LogEvent* event = reader.next();
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->channel, "ANSWER");
    EXPECT_EQ(event->log_utime_us, 1'003'000 + 10'000 * i);
  }
  EXPECT_EQ(reader.next(), nullptr);
}

TEST(ReplayBus, CountsCorruptMessagesAndSkipsOtherChannels) {
  const test::TemporaryDir dir;
  {
    LogWriter writer(dir.path() / "in");
    const std::vector<std::byte> noise(100, std::byte{0x5A});
    ASSERT_TRUE(writer.write(1, "ODOMETRY", noise));
    ASSERT_TRUE(writer.write(2, "SOMETHING_ELSE", noise));
  }
  ReplayBus bus(dir.path() / "in", dir.path() / "out");
  bus.subscribe<nodmap::odometry_t>("ODOMETRY", [](const nodmap::odometry_t&) { FAIL(); });
  while (bus.step()) {
  }
  EXPECT_EQ(bus.counts().corrupt, 1);
  EXPECT_EQ(bus.counts().received, 0);
}

}  // namespace replay_bus_test
}  // namespace nodmap::bus
