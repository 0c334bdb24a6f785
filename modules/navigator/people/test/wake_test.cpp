// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/wake.hpp"

#include <gtest/gtest.h>

#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/people/test/walking_scene.hpp"

namespace nodmap::navigator {
namespace wake_test {

// At (2, 0), walking to the left at 1 m/s: a wake of 1 m to the right.
Person walker() {
  Person person;
  person.position = {2.0, 0.0};
  person.velocity = {0.0, 1.0};
  person.radius_m = 0.25;
  return person;
}

// The disc and 0.25 m around it, 1 m back along the path.
TEST(Wake, PointsInItAreNobodys) {
  const Points outside{{2.0, 0.51}, {1.49, 0.0}, {2.51, -0.5}, {2.0, -1.51}};
  Points points = outside;
  points.insert(points.end(), {{2.0, 0.49}, {1.51, 0.0}, {2.49, -0.5}, {2.0, -1.49}});
  EXPECT_EQ(without_wakes({walker()}, points), outside);
  EXPECT_EQ(without_wakes({}, points), points);
}

TEST(Wake, OfSomebodyWhoStandsItIsTheDisc) {
  Person person = walker();
  person.velocity.setZero();
  EXPECT_EQ(without_wakes({person}, {{2.0, 0.49}, {2.0, -0.51}}), (Points{{2.0, -0.51}}));
}

TEST(Wake, SomebodyOutOfSightHasNone) {
  Person person = walker();
  person.is_in_sight = false;
  EXPECT_EQ(without_wakes({person}, {{2.0, 0.0}}).size(), 1U);
}

// A post that has come onto floor that was seen, half a second behind the person and far behind.
TEST(Wake, ObstaclesInItAreForgotten) {
  const auto is_known_after = [](const Person& person) {
    LocalMap map({}, {});
    const auto look = [&](const test::Ground& ground) {
      for (double deg = -60.0; deg <= 5.0; deg += 1.5) {
        map.add_scan(test::scan_of(ground, {}, geometry::deg_to_rad(deg)), {});
      }
    };
    look({});
    look({{{{0.95, -0.05}, {1.05, 0.05}, 0.45}}});
    EXPECT_FALSE(map.points_base({}, 2.0).empty());
    forget_wakes({person}, map);
    return !map.points_base({}, 2.0).empty();
  };
  Person person = walker();
  person.position = {1.0, 0.5};
  EXPECT_FALSE(is_known_after(person));
  person.is_in_sight = false;
  EXPECT_TRUE(is_known_after(person));
  person.is_in_sight = true;
  person.position = {1.0, 1.6};
  EXPECT_TRUE(is_known_after(person));
}

// A post on floor that was seen, half a second behind the person. It has been there for a while
// when the person comes.
TEST(Wake, WhatIsThereLongerThanAnybodyWalksThereStays) {
  const auto is_known_after = [](double stands_s) {
    LocalMap map({}, {});
    const auto sweep = [&](const test::Ground& ground, double time_s) {
      for (double deg = -60.0; deg <= 2.0; deg += 3.0) {
        scan::Scan scan = test::scan_of(ground, {}, geometry::deg_to_rad(deg));
        scan.stamp = test::at(time_s);
        map.add_scan(scan, {});
      }
    };
    sweep({}, 99.0);
    for (double time_s = 0.0; time_s <= stands_s; time_s += 0.5) {
      sweep({{{{0.95, -0.05}, {1.05, 0.05}, 0.45}}}, 100.0 + time_s);
    }
    Person person = walker();
    person.position = {1.0, 0.5};
    forget_wakes({person}, map);
    return !map.points_base({}, 2.0).empty();
  };
  EXPECT_FALSE(is_known_after(2.5));
  EXPECT_TRUE(is_known_after(3.5));
}

// The robot touches glass 2 cm before its front. Somebody has walked past it, on floor that was
// seen.
TEST(Wake, AContactStays) {
  LocalMap map({}, {});
  test::sweep(map, {}, {-1.0, 0.0, 0.0}, 1.0);
  map.add_contact({0.3, 0.0, 0.0}, true);
  ASSERT_TRUE(map.seen_floor().is_around({0.55, 0.0}));
  const std::size_t num_points = map.points_base({}, 2.0).size();
  ASSERT_GT(num_points, 0U);
  Person person = walker();
  person.position = {0.5, 0.5};
  forget_wakes({person}, map);
  EXPECT_EQ(map.points_base({}, 2.0).size(), num_points);
}

}  // namespace wake_test
}  // namespace nodmap::navigator
