// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/cloud_file.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <system_error>

#include "common/formats/atomic_file.hpp"
#include "common/formats/ply.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap::formats {
namespace cloud_file_test {

const CloudPoint kPoints[] = {{{1.5F, -2.0F, 3.0F}, {255, 0, 10}, 1.75, 0.25F},
                              {{4.0F, 5.0F, 6.0F}, {1, 2, 3}, -1e9, 0.5F}};

template <class Number>
Number number_at(const std::string& bytes, std::size_t offset) {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

std::string body_of(const std::filesystem::path& file, const std::string& last_line) {
  const std::string bytes = test::slurp(file);
  return bytes.substr(bytes.find(last_line) + last_line.size());
}

TEST(CloudFile, APlyIsReadAgain) {
  const test::TemporaryDir dir;
  write_cloud(dir.path() / "a.ply", CloudFormat::kPly, kPoints);
  const auto points = read_ply(dir.path() / "a.ply");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0], kPoints[0].p);
  EXPECT_EQ(points[1], kPoints[1].p);
}

TEST(CloudFile, BytesOfAPly) {
  const test::TemporaryDir dir;
  write_cloud(dir.path() / "a.ply", CloudFormat::kPly, kPoints);
  const std::string body = body_of(dir.path() / "a.ply", "end_header\n");
  ASSERT_EQ(body.size(), 2U * 27U);
  EXPECT_EQ(number_at<float>(body, 27 + 4), 5.0F);
  EXPECT_EQ(number_at<std::uint8_t>(body, 12), 255);
  EXPECT_EQ(number_at<std::uint8_t>(body, 14), 10);
  EXPECT_EQ(number_at<double>(body, 27 + 15), -1e9);
  EXPECT_EQ(number_at<float>(body, 23), 0.25F);
}

// Of the Point Cloud Library: pcl_viewer and Open3D read the same.
TEST(CloudFile, BytesOfAPcd) {
  const test::TemporaryDir dir;
  write_cloud(dir.path() / "a.pcd", CloudFormat::kPcd, kPoints);
  const std::string bytes = test::slurp(dir.path() / "a.pcd");
  EXPECT_NE(bytes.find("\nFIELDS x y z rgb time sigma\nSIZE 4 4 4 4 8 4\nTYPE F F F U F F\n"),
            std::string::npos);
  EXPECT_NE(bytes.find("\nWIDTH 2\nHEIGHT 1\n"), std::string::npos);
  EXPECT_NE(bytes.find("\nPOINTS 2\nDATA binary\n"), std::string::npos);
  const std::string body = body_of(dir.path() / "a.pcd", "DATA binary\n");
  ASSERT_EQ(body.size(), 2U * 28U);
  EXPECT_EQ(number_at<float>(body, 28 + 8), 6.0F);
  EXPECT_EQ(number_at<std::uint32_t>(body, 12), 0xFF000AU);
  EXPECT_EQ(number_at<double>(body, 28 + 16), -1e9);
  EXPECT_EQ(number_at<float>(body, 24), 0.25F);
}

TEST(CloudFile, WhatCannotBeWrittenDoesNotReplaceTheFile) {
  const test::TemporaryDir dir;
  const std::filesystem::path file = dir.path() / "a.ply";
  write_cloud(file, CloudFormat::kPly, {});
  std::filesystem::create_directory(unfinished_name(file));
  EXPECT_THROW(write_cloud(file, CloudFormat::kPly, kPoints), std::system_error);
  EXPECT_TRUE(read_ply(file).empty());
}

}  // namespace cloud_file_test
}  // namespace nodmap::formats
