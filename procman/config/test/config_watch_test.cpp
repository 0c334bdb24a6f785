// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/config_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/fsuid.h>

#include <boost/core/noncopyable.hpp>
#include <fstream>

#include "tests/support/data_dir.hpp"

namespace nodmap::procman {
namespace config_watch_test {

// Opens files as another user, because root may read any file.
class OtherUser : private boost::noncopyable {
 public:
  OtherUser() : before_(static_cast<uid_t>(::setfsuid(kNobody))) {}
  ~OtherUser() { ::setfsuid(before_); }

 private:
  static constexpr uid_t kNobody = 65534;
  uid_t before_;
};

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

// An editor that finds the disk full leaves an empty file, and the robot drives meanwhile.
TEST_F(ConfigWatchTest, AFileWithoutCommandsIsAnErrorAndWhatFollowsIsNot) {
  write("cmd \"a\" { exec = \"x\"; }");
  watch_.emplace(file_, 1s, now_);
  for (const char* text : {"", "# nothing", "group \"g\" { }", "script \"s\" { wait ms 1; }"}) {
    write(text);
    EXPECT_FALSE(poll_after(1s));
    const auto parsed = poll_after(1s);
    ASSERT_TRUE(parsed) << text;
    ASSERT_EQ(parsed->errors.size(), 1U) << text;
    EXPECT_EQ(describe("f", parsed->errors[0]), "f:1:1: there is no command");
    EXPECT_FALSE(poll_after(1s)) << "once";
  }
  write("cmd \"a\" { exec = \"x\"; }");
  EXPECT_FALSE(poll_after(1s));
  const auto parsed = poll_after(1s);
  ASSERT_TRUE(parsed);
  EXPECT_TRUE(parsed->errors.empty());
}

TEST_F(ConfigWatchTest, ADeputyNeedsACommandOfItsOwn) {
  write(R"(cmd "a" { exec = "x"; deputy = "here"; })");
  watch_.emplace(file_, 1s, now_, "here");
  write(R"(cmd "a" { exec = "x"; deputy = "there"; })");
  EXPECT_FALSE(poll_after(1s));
  const auto elsewhere = poll_after(1s);
  ASSERT_TRUE(elsewhere);
  ASSERT_EQ(elsewhere->errors.size(), 1U);
  EXPECT_EQ(elsewhere->errors[0].text, "there is no command for the deputy here");
  write(R"(cmd "a" { exec = "x"; deputy = "there"; } cmd "b" { exec = "y"; deputy = "here"; })");
  EXPECT_FALSE(poll_after(1s));
  const auto both = poll_after(1s);
  ASSERT_TRUE(both);
  EXPECT_TRUE(both->errors.empty());
}

// Somebody copies it as root, who alone may read it then, and permits everybody to read it later:
// that changes neither its time nor its size.
TEST_F(ConfigWatchTest, ReportsOnceThatAFileCannotBeReadAndTriesAgain) {
  using std::filesystem::perms;
  std::filesystem::permissions(dir_.path(), perms::group_exec | perms::others_exec,
                               std::filesystem::perm_options::add);
  write("cmd \"a\" { exec = \"x\"; }");
  watch_.emplace(file_, 1s, now_);
  write("cmd \"b\" { exec = \"x\"; }");
  std::filesystem::permissions(file_, perms::none);
  {
    const OtherUser user;
    EXPECT_FALSE(poll_after(1s));
    const auto unread = poll_after(1s);
    ASSERT_TRUE(unread);
    ASSERT_EQ(unread->errors.size(), 1U);
    EXPECT_THAT(unread->errors[0].text, ::testing::HasSubstr("Permission denied"));
    EXPECT_FALSE(poll_after(1s)) << "once";
  }
  std::filesystem::permissions(file_, perms::all);
  const auto parsed = poll_after(1s);
  ASSERT_TRUE(parsed);
  EXPECT_TRUE(parsed->errors.empty());
  EXPECT_NE(parsed->config.find_command("b"), nullptr);
  EXPECT_FALSE(poll_after(10s));
}

}  // namespace config_watch_test
}  // namespace nodmap::procman
