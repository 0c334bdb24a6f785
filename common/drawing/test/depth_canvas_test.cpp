// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/depth_canvas.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::drawing {
namespace depth_canvas_test {

constexpr Rgb kNear{200, 100, 50};
constexpr Rgb kFar{10, 20, 30};

TEST(DepthCanvas, NearCoversFarInAnyOrder) {
  DepthCanvas canvas({.width = 20, .height = 10}, kBlack);
  canvas.splat({5, 5, 2.0}, 1, kNear);
  canvas.splat({5, 5, 3.0}, 1, kFar);
  canvas.splat({15, 5, 3.0}, 1, kFar);
  canvas.splat({15, 5, 2.0}, 1, kNear);
  EXPECT_EQ(canvas.shaded(5, 5, 0.0), kNear);
  EXPECT_EQ(canvas.shaded(15, 5, 0.0), kNear);
  EXPECT_EQ(canvas.shaded(4, 4, 0.0), kNear);  // 3 x 3 pixels
  EXPECT_EQ(canvas.shaded(3, 5, 0.0), kBlack);
}

TEST(DepthCanvas, HollowsAreDarkerAndPlanesAreNot) {
  DepthCanvas canvas({.width = 40, .height = 40}, kBlack);
  canvas.splat({20, 20, 5.0}, 20, kNear);
  EXPECT_EQ(canvas.shaded(20, 20, 2.0), kNear);
  canvas.splat({10, 20, 4.0}, 8, kFar);  // up to column 18, 1 m nearer
  EXPECT_LT(canvas.shaded(20, 20, 2.0)[0], kNear[0]);
  EXPECT_EQ(canvas.shaded(30, 20, 2.0), kNear);
}

TEST(DepthCanvas, OutsideIsCutOff) {
  DepthCanvas canvas({.width = 4, .height = 4}, kBlack);
  canvas.splat({-1, -1, 1.0}, 1, kNear);
  canvas.splat({1e12, 2, 1.0}, 1, kNear);
  canvas.splat({std::nan(""), 2, 1.0}, 1, kNear);
  EXPECT_EQ(canvas.shaded(0, 0, 0.0), kNear);
  EXPECT_EQ(canvas.shaded(3, 3, 0.0), kBlack);
}

}  // namespace depth_canvas_test
}  // namespace nodmap::drawing
