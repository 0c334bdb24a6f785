// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/cloud_export.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "common/formats/ply.hpp"
#include "common/formats/tum.hpp"
#include "common/formats/user_error.hpp"
#include "common/node/messages.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/convert/recording.hpp"

namespace nodmap::convert {
namespace cloud_export_test {

constexpr time::Duration kScanPeriod = 13'320us;
constexpr double kSpeedMps = 1.5;
constexpr double kWallM = 6.0;  // x of a wall across the path, in odom

// A level scan of that wall, taken at one instant, while driving towards it.
scan::Scan scan_at(time::Timestamp stamp) {
  scan::Scan scan;
  scan.stamp = stamp;
  scan.angle_first_rad = -0.5;
  scan.angle_step_rad = 0.1;
  scan.range_min_m = 0.01;
  scan.range_max_m = 80.0;
  const double distance_m = kSpeedMps * time::seconds(stamp.time_since_epoch());
  for (std::size_t beam = 0; beam < 11; ++beam) {
    scan.ranges_m.push_back(
        static_cast<float>((kWallM - distance_m) / std::cos(scan.angle_rad(beam))));
  }
  return scan;
}

class CloudExport : public testing::Test {
 protected:
  CloudExport() { record(100); }

  // 100 scans, of which the first `num_odometry` have odometry.
  void record(int num_odometry) const {
    std::filesystem::remove(log());
    Recording recording(log());
    for (int i = 0; i < 100; ++i) {
      const time::Timestamp stamp(i * kScanPeriod);
      const double x_m = kSpeedMps * time::seconds(stamp.time_since_epoch());
      if (i < num_odometry) {
        recording.add_odometry(node::write_odometry(stamp, geometry::to_se3({x_m, 0.0, 0.0})));
      }
      recording.add_scan(node::write_scan(scan_at(stamp)));
    }
    recording.commit("in", "");
  }

  [[nodiscard]] std::filesystem::path log() const { return dir_.path() / "a.lcmlog"; }
  [[nodiscard]] std::filesystem::path out() const { return dir_.path() / "cloud.ply"; }

  test::TemporaryDir dir_;
};

TEST_F(CloudExport, PutsTheWallIntoOnePlaneSeenFromTheMiddle) {
  export_cloud(log(), out(), formats::CloudFormat::kPly, {.start_s = 0.4, .num_scans = 51});
  // The first scan not before 0.4 s is the 31st.
  const time::Timestamp middle(31 * kScanPeriod + 25 * kScanPeriod);
  const auto pose = formats::read_tum(dir_.path() / "cloud.tum");
  ASSERT_EQ(pose.size(), 1U);
  EXPECT_EQ(pose[0].stamp, middle);
  const auto points = formats::read_ply(out());
  ASSERT_EQ(points.size(), 51U * 11U);
  for (const Eigen::Vector3f& p : points) {
    // Ranges are floats of some metres: a few 1e-7.
    EXPECT_NEAR(p.x(), kWallM - kSpeedMps * time::seconds(middle.time_since_epoch()), 1e-5);
  }
}

// The user has named x.pcd, and x.tum belongs to x.ply or is a trajectory.
TEST_F(CloudExport, SaysWhyThereMustBeNoTumFile) {
  export_cloud(log(), out(), formats::CloudFormat::kPly, {.start_s = 0.4, .num_scans = 51});
  const std::filesystem::path pcd = dir_.path() / "cloud.pcd";
  try {
    export_cloud(log(), pcd, formats::CloudFormat::kPcd, {.start_s = 0.4, .num_scans = 51});
    ADD_FAILURE() << "it was written";
  } catch (const formats::UserError& error) {
    EXPECT_EQ(error.what(),
              (dir_.path() / "cloud.tum").string() +
                  ": exists and is never overwritten; needed for the time and pose of " +
                  pcd.string());
  }
}

// Odometry ends at scan 60, and the pose is extrapolated by 50 ms, which is three more scans.
TEST_F(CloudExport, ScansWithoutOdometryAreLeftOut) {
  record(61);
  export_cloud(log(), out(), formats::CloudFormat::kPly, {.start_s = 0.4, .num_scans = 51});
  EXPECT_EQ(formats::read_ply(out()).size(), (63U - 31U + 1U) * 11U);
}

TEST_F(CloudExport, TooFewScansAreAnErrorAndLeaveNothing) {
  EXPECT_THROW(
      export_cloud(log(), out(), formats::CloudFormat::kPly, {.start_s = 1.0, .num_scans = 50}),
      std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(out()));
  EXPECT_FALSE(std::filesystem::exists(dir_.path() / "cloud.tum"));
}

}  // namespace cloud_export_test
}  // namespace nodmap::convert
