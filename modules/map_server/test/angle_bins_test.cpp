// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/angle_bins.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace nodmap::map_server {
namespace {

using geometry::deg_to_rad;

AngleBins bins(double aperture_deg, double resolution_deg) {
  return {deg_to_rad(aperture_deg), deg_to_rad(resolution_deg)};
}

TEST(AngleBins, R17_NumberOfBins) {
  EXPECT_EQ(bins(180, 1).size(), 181U);
  EXPECT_EQ(bins(180, 0.5).size(), 361U);
  EXPECT_EQ(bins(360, 0.5).size(), 720U);
  EXPECT_EQ(bins(360, 1).size(), 360U);
  EXPECT_EQ(bins(270, 0.25).size(), 1081U);
}

TEST(AngleBins, R17_IndexOfAngleRoundTrip) {
  for (const AngleBins& b : {bins(180, 1), bins(360, 0.5), bins(90, 0.25), bins(360, 7)}) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      EXPECT_EQ(b.index(geometry::normalize_angle(b.angle_rad(i))), i);
      // Anywhere within the bin but for rounding at its borders.
      EXPECT_EQ(b.index(geometry::normalize_angle(b.angle_rad(i) + 0.499 * b.step_rad())), i);
      EXPECT_EQ(b.index(geometry::normalize_angle(b.angle_rad(i) - 0.499 * b.step_rad())), i);
    }
  }
}

TEST(AngleBins, R17_OutsideTheApertureThereIsNoBin) {
  EXPECT_EQ(bins(180, 1).index(deg_to_rad(91)), std::nullopt);
  EXPECT_EQ(bins(180, 1).index(deg_to_rad(-91)), std::nullopt);
  EXPECT_EQ(bins(180, 1).index(deg_to_rad(180)), std::nullopt);
}

TEST(AngleBins, BothSidesOfStraightBackShareABin) {
  const AngleBins b = bins(360, 1);
  EXPECT_EQ(b.index(deg_to_rad(179.9)), b.index(deg_to_rad(-179.9)));
  EXPECT_EQ(b.index(geometry::kPi), b.index(-geometry::kPi));
}

TEST(AngleBins, NotANumberHasNoBin) {
  EXPECT_EQ(bins(360, 1).index(std::numeric_limits<double>::quiet_NaN()), std::nullopt);
  EXPECT_EQ(bins(360, 1).index(std::numeric_limits<double>::infinity()), std::nullopt);
}

}  // namespace
}  // namespace nodmap::map_server
