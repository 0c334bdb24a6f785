// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/message_log.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

#include "common/formats/input_file.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/stop_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::bus {
namespace message_log_test {

namespace fs = std::filesystem;

class MessageLog : public testing::Test {
 protected:
  static save_request_t request_by(const std::string& name) {
    save_request_t request{};
    request.requested_by = name;
    return request;
  }

  void write(const std::vector<std::string>& names) const {
    MessageLogWriter writer(file_);
    for (const std::string& name : names) {
      writer.write(time::from_utime(7), "SAVE_REQUEST", request_by(name));
    }
    ASSERT_FALSE(writer.replace());
  }

  [[nodiscard]] std::vector<std::string> read() const {
    MessageLogReader log(file_);
    std::vector<std::string> names;
    while (const LogEvent* event = log.next()) {
      names.push_back(log.decode<save_request_t>(*event).requested_by);
    }
    return names;
  }

  test::TemporaryDir dir_;
  fs::path file_ = dir_.path() / "requests.lcmlog";
};

TEST_F(MessageLog, IsReadAsItWasWritten) {
  write({"a", "b"});
  EXPECT_EQ(read(), (std::vector<std::string>{"a", "b"}));
  write({"c"});
  EXPECT_EQ(read(), std::vector<std::string>{"c"});
}

TEST_F(MessageLog, TheOldFileStaysUntilTheNewOneIsComplete) {
  write({"a"});
  {
    MessageLogWriter writer(file_);
    writer.write(time::from_utime(7), "SAVE_REQUEST", request_by("b"));
    EXPECT_EQ(read(), std::vector<std::string>{"a"});
  }
  EXPECT_EQ(read(), std::vector<std::string>{"a"});
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_.path()), fs::directory_iterator()), 1);
}

TEST_F(MessageLog, TheFileThatAKilledProcessLeftIsReplaced) {
  std::ofstream(file_.string() + ".part") << "half of one";
  write({"a"});
  EXPECT_EQ(read(), std::vector<std::string>{"a"});
}

TEST_F(MessageLog, ErrorsHaveACode) {
  MessageLogWriter nowhere(dir_.path() / "none" / "file.lcmlog");
  nowhere.write(time::from_utime(7), "SAVE_REQUEST", request_by("a"));
  EXPECT_EQ(nowhere.replace(), std::errc::no_such_file_or_directory);
  fs::create_directories(file_ / "in the way");
  MessageLogWriter folder(file_);
  EXPECT_EQ(folder.replace(), std::errc::is_a_directory);
  EXPECT_FALSE(fs::exists(file_.string() + ".part"));
}

// What a reader of nothing makes of a file.
struct NoReader {
  explicit NoReader(const MessageLogReader& /*log*/) {}
  void add(const LogEvent& /*event*/) {}
  [[nodiscard]] bool finish() const { return true; }
};

TEST_F(MessageLog, APathThatCannotBeExaminedIsAnErrorOfTheUser) {
  fs::create_symlink(file_.filename(), file_);
  EXPECT_THROW((void)read_message_log<NoReader>(file_, "requests.lcmlog"), formats::InputFileError);
}

TEST_F(MessageLog, ATruncatedFileIsAnError) {
  write({"a", "b"});
  fs::resize_file(file_, fs::file_size(file_) - 1);
  EXPECT_THROW((void)read(), formats::InputFileError);
}

TEST_F(MessageLog, AFileOfAnotherKindIsNotSaidToBeDamaged) {
  std::ofstream(file_) << "image: map.pgm";
  try {
    (void)read();
    ADD_FAILURE() << "it was read";
  } catch (const formats::InputFileError& error) {
    EXPECT_EQ(error.what(), file_.string() + ": not an LCM event log (no event found)");
  }
}

TEST_F(MessageLog, AWrongMessageIsNamed) {
  {
    MessageLogWriter writer(file_);
    writer.write(time::from_utime(7), "SAVE_REQUEST", stop_t{});
    ASSERT_FALSE(writer.replace());
  }
  try {
    (void)read();
    ADD_FAILURE() << "it was read";
  } catch (const formats::InputFileError& error) {
    EXPECT_EQ(error.what(), file_.string() + ": event 0 is not a valid SAVE_REQUEST");
  }
}

}  // namespace message_log_test
}  // namespace nodmap::bus
