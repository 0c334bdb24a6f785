// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/collision.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace nodmap::sim {
namespace collision_test {

constexpr double kMm = 1e-3;

bool hits(const Object& object, const BodyPose& body = {}) {
  World world;
  world.objects.push_back(object);
  return !Collision(world, {}).touched(body).empty();
}

Object box(double x, double z_min, double z_max) {
  return {Box{{x, 0.0, 0.5 * (z_min + z_max)}, {0.2, 0.2, z_max - z_min}, 0.0}};
}

TEST(Collision, ABodyTouchesAnObjectOnlyWithinItsLengthWidthAndHeight) {
  // The front is at 0.225 m, and the box reaches 0.1 m from its middle.
  EXPECT_TRUE(hits(box(0.325 - kMm, 0.0, 1.0)));
  EXPECT_FALSE(hits(box(0.325 + kMm, 0.0, 1.0)));
  // Side: half of 0.33 m.
  EXPECT_TRUE(hits({Cylinder{{0.0, 0.265 - kMm, 0.5}, 0.1, 1.0}}));
  EXPECT_FALSE(hits({Cylinder{{0.0, 0.265 + kMm, 0.5}, 0.1, 1.0}}));
  // Beyond a corner the distance is diagonal.
  const double diagonal = 0.1 / std::sqrt(2.0);
  EXPECT_TRUE(hits({Cylinder{{0.225 + diagonal - kMm, 0.165 + diagonal - kMm, 0.5}, 0.1, 1.0}}));
  EXPECT_FALSE(hits({Cylinder{{0.225 + diagonal + kMm, 0.165 + diagonal + kMm, 0.5}, 0.1, 1.0}}));
  // Height: from the climb height to 0.47 m.
  EXPECT_FALSE(hits(box(0.0, 0.0, 0.03 - kMm)));
  EXPECT_TRUE(hits(box(0.0, 0.0, 0.03 + kMm)));
  EXPECT_TRUE(hits(box(0.0, 0.47 - kMm, 0.6)));
  EXPECT_FALSE(hits(box(0.0, 0.47 + kMm, 0.6)));
  // The same for a body on a platform of 0.4 m.
  EXPECT_FALSE(hits(box(0.0, 0.0, 0.43 - kMm), {{}, 0.4}));
  EXPECT_TRUE(hits(box(0.0, 0.0, 0.43 + kMm), {{}, 0.4}));
  EXPECT_TRUE(hits(box(0.0, 0.87 - kMm, 1.0), {{}, 0.4}));
  // The body rotates with the robot.
  EXPECT_FALSE(hits(box(0.325 - kMm, 0.0, 1.0), {{0.0, 0.0, 0.5 * geometry::kPi}}));
}

TEST(Collision, RampsAreGroundUpToTheSlopeLimit) {
  const auto ramp = [](double height) {
    return Object{Ramp{{0.1, 0.0, 0.0}, {3.1, 0.0, height}, 2.0}};
  };
  EXPECT_FALSE(hits(ramp(0.6)));
  EXPECT_FALSE(hits(ramp(0.6), {{2.1, 0.0, 0.0}, 0.4}));  // the body is on it
  EXPECT_TRUE(hits(ramp(0.6), {{2.1, 0.0, 0.0}, 0.0}));   // the body is under it
  EXPECT_TRUE(hits(ramp(3.0)));
}

TEST(Collision, APitIsTouchedByABodyOnTheFloor) {
  World world;
  world.pits.push_back({{0.5, -1.0}, {1.0, 1.0}, 0.3});
  const Collision collision(world, {});
  EXPECT_TRUE(collision.touched({{0.275 - kMm, 0.0, 0.0}, 0.0}).empty());
  EXPECT_FALSE(collision.touched({{0.275 + kMm, 0.0, 0.0}, 0.0}).empty());
  EXPECT_NEAR(collision.clearance_m({{0.0, 0.0, 0.0}, 0.0}), 0.275, 1e-12);
}

// The body reaches 0.225 m ahead and 0.165 m to the side.
TEST(Collision, TheAxisOfAnActorInsideTheBodyHasANegativeDistance) {
  const Collision collision({}, {});
  const auto distance_m = [&collision](double x, double y) {
    return collision.axis_distance({{1.0 + x, y}, 0.25, 1.75}, {.T_world_base = {1.0, 0.0, 0.0}});
  };
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(distance_m(0.325, 0.0), 0.1, kRounding);
  EXPECT_NEAR(distance_m(-0.225 - 0.03, 0.165 + 0.04), 0.05, kRounding) << "from a corner";
  EXPECT_NEAR(distance_m(0.2, 0.1), -0.025, kRounding) << "the front is the nearest edge";
  EXPECT_NEAR(distance_m(0.1, -0.1), -0.065, kRounding) << "the side is";
}

TEST(Collision, InAnEmptyWorldTheClearanceIsInfinite) {
  EXPECT_EQ(Collision({}, {}).clearance_m({}), std::numeric_limits<double>::infinity());
}

class Random {
 public:
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(engine_);
  }

 private:
  std::mt19937_64 engine_{11};
};

Object random_object(Random& random, int kind) {
  const Eigen::Vector3d p(random.between(-1, 1), random.between(-1, 1), random.between(0, 0.7));
  if (kind == 0) {
    return {Box{p,
                {random.between(0.1, 0.8), random.between(0.1, 0.8), random.between(0.05, 0.5)},
                random.between(-4, 4)}};
  }
  if (kind == 1) {
    return {Cylinder{p, random.between(0.02, 0.4), random.between(0.05, 0.5)}};
  }
  Mesh mesh;
  for (int i = 0; i < 3; ++i) {
    mesh.vertices.push_back(p + Eigen::Vector3d(random.between(-0.6, 0.6),
                                                random.between(-0.6, 0.6),
                                                random.between(-0.6, 0.6)));
  }
  mesh.triangles.emplace_back(0, 1, 2);
  return {mesh};
}

// A random point of the object.
Eigen::Vector3d sample(const Object& object, Random& random) {
  if (const auto* box = std::get_if<Box>(&object.shape)) {
    const Eigen::Vector3d local(random.between(-0.5, 0.5), random.between(-0.5, 0.5),
                                random.between(-0.5, 0.5));
    return box->center + Eigen::AngleAxisd(box->yaw_rad, Eigen::Vector3d::UnitZ()) *
                             local.cwiseProduct(box->size);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) {
    const double r = cylinder->radius_m * std::sqrt(random.between(0, 1));
    const double a = random.between(-4, 4);
    return cylinder->center + Eigen::Vector3d(r * std::cos(a), r * std::sin(a),
                                              cylinder->height_m * random.between(-0.5, 0.5));
  }
  const auto& v = std::get<Mesh>(object.shape).vertices;
  double a = random.between(0, 1);
  double b = random.between(0, 1);
  if (a + b > 1.0) {
    a = 1.0 - a;
    b = 1.0 - b;
  }
  return v[0] + a * (v[1] - v[0]) + b * (v[2] - v[0]);
}

struct Sampled {
  double distance_m = std::numeric_limits<double>::infinity();
  int points = 0;
};

// Oracle: the smallest horizontal distance from the body to sampled points of the object that are
// within the body's height.
Sampled sampled_distance(const Object& object, const BodyPose& body, Random& random) {
  const geometry::SE2 T_base_world = body.T_world_base.inverse();
  Sampled sampled;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d p = sample(object, random);
    if (p.z() > body.ground_m + 0.03 && p.z() < body.ground_m + 0.47) {
      const Eigen::Vector2d q = T_base_world * Eigen::Vector2d(p.head<2>());
      const double dx = std::max(0.0, std::abs(q.x()) - 0.225);
      const double dy = std::max(0.0, std::abs(q.y()) - 0.165);
      sampled.distance_m = std::min(sampled.distance_m, std::hypot(dx, dy));
      ++sampled.points;
    }
  }
  return sampled;
}

TEST(Collision, TheClearanceAgreesWithSampledPoints) {
  Random random;
  int overlaps = 0;
  int apart = 0;
  for (int i = 0; i < 900; ++i) {
    const Object object = random_object(random, i % 3);
    const BodyPose body{
        {random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(-4, 4)},
        random.between(0, 0.2)};
    World world;
    world.objects.push_back(object);
    const double distance_m = Collision(world, {}).distance(0, body);
    const Sampled sampled = sampled_distance(object, body, random);
    // No point of the object is nearer than the clearance,
    ASSERT_GE(sampled.distance_m, distance_m - 1e-9) << i;
    // and some point is about as near: a thousand points in less than a square metre leave gaps of
    // up to 2.4 cm. There are fewer points if only a small part of the object is within the height.
    if (sampled.points > 1000) {
      EXPECT_NEAR(sampled.distance_m, distance_m, 0.03) << i;
    }
    overlaps += distance_m == 0.0 ? 1 : 0;
    apart += std::isfinite(distance_m) && distance_m > 0.0 ? 1 : 0;
  }
  EXPECT_GT(overlaps, 100);
  EXPECT_GT(apart, 100);
}

}  // namespace collision_test
}  // namespace nodmap::sim
