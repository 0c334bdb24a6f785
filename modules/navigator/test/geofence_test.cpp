// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/geofence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "common/params/params.hpp"
#include "modules/navigator/test/point_world.hpp"

namespace nodmap::navigator {
namespace geofence_test {

using test::ClosedLoop;
using ::testing::HasSubstr;

// A square of 4 m with a square hole of 1 m. The first ring is not closed, the second has the
// reverse of the usual orientation.
const char* const kWithHole =
    "POLYGON((-2 -2, 2 -2, 2 2, -2 2), (0.5 0.5, 1.5 0.5, 1.5 1.5, 0.5 1.5, 0.5 0.5))";

bool is_in_square(const Eigen::Vector2d& p, double low, double high) {
  return (p.array() > low).all() && (p.array() < high).all();
}

TEST(Geofence, ContainsPointsInsideTheOuterRingAndOutsideTheHoles) {
  const Geofence fence(kWithHole);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d p(uniform(random), uniform(random));
    EXPECT_EQ(fence.contains(p), is_in_square(p, -2, 2) && !is_in_square(p, 0.5, 1.5));
  }
  EXPECT_FALSE(fence.contains({2.0, 0.0})) << "the boundary";
  EXPECT_FALSE(fence.contains({std::nan(""), 0.0}));
}

// The oracle: all corners are inside, and no point of the boundary is within the body.
TEST(Geofence, ContainsABodyOfWhichNoPartIsOutside) {
  const Geofence fence(kWithHole);
  const robot::Footprint body{0.4, 0.2};
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-2.5, 2.5);
  int num_contained = 0;
  for (int i = 0; i < 2000; ++i) {
    const geometry::SE2 T_map_base{uniform(random), uniform(random), uniform(random)};
    bool is_inside = true;
    for (const Eigen::Vector2d& corner_base :
         {Eigen::Vector2d(0.4, 0.2), Eigen::Vector2d(0.4, -0.2), Eigen::Vector2d(-0.4, 0.2),
          Eigen::Vector2d(-0.4, -0.2)}) {
      is_inside = is_inside && fence.contains(T_map_base * corner_base);
    }
    for (const Eigen::Vector2d& p_map : fence.boundary_near({0.0, 0.0}, 100.0)) {
      is_inside = is_inside && !body.contains(T_map_base.inverse() * p_map);
    }
    EXPECT_EQ(fence.contains(T_map_base, body), is_inside) << i;
    num_contained += is_inside ? 1 : 0;
  }
  EXPECT_GT(num_contained, 200) << "both answers must occur: a quarter of the places is expected";
}

TEST(Geofence, TheBoundaryNearAPlaceIsThePartWithinTheRadius) {
  const Geofence fence(kWithHole);
  const Points whole = fence.boundary_near({0.0, 0.0}, 100.0);
  EXPECT_EQ(whole.size(), 4U * 200U + 4U * 50U) << "16 m and 4 m, a point each 2 cm";
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-4.0, 4.0);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2d p(uniform(random), uniform(random));
    const double radius_m = std::abs(uniform(random));
    const Points near = fence.boundary_near(p, radius_m);
    std::size_t expected = 0;
    for (const Eigen::Vector2d& q : whole) {
      // Rounding decides about points on the circle itself.
      const double distance_m = (q - p).norm();
      expected += distance_m < radius_m - 1e-9 ? 1U : 0U;
      EXPECT_TRUE(std::abs(distance_m - radius_m) > 1e-9);
    }
    EXPECT_EQ(near.size(), expected);
  }
}

TEST(Geofence, AnInvalidTextIsAnError) {
  for (const char* bad :
       {"", "POLYGON", "POLYGON((0 0, 1 0))", "POLYGON((0 0, 1 0, 2 0))", "POINT(1 2)",
        "POLYGON((0 0, 2 0, 0 2, 2 2))", "POLYGON((0 0, 1 0, 1 nan))", "POLYGON((0 0, 1e9 0, 1 1))",
        "POLYGON((0 0, 2 0, 2 2), (3 3, 4 3, 4 4))", "POLYGON((0 0, 1 0, 1 1)) and more",
        "0 0, 1 0, 1 1"}) {
    EXPECT_THROW(Geofence{bad}, params::ParamError) << bad;
  }
}

TEST(Geofence, AnErrorSaysWhatIsWrong) {
  const auto error_of = [](const char* wkt) -> std::string {
    try {
      const Geofence fence(wkt);
    } catch (const params::ParamError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_THAT(error_of("POINT(1 2)"), HasSubstr("must be POLYGON((X Y, X Y, ...))"));
  EXPECT_THAT(error_of("POLYGON((0 0, 1 0))"), HasSubstr("three corners"));
  EXPECT_THAT(error_of("POLYGON((0 0, 2 0, 0 2, 2 2))"), HasSubstr("crosses or touches itself"));
  EXPECT_THAT(error_of("POLYGON((0 0, 2 0, 2 2), (3 3, 4 3, 4 4))"), HasSubstr("a hole is not"));
}

// Whether all corners of the body are inside the fence.
bool is_within(const Geofence& fence, const geometry::SE2& T_map_base,
               const robot::Footprint& body) {
  for (const double x : {body.half_length_m, -body.half_length_m}) {
    for (const double y : {body.half_width_m, -body.half_width_m}) {
      if (!fence.contains(T_map_base * Eigen::Vector2d(x, y))) {
        return false;
      }
    }
  }
  return true;
}

// There is nothing in the world but the fence.
TEST(Geofence, TheWholeBodyStaysInsideWhileItRoams) {
  const Geofence fence(kWithHole);
  const robot::Footprint body = robot::Body{}.footprint();
  for (const double yaw_rad : {0.0, 0.7, 2.0, -2.5}) {
    ClosedLoop loop({}, {-0.8, -0.8, yaw_rad});
    loop.geofence = &fence;
    loop.max_forward_mps = 1.5;
    loop.on_decision = [&] {
      EXPECT_TRUE(is_within(fence, loop.robot.T_odom_base, body)) << loop.time_s;
    };
    loop.run(60.0);
    EXPECT_GT(loop.driven_m, 10.0) << "a tenth of what it drives in the open";
  }
}

}  // namespace geofence_test
}  // namespace nodmap::navigator
