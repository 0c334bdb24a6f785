// SPDX-License-Identifier: BSD-3-Clause
// Conversions of the public recordings.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "common/node/messages.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/convert/carmen_export.hpp"
#include "tools/convert/carmen_import.hpp"
#include "tools/convert/nod_import.hpp"
#include "tools/convert/table_export.hpp"
#include "tools/convert/test/messages_of.hpp"
#include "tools/convert/uos_import.hpp"
#include "tools/evaluate/relations.hpp"

namespace nodmap::convert {
namespace recordings_test {

struct PublicLog {
  const char* name;
  std::size_t num_scans;
  std::size_t num_odometry;
  double mount_x_m;
  double odometry_error_m;  // known mean error of the raw odometry over the relations
};

class CarmenRecordings : public testing::TestWithParam<PublicLog> {};

TEST_P(CarmenRecordings, RawOdometryHasTheKnownError) {
  const PublicLog& known = GetParam();
  NODMAP_REQUIRE_DATA(clf, std::filesystem::path("slam2d") / (std::string(known.name) + ".clf"));
  const test::TemporaryDir dir;
  import_carmen(clf, dir.path() / "a.lcmlog");
  export_tum(dir.path() / "a.lcmlog", dir.path() / "a.tum", "ODOMETRY");
  const auto relations =
      evaluate::read_relations(std::filesystem::path(clf).replace_extension(".relations"));
  const auto errors =
      evaluate::measure_relations(formats::read_tum(dir.path() / "a.tum"), relations);
  EXPECT_EQ(errors.missing, 0U);  // every stamp is found exactly
  EXPECT_EQ(errors.n, relations.size());
  EXPECT_NEAR(errors.trans_mean_m, known.odometry_error_m, 0.01);
}

TEST_P(CarmenRecordings, NothingIsLostAndScansRoundTrip) {
  const PublicLog& known = GetParam();
  NODMAP_REQUIRE_DATA(clf, std::filesystem::path("slam2d") / (std::string(known.name) + ".clf"));
  const test::TemporaryDir dir;
  import_carmen(clf, dir.path() / "a.lcmlog");
  export_carmen(dir.path() / "a.lcmlog", dir.path() / "b.clf");
  import_carmen(dir.path() / "b.clf", dir.path() / "b.lcmlog");
  const auto there = test::messages_of(dir.path() / "a.lcmlog");
  const auto back = test::messages_of(dir.path() / "b.lcmlog");
  ASSERT_EQ(there.scans.size(), known.num_scans);
  ASSERT_EQ(there.odometry.size(), known.num_odometry);
  EXPECT_EQ(there.scans.front().mount_position_m[0], known.mount_x_m);
  EXPECT_EQ(there.channels, back.channels);
  EXPECT_EQ(there.log_utimes_us, back.log_utimes_us);
  EXPECT_TRUE(std::is_sorted(there.log_utimes_us.begin(), there.log_utimes_us.end()));
  std::vector<std::byte> a;
  std::vector<std::byte> b;
  for (std::size_t i = 0; i < there.scans.size(); ++i) {
    bus::encode_into(a, there.scans[i]);
    bus::encode_into(b, back.scans[i]);
    ASSERT_EQ(a, b) << "scan " << i;
  }
}

// The errors of the raw odometry were computed by another program directly from the lines of the
// .clf.
INSTANTIATE_TEST_SUITE_P(Public, CarmenRecordings,
                         testing::Values(PublicLog{"intel", 13631, 40546, 0.0, 7.370},
                                         PublicLog{"fr079", 4934, 13885, -0.04, 6.504},
                                         PublicLog{"mit-csail", 1988, 1988, 0.0, 1.802}),
                         [](const auto& log) { return std::string(log.param.name).substr(0, 3); });

TEST(UosRecordings, SlicesAreThoseOfTheDerivedFiles) {
  NODMAP_REQUIRE_DATA(kurt3d, "kurt3d");
  const test::TemporaryDir dir;
  for (int k = 0; k < 3; ++k) {
    const std::string name = std::to_string(k);
    import_uos(kurt3d, dir.path() / (name + ".uos.lcmlog"), {k, k});
    import_nod(kurt3d / ("scan00" + name + ".nod"), dir.path() / (name + ".nod.lcmlog"));
    const auto uos = test::messages_of(dir.path() / (name + ".uos.lcmlog"));
    const auto nod = test::messages_of(dir.path() / (name + ".nod.lcmlog"));
    ASSERT_EQ(uos.scans.size(), 226U);
    ASSERT_EQ(nod.scans.size(), 226U);
    for (std::size_t i = 0; i < 226; ++i) {
      const nodmap::scan_t& a = uos.scans[i];
      const nodmap::scan_t& b = nod.scans[i];
      EXPECT_EQ(a.utime, b.utime);
      EXPECT_NEAR(a.pitch_first_rad, b.pitch_first_rad, 1e-5);  // the .nod has 0.0001 degrees
      EXPECT_NEAR(a.angle_first_rad, b.angle_first_rad, 1e-9);
      EXPECT_NEAR(a.angle_step_rad, b.angle_step_rad, 1e-9);
      ASSERT_EQ(a.num_ranges, b.num_ranges);
      for (std::size_t j = 0; j < a.ranges_m.size(); ++j) {
        if (std::isinf(b.ranges_m[j])) {
          EXPECT_TRUE(std::isinf(a.ranges_m[j])) << k << " " << i << " " << j;
        } else {
          // The .nod has millimetres, the .3d six digits of centimetres.
          EXPECT_NEAR(a.ranges_m[j], b.ranges_m[j], 0.0006) << k << " " << i << " " << j;
        }
      }
    }
  }
}

TEST(UosRecordings, ScansReproduceThePointsOfTheFile) {
  NODMAP_REQUIRE_DATA(file, "kurt3d/scan000.3d");
  const test::TemporaryDir dir;
  import_uos(file.parent_path(), dir.path() / "a.lcmlog", {0, 0});
  std::ifstream in(file);
  const auto scans = test::messages_of(dir.path() / "a.lcmlog").scans;
  ASSERT_FALSE(scans.empty());
  for (const nodmap::scan_t& message : scans) {
    scan::Scan scan;
    ASSERT_TRUE(node::read_scan(message, scan));
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      Eigen::Vector3d p_cm;
      ASSERT_TRUE(in >> p_cm.x() >> p_cm.y() >> p_cm.z());
      if (!scan.is_hit(i)) {
        continue;
      }
      const Eigen::Vector3d p_m(0.01 * p_cm.z(), -0.01 * p_cm.x(), 0.01 * p_cm.y());
      // Six digits of up to 3200 cm, and the beam's angle within a thousandth of a degree.
      EXPECT_LT((scan::point_in_base(scan, i, static_cast<double>(scan.ranges_m[i])) - p_m).norm(),
                0.001);
    }
  }
}

TEST(NodRecordings, TheFloorIsLevelAtTheGround) {
  NODMAP_REQUIRE_DATA(file, "tilting/room_240.nod");
  const test::TemporaryDir dir;
  import_nod(file, dir.path() / "a.lcmlog");
  const auto messages = test::messages_of(dir.path() / "a.lcmlog");
  ASSERT_EQ(messages.scans.size(), 865U);
  std::size_t num_floor = 0;
  std::size_t num_below = 0;
  for (const nodmap::scan_t& message : messages.scans) {
    scan::Scan scan;
    ASSERT_TRUE(node::read_scan(message, scan));
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      if (scan.is_hit(i)) {
        const double z_m = scan::point_in_base(scan, i, static_cast<double>(scan.ranges_m[i])).z();
        num_floor += std::abs(z_m) < 0.03 ? 1U : 0U;
        num_below += z_m < -0.1 ? 1U : 0U;
      }
    }
  }
  EXPECT_GT(num_floor, 5000U);
  EXPECT_LT(num_below, num_floor / 10);
}

}  // namespace recordings_test
}  // namespace nodmap::convert
