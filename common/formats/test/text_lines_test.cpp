// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/text_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/formats/input_file.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::formats {
namespace text_lines_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class TextLinesTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> lines_of(const std::string& text) const {
    std::ofstream(file(), std::ios::binary) << text;
    TextLines lines(file());
    std::vector<std::string> all;
    while (lines.next()) {
      all.emplace_back(lines.line());
    }
    return all;
  }
  [[nodiscard]] std::filesystem::path file() const { return dir_.path() / "a.txt"; }

 private:
  test::TemporaryDir dir_;
};

TEST_F(TextLinesTest, TheLastLineNeedsNoEnd) {
  EXPECT_THAT(lines_of(""), IsEmpty());
  EXPECT_THAT(lines_of("\n"), ElementsAre(""));
  EXPECT_THAT(lines_of("a\n\nb\r\n"), ElementsAre("a", "", "b\r"));
  EXPECT_THAT(lines_of("a\nb"), ElementsAre("a", "b"));
  EXPECT_THAT(lines_of(std::string("a\0b\n", 4)), ElementsAre(std::string("a\0b", 3)));
}

TEST_F(TextLinesTest, BlankLinesAndCommentsHaveNoContent) {
  std::ofstream(file()) << "# a\n \t\r\n\n1 # b\n  # c\n2";
  TextLines lines(file());
  ASSERT_TRUE(lines.next_content());
  EXPECT_EQ(lines.line(), "1 # b");
  ASSERT_TRUE(lines.next_content());
  EXPECT_EQ(lines.line(), "2");
  EXPECT_EQ(lines.place(), file().string() + ":6");
  EXPECT_FALSE(lines.next_content());
}

TEST_F(TextLinesTest, RefusesALineOfMoreThanAMegabyte) {
  const std::string longest(1'000'000, 'x');
  EXPECT_THAT(lines_of(longest), ElementsAre(longest));
  EXPECT_THAT(lines_of(longest + "\n"), ElementsAre(longest));
  try {
    (void)lines_of("a\n" + longest + "x\n");
    FAIL() << "a longer line is taken";
  } catch (const InputFileError& error) {
    EXPECT_EQ(error.what(),
              file().string() + ":2: a line of more than a megabyte; this is not a text file");
  }
}

TEST_F(TextLinesTest, RefusesAFileWithoutEnd) {
  TextLines lines("/dev/zero");
  EXPECT_THROW((void)lines.next(), InputFileError);
}

TEST(Quote, IsShortAndPrintable) {
  EXPECT_EQ(quote("1.0 x"), "'1.0 x'");
  EXPECT_EQ(quote("\033[31m\xff\t"),
            "'?[31m?"
            "?'");
  EXPECT_EQ(quote(std::string(80, 'x')), "'" + std::string(80, 'x') + "'");
  EXPECT_EQ(quote(std::string(81, 'x')), "'" + std::string(80, 'x') + "...'");
}

}  // namespace text_lines_test
}  // namespace nodmap::formats
