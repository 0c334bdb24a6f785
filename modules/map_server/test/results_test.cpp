// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/results.hpp"

#include <gtest/gtest.h>

#include "common/geometry/angle.hpp"

namespace nodmap::map_server {
namespace {

ExtendedScan map_with(Relevance relevance, const Eigen::Vector2d& p) {
  ExtendedScan map(AngleBins(geometry::deg_to_rad(360), geometry::deg_to_rad(1)), relevance);
  const EgoPoint point = EgoPoint::at(p, 0.2);
  map[*map.bins().index(point.bearing_rad)] = point;
  return map;
}

bool is_reddish(drawing::Rgb c) {
  return c[0] > 150 && c[2] < 100;
}
bool is_bluish(drawing::Rgb c) {
  return c[2] > 150 && c[0] < 100;
}

// Points at 4.5 m give a picture of 5 m to each side: 100 pixels a metre. Ahead is up, left is
// left.
TEST(Results, AheadIsUpAndLeftIsLeft) {
  const drawing::Image image = draw_maps(map_with(Relevance::kNearest, {2.0, 0.0}),
                                         map_with(Relevance::kFarthest, {0.0, 4.5}), {0.45, 0.33});
  EXPECT_TRUE(is_reddish(image.at(500, 300)));
  EXPECT_TRUE(is_bluish(image.at(50, 500)));
  EXPECT_EQ(image.at(500, 500), image.at(490, 515));  // the robot's body
  EXPECT_NE(image.at(500, 500), drawing::kWhite);
  EXPECT_EQ(image.at(900, 640), drawing::kWhite);
}

TEST(Results, EmptyMapsAreDrawnToo) {
  const ExtendedScan none(AngleBins(1.0, 0.1), Relevance::kNearest);
  EXPECT_GT(draw_maps(none, none, {}).width(), 0);
}

}  // namespace
}  // namespace nodmap::map_server
