// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/input_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/data_dir.hpp"

namespace nodmap::formats {
namespace input_file_test {

std::string error_of(const std::filesystem::path& file) {
  try {
    (void)open_input(file);
  } catch (const InputFileError& error) {
    return error.what();
  }
  return {};
}

TEST(InputFile, SaysWhichFileAndWhy) {
  const test::TemporaryDir dir;
  const std::string path = dir.path();
  EXPECT_EQ(error_of(path + "/none"), path + "/none: cannot open: No such file or directory");
  EXPECT_EQ(error_of(path), path + ": cannot open: Is a directory");
}

TEST(InputFile, ReadsEveryByte) {
  const test::TemporaryDir dir;
  const std::string bytes("a\r\n\0\x1a\xff", 6);
  std::ofstream(dir.path() / "file", std::ios::binary) << bytes;
  EXPECT_EQ(read_input(dir.path() / "file"), bytes);
}

TEST(InputFile, AFileWithoutEndIsNotReadIntoTheMemory) {
  EXPECT_THROW((void)read_input("/dev/zero"), InputFileError);
}

}  // namespace input_file_test
}  // namespace nodmap::formats
