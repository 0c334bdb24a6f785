// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <boost/core/noncopyable.hpp>
#include <csignal>
#include <fstream>

#include "modules/logger/test/recorder_fixture.hpp"

namespace nodmap::logger {
namespace recorder_test {

using ::testing::ElementsAre;

// A limit on the size of files stands in for a disk that is full: write() fails in the same way.
class FileSizeLimit : private boost::noncopyable {
 public:
  explicit FileSizeLimit(std::uint64_t bytes) {
    EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &before_), 0);
    EXPECT_NE(std::signal(SIGXFSZ, SIG_IGN), SIG_ERR);
    set(bytes);
  }
  ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }

  void set(std::uint64_t bytes) {
    const struct rlimit limit { bytes, before_.rlim_max };
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  void lift() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  struct rlimit before_ {};
};

using RecorderTest = recorder_fixture::RecorderFixture;

TEST_F(RecorderTest, AnEventIsInTheFileWithinTheFlushPeriod) {
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  record(recorder);
  recorder.tick();
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre());
  clock_.advance(Recorder::kFlushPeriod);
  recorder.tick();
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre(0));
}

// Events at any time, ticks as often as the logger makes them. The logger promises 100 ms; its two
// periods make it 60.
TEST_F(RecorderTest, EachEventIsInTheFileWithin100MillisecondsOfItsStamp) {
  constexpr time::Duration kTickPeriod = 20ms;  // the logger's longest wait for a message
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  const time::Timestamp start = clock_.now();
  std::vector<time::Timestamp> recorded;
  for (time::Duration t = 0ms; t <= 1s; t += 1ms) {
    clock_.set(start + t);
    if (t % 7ms == 0ms) {
      record(recorder);
      recorded.push_back(clock_.now());
    }
    if (t % kTickPeriod == 0ms) {
      recorder.tick();
    }
    const std::size_t num_in_file = stamps("lcmlog-2026-11-21.00").size();
    EXPECT_TRUE(num_in_file == recorded.size() || clock_.now() - recorded[num_in_file] < 100ms)
        << "at " << t / 1ms << " ms";
  }
  EXPECT_GT(stamps("lcmlog-2026-11-21.00").size(), 100U);
}

TEST_F(RecorderTest, AClockSetBackDoesNotStopTheFlush) {
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  record(recorder);
  clock_.advance(-1h);
  recorder.tick();
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre(0));
}

TEST_F(RecorderTest, TheDiskHasEverythingOnceASecondAndAtTheEnd) {
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  for (int i = 0; i < 100; ++i) {
    clock_.advance(100ms);
    record(recorder);
    recorder.tick();
  }
  EXPECT_EQ(recorder.counts().syncs, 10);
  recorder.close();
  EXPECT_EQ(recorder.counts().syncs, 11);
}

TEST_F(RecorderTest, ClosingWritesTheRest) {
  Recorder recorder({.folder = {.dir = dir_.path() / "made" / "here"}}, clock_);
  record(recorder);
  recorder.close();
  EXPECT_THAT(stamps("made/here/lcmlog-2026-11-21.00"), ElementsAre(0));
  EXPECT_EQ(recorder.health().state, node::HealthState::kOk);
}

TEST_F(RecorderTest, SplitsBySizeAndLosesNothingBetween) {
  Recorder recorder({.folder = {.dir = dir_.path()}, .split_bytes = 3000}, clock_);
  for (int i = 0; i < 8; ++i) {
    record(recorder);
  }
  recorder.close();
  EXPECT_THAT(names(),
              ElementsAre("lcmlog-2026-11-21.00", "lcmlog-2026-11-21.01", "lcmlog-2026-11-21.02"));
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre(0, 1, 2));
  EXPECT_THAT(stamps("lcmlog-2026-11-21.01"), ElementsAre(3, 4, 5));
  EXPECT_THAT(stamps("lcmlog-2026-11-21.02"), ElementsAre(6, 7));
  EXPECT_EQ(recorder.counts().written, 8);
  EXPECT_EQ(recorder.counts().files, 3);
  EXPECT_EQ(recorder.counts().syncs, 3) << "of each file at its end";
}

TEST_F(RecorderTest, NeverTouchesExistingFiles) {
  std::ofstream(dir_.path() / "lcmlog-2026-11-21.00") << "precious";
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  EXPECT_EQ(recorder.current_file().filename(), "lcmlog-2026-11-21.01");
  EXPECT_EQ(std::filesystem::file_size(dir_.path() / "lcmlog-2026-11-21.00"), 8U);
}

TEST_F(RecorderTest, TheQuotaHoldsAtEveryMoment) {
  std::ofstream(dir_.path() / "notes.txt") << std::string(50'000, 'x');
  std::filesystem::create_symlink("notes.txt", dir_.path() / "lcmlog-2020-01-01.00");
  Recorder recorder({.folder = {.dir = dir_.path(), .quota_bytes = 9000}, .split_bytes = 3000},
                    clock_);
  for (int i = 0; i < 100; ++i) {
    record(recorder);
    clock_.advance(Recorder::kFlushPeriod);
    recorder.tick();
    std::uintmax_t total_bytes = 0;
    for (const std::string& name : names()) {
      total_bytes +=
          name.starts_with("lcmlog-2026") ? std::filesystem::file_size(dir_.path() / name) : 0;
    }
    ASSERT_LE(total_bytes, 9000U);
  }
  recorder.close();
  EXPECT_EQ(recorder.counts().written, 100);
  EXPECT_EQ(recorder.num_deleted_files(), recorder.counts().files - 3);
  EXPECT_THAT(names(), ElementsAre("lcmlog-2020-01-01.00", "lcmlog-2026-11-21.31",
                                   "lcmlog-2026-11-21.32", "lcmlog-2026-11-21.33", "notes.txt"));
  EXPECT_THAT(stamps("lcmlog-2026-11-21.33"), ElementsAre(99));
}

TEST_F(RecorderTest, AFullDiskIsReportedAndKeepsTheWrittenEvents) {
  const FileSizeLimit full(2500);
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  for (int i = 0; i < 4; ++i) {
    record(recorder);
  }
  clock_.advance(Recorder::kFlushPeriod);
  recorder.tick();
  EXPECT_EQ(recorder.health().state, node::HealthState::kFailed);
  EXPECT_THAT(recorder.health().reason, ::testing::HasSubstr("File too large"));
  record(recorder);
  EXPECT_EQ(recorder.counts().written, 2);
  EXPECT_EQ(recorder.counts().dropped, 3);
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre(0, 1)) << "and no torn event";
}

TEST_F(RecorderTest, ContinuesInANewFileWhenThereIsSpaceAgain) {
  FileSizeLimit full(2500);
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  for (int i = 0; i < 3; ++i) {
    record(recorder);
  }
  clock_.advance(Recorder::kFlushPeriod);
  recorder.tick();  // 0 and 1 are in the file, 2 is dropped
  full.lift();
  clock_.advance(Recorder::kFirstBackOff - 1us);
  recorder.tick();
  record(recorder);  // 3: too early
  clock_.advance(1us);
  recorder.tick();
  record(recorder);  // 4
  EXPECT_EQ(recorder.health().state, node::HealthState::kFailed) << "until it is in the file";
  clock_.advance(Recorder::kFlushPeriod);
  recorder.tick();
  EXPECT_EQ(recorder.health().state, node::HealthState::kOk);
  EXPECT_EQ(recorder.counts().dropped, 2);
  EXPECT_EQ(recorder.counts().written, 3);
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre(0, 1));
  EXPECT_THAT(stamps("lcmlog-2026-11-21.01"), ElementsAre(4));
}

// While the disk stays full, every attempt creates a file, finds no space and removes it.
TEST_F(RecorderTest, BacksOffAndLeavesNoEmptyFilesWhileTheDiskStaysFull) {
  FileSizeLimit full(0);
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  int num_tries = 0;
  std::filesystem::path last_file;
  for (int tenths_s = 0; tenths_s < 1200; ++tenths_s) {
    clock_.advance(100ms);
    recorder.tick();
    num_tries += std::filesystem::exists(recorder.current_file()) ? 1 : 0;
    record(recorder);
    clock_.advance(Recorder::kFlushPeriod);
    recorder.tick();
    EXPECT_THAT(names(), ElementsAre());
  }
  // 168 s: at the start, then after 1, 2, 4, 8, 16, 30, 30, 30, 30 s: the sum is 151 s.
  EXPECT_EQ(num_tries, 10);
  EXPECT_EQ(recorder.counts().dropped, 1200);
  EXPECT_EQ(recorder.counts().written, 0);
  EXPECT_EQ(recorder.counts().files, 0);
}

TEST_F(RecorderTest, AFailureInTheMiddleOfASplitIsNotForgotten) {
  FileSizeLimit full(1500);
  Recorder recorder({.folder = {.dir = dir_.path()}, .split_bytes = 2000}, clock_);
  for (int i = 0; i < 3; ++i) {
    record(recorder);  // the third splits, which flushes the second, for which there is no room
  }
  EXPECT_EQ(recorder.health().state, node::HealthState::kFailed);
  EXPECT_EQ(recorder.counts().written, 1);
  EXPECT_EQ(recorder.counts().dropped, 2);
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.00"));
}

TEST_F(RecorderTest, AFolderThatCannotBeCreatedIsAnErrorAtTheStart) {
  std::ofstream(dir_.path() / "file") << "x";
  EXPECT_THROW(Recorder({.folder = {.dir = dir_.path() / "file"}}, clock_), std::exception);
}

// The disk has 12 kB, of which 5 kB must stay free: the newest logs of 7 kB remain.
TEST_F(RecorderTest, TheOldestLogsAreDeletedForTheReserveOfTheDisk) {
  const auto available = [this](const std::filesystem::path&) {
    std::int64_t used_bytes = 0;
    for (const std::string& name : names()) {
      used_bytes += static_cast<std::int64_t>(std::filesystem::file_size(dir_.path() / name));
    }
    return 12'000 - used_bytes;
  };
  Recorder recorder(
      {.folder = {.dir = dir_.path(), .reserve_bytes = 5000, .available_bytes = available},
       .split_bytes = 3000},
      clock_);
  for (int i = 0; i < 30; ++i) {
    record(recorder);
    clock_.advance(Recorder::kSyncPeriod);
    recorder.tick();
    EXPECT_GE(available({}), 5000) << i;
  }
  recorder.close();
  EXPECT_EQ(recorder.counts().dropped, 0);
  EXPECT_GT(recorder.num_deleted_files(), 0);
  EXPECT_EQ(recorder.health().state, node::HealthState::kOk);
  EXPECT_EQ(stamps(names().back()).back(), 29) << "the newest events are kept";
}

// Other files fill the disk: the reserve is not used, and this is reported.
TEST_F(RecorderTest, RecordingPausesWhenOtherFilesFillTheDisk) {
  std::int64_t available_bytes = 10'000;
  Recorder recorder({.folder = {.dir = dir_.path(),
                                .reserve_bytes = 5000,
                                .available_bytes = [&](const auto&) { return available_bytes; }}},
                    clock_);
  record(recorder);
  clock_.advance(Recorder::kSyncPeriod);
  recorder.tick();
  EXPECT_EQ(recorder.health().state, node::HealthState::kOk);
  available_bytes = 4000;
  for (int i = 0; i < 20; ++i) {
    clock_.advance(Recorder::kSyncPeriod);
    recorder.tick();
    record(recorder);
  }
  EXPECT_EQ(recorder.health().state, node::HealthState::kFailed);
  EXPECT_NE(recorder.health().reason.find("reserve"), std::string::npos);
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.00"));
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre(0)) << "the last events before it";
  available_bytes = 6000;
  clock_.advance(Recorder::kMaxBackOff);
  recorder.tick();
  record(recorder);
  clock_.advance(Recorder::kFlushPeriod);
  recorder.tick();
  EXPECT_EQ(recorder.health().state, node::HealthState::kOk);
}

// The disk is full for a moment after the logger has started again: the recording of the last run
// is worth more than the first second of the new one.
TEST_F(RecorderTest, ANewFileWithoutEventsDoesNotReplaceTheLastRecording) {
  Recorder first({.folder = {.dir = dir_.path()}}, clock_);
  record(first);
  first.close();
  std::int64_t available_bytes = 4000;
  Recorder second({.folder = {.dir = dir_.path(),
                              .quota_bytes = 500,
                              .reserve_bytes = 5000,
                              .available_bytes = [&](const auto&) { return available_bytes; }}},
                  clock_);
  for (int i = 0; i < 5; ++i) {
    record(second);
    clock_.advance(Recorder::kMaxBackOff);
    second.tick();
  }
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.00"));
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre(0));
  EXPECT_EQ(second.counts().dropped, 5);
  EXPECT_EQ(second.health().state, node::HealthState::kFailed);
  available_bytes = 6000;
  clock_.advance(Recorder::kMaxBackOff);
  second.tick();
  record(second);
  clock_.advance(Recorder::kFlushPeriod);
  second.tick();
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.01")) << "now the quota holds";
}

}  // namespace recorder_test
}  // namespace nodmap::logger
