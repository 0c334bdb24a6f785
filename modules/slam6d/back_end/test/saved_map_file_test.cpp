// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/saved_map_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "common/formats/input_file.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::slam6d {
namespace saved_map_file_test {

namespace fs = std::filesystem;
using geometry::SE3;

SavedMap three_keyframes() {
  SavedMap map;
  for (int k = 0; k < 3; ++k) {
    auto cloud = std::make_shared<SweepCloud>();
    cloud->stamp = time::Timestamp(1s * k);
    cloud->points = {{1.0F, 2.0F, 0.1F * static_cast<float>(k)}, {-3.0F, 0.25F, 1.0F}};
    cloud->lines = {{Eigen::Vector3f(0.1F, 0.0F, 0.4F), 1},
                    {Eigen::Vector3f(0.1F, 0.0F, 0.41F), 2}};
    SE3 T = SE3::Identity();
    T.translation() = Eigen::Vector3d(k, 0.5 * k, 0.01);
    T.linear() = geometry::rotation_of({0.01, 0.02, 0.3 * k});
    map.keyframes.push_back({.cloud = std::move(cloud), .T_map_base = T, .is_level = k == 1});
  }
  const Matrix6d information = Matrix6d::Identity() * 400.0;
  for (std::size_t k = 1; k < 3; ++k) {
    map.steps.push_back(
        {.from = 0, .to = k, .T_from_to = map.keyframes[k].T_map_base, .information = information});
  }
  map.loops.push_back({.from = 2,
                       .to = 0,
                       .T_from_to = map.keyframes[2].T_map_base.inverse(),
                       .information = information,
                       .may_be_wrong = true});
  return map;
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(SavedMapFile, IsReadAsItWasWritten) {
  const test::TemporaryDir dir;
  const SavedMap written = three_keyframes();
  ASSERT_FALSE(write_saved_map(dir.path(), written));
  const SavedMap map = read_saved_map(dir.path());
  ASSERT_EQ(map.keyframes.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(map.keyframes[k].cloud->stamp, written.keyframes[k].cloud->stamp);
    EXPECT_EQ(map.keyframes[k].cloud->points, written.keyframes[k].cloud->points);
    ASSERT_EQ(map.keyframes[k].cloud->lines.size(), 2U);
    EXPECT_EQ(map.keyframes[k].cloud->lines[1].end, 2U);
    EXPECT_EQ(map.keyframes[k].cloud->lines[1].p_base_mirror,
              written.keyframes[k].cloud->lines[1].p_base_mirror);
    // The pose is stored as a quaternion, which rounds it.
    EXPECT_TRUE(map.keyframes[k].T_map_base.isApprox(written.keyframes[k].T_map_base, 1e-14));
    EXPECT_EQ(map.keyframes[k].is_level, k == 1);
  }
  ASSERT_EQ(map.steps.size(), 2U);
  EXPECT_EQ(map.steps[1].from, 0U);
  EXPECT_EQ(map.steps[1].to, 2U);
  EXPECT_EQ(map.steps[1].information, written.steps[1].information);
  ASSERT_EQ(map.loops.size(), 1U);
  EXPECT_EQ(map.loops[0].from, 2U);
  EXPECT_TRUE(map.loops[0].may_be_wrong);
  EXPECT_TRUE(map.loops[0].T_from_to.isApprox(written.loops[0].T_from_to, 1e-14));
  // The file may be named as well as its folder.
  EXPECT_EQ(read_saved_map(dir.path() / "keyframes.lcmlog").keyframes.size(), 3U);
}

TEST(SavedMapFile, ATruncatedOrMissingFileIsRefused) {
  const test::TemporaryDir dir;
  ASSERT_FALSE(write_saved_map(dir.path(), three_keyframes()));
  const std::string bytes = read(dir.path() / "keyframes.lcmlog");
  const auto refused = [&](const std::string& damaged) {
    std::ofstream(dir.path() / "keyframes.lcmlog", std::ios::binary) << damaged;
    EXPECT_THROW((void)read_saved_map(dir.path()), formats::InputFileError);
  };
  refused(bytes.substr(0, bytes.size() - 1));
  refused(bytes.substr(0, bytes.size() / 2));
  refused("");
  EXPECT_THROW((void)read_saved_map(dir.path() / "none"), formats::InputFileError);
}

// It lies in the same folder as keyframes.lcmlog.
TEST(SavedMapFile, AnOctoMapIsRefusedAsSuch) {
  const test::TemporaryDir dir;
  const fs::path file = dir.path() / "map.bt";
  std::ofstream(file) << "# Octomap OcTree binary file\n";
  try {
    (void)read_saved_map(file);
    ADD_FAILURE() << "it was read";
  } catch (const formats::InputFileError& error) {
    EXPECT_EQ(error.what(), file.string() +
                                ": is an OctoMap, which contains no sweeps; the folder "
                                "of a saved map, or the keyframes.lcmlog in it, is "
                                "needed");
  }
}

TEST(SavedMapFile, TheErrorNamesTheImpossiblePart) {
  const test::TemporaryDir dir;
  const auto refused = [&](const SavedMap& map, const std::string& problem) {
    ASSERT_FALSE(write_saved_map(dir.path(), map));
    try {
      (void)read_saved_map(dir.path());
      ADD_FAILURE() << problem;
    } catch (const formats::InputFileError& error) {
      EXPECT_NE(std::string(error.what()).find(problem), std::string::npos) << error.what();
    }
  };
  SavedMap map = three_keyframes();
  map.steps[1].from = 7;
  refused(map, "keyframe 2 is joined to none before it");
  map = three_keyframes();
  map.loops[0].from = 7;
  refused(map, "a loop from a keyframe that does not exist");
  map = three_keyframes();
  // Each diagonal element is 400: that is a correlation of 2.
  map.loops[0].information(0, 1) = map.loops[0].information(1, 0) = 800.0;
  refused(map, "an edge without a valid information matrix");
  map = three_keyframes();
  auto cloud = std::make_shared<SweepCloud>(*map.keyframes[1].cloud);
  cloud->lines.back().end = 1;
  map.keyframes[1].cloud = cloud;
  refused(map, "keyframe 1 has points of no scan");
  cloud = std::make_shared<SweepCloud>(*three_keyframes().keyframes[1].cloud);
  cloud->points[0].x() = 1e12F;  // its cells and pixels would not fit into 32 bits
  map.keyframes[1].cloud = cloud;
  refused(map, "keyframe 1 holds an impossible point");
  cloud = std::make_shared<SweepCloud>(*three_keyframes().keyframes[1].cloud);
  cloud->lines[1].p_base_mirror.z() = 1e12F;
  map.keyframes[1].cloud = cloud;
  refused(map, "keyframe 1 holds an impossible mirror");
  map = three_keyframes();
  map.keyframes[2].T_map_base.translation().x() = 1e300;
  refused(map, "keyframe 2 holds an impossible pose");
}

// The error is returned.
TEST(SavedMapFile, AFileThatCannotBeWrittenIsReported) {
  EXPECT_TRUE(write_saved_map("/nowhere/at/all", three_keyframes()));
}

}  // namespace saved_map_file_test
}  // namespace nodmap::slam6d
