// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/nod.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::convert {
namespace nod_test {

TEST(Nod, TiltCountsDownwardsAndTheMirrorStandsAboveTheAxle) {
  const NodLine line = parse_nod_line("NOD 1436203604.814177 30 3 -1.5 1.5 0.02 5.6 1.0 2.0 inf");
  const auto* nod = std::get_if<NodScan>(&line);
  ASSERT_NE(nod, nullptr);
  EXPECT_EQ(nod->scan.stamp, time::from_utime(1436203604814177));
  EXPECT_TRUE(std::isinf(nod->scan.ranges_m[2]));
  EXPECT_EQ(nod->scan.range_max_m, 5.6);
  // From the axle 1 m above the ground: 8 cm along the tilted upward axis, 2 m along the beam
  // ahead.
  const double sine = 0.5;
  const double cosine = std::sqrt(0.75);
  const Eigen::Vector3d expected(0.08 * sine + 2.0 * cosine, 0.0, 1.0 + 0.08 * cosine - 2.0 * sine);
  EXPECT_TRUE(scan::point_in_base(nod->scan, 1, 2.0).isApprox(expected, 1e-12));
}

TEST(Nod, SlicesCountUpwardsFromTheRightInCentimetres) {
  const NodLine line = parse_nod_line("SLICE 4 30 3 0 90 100 200 3276.6");
  const auto* slice = std::get_if<NodSlice>(&line);
  ASSERT_NE(slice, nullptr);
  EXPECT_EQ(slice->scan.ranges_m[0], 1.0F);
  EXPECT_TRUE(std::isinf(slice->scan.ranges_m[2]));
  EXPECT_TRUE(scan::point_in_base(slice->scan, 0, 1.0).isApprox(Eigen::Vector3d(0, -1, 0), 1e-12));
  EXPECT_TRUE(scan::point_in_base(slice->scan, 1, 2.0)
                  .isApprox(Eigen::Vector3d(std::sqrt(3.0), 0.0, 1.0), 1e-12));
}

// Free space removes obstacles from maps, so only a reading may say that it is free.
TEST(Nod, AMissingReadingOfASliceIsNotFreeSpace) {
  const NodLine line = parse_nod_line("SLICE 0 -10 4 0 1 100 nan inf 3300");
  const auto* slice = std::get_if<NodSlice>(&line);
  ASSERT_NE(slice, nullptr);
  EXPECT_TRUE(std::isnan(slice->scan.ranges_m[1]));
  EXPECT_TRUE(std::isinf(slice->scan.ranges_m[2]));
  EXPECT_TRUE(std::isinf(slice->scan.ranges_m[3]));
}

TEST(Nod, DamagedLinesAreUnreadable) {
  for (const char* line :
       {"NOD", "NOD 1.0 30 3 -1.5 1.5 0.02 5.6 1 2", "NOD 1.0 30 2 -1.5 1.5 0.02 5.6 1 2 3",
        "NOD 1.0 nan 1 -1.5 1.5 0.02 5.6 1", "NOD 1.0 30 1 -1.5 1.5 5.6 0.02 1",
        "SLICE 0 30 2 0 90 1", "SCAN 1.0 2.0"}) {
    EXPECT_TRUE(std::holds_alternative<NodUnreadable>(parse_nod_line(line))) << line;
  }
  EXPECT_TRUE(std::holds_alternative<NodOther>(parse_nod_line("# NOD")));
  EXPECT_TRUE(std::holds_alternative<NodOther>(parse_nod_line("  ")));
}

}  // namespace nod_test
}  // namespace nodmap::convert
