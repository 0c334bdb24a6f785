// SPDX-License-Identifier: BSD-3-Clause
// Whole conversions of small hand-made recordings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <fstream>
#include <numbers>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/formats/tum.hpp"
#include "common/formats/user_error.hpp"
#include "common/node/messages.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/convert/carmen_export.hpp"
#include "tools/convert/carmen_import.hpp"
#include "tools/convert/nod_import.hpp"
#include "tools/convert/table_export.hpp"
#include "tools/convert/test/messages_of.hpp"
#include "tools/convert/uos_import.hpp"

namespace nodmap::convert {
namespace import_test {

class Import : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const char* name) const { return dir_.path() / name; }
  void write(const char* name, const std::string& content) const {
    std::ofstream(file(name)) << content;
  }
  [[nodiscard]] std::string read(const char* name) const {
    std::ifstream in(file(name));
    return {std::istreambuf_iterator<char>(in), {}};
  }

  test::TemporaryDir dir_;
};

// Stamps step back, a line is damaged, and the scanner sits 4 cm behind the centre.
constexpr const char* kCarmenLog =
    "# a robot\n"
    "PARAM robot_frontlaser_offset 0.5 1.0 host 1.0\n"
    "ODOM 0 0 0 0.5 0.1 0 10.000001 host 0.0\n"
    "FLASER 3 1 81.83 2 0.96 2 0 1 2 0 10.000003 host 0.1\n"
    "FLASER 3 1 2\n"
    "SYNC tag 10.0 host 0.1\n"
    "ODOM 2 0 0 0.6 0.1 0 10.000002 host 0.2\n";

TEST_F(Import, CarmenScansFollowTheirOdometry) {
  write("a.clf", kCarmenLog);
  import_carmen(file("a.clf"), file("a.lcmlog"));
  const auto messages = test::messages_of(file("a.lcmlog"));
  EXPECT_EQ(messages.channels,
            (std::vector<std::string>{"ODOMETRY", "ODOMETRY", "SCAN", "ODOMETRY"}));
  EXPECT_EQ(messages.log_utimes_us,
            (std::vector<std::int64_t>{10'000'001, 10'000'003, 10'000'003, 10'000'003}));
  ASSERT_EQ(messages.odometry.size(), 3U);
  EXPECT_EQ(messages.odometry[1].utime, 10'000'003);
  EXPECT_EQ(messages.odometry[1].position_m[0], 1.0);
  EXPECT_EQ(messages.odometry[1].forward_mps, 0.5);  // the last known
  EXPECT_EQ(messages.odometry[2].utime, 10'000'002);
  EXPECT_EQ(messages.odometry[2].odometry_seq, 2);
  const nodmap::scan_t& scan = messages.scans.at(0);
  EXPECT_EQ(scan.utime, 10'000'003);
  EXPECT_EQ(scan.pitch_first_rad, 0.0);
  EXPECT_EQ(scan.mount_position_m[0], -0.04);
  EXPECT_EQ(scan.mount_position_m[2], 0.3);
  EXPECT_EQ(scan.range_max_m, 80.0);
  EXPECT_TRUE(std::isinf(scan.ranges_m[1]));
}

TEST_F(Import, CarmenRoundTrip) {
  write("a.clf", kCarmenLog);
  import_carmen(file("a.clf"), file("a.lcmlog"));
  export_carmen(file("a.lcmlog"), file("b.clf"));
  import_carmen(file("b.clf"), file("b.lcmlog"));
  EXPECT_THAT(read("b.clf"), testing::StartsWith("ODOM 0.000000 "));
  EXPECT_EQ(read("a.lcmlog"), read("b.lcmlog"));
}

// The laser's pose is that of the mirror, ahead of the mount here. A scan long after the last
// odometry has no pose.
TEST_F(Import, CarmenExportPlacesTheMirrorByOdometryOfTheSameTime) {
  const auto write_to = [](bus::LogWriter& log, const char* channel, const auto& message) {
    std::vector<std::byte> bytes;
    bus::encode_into(bytes, message);
    ASSERT_TRUE(log.write(message.utime, channel, bytes));
  };
  {
    bus::LogWriter log(file("a.lcmlog"));
    scan::Scan scan;
    scan.angle_step_rad = 0.1;
    scan.range_max_m = 80.0;
    scan.mirror_offset_m = {0.1, 0.0, 0.02};
    scan.T_base_mount = geometry::to_se3({0.25, 0.0, 0.0});
    scan.ranges_m = {1.0F, 2.0F};
    write_to(log, "ODOMETRY", node::write_odometry(time::Timestamp(1s), geometry::SE3::Identity()));
    for (const time::Duration since_epoch : {1000ms, 3000ms}) {
      scan.stamp = time::Timestamp(since_epoch);
      write_to(log, "SCAN", node::write_scan(scan));
    }
    ASSERT_TRUE(log.flush());
  }
  export_carmen(file("a.lcmlog"), file("a.clf"));
  import_carmen(file("a.clf"), file("b.lcmlog"));
  const auto messages = test::messages_of(file("b.lcmlog"));
  ASSERT_EQ(messages.scans.size(), 1U);
  EXPECT_EQ(messages.scans[0].utime, 1'000'000);
  EXPECT_NEAR(messages.scans[0].mount_position_m[0] + messages.scans[0].mirror_offset_m[0], 0.35,
              1e-6);  // digits in the log
}

TEST_F(Import, FailuresLeaveNothing) {
  write("a.clf", "nothing\nof use\n");
  EXPECT_THROW(import_carmen(file("a.clf"), file("a.lcmlog")), std::runtime_error);
  EXPECT_THROW(import_carmen(file("none.clf"), file("a.lcmlog")), std::runtime_error);
  EXPECT_THROW(import_carmen(dir_.path(), file("a.lcmlog")), std::runtime_error);
  EXPECT_THROW(import_nod(file("a.clf"), file("a.lcmlog")), std::runtime_error);
  EXPECT_THROW(import_uos(dir_.path(), file("a.lcmlog"), {}), std::runtime_error);
  EXPECT_THROW(import_uos(file("a.clf"), file("a.lcmlog"), {}), std::runtime_error);
  EXPECT_THROW(export_tum(file("a.clf"), file("a.tum"), "ODOMETRY"), std::runtime_error);
  EXPECT_THROW(export_csv(file("a.clf"), file("a.csv"), "SCAN"), std::runtime_error);
  EXPECT_THROW(export_carmen(file("a.clf"), file("b.clf")), std::runtime_error);
  for (const auto& entry : std::filesystem::directory_iterator(dir_.path())) {
    EXPECT_EQ(entry.path().filename(), "a.clf");
  }
}

TEST_F(Import, NodLinesBecomePitchedScansOfAStationaryRobot) {
  write("a.nod", "NOD 5.0 30 2 -1.5 3.0 0.02 5.6 1 2\nSLICE 0 10 2 0 90 100 200\nNOD 6.0\n");
  import_nod(file("a.nod"), file("a.lcmlog"));
  const auto messages = test::messages_of(file("a.lcmlog"));
  ASSERT_EQ(messages.scans.size(), 2U);
  ASSERT_EQ(messages.odometry.size(), 2U);
  EXPECT_EQ(messages.scans[0].utime, 5'000'000);
  EXPECT_NEAR(messages.scans[0].pitch_first_rad, -std::numbers::pi / 6, 1e-12);
  EXPECT_NEAR(messages.scans[1].pitch_last_rad, std::numbers::pi / 18, 1e-12);
}

// Two slices of five beams, 90 cm in each direction.
std::string tiny_uos_scan() {
  std::string text;
  for (const double pitch_deg : {-1.0, 1.0}) {
    for (int i = 0; i < 5; ++i) {
      const double angle = std::numbers::pi * i / 4.0;
      const double pitch = std::numbers::pi * pitch_deg / 180.0;
      text += std::to_string(90 * std::cos(angle)) + " " +
              std::to_string(90 * std::sin(angle) * std::sin(pitch)) + " " +
              std::to_string(90 * std::sin(angle) * std::cos(pitch)) + "\n";
    }
  }
  return text;
}

TEST_F(Import, UosScansAreTakenStationaryWithDrivesBetweenThem) {
  for (const char* name : {"scan000.3d", "scan001.3d", "scan002.3d"}) {
    write(name, tiny_uos_scan() + "x\n");
  }
  write("scan000.pose", "0 0 0\n0 0 0\n");
  write("scan001.pose", "0 0 200\n0 0 0\n");
  write("scan002.pose", "100 0 200\n0 0 0\n");
  import_uos(dir_.path(), file("a.lcmlog"), {0, 1});
  const auto messages = test::messages_of(file("a.lcmlog"));
  ASSERT_EQ(messages.scans.size(), 4U);
  EXPECT_NEAR(messages.scans[0].pitch_first_rad, -std::numbers::pi / 180.0, 1e-6);  // six decimals
  EXPECT_EQ(messages.scans[0].num_ranges, 5);
  EXPECT_NEAR(messages.scans[0].ranges_m[2], 0.9, 1e-6);
  EXPECT_EQ(messages.scans[1].utime - messages.scans[0].utime, 26'640);
  // The drive: 2 m at 0.5 m/s, a message every 10 ms, with increasing stamps.
  EXPECT_NEAR(1e-6 * static_cast<double>(messages.scans[2].utime - messages.scans[1].utime), 4.0,
              0.05);
  EXPECT_GT(messages.odometry.size(), 400U);
  for (std::size_t i = 1; i < messages.odometry.size(); ++i) {
    EXPECT_GT(messages.odometry[i].utime, messages.odometry[i - 1].utime);
  }
  EXPECT_NEAR(messages.odometry[200].forward_mps, 0.5, 1e-9);
  EXPECT_EQ(messages.odometry.back().position_m[0], 2.0);
}

// Copies that somebody keeps beside the scans: one has no pose, which would be an error.
TEST_F(Import, UosTakesNoFileWhoseNameOnlyBeginsLikeThatOfAScan) {
  for (const char* name : {"scan000.3d", "scan000_old.3d", "scan001b.3d"}) {
    write(name, tiny_uos_scan());
  }
  write("scan000.pose", "0 0 0\n0 0 0\n");
  write("scan000_old.pose", "0 0 900\n0 0 0\n");
  import_uos(dir_.path(), file("a.lcmlog"), {});
  const auto messages = test::messages_of(file("a.lcmlog"));
  EXPECT_EQ(messages.scans.size(), 2U);
  EXPECT_EQ(messages.odometry.back().position_m[0], 0.0);
}

TEST_F(Import, UosSaysThatThereIsNoScanInTheRange) {
  write("scan000.3d", tiny_uos_scan());
  write("scan000.pose", "0 0 0\n0 0 0\n");
  const auto error_of = [this](const UosRange& range) -> std::string {
    try {
      import_uos(dir_.path(), file("a.lcmlog"), range);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_THAT(error_of({5, 9}), testing::EndsWith("no scanNNN.3d with slices from number 5 to 9"));
  EXPECT_THAT(error_of({5, UosRange{}.last}), testing::EndsWith("from number 5 on"));
  EXPECT_EQ(error_of({}), "none");
}

// Each drive between two scans is written every 10 ms: one of 2^31 cm would fill the disk.
TEST_F(Import, UosScansFartherApartThanARobotDrivesAreRefused) {
  write("scan000.3d", tiny_uos_scan());
  write("scan000.pose", "0 0 0\n0 0 0\n");
  write("scan001.3d", tiny_uos_scan());
  for (const char* far : {"2147483648 0 0\n0 0 0\n", "0 0 -100100\n0 0 0\n"}) {
    write("scan001.pose", far);
    EXPECT_THROW(import_uos(dir_.path(), file("a.lcmlog"), {}), formats::UserError) << far;
    EXPECT_FALSE(std::filesystem::exists(file("a.lcmlog")));
  }
}

TEST_F(Import, UosWithoutAPoseIsAnErrorThatNamesTheFile) {
  write("scan000.3d", tiny_uos_scan());
  try {
    import_uos(dir_.path(), file("a.lcmlog"), {});
    FAIL() << "a scan without a pose has no place";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("scan000.pose"));
  }
}

TEST_F(Import, ExportsTablesOfAChannel) {
  write("a.clf", kCarmenLog);
  import_carmen(file("a.clf"), file("a.lcmlog"));
  export_tum(file("a.lcmlog"), file("a.tum"), "ODOMETRY");
  EXPECT_THAT(read("a.tum"), testing::StartsWith("10.000001 0.000000000 "));
  EXPECT_EQ(formats::read_tum(file("a.tum")).size(), 3U);
  export_csv(file("a.lcmlog"), file("a.csv"), "SCAN");
  EXPECT_THAT(read("a.csv"), testing::StartsWith("utime_us,pitch_first_rad"));
  EXPECT_THAT(read("a.csv"), testing::EndsWith(",1,inf,2\n"));
  export_csv(file("a.lcmlog"), file("odometry.csv"), "ODOMETRY");
  EXPECT_THAT(read("odometry.csv"), testing::HasSubstr("\n10000003,1,2,0,1,0,0,0,0.5,0.1\n"));
  EXPECT_THROW(export_tum(file("a.lcmlog"), file("b.tum"), "SCAN"), std::runtime_error);
}

}  // namespace import_test
}  // namespace nodmap::convert
