// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/occupancy_mapper.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"

namespace nodmap::slam6d {
namespace occupancy_mapper_test {

// A keyframe that sees a wall 3 m ahead, `num_lines` scans high.
Keyframe keyframe_before_a_wall(int num_lines) {
  SweepCloud cloud;
  for (int line = 0; line < num_lines; ++line) {
    for (int i = 0; i < 100; ++i) {
      cloud.points.emplace_back(3.025F, -0.99F + 0.02F * static_cast<float>(i),
                                0.01F + 0.02F * static_cast<float>(line));
    }
    cloud.lines.push_back({Eigen::Vector3f(0.0F, 0.0F, 0.5F), cloud.points.size()});
  }
  Keyframe keyframe;
  keyframe.cloud = std::make_shared<const SweepCloud>(std::move(cloud));
  return keyframe;
}

std::string map_file(const OccupancyMapper& mapper) {
  return mapper.map().encode(OccupancyMap::Format::kOt).value();
}

// Updates the map of this keyframe, at a time in seconds, and waits until that is done.
void update(OccupancyMapper& mapper, const Keyframe& keyframe, int now_s) {
  mapper.update(std::vector{keyframe}, time::Timestamp(std::chrono::seconds(now_s)), 0.1);
  EXPECT_FALSE(mapper.take());
}

// What is handed out: a whole file, or nothing.
std::string handed_out(OccupancyMapper& mapper) {
  std::string file;
  while (const auto part = mapper.next_part()) {
    file += part->bytes;
  }
  return file;
}

// The first sweep was cut short, and the map began anew with the next one while the robot was
// stationary: the new first keyframe has the number and the pose of the old one.
TEST(OccupancyMapper, AKeyframeWithAnotherCloudIsInsertedAnew) {
  const Keyframe whole = keyframe_before_a_wall(50);
  OccupancyMapper mapper({});
  update(mapper, keyframe_before_a_wall(5), 0);
  update(mapper, whole, 1);
  OccupancyMapper expected({});
  update(expected, whole, 0);
  EXPECT_TRUE(map_file(mapper) == map_file(expected));
}

// The wall, 3 m away, moves by 2.6 cm.
TEST(OccupancyMapper, AKeyframeThatOnlyRotatedIsInsertedAnew) {
  std::vector<Keyframe> keyframes{keyframe_before_a_wall(50)};
  OccupancyMapper mapper({});
  mapper.update(keyframes, {}, 0.03);
  EXPECT_FALSE(mapper.take());
  keyframes[0].T_map_base.linear() = geometry::rotation_of({0.0, 0.0, geometry::deg_to_rad(0.5)});
  mapper.update(keyframes, time::Timestamp(1s), 0.03);
  EXPECT_FALSE(mapper.take());
  OccupancyMapper expected({});
  expected.update(keyframes, {}, 0.03);
  EXPECT_FALSE(expected.take());
  EXPECT_TRUE(map_file(mapper) == map_file(expected));
}

// At the end all keyframes are adjusted, and there is no new one.
TEST(OccupancyMapper, TheLastMapIsHandedOutAgainIfKeyframesHaveMoved) {
  std::vector<Keyframe> keyframes{keyframe_before_a_wall(50)};
  OccupancyMapper mapper({});
  mapper.update(keyframes, {}, 0.005);
  EXPECT_FALSE(mapper.take());
  const std::string at_first = handed_out(mapper);
  EXPECT_TRUE(at_first == mapper.map().encode(OccupancyMap::Format::kBt));
  mapper.publish_last();
  EXPECT_FALSE(mapper.next_part()) << "it has been handed out";
  keyframes[0].T_map_base.translation().x() = 0.2;
  mapper.update(keyframes, time::Timestamp(1s), 0.005);
  EXPECT_FALSE(mapper.take());
  mapper.publish_last();
  const std::string at_last = handed_out(mapper);
  EXPECT_TRUE(at_last == mapper.map().encode(OccupancyMap::Format::kBt));
  EXPECT_FALSE(at_last == at_first);
}

TEST(OccupancyMapper, AnUnchangedKeyframeIsInsertedOnce) {
  const Keyframe keyframe = keyframe_before_a_wall(5);
  OccupancyMapper mapper({});
  update(mapper, keyframe, 0);
  mapper.update(std::vector{keyframe}, time::Timestamp(1s), 0.1);
  EXPECT_FALSE(mapper.is_working());
}

// The same stationary robot: no other keyframe follows that would publish the new map.
TEST(OccupancyMapper, AChangedMapIsHandedOutAfterThePeriodWithoutANewKeyframe) {
  const Keyframe whole = keyframe_before_a_wall(50);
  OccupancyMapper mapper({.publish_period_s = 5.0});
  update(mapper, keyframe_before_a_wall(5), 100);
  const std::string first = handed_out(mapper);
  EXPECT_FALSE(first.empty());
  for (const int now_s : {101, 104}) {
    update(mapper, whole, now_s);
    EXPECT_EQ(handed_out(mapper), "") << now_s;
  }
  update(mapper, whole, 105);
  EXPECT_TRUE(handed_out(mapper) == mapper.map().encode(OccupancyMap::Format::kBt).value());
}

// A receiver that has started in between would else wait until the robot drives on.
TEST(OccupancyMapper, AnUnchangedMapIsHandedOutAgainAfterTwelvePeriods) {
  const Keyframe keyframe = keyframe_before_a_wall(5);
  OccupancyMapper mapper({.publish_period_s = 5.0});
  update(mapper, keyframe, 100);
  const std::string first = handed_out(mapper);
  update(mapper, keyframe, 159);
  EXPECT_EQ(handed_out(mapper), "");
  update(mapper, keyframe, 160);
  EXPECT_TRUE(handed_out(mapper) == first);
}

// A file of N keyframes is written as a whole: written every ten of them, all files of a long drive
// would be N / 20 times as large as the last one.
TEST(OccupancyMapper, WhatIsSavedOnALongDriveGrowsWithTheMap) {
  const Keyframe keyframe = keyframe_before_a_wall(1);
  std::vector<Keyframe> keyframes;
  std::vector<std::size_t> saved;  // number of keyframes
  OccupancyMapper mapper({.save_every_keyframes = 10, .publish_period_s = 0.0});
  constexpr std::size_t kNumber = 2000;
  while (keyframes.size() < kNumber) {
    keyframes.push_back(keyframe);
    keyframes.back().id = keyframes.size() - 1;
    mapper.update(keyframes, {}, 0.1, [&] {
      saved.push_back(keyframes.size());
      return [](const OccupancyMap&) { return std::error_code{}; };
    });
    (void)mapper.take();
  }
  ASSERT_GT(saved.size(), 3U);
  EXPECT_EQ(saved[0], 10U);
  EXPECT_EQ(saved[1], 20U);
  const std::size_t all = std::accumulate(saved.begin(), saved.end(), std::size_t{0});
  // A geometric series with ratio 1.1 adds up to eleven times its last element.
  EXPECT_LT(all, 11U * kNumber);
  // Of a process that is killed, at most a tenth is lost.
  EXPECT_GT(11U * saved.back(), 10U * (kNumber - 1));
}

TEST(OccupancyMapper, AtTheEndAMapThatHasChangedIsHandedOutAtOnce) {
  const Keyframe whole = keyframe_before_a_wall(50);
  OccupancyMapper mapper({.publish_period_s = 5.0});
  update(mapper, keyframe_before_a_wall(5), 100);
  EXPECT_FALSE(handed_out(mapper).empty());
  update(mapper, whole, 101);
  mapper.publish_last();
  EXPECT_TRUE(handed_out(mapper) == mapper.map().encode(OccupancyMap::Format::kBt).value());
}

}  // namespace occupancy_mapper_test
}  // namespace nodmap::slam6d
