// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/cloud_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace nodmap::drawing {
namespace cloud_view_test {

// A floor of 8 x 3 m seen from above, and a ceiling over it that faces down.
std::vector<DrawnPoint> floor_and_ceiling() {
  std::vector<DrawnPoint> points;
  for (int i = 0; i < 160; ++i) {
    for (int j = 0; j < 60; ++j) {
      const float x = 0.05F * static_cast<float>(i);
      const float y = 0.05F * static_cast<float>(j);
      points.push_back({{x, y, 0.0F}, {0.0F, 0.0F, 1.0F}});
      points.push_back({{x, y, 2.5F}, {0.0F, 0.0F, -1.0F}});
    }
  }
  return points;
}

double share_painted(const Image& image) {
  const Rgb background = image.at(0, 0);
  double painted = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      painted += image.at(x, y) == background ? 0.0 : 1.0;
    }
  }
  return painted / (static_cast<double>(image.width()) * image.height());
}

// The floor is visible through the ceiling: the painted pixels have colours of the low half of the
// scale (only there is blue above green), and much of the image is painted.
TEST(CloudView, TheFloorIsVisibleThroughTheCeiling) {
  const std::vector<Eigen::Vector3d> way{{1, 1, 0}, {3, 1, 0}};
  const Image image = draw_cloud(floor_and_ceiling(), {way, way, way});
  EXPECT_GT(share_painted(image), 0.4);  // half of it is
  const Rgb middle_of_top = image.at(image.width() / 2, image.height() - 200);
  EXPECT_GT(middle_of_top[2], middle_of_top[1]);
}

// The cloud is at 160 x 60 places, several pixels apart; the scale bar is painted, too.
TEST(CloudView, ThePathImageHasAPixelForEachPlaceInTheCloud) {
  const Image image = draw_path_on_cloud(floor_and_ceiling(), {});
  EXPECT_GE(share_painted(image) * image.width() * image.height(), 160.0 * 60.0);
}

TEST(CloudView, DrawsAnEmptyCloudAndASinglePoint) {
  EXPECT_GT(draw_cloud({}, {}).width(), 0);
  EXPECT_GT(draw_path_on_cloud({}, {}).width(), 0);
  const std::vector<DrawnPoint> one{{{1, 2, 3}, {0, 0, 0}}};
  EXPECT_GT(draw_cloud(one, {}).width(), 0);
  EXPECT_GT(draw_path_on_cloud(one, {}).width(), 0);
}

}  // namespace cloud_view_test
}  // namespace nodmap::drawing
