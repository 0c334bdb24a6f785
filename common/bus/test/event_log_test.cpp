// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/event_log.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <lcm/lcm-cpp.hpp>
#include <random>

#include "tests/support/data_dir.hpp"

namespace nodmap::bus {
namespace event_log_test {

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto view = std::as_bytes(std::span(text));
  return {view.begin(), view.end()};
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void write_sample(const std::filesystem::path& file, int num_events) {
  LogWriter writer(file);
  for (int i = 0; i < num_events; ++i) {
    ASSERT_TRUE(writer.write(1'000'000 + i, "CHANNEL_" + std::to_string(i % 3),
                             bytes_of(std::string(static_cast<std::size_t>(i % 50), 'x'))));
  }
  ASSERT_TRUE(writer.flush());
}

std::string slurp(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void spill(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

int count_events(LogReader& reader) {
  int count = 0;
  while (reader.next() != nullptr) {
    ++count;
  }
  return count;
}

// Oracle: LCM's own reader.
TEST(EventLog, LcmReadsWhatWeWrite) {
  const test::TemporaryDir dir;
  const auto file = dir.path() / "a.lcmlog";
  write_sample(file, 100);
  lcm::LogFile theirs(file.string(), "r");
  LogReader ours(file);
  ASSERT_TRUE(theirs.good());
  for (int i = 0; i < 100; ++i) {
    const lcm::LogEvent* expected = theirs.readNextEvent();
    const LogEvent* event = ours.next();
    ASSERT_NE(expected, nullptr);
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->event_number, expected->eventnum);
    EXPECT_EQ(event->log_utime_us, expected->timestamp);
    EXPECT_EQ(event->channel, expected->channel);
    EXPECT_EQ(text_of(event->data), std::string(static_cast<const char*>(expected->data),
                                                static_cast<std::size_t>(expected->datalen)));
  }
  EXPECT_EQ(theirs.readNextEvent(), nullptr);
  EXPECT_EQ(ours.next(), nullptr);
}

// Oracle: LCM's own writer.
TEST(EventLog, WeReadWhatLcmWrites) {
  const test::TemporaryDir dir;
  const auto file = dir.path() / "a.lcmlog";
  {
    lcm::LogFile theirs(file.string(), "w");
    std::string data = "hello";
    lcm::LogEvent event{};
    event.timestamp = 42;
    event.channel = "POSE";
    event.datalen = static_cast<int>(data.size());
    event.data = data.data();
    ASSERT_EQ(theirs.writeEvent(&event), 0);
  }
  LogReader reader(file);
  const LogEvent* event = reader.next();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->log_utime_us, 42);
  EXPECT_EQ(event->channel, "POSE");
  EXPECT_EQ(text_of(event->data), "hello");
}

TEST(EventLog, ACutOffLastEventIsSkippedAndCounted) {
  const test::TemporaryDir dir;
  write_sample(dir.path() / "whole", 10);
  const std::string whole = slurp(dir.path() / "whole");
  // The last event is 28 + 9 + 9 bytes; cut it at each of them.
  for (std::size_t cut = 1; cut < 46; ++cut) {
    const auto file = dir.path() / ("cut" + std::to_string(cut));
    spill(file, whole.substr(0, whole.size() - cut));
    LogReader reader(file);
    EXPECT_EQ(count_events(reader), 9);
    EXPECT_EQ(reader.skipped_bytes(), 46 - static_cast<std::int64_t>(cut));
  }
}

TEST(EventLog, DamageInTheMiddleCostsOnlyTheEventsItHits) {
  const test::TemporaryDir dir;
  write_sample(dir.path() / "whole", 100);
  std::string content = slurp(dir.path() / "whole");
  content[content.size() / 2] = '\xFF';
  content.insert(content.size() / 3, "garbage between two events or within one");
  spill(dir.path() / "damaged", content);
  LogReader reader(dir.path() / "damaged");
  EXPECT_GE(count_events(reader), 98);
}

TEST(EventLog, AClaimedSizeBeyondTheFileIsNotBelieved) {
  const test::TemporaryDir dir;
  write_sample(dir.path() / "whole", 3);
  std::string content = slurp(dir.path() / "whole");
  content[24] = '\x0F';  // data size of the first event: 250 MB
  spill(dir.path() / "damaged", content);
  LogReader reader(dir.path() / "damaged");
  EXPECT_EQ(count_events(reader), 2);
}

TEST(EventLog, RandomBytesHoldNoEvents) {
  const test::TemporaryDir dir;
  std::mt19937 random(3);
  std::string noise(1'000'000, '\0');
  for (char& c : noise) {
    c = static_cast<char>(random() & 0xFFU);
  }
  spill(dir.path() / "noise", noise);
  LogReader reader(dir.path() / "noise");
  EXPECT_EQ(count_events(reader), 0);
  EXPECT_EQ(reader.skipped_bytes(), 1'000'000);
}

TEST(EventLog, EmptyAndMissingFiles) {
  const test::TemporaryDir dir;
  spill(dir.path() / "empty", "");
  LogReader reader(dir.path() / "empty");
  EXPECT_EQ(reader.next(), nullptr);
  EXPECT_THROW(LogReader(dir.path() / "missing"), std::runtime_error);
  EXPECT_THROW(LogReader(dir.path()), std::runtime_error);
}

// After a power cut a file whose name did not reach the disk is gone.
TEST(EventLog, SyncPutsTheFileAndOnceItsNameOnTheDisk) {
  const test::TemporaryDir dir;
  LogWriter writer(dir.path() / "log");
  EXPECT_EQ(writer.num_syncs(), 0);
  EXPECT_TRUE(writer.sync());
  EXPECT_EQ(writer.num_syncs(), 2);
  EXPECT_TRUE(writer.sync());
  EXPECT_EQ(writer.num_syncs(), 3);
}

TEST(EventLog, AFileWhoseNameCannotReachTheDiskIsReported) {
  const test::TemporaryDir dir;
  std::filesystem::create_directory(dir.path() / "logs");
  LogWriter writer(dir.path() / "logs" / "log");
  std::filesystem::remove_all(dir.path() / "logs");
  EXPECT_FALSE(writer.sync());
  EXPECT_TRUE(writer.failure());
}

TEST(EventLog, NeverOverwrites) {
  const test::TemporaryDir dir;
  spill(dir.path() / "precious", "x");
  EXPECT_THROW(LogWriter(dir.path() / "precious"), std::runtime_error);
  EXPECT_EQ(slurp(dir.path() / "precious"), "x");
}

// A limit on the size of files stands in for a disk that is full: write() fails in the same way.
TEST(EventLog, AFullDiskIsReportedAndKeepsTheWrittenEvents) {
  const test::TemporaryDir dir;
  const auto file = dir.path() / "a.lcmlog";
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  ASSERT_NE(std::signal(SIGXFSZ, SIG_IGN), SIG_ERR);
  const struct rlimit full { 10'000, before.rlim_max };
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  std::int64_t size_bytes = 0;
  {
    LogWriter writer(file);
    const std::vector<std::byte> data(972);
    for (int i = 0; i < 100; ++i) {
      if (!writer.write(i, "DATA", data)) {
        break;
      }
    }
    EXPECT_FALSE(writer.flush());
    EXPECT_FALSE(writer.write(0, "DATA", data));
    size_bytes = writer.size_bytes();
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(size_bytes, 10'000);
  LogReader reader(file);
  EXPECT_EQ(count_events(reader), 9);  // of 1004 bytes each; the tenth is torn
}

}  // namespace event_log_test
}  // namespace nodmap::bus
