// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/tum.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <system_error>

#include "common/formats/atomic_file.hpp"
#include "common/formats/input_file.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::formats {
namespace tum_test {

TEST(Tum, StampsSurviveToTheMicrosecond) {
  const test::TemporaryDir dir;
  Trajectory trajectory;
  for (const std::int64_t utime :
       {-1'500'000LL, -1LL, 0LL, 1LL, 999'999LL, 976052857337284LL, 1071078718462310LL}) {
    trajectory.push_back({time::from_utime(utime), geometry::to_se3({1.0 / 3.0, -2, 3.0})});
  }
  write_tum(dir.path() / "a.tum", trajectory);
  const Trajectory back = read_tum(dir.path() / "a.tum");
  ASSERT_EQ(back.size(), trajectory.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].stamp, trajectory[i].stamp);
    EXPECT_TRUE(back[i].pose.isApprox(trajectory[i].pose, 1e-8));  // nine decimals are written
  }
}

// As on a full disk: half a trajectory must not pass for a result.
TEST(Tum, WhatCannotBeWrittenDoesNotReplaceTheFile) {
  const test::TemporaryDir dir;
  const std::filesystem::path file = dir.path() / "a.tum";
  write_tum(file, {{time::from_utime(1), geometry::SE3::Identity()}});
  std::filesystem::create_directory(unfinished_name(file));
  EXPECT_THROW(write_tum(file, {{time::from_utime(2), geometry::SE3::Identity()}}),
               std::system_error);
  EXPECT_EQ(read_tum(file).at(0).stamp, time::from_utime(1));
}

TEST(Tum, SkipsCommentsAndNamesTheLineOfAnError) {
  const test::TemporaryDir dir;
  std::ofstream(dir.path() / "a.tum")
      << "# stamp x y z qx qy qz qw\n\n1.5 0 0 0 0 0 0 1\n1.6 0 0\n";
  try {
    (void)read_tum(dir.path() / "a.tum");
    FAIL() << "a line of three numbers is no pose";
  } catch (const InputFileError& error) {
    EXPECT_NE(std::string(error.what()).find("a.tum:4"), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)read_tum(dir.path() / "none"), InputFileError);
}

TEST(Tum, ReadsShortAndLongDecimals) {
  const test::TemporaryDir dir;
  std::ofstream(dir.path() / "a.tum")
      << "1.5 0 0 0 0 0 0 1\n7 0 0 0 0 0 0 1\n1.1234567 0 0 0 0 0 0 1\n"
         "1.123456789e+09 1.0e+00 0 0 0 0 0 1\n";
  const Trajectory back = read_tum(dir.path() / "a.tum");
  EXPECT_EQ(back.at(0).stamp, time::from_utime(1'500'000));
  EXPECT_EQ(back.at(1).stamp, time::from_utime(7'000'000));
  EXPECT_EQ(back.at(2).stamp, time::from_utime(1'123'457));
  EXPECT_EQ(back.at(3).stamp, time::from_utime(1'123'456'789'000'000));
  EXPECT_EQ(back.at(3).pose.translation().x(), 1.0);
}

}  // namespace tum_test
}  // namespace nodmap::formats
