// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/results.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/formats/user_error.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::node {
namespace results_test {

TEST(ResultDir, IsMadeAndNeverOverwritten) {
  const test::TemporaryDir dir;
  make_result_dir(dir.path() / "a" / "b");
  EXPECT_TRUE(std::filesystem::is_directory(dir.path() / "a" / "b"));
  EXPECT_NO_THROW(make_result_dir(dir.path() / "a" / "b"));  // exists, but empty
  std::ofstream(dir.path() / "a" / "b" / "result.json") << "{}";
  EXPECT_THROW(make_result_dir(dir.path() / "a" / "b"), formats::UserError);
}

TEST(ResultDir, ThatCannotBeMadeIsAnErrorOfTheUser) {
  const test::TemporaryDir dir;
  std::ofstream(dir.path() / "file") << "in the way";
  for (const std::filesystem::path& out : {dir.path() / "file", dir.path() / "file" / "a"}) {
    try {
      make_result_dir(out);
      ADD_FAILURE() << out << " was made";
    } catch (const formats::UserError& error) {
      EXPECT_EQ(error.what(), out.string() + ": cannot make this folder: Not a directory");
    }
  }
}

TEST(WriteEach, GoesOnAfterAnErrorAndThrowsTheFirst) {
  std::string written;
  try {
    write_each({[&] { written += "a"; }, [] { throw std::runtime_error("first"); },
                [] { throw std::runtime_error("second"); }, [&] { written += "b"; }});
    FAIL() << "the errors were lost";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "first");
  }
  EXPECT_EQ(written, "ab");
}

TEST(ResultDir, ARestartedProcessTakesTheNext) {
  const test::TemporaryDir dir;
  const std::filesystem::path out = dir.path() / "slam2d";
  EXPECT_TRUE(make_next_result_dir({}).path.empty());
  EXPECT_EQ(make_next_result_dir(out).path, out);
  EXPECT_EQ(make_next_result_dir(out).path, out);  // nothing was written: it was killed
  std::ofstream(out / "result.json") << "{}";
  const std::filesystem::path second = dir.path() / "slam2d.2";
  EXPECT_EQ(make_next_result_dir(out).path, second);
  EXPECT_TRUE(std::filesystem::is_directory(second));
  std::ofstream(second / "result.json") << "{}";
  EXPECT_EQ(make_next_result_dir(out).path, dir.path() / "slam2d.3");
  EXPECT_EQ(make_next_result_dir(out.string() + "/").path, dir.path() / "slam2d.3");
}

// Neither has written anything yet.
TEST(ResultDir, OfTwoThatRunEachHasItsOwn) {
  const test::TemporaryDir dir;
  const std::filesystem::path out = dir.path() / "slam2d";
  std::optional<LiveResultDir> first = make_next_result_dir(out);
  EXPECT_EQ(first->path, out);
  EXPECT_EQ(make_next_result_dir(out).path, dir.path() / "slam2d.2");
  first.reset();
  EXPECT_EQ(make_next_result_dir(out).path, out);
}

TEST(ResultJson, OneThatCannotBeWrittenLeavesTheOldOneAndIsNamed) {
  const test::TemporaryDir dir;
  const auto written = [&dir] {
    return nlohmann::json::parse(std::ifstream(dir.path() / "result.json"));
  };
  write_result_json(dir.path(), {{"run", 1}});
  EXPECT_EQ(written()["run"], 1);
  std::filesystem::create_directory(dir.path() / "result.json.part");  // where the new one is to go
  try {
    write_result_json(dir.path(), {{"run", 2}});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("result.json"), std::string::npos);
  }
  EXPECT_EQ(written()["run"], 1);
}

// A replayed log's name in Latin-1.
TEST(ResultJson, ANameThatIsNotUtf8LosesNothingElse) {
  const test::TemporaryDir dir;
  write_result_json(dir.path(), {{"file", "caf\xE9.lcmlog"}, {"run", 1}});
  const auto result = nlohmann::json::parse(std::ifstream(dir.path() / "result.json"));
  EXPECT_EQ(result["file"], "caf\uFFFD.lcmlog");
  EXPECT_EQ(result["run"], 1);
}

}  // namespace results_test
}  // namespace nodmap::node
