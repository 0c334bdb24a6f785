// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/relocalisation.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/node/messages.hpp"
#include "modules/slam2d/grid/map_file.hpp"
#include "modules/slam2d/test/drawn_world.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::evaluate {
namespace relocalisation_test {

using geometry::SE2;
using slam2d::test::room;

// A map of a room, and a log of a circle in it: 40 scans.
class RelocalisationTest : public testing::Test {
 protected:
  RelocalisationTest() {
    EXPECT_FALSE(slam2d::write_ros_map(
        dir_.path(), slam2d::test::drawn_grid(room(), slam2d::test::poses_in_room())));
    bus::LogWriter log(log_);
    SE2 pose;
    for (std::int64_t i = 0; i < 40; ++i) {
      const time::Timestamp stamp(200ms * i);
      write(log, stamp, "ODOMETRY", node::write_odometry(stamp, geometry::to_se3(pose)));
      write(log, stamp, "SCAN", node::write_scan(scanner_.scan(room(), pose, stamp)));
      truth_.push_back({stamp, geometry::to_se3(pose)});
      pose = pose * SE2{0.1, 0.0, 0.15};
    }
    EXPECT_TRUE(log.flush());
  }

  template <class Message>
  void write(bus::LogWriter& log, time::Timestamp stamp, const std::string& channel,
             const Message& message) {
    std::vector<std::byte> bytes;
    bus::encode_into(bytes, message);
    ASSERT_TRUE(log.write(time::to_utime(stamp), channel, bytes));
  }

  [[nodiscard]] RelocalisationResult measure(const RelocalisationPlan& plan) const {
    return measure_relocalisation(dir_.path(), log_, truth_, plan);
  }

  nodmap::test::TemporaryDir dir_;
  std::filesystem::path log_ = dir_.path() / "circle.lcmlog";
  slam2d::test::Scanner scanner_;
  formats::Trajectory truth_;
};

TEST_F(RelocalisationTest, CountsThePlacesThatWereFound) {
  const RelocalisationResult result = measure({.num_scans = 1, .every = 4});
  EXPECT_EQ(result.n, 10U);
  EXPECT_GE(result.right, 9U);
  EXPECT_EQ(result.wrong, 0U);
  EXPECT_EQ(result.right + result.said_lost, 10U);
  EXPECT_GT(result.ms_p50, 0.0);
  EXPECT_GE(result.ms_max, result.ms_p50);
}

TEST_F(RelocalisationTest, LocatesGroupsOfScansAtTheirLastScan) {
  const RelocalisationResult result = measure({.num_scans = 4, .every = 2});
  EXPECT_EQ(result.n, 5U);
  EXPECT_EQ(result.right, 5U);
}

TEST_F(RelocalisationTest, APlaceElsewhereIsWrong) {
  for (formats::StampedPose& pose : truth_) {
    pose.pose.translation().x() += 0.3;
  }
  EXPECT_EQ(measure({.num_scans = 1, .every = 4}).right, 0U);
  EXPECT_GE(measure({.num_scans = 1, .every = 4}).wrong, 9U);
}

TEST_F(RelocalisationTest, ScansWithoutATruthAreLeftOut) {
  truth_.resize(10);
  EXPECT_EQ(measure({.num_scans = 1, .every = 1}).n, 10U);
}

TEST_F(RelocalisationTest, FilesThatAreMissingAreNamed) {
  EXPECT_THROW((void)measure_relocalisation(dir_.path() / "none", log_, truth_, {}),
               std::runtime_error);
  EXPECT_THROW((void)measure_relocalisation(dir_.path(), dir_.path() / "none", truth_, {}),
               std::runtime_error);
}

}  // namespace relocalisation_test
}  // namespace nodmap::evaluate
