// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/plan_view.hpp"

#include <gtest/gtest.h>

#include <array>

namespace nodmap::drawing {
namespace plan_view_test {

using Eigen::Vector2d;

constexpr Rgb kRed{255, 0, 0};

Extent square(double half_m) {
  Extent extent;
  extent.add({-half_m, -half_m});
  extent.add({half_m, half_m});
  return extent;
}

int count(const Image& image, Rgb colour) {
  int pixels = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      pixels += image.at(x, y) == colour ? 1 : 0;
    }
  }
  return pixels;
}

TEST(PlanView, AMapThatIsTooLargeForTheScaleIsShownWhole) {
  Extent extent;
  extent.add({-1000.0, -5.0});
  extent.add({3000.0, 5.0});
  PlanView view(extent, 20.0);  // 80,000 pixels
  EXPECT_EQ(view.px_per_m(), 5.0);
  EXPECT_EQ(view.image().width(), 20'000);
  EXPECT_EQ(view.image().height(), 50);
  EXPECT_EQ(view.to_px(extent.high), Vector2d(20'000.0, 0.0));
}

TEST(PlanView, XIsToTheRightAndYIsUp) {
  PlanView view(square(5.0), 10.0);
  ASSERT_EQ(view.image().width(), 100);
  ASSERT_EQ(view.image().height(), 100);
  EXPECT_EQ(view.to_px({5.0, 5.0}), Vector2d(100.0, 0.0));
  view.fill_disc({4.0, 3.0}, 0.1, kRed);
  EXPECT_EQ(view.image().at(90, 20), kRed);
}

TEST(PlanView, ScaleFitsTheLongerSide) {
  EXPECT_EQ(fitting_scale(square(10.0), 1000.0, 100.0), 50.0);
  EXPECT_EQ(fitting_scale(square(1.0), 1000.0, 100.0), 100.0);
  EXPECT_EQ(fitting_scale({}, 1000.0, 100.0), 100.0);
}

TEST(PlanView, NothingToShowIsASquareMetre) {
  const PlanView view({}, 10.0);
  EXPECT_EQ(view.image().width(), 10);
  EXPECT_EQ(view.image().height(), 10);
}

TEST(PlanView, ConvexPolygonsHaveTheirArea) {
  PlanView view(square(5.0), 10.0);
  const std::array corners{Vector2d(-2.0, -1.0), Vector2d(2.0, -1.0), Vector2d(2.0, 1.0),
                           Vector2d(-2.0, 1.0)};
  view.fill_convex(corners, kRed);
  // 40 x 20 pixels, and outlines on their rim of at most a pixel.
  EXPECT_GE(count(view.image(), kRed), 800);
  EXPECT_LE(count(view.image(), kRed), 41 * 21);
}

TEST(PlanView, GridCellsAreDrawnInTheirPlaces) {
  PlanView view(square(1.0), 10.0);
  view.draw_grid({.origin = {0.0, 0.0},
                  .cell_size_m = 0.5,
                  .width = 2,
                  .height = 2,
                  .colour = [](int x, int y) {
                    return x == 1 && y == 0 ? kRed : Rgb{0, 0, 255};
                  }});
  EXPECT_EQ(view.image().at(16, 7), kRed);  // x 0.65 m, y 0.25 m
  EXPECT_EQ(count(view.image(), kRed), 25);
  EXPECT_EQ(count(view.image(), Rgb{0, 0, 255}), 75);
  EXPECT_EQ(view.image().at(5, 5), drawing::kWhite);
}

TEST(PlanView, ScaleBarIsAsLongAsItSays) {
  PlanView view(square(10.0), 20.0);  // a quarter of the width is 5 m
  view.draw_scale_bar();
  int length_px = 0;
  for (int x = 0; x < view.image().width(); ++x) {
    length_px += view.image().at(x, view.image().height() - 14) == kBlack ? 1 : 0;
  }
  EXPECT_EQ(length_px, 100);
}

TEST(Text, IsDrawnInDotsAndCutOffOutside) {
  Image image(40, 12);
  draw_text(image, 0, 0, "L1?");
  const int num_drawn = count(image, kBlack);
  // An L of 7 dots, a 1 of 8; the rest is a space.
  EXPECT_EQ(num_drawn, 4 * (7 + 8));
  draw_text(image, 30, 8, "far outside");
  EXPECT_GT(count(image, kBlack), num_drawn);
}

}  // namespace plan_view_test
}  // namespace nodmap::drawing
