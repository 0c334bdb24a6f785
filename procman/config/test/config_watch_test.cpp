// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/config_watch.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/data_dir.hpp"

namespace nodmap::procman {
namespace config_watch_test {

class ConfigWatchTest : public ::testing::Test {
 protected:
  void write(const std::string& text) {
    std::ofstream(file_) << text;
    // So that two edits within one tick of the file system's clock count as two.
    edited_ += std::chrono::seconds(1);
    std::filesystem::last_write_time(file_, edited_);
  }
  std::optional<ParsedConfig> poll_after(time::Duration duration) {
    now_ += duration;
    return watch_->poll(now_);
  }

  test::TemporaryDir dir_;
  std::filesystem::path file_ = dir_.path() / "robot.pmd";
  std::filesystem::file_time_type edited_{};
  time::SteadyTime now_{100s};
  std::optional<ConfigWatch> watch_;
};

TEST_F(ConfigWatchTest, ReportsAnEditOnceWhenTheFileIsNoLongerChanging) {
  write("cmd \"a\" { exec = \"x\"; }");
  watch_.emplace(file_, 1s, now_);
  EXPECT_FALSE(poll_after(10s)) << "unchanged";
  write("cmd \"b\" { exec");
  EXPECT_FALSE(poll_after(1s)) << "seen only now";
  write("cmd \"b\" { exec = \"x\"; }");
  EXPECT_FALSE(poll_after(900ms)) << "changed again";
  EXPECT_FALSE(poll_after(900ms));
  const auto parsed = poll_after(300ms);
  ASSERT_TRUE(parsed);
  EXPECT_TRUE(parsed->errors.empty());
  EXPECT_NE(parsed->config.find_command("b"), nullptr);
  EXPECT_FALSE(poll_after(10s));
}

TEST_F(ConfigWatchTest, ReportsErrorsAndWaitsForAFileThatWasDeleted) {
  write("cmd \"a\" { exec = \"x\"; }");
  watch_.emplace(file_, 1s, now_);
  std::filesystem::remove(file_);
  EXPECT_FALSE(poll_after(1s));
  EXPECT_FALSE(poll_after(5s));
  write("cmd {");
  EXPECT_FALSE(poll_after(1s));
  const auto parsed = poll_after(1s);
  ASSERT_TRUE(parsed);
  EXPECT_FALSE(parsed->errors.empty());
}

}  // namespace config_watch_test
}  // namespace nodmap::procman
