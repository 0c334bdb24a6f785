// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/log_summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "common/bus/codec.hpp"
#include "nodmap/loop_2d_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/status_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::convert {
namespace log_summary_test {

template <class Message>
std::vector<std::byte> encoded(const Message& message) {
  std::vector<std::byte> bytes;
  bus::encode_into(bytes, message);
  return bytes;
}

std::vector<std::byte> odometry_at(std::int64_t utime_us) {
  nodmap::odometry_t message{};
  message.utime = utime_us;
  return encoded(message);
}

class LogSummaryTest : public testing::Test {
 protected:
  void write() {
    bus::LogWriter writer(log_);
    const auto put = [&](std::int64_t utime_us, const char* channel,
                         const std::vector<std::byte>& bytes) {
      ASSERT_TRUE(writer.write(utime_us, channel, bytes));
    };
    put(1'000'000, "ODOMETRY", odometry_at(5));
    put(1'500'000, "ODOMETRY", odometry_at(7));
    put(3'000'000, "ODOMETRY", odometry_at(6));
    auto damaged = odometry_at(8);
    damaged.pop_back();
    put(3'000'000, "ODOMETRY", damaged);
    put(3'000'000, "ODOMETRY", encoded(nodmap::status_t{}));
    put(2'000'000, "FOREIGN", std::vector<std::byte>(12));
    put(2'500'000, "SHORT", {});
  }

  test::TemporaryDir dir_;
  std::filesystem::path log_ = dir_.path() / "a.lcmlog";
};

// In a saved map a loop begins with the number of a submap.
TEST_F(LogSummaryTest, AMessageWithoutATimeDoesNotStepBack) {
  {
    bus::LogWriter writer(log_);
    for (const std::int32_t submap : {9, 2, 5}) {
      nodmap::loop_2d_t loop{};
      loop.from_submap = submap;
      ASSERT_TRUE(writer.write(1'000'000, "LOOP_2D", encoded(loop)));
    }
  }
  const ChannelSummary loops = summarize_log(log_).channels.at("LOOP_2D");
  EXPECT_EQ(loops.corrupt, 0);
  EXPECT_EQ(loops.steps_back, 0);
}

// As in two recordings, one behind the other in a file.
TEST_F(LogSummaryTest, ALogWhoseTimeStepsBackHasADuration) {
  {
    bus::LogWriter writer(log_);
    for (const std::int64_t utime_us : {8'000'000, 9'000'000, 1'000'000, 2'000'000, 7'000'000}) {
      ASSERT_TRUE(writer.write(utime_us, "ODOMETRY", odometry_at(utime_us)));
    }
  }
  const LogSummary summary = summarize_log(log_);
  EXPECT_EQ(summary.channels.at("ODOMETRY").duration_s(), 8.0);
  EXPECT_EQ(summary.channels.at("ODOMETRY").longest_gap, 5s);
}

TEST_F(LogSummaryTest, CountsByChannel) {
  write();
  std::ofstream(log_, std::ios::app) << "damage";
  const LogSummary summary = summarize_log(log_);
  ASSERT_EQ(summary.channels.size(), 3U);
  const ChannelSummary& odometry = summary.channels.at("ODOMETRY");
  EXPECT_EQ(odometry.type, "nodmap.odometry_t");
  EXPECT_EQ(odometry.count, 5);
  EXPECT_EQ(odometry.corrupt, 2);  // one cut short, one of another type
  EXPECT_EQ(odometry.steps_back, 1);
  EXPECT_EQ(odometry.longest_gap, 1500ms);
  EXPECT_DOUBLE_EQ(odometry.rate_hz(), 2.0);
  const ChannelSummary& foreign = summary.channels.at("FOREIGN");
  EXPECT_EQ(foreign.type, "? 0000000000000000");
  EXPECT_EQ(foreign.corrupt, 0);  // unknown types cannot be checked
  EXPECT_EQ(foreign.rate_hz(), 0.0);
  EXPECT_EQ(summary.skipped_bytes, 6);
}

TEST_F(LogSummaryTest, PrintsATable) {
  write();
  std::ostringstream text;
  print(text, summarize_log(log_));
  EXPECT_THAT(text.str(), testing::ContainsRegex("ODOMETRY +nodmap.odometry_t +5 +2.00 +1.500"));
  EXPECT_THAT(text.str(), testing::HasSubstr("duration 2.000 s, 0 bytes skipped"));
  std::ostringstream nothing;
  print(nothing, LogSummary{});
  EXPECT_THAT(nothing.str(), testing::HasSubstr("duration 0.000 s"));
}

TEST(LogSummary, MissingLogIsAnError) {
  EXPECT_THROW((void)summarize_log("/no/such.lcmlog"), std::runtime_error);
}

}  // namespace log_summary_test
}  // namespace nodmap::convert
