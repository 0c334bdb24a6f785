// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/recording.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/data_dir.hpp"

namespace nodmap::convert {
namespace recording_test {

nodmap::odometry_t odometry_at(std::int64_t utime_us) {
  nodmap::odometry_t message{};
  message.utime = utime_us;
  return message;
}

TEST(Recording, LogTimeNeverStepsBackAndMessagesKeepTheirs) {
  const test::TemporaryDir dir;
  Recording recording(dir.path() / "a.lcmlog");
  const std::vector<std::int64_t> utimes = {100, 300, 200, 400};
  for (const std::int64_t utime_us : utimes) {
    recording.add_odometry(odometry_at(utime_us));
  }
  recording.commit("in", "");
  bus::LogReader reader(dir.path() / "a.lcmlog");
  const std::vector<std::int64_t> log_utimes = {100, 300, 300, 400};
  for (std::size_t i = 0; i < utimes.size(); ++i) {
    const bus::LogEvent* event = reader.next();
    ASSERT_NE(event, nullptr);
    nodmap::odometry_t message{};
    ASSERT_TRUE(bus::decode_into(message, event->data));
    EXPECT_EQ(event->log_utime_us, log_utimes[i]);
    EXPECT_EQ(message.utime, utimes[i]);
    EXPECT_EQ(message.odometry_seq, static_cast<std::int64_t>(i));
  }
}

TEST(Recording, LeavesNothingUnlessCommitted) {
  const test::TemporaryDir dir;
  {
    Recording recording(dir.path() / "a.lcmlog");
    recording.add_odometry(odometry_at(1));
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
  {
    Recording empty(dir.path() / "a.lcmlog");
    EXPECT_THROW(empty.commit("in", ""), std::runtime_error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(Recording, NeverOverwrites) {
  const test::TemporaryDir dir;
  const auto taken = dir.path() / "a.lcmlog";
  {
    Recording late(taken);
    late.add_odometry(odometry_at(1));
    std::ofstream(taken) << "mine";  // another process has created it meanwhile
    EXPECT_THROW(late.commit("in", ""), std::runtime_error);
  }
  EXPECT_THROW(Recording{taken}, std::runtime_error);
  std::string content;
  std::getline(std::ifstream(taken), content);
  EXPECT_EQ(content, "mine");
  EXPECT_THROW(Recording{dir.path() / "no" / "such" / "folder.lcmlog"}, std::runtime_error);
}

}  // namespace recording_test
}  // namespace nodmap::convert
