// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/yaml_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <string>

#include "common/formats/input_file.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::formats {
namespace yaml_file_test {

using ::testing::HasSubstr;

class YamlFile : public ::testing::Test {
 protected:
  YAML::Node read(const std::string& text) {
    std::ofstream(file_) << text;
    return read_yaml(file_);
  }

  std::string error_of(const std::string& text) {
    try {
      (void)read(text);
    } catch (const InputFileError& error) {
      return error.what();
    }
    return {};
  }

  test::TemporaryDir dir_;
  std::filesystem::path file_ = dir_.path() / "f.yaml";
};

TEST_F(YamlFile, IsReadAsOneDocument) {
  EXPECT_EQ(read("a: 1\n")["a"].as<int>(), 1);
  EXPECT_EQ(read("---\na: 2\n...\n")["a"].as<int>(), 2);
  EXPECT_TRUE(read("# nothing\n").IsNull());
  EXPECT_TRUE(read("").IsNull());
}

TEST_F(YamlFile, ASecondDocumentIsRefusedWithItsLine) {
  EXPECT_THAT(error_of("a: 1\n---\nb: 2\n"), HasSubstr("f.yaml:2: begins another YAML document"));
}

TEST_F(YamlFile, WhatIsNotYamlIsRefusedWithItsLine) {
  EXPECT_THAT(error_of("a: 1\nb: {\n"), HasSubstr("f.yaml:"));
  EXPECT_THAT(error_of("a: 1\nb: [1, 2\nc: 3\n"), HasSubstr("f.yaml:3"));
}

TEST_F(YamlFile, AnErrorDoesNotPrintBytesOfTheFile) {
  EXPECT_THAT(error_of("a: \"\\\x1b\"\n"), HasSubstr("unknown escape character: ?"));
}

// yaml-cpp finds a document without content before a comma, and remains before it: LoadAll() did so
// until the memory was used up.
TEST_F(YamlFile, ACommaThatBelongsToNothingIsRefused) {
  EXPECT_THAT(error_of(",\n"), HasSubstr("f.yaml:1: begins another YAML document"));
  EXPECT_THAT(error_of("# the body\n, and its mounts\na: 1\n"), HasSubstr("f.yaml:2: begins"));
}

}  // namespace yaml_file_test
}  // namespace nodmap::formats
