// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/ray_caster.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <random>

namespace nodmap::sim {
namespace ray_caster_test {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

// Oracle: each surface alone, as a bounded plane or a quadratic equation; without slabs, tree or
// Moeller-Trumbore.
class BruteForce {
 public:
  explicit BruteForce(const Ray& ray) : ray_(ray) {}

  double nearest = kNoHit;
  Vec3 normal = Vec3::Zero();

  // A parallelogram about `center` with half edges u and v.
  void patch(const Vec3& center, const Vec3& u, const Vec3& v) {
    plane(center, u.cross(v).normalized(), [&](const Vec3& p) {
      // Coordinates along two edges, which may be oblique.
      Eigen::Matrix<double, 3, 2> edges;
      edges << u, v;
      const Vec2 share = (edges.transpose() * edges).inverse() * edges.transpose() * (p - center);
      return share.cwiseAbs().maxCoeff() <= 1.0;
    });
  }

  void triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = (b - a).cross(c - a).normalized();
    plane(a, n, [&](const Vec3& p) {
      return (b - a).cross(p - a).dot(n) >= 0.0 && (c - b).cross(p - b).dot(n) >= 0.0 &&
             (a - c).cross(p - c).dot(n) >= 0.0;
    });
  }

  void box(const Box& box) {
    const Eigen::Matrix3d axes = Eigen::AngleAxisd(box.yaw_rad, Vec3::UnitZ()).toRotationMatrix() *
                                 Vec3(0.5 * box.size).asDiagonal();
    for (int i = 0; i < 3; ++i) {
      for (const double side : {-1.0, 1.0}) {
        patch(box.center + side * axes.col(i), axes.col((i + 1) % 3), axes.col((i + 2) % 3));
      }
    }
  }

  void cylinder(const Vec3& center, double radius, double height) {
    for (const double side : {-0.5, 0.5}) {
      plane(center + side * height * Vec3::UnitZ(), Vec3::UnitZ(),
            [&](const Vec3& p) { return (p - center).head<2>().norm() <= radius; });
    }
    // |o + t d| = r in the plane.
    const Vec2 o = (ray_.origin - center).head<2>();
    const Vec2 d = ray_.direction.head<2>();
    const double p = 2.0 * o.dot(d) / d.squaredNorm();
    const double q = (o.squaredNorm() - radius * radius) / d.squaredNorm();
    const double under_root = 0.25 * p * p - q;
    for (const double sign : {-1.0, 1.0}) {
      const double t = -0.5 * p + sign * std::sqrt(under_root);
      const Vec3 at = ray_.origin + t * ray_.direction;
      if (under_root >= 0.0 && std::abs(at.z() - center.z()) <= 0.5 * height) {
        take(t, Vec3(at.x() - center.x(), at.y() - center.y(), 0.0).normalized());
      }
    }
  }

  void ground(const std::vector<Pit>& pits) {
    const auto in_air = [&](const Vec3& p) {
      return std::ranges::any_of(pits, [&](const Pit& pit) {
        return p.x() > pit.min.x() && p.x() < pit.max.x() && p.y() > pit.min.y() &&
               p.y() < pit.max.y() && p.z() > -pit.depth_m && p.z() < 0.0;
      });
    };
    plane(Vec3::Zero(), Vec3::UnitZ(),
          [&](const Vec3& p) { return !in_air(p - 1e-7 * Vec3::UnitZ()); });
    for (const Pit& pit : pits) {
      const Vec3 size(pit.max.x() - pit.min.x(), pit.max.y() - pit.min.y(), pit.depth_m);
      const Vec3 center(pit.min.x() + 0.5 * size.x(), pit.min.y() + 0.5 * size.y(),
                        -0.5 * pit.depth_m);
      for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
          if (axis == 2 && side > 0.0) {
            continue;  // open above
          }
          const Vec3 out = side * Vec3::Unit(axis);
          plane(center + 0.5 * size.cwiseProduct(out), out, [&](const Vec3& p) {
            Vec3 beyond = (p - center).cwiseAbs() - 0.5 * size;
            beyond[axis] = -1.0;
            return beyond.maxCoeff() <= 0.0 && !in_air(p + 1e-7 * out);
          });
        }
      }
    }
  }

 private:
  template <class Inside>
  void plane(const Vec3& at, const Vec3& n, const Inside& inside) {
    const double t = (at - ray_.origin).dot(n) / ray_.direction.dot(n);
    if (std::isfinite(t) && inside(ray_.origin + t * ray_.direction)) {
      take(t, n);
    }
  }

  void take(double t, const Vec3& n) {
    if (t > 0.0 && t < nearest) {
      nearest = t;
      normal = n.dot(ray_.direction) > 0.0 ? Vec3(-n) : n;
    }
  }

  Ray ray_;
};

class Random {
 public:
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(engine_);
  }
  Vec3 point(double reach, double low, double high) {
    return {between(-reach, reach), between(-reach, reach), between(low, high)};
  }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    return Vec3(normal(engine_), normal(engine_), normal(engine_)).normalized();
  }

 private:
  std::mt19937_64 engine_{42};
};

World random_world(Random& random) {
  World world;
  for (int i = 0; i < 20; ++i) {
    const Vec3 size(random.between(0.05, 1.5), random.between(0.05, 1.5),
                    random.between(0.05, 2.0));
    world.objects.push_back({Box{random.point(6, 0, 2), size, random.between(-4, 4)}, 0.5});
    world.objects.push_back(
        {Cylinder{random.point(6, 0, 2), random.between(0.01, 0.5), random.between(0.1, 2)}, 0.6});
  }
  Mesh mesh;
  for (int i = 0; i < 20; ++i) {
    const Vec3 a = random.point(6, 0, 2);
    for (const Vec3& corner : {a, Vec3(a + random.direction()), Vec3(a + random.direction())}) {
      mesh.vertices.push_back(corner);
    }
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  world.objects.push_back({mesh, 0.7});
  world.objects.push_back({Ramp{{-3, -3, 0}, {1, -2, 0.8}, 1.5}, 0.9});
  // Three pits side by side like steps, one pit inside another, and one alone.
  world.pits = {{{-5, 1}, {-4, 3}, 0.2}, {{-4, 1}, {-3, 3}, 0.4}, {{-3, 1}, {-1, 3}, 0.6},
                {{2, 2}, {5, 5}, 0.3},   {{3, 3}, {4, 4}, 1.0},   {{1, -5}, {3, -4}, 0.5}};
  return world;
}

void look_at_objects(const World& world, BruteForce& oracle) {
  for (const Object& object : world.objects) {
    if (const auto* box = std::get_if<Box>(&object.shape)) {
      oracle.box(*box);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) {
      oracle.cylinder(cylinder->center, cylinder->radius_m, cylinder->height_m);
    } else if (const auto* ramp = std::get_if<Ramp>(&object.shape)) {
      const Vec3 along = ramp->to - ramp->from;
      const Vec3 left = Vec3::UnitZ().cross(along).normalized();
      oracle.patch(ramp->from + 0.5 * along, 0.5 * along, 0.5 * ramp->width_m * left);
    } else {
      const auto& mesh = std::get<Mesh>(object.shape);
      for (std::size_t i = 0; i < mesh.vertices.size(); i += 3) {
        oracle.triangle(mesh.vertices[i], mesh.vertices[i + 1], mesh.vertices[i + 2]);
      }
    }
  }
}

TEST(RayCaster, AgreesWithBruteForce) {
  Random random;
  const World world = random_world(random);
  const RayCaster caster(world);
  const std::vector<ActorState> actors{{{1, 1}, 0.3, 1.7}, {{-2, 0}, 0.2, 1.2}};
  constexpr double kMaxRangeM = 8.0;
  int hits = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Ray ray{random.point(7, 0.01, 2.5), random.direction()};
    BruteForce oracle(ray);
    look_at_objects(world, oracle);
    oracle.ground(world.pits);
    for (const ActorState& actor : actors) {
      oracle.cylinder({actor.position.x(), actor.position.y(), 0.5 * actor.height_m},
                      actor.radius_m, actor.height_m);
    }
    const auto hit = caster.cast(ray, kMaxRangeM, actors);
    ASSERT_EQ(hit.has_value(), oracle.nearest <= kMaxRangeM) << "ray " << i;
    if (hit) {
      ++hits;
      // Both are computed with doubles of about 10; the tolerance is a thousand times their
      // rounding error because of grazing rays. Pits are entered a nanometre late.
      ASSERT_NEAR(hit->distance_m, oracle.nearest, 1e-8) << "ray " << i;
      ASSERT_NEAR((hit->normal - oracle.normal).norm(), 0.0, 1e-6) << "ray " << i;
    }
  }
  EXPECT_GT(hits, 50'000);
}

TEST(RayCaster, ReportsTheReflectivityOfTheSurfaceHit) {
  World world;
  world.objects.push_back({Box{{2, 0, 1}, {0.2, 2, 2}, 0}, 0.1});
  world.objects.push_back({Cylinder{{-2, 0, 1}, 0.5, 2}, 3.0});
  const RayCaster caster(world);
  EXPECT_EQ(caster.cast({{0, 0, 1}, Vec3::UnitX()}, 10)->reflectivity, 0.1);
  EXPECT_EQ(caster.cast({{0, 0, 1}, -Vec3::UnitX()}, 10)->reflectivity, 3.0);
  EXPECT_EQ(caster.cast({{0, 0, 1}, -Vec3::UnitZ()}, 10)->reflectivity, kDefaultReflectivity);
}

TEST(RayCaster, ReportsTheReflectivityOfTheFloorItsPitsAndActors) {
  World world;
  world.floor_reflectivity = 0.1;
  world.pits.push_back({{2, -1}, {4, 1}, 0.5});
  const RayCaster caster(world);
  EXPECT_EQ(caster.cast({{0, 0, 1}, -Vec3::UnitZ()}, 10)->reflectivity, 0.1);
  EXPECT_EQ(caster.cast({{3, 0, 1}, -Vec3::UnitZ()}, 10)->reflectivity, 0.1);
  const std::vector<ActorState> actors{{{0, 3}, 0.25, 1.75, 0, 0.05}};
  EXPECT_EQ(caster.cast({{0, 0, 1}, Vec3::UnitY()}, 10, actors)->reflectivity, 0.05);
}

TEST(RayCaster, LooksBetweenLegsBelowTheHip) {
  const RayCaster caster(World{});
  const std::vector<ActorState> actors{
      {{3, 0}, 0.25, 1.75, 0, kDefaultReflectivity, Legs{{3, 0.1}, {3, -0.1}}}};
  const auto look = [&](double y, double z) {
    return caster.cast({{0, y, z}, Vec3::UnitX()}, 10, actors);
  };
  EXPECT_FALSE(look(0.0, 0.4));
  EXPECT_NEAR(look(0.1, 0.4)->distance_m, 3.0 - 0.07, 1e-12);
  EXPECT_NEAR(look(-0.1, 0.4)->distance_m, 3.0 - 0.07, 1e-12);
  EXPECT_FALSE(look(0.2, 0.4));
  EXPECT_NEAR(look(0.0, 0.9)->distance_m, 3.0 - 0.25, 1e-12);
}

TEST(RayCaster, HandlesAxisAlignedRaysAndFlatObjects) {
  World world;  // zero components, and a flat bounding box
  world.objects.push_back({Ramp{{1, 0, 0.5}, {3, 0, 0.5}, 1.0}});
  world.objects.push_back({Box{{5, 0, 1}, {1, 1, 2}, 0}});
  world.objects.push_back({Box{{-5, 0, 1}, {1, 1, 2}, 0}});
  const RayCaster caster(world);
  EXPECT_NEAR(caster.cast({{0, 0, 1}, Vec3::UnitX()}, 10)->distance_m, 4.5, 1e-12);
  EXPECT_NEAR(caster.cast({{0, 0, 1}, -Vec3::UnitX()}, 10)->distance_m, 4.5, 1e-12);
  EXPECT_NEAR(caster.cast({{2, 0, 1}, -Vec3::UnitZ()}, 10)->distance_m, 0.5, 1e-12);
  EXPECT_FALSE(caster.cast({{0, 3, 1}, Vec3::UnitX()}, 10).has_value());
  EXPECT_FALSE(caster.cast({{0, 0, 1}, Vec3::UnitX()}, 4.4).has_value());
}

// A ray within the plane of a side touches the box, whichever side it is.
TEST(RayCaster, RaysAlongTheSidesOfABoxHitIt) {
  World world;
  world.objects.push_back({Box{{5, 0, 1}, {1, 1, 1}, 0}});
  const RayCaster caster(world);
  for (const Vec3& origin : {Vec3(0, -0.5, 1), Vec3(0, 0.5, 1), Vec3(0, 0, 0.5), Vec3(0, 0, 1.5)}) {
    const std::optional<Hit> hit = caster.cast({origin, Vec3::UnitX()}, 10);
    ASSERT_TRUE(hit) << origin.transpose();
    EXPECT_NEAR(hit->distance_m, 4.5, 1e-12) << origin.transpose();
  }
}

TEST(RayCaster, AnEmptyWorldHasAFloor) {
  const RayCaster caster(World{});
  EXPECT_NEAR(caster.cast({{0, 0, 1}, -Vec3::UnitZ()}, 10)->distance_m, 1.0, 1e-12);
  EXPECT_FALSE(caster.cast({{0, 0, 1}, Vec3::UnitZ()}, 10).has_value());
}

}  // namespace ray_caster_test
}  // namespace nodmap::sim
