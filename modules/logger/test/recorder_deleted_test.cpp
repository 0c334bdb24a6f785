// SPDX-License-Identifier: BSD-3-Clause
// The file, or its folder, is deleted or moved while it is recorded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "modules/logger/recorder.hpp"
#include "modules/logger/test/recorder_fixture.hpp"
#include "tests/support/logged.hpp"

namespace nodmap::logger {
namespace recorder_deleted_test {

using ::testing::ElementsAre;

using RecorderDeletedTest = recorder_fixture::RecorderFixture;

TEST_F(RecorderDeletedTest, ADeletedFolderIsCreatedAgain) {
  const auto dir = dir_.path() / "logs";
  Recorder recorder({.folder = {.dir = dir}, .split_bytes = 1000}, clock_);
  record(recorder);
  std::filesystem::remove_all(dir);
  record(recorder);
  clock_.advance(Recorder::kFirstBackOff);
  recorder.tick();
  record(recorder);
  recorder.close();
  EXPECT_THAT(stamps("logs/lcmlog-2026-11-21.00"), ElementsAre(2));
  EXPECT_EQ(recorder.counts().dropped, 2);
}

// The system takes whatever is written to a file that has no name any more.
TEST_F(RecorderDeletedTest, ADeletedFileIsNoticedWithinASecondAndItsEventsCountAsDropped) {
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  record(recorder);
  clock_.advance(Recorder::kSyncPeriod);
  recorder.tick();
  std::filesystem::remove(recorder.current_file());
  record(recorder);
  clock_.advance(Recorder::kSyncPeriod);
  recorder.tick();
  EXPECT_EQ(recorder.health().state, node::HealthState::kFailed);
  EXPECT_THAT(recorder.health().reason, ::testing::EndsWith("the file was deleted"));
  EXPECT_EQ(recorder.counts().written, 0);
  EXPECT_EQ(recorder.counts().dropped, 2);
  EXPECT_EQ(recorder.counts().files, 0);
  clock_.advance(Recorder::kFirstBackOff);
  recorder.tick();
  record(recorder);
  clock_.advance(Recorder::kFlushPeriod);
  recorder.tick();
  EXPECT_EQ(recorder.health().state, node::HealthState::kOk);
  EXPECT_EQ(recorder.counts().written, 1);
  EXPECT_THAT(stamps("lcmlog-2026-11-21.00"), ElementsAre(2));
}

TEST_F(RecorderDeletedTest, AMovedFileKeepsItsEventsAndWhatHasItsNameIsNotTouched) {
  Recorder recorder({.folder = {.dir = dir_.path()}}, clock_);
  record(recorder);
  clock_.advance(Recorder::kFlushPeriod);
  recorder.tick();
  std::filesystem::rename(recorder.current_file(), dir_.path() / "moved");
  std::ofstream(recorder.current_file()) << std::string(5000, 'x');
  clock_.advance(Recorder::kSyncPeriod);
  recorder.tick();
  EXPECT_THAT(recorder.health().reason, ::testing::EndsWith("the file was moved"));
  EXPECT_THAT(stamps("moved"), ElementsAre(0));
  EXPECT_EQ(std::filesystem::file_size(dir_.path() / "lcmlog-2026-11-21.00"), 5000U);
  EXPECT_EQ(recorder.counts().written, 1);
  EXPECT_EQ(recorder.counts().dropped, 0);
  clock_.advance(Recorder::kFirstBackOff);
  recorder.tick();
  record(recorder);
  recorder.close();
  EXPECT_THAT(stamps("lcmlog-2026-11-21.01"), ElementsAre(1));
}

// The folder is gone, and no other can be made in its place.
TEST_F(RecorderDeletedTest, AFileThatCannotBeSyncedAtItsEndIsReportedOnce) {
  const auto dir = dir_.path() / "logs";
  Recorder recorder({.folder = {.dir = dir}, .split_bytes = 1000}, clock_);
  record(recorder);
  std::filesystem::remove_all(dir);
  std::ofstream(dir) << "x";
  const std::string text = test::logged([&] { record(recorder); });
  EXPECT_EQ(std::ranges::count(text, '\n'), 1) << text;
  EXPECT_THAT(text, ::testing::HasSubstr("cannot record into " + dir.string()));
  EXPECT_EQ(recorder.counts().dropped, 2) << "the one in the deleted file, too";
}

}  // namespace recorder_deleted_test
}  // namespace nodmap::logger
