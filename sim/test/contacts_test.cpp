// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/contacts.hpp"

#include <gtest/gtest.h>

namespace nodmap::sim {
namespace contacts_test {

constexpr double kFast = 0.3;
constexpr bool kApproaches = true;
constexpr double kStationary = 0.049;

// Two boxes, 1 m ahead and 1 m behind, a pit on the left, and somebody who stands on the right.
class ContactsTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kAhead = 0;
  static constexpr std::size_t kBehind = 1;
  static constexpr std::size_t kPit = 2;

  static World make_world() {
    World world;
    world.objects.push_back({Box{{1.1, 0.0, 0.5}, {0.2, 2.0, 1.0}, 0.0}});
    world.objects.push_back({Box{{-1.1, 0.0, 0.5}, {0.2, 2.0, 1.0}, 0.0}});
    world.pits.push_back({.min = {-1.0, 2.0}, .max = {1.0, 3.0}});
    Actor actor;
    actor.path = {{0.0, {0.0, -2.0}}};
    world.actors.push_back(actor);
    return world;
  }

  void stand_at(double x, double y = 0.0) {
    contacts_.end_separated({.T_world_base = {x, y, 0.0}});
  }
  [[nodiscard]] const ContactCounts& counts() const { return contacts_.counts(); }

  World world_ = make_world();
  Collision collision_{world_, {}};
  Crowd crowd_{world_, {}};
  Contacts contacts_{collision_, crowd_};
};

// The front is at 0.225 m: at x = 0.775 it touches the box.
TEST_F(ContactsTest, CountOnceUntilApart) {
  contacts_.touch_obstacle(kAhead, kFast);
  contacts_.touch_obstacle(kAhead, kFast);
  EXPECT_EQ(counts().collisions, 1);
  stand_at(0.775 - 0.5 * Contacts::kSeparatedM);
  contacts_.touch_obstacle(kAhead, kFast);
  EXPECT_EQ(counts().collisions, 1);
  stand_at(0.775 - 1.5 * Contacts::kSeparatedM);
  contacts_.touch_obstacle(kAhead, kFast);
  EXPECT_EQ(counts().collisions, 2);
  contacts_.touch_obstacle(kBehind, kFast);
  EXPECT_EQ(counts().collisions, 3);
  EXPECT_EQ(counts().falls, 0);
}

TEST_F(ContactsTest, OnlyWhatMovesHasCausedAContact) {
  contacts_.touch_obstacle(kAhead, kStationary);
  EXPECT_EQ(counts().contacts_caused, 0);
  contacts_.touch_obstacle(kBehind, kFast);
  EXPECT_EQ(counts().contacts_caused, 1);
}

TEST_F(ContactsTest, PitsAndEdgesAreFalls) {
  contacts_.touch_obstacle(kPit, kFast);
  EXPECT_EQ(counts().falls, 1);
  contacts_.touch_edge({0.0, 0.0, 0.0}, kFast);
  contacts_.touch_edge({0.02, 0.0, 0.0}, kFast);
  EXPECT_EQ(counts().falls, 2) << "along the same edge";
  stand_at(0.045);  // 2.5 cm from where it met the edge last
  contacts_.touch_edge({0.045, 0.0, 0.0}, kFast);
  EXPECT_EQ(counts().falls, 2);
  stand_at(0.08);
  contacts_.touch_edge({0.08, 0.0, 0.0}, kFast);
  EXPECT_EQ(counts().falls, 3);
  EXPECT_EQ(counts().collisions, 3);
}

TEST_F(ContactsTest, SomebodyWhoTouchesTheStationaryRobotBumps) {
  contacts_.touch_actor(0, kStationary, kApproaches);
  contacts_.touch_actor(0, kFast, !kApproaches);  // the robot moves away
  EXPECT_EQ(counts().bumps, 1);
  EXPECT_EQ(counts().collisions, 0);
  stand_at(0.0, 0.0);  // the actor is 1.6 m away
  contacts_.touch_actor(0, kFast, !kApproaches);
  EXPECT_EQ(counts().bumps, 1);
  EXPECT_EQ(counts().collisions, 1);
  EXPECT_EQ(counts().contacts_caused, 1);
}

TEST_F(ContactsTest, ARobotThatDrivesIntoSomebodyWhoBumpedItCollides) {
  contacts_.touch_actor(0, kStationary, kApproaches);
  contacts_.touch_actor(0, kFast, kApproaches);
  contacts_.touch_actor(0, kFast, kApproaches);  // still the same collision
  EXPECT_EQ(counts().bumps, 1);
  EXPECT_EQ(counts().collisions, 1);
  EXPECT_EQ(counts().contacts_caused, 1);
}

}  // namespace contacts_test
}  // namespace nodmap::sim
