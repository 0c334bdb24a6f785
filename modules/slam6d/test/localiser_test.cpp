// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localiser.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace localiser_test {

using geometry::SE3;

/// A robot in Room::hall() or in look_alike_hall(), whose poses are tracked without any error.
class LocaliserInAHall : public testing::Test {
 protected:
  [[nodiscard]] Localiser localiser(const std::optional<SE3>& T_map_start = std::nullopt) const {
    return {LocaliseParams{}, RegistrationParams{}, map_.keyframes, map_.voxels, T_map_start};
  }

  PoseState classify(Localiser& localiser, const Room& room, double x_m,
                     double inlier_ratio = 0.9) {
    PoseUpdate update;
    update.T_map_base = pose(x_m, 0.0, 0.0);
    update.registration = Registration{};
    update.registration->state = PoseState::kTracking;
    update.registration->inlier_ratio = inlier_ratio;
    update.registration->upright_inlier_ratio = inlier_ratio;
    localiser.classify(sweep_at(room, update.T_map_base, ++seed_), update, 0);
    return update.registration->state;
  }

  TestMap map_{Room::hall(), along_hall()};
  unsigned seed_ = 99;
};

TEST_F(LocaliserInAHall, APlaceIsConfirmedAfterThreeMetres) {
  Localiser robot = localiser();
  ASSERT_TRUE(robot.find(sweep_at(Room::hall(), pose(-2.0, 0.0, 0.0), 98), map_.voxels, {}));
  for (const double x_m : {-2.0, -1.0, 0.0, 0.9}) {
    EXPECT_EQ(classify(robot, Room::hall(), x_m), PoseState::kDegraded) << x_m;
  }
  EXPECT_FALSE(robot.is_confirmed());
  EXPECT_EQ(classify(robot, Room::hall(), 1.1), PoseState::kTracking);
  EXPECT_TRUE(robot.is_confirmed());
}

// The given start pose is wrong: the robot is in the other hall.
TEST_F(LocaliserInAHall, APlaceThatContradictsTheMapIsGivenUp) {
  Localiser robot = localiser(pose(-2.0, 0.0, 0.0));
  ASSERT_TRUE(robot.find(sweep_at(look_alike_hall(), pose(-2.0, 0.0, 0.0), 98), map_.voxels, {}));
  int sweeps = 0;
  for (double x_m = -2.0; x_m < 1.0 && robot.has_place(); x_m += 0.5) {
    classify(robot, look_alike_hall(), x_m);
    ++sweeps;
  }
  EXPECT_FALSE(robot.has_place());
  EXPECT_EQ(robot.metrics().times_contradicted, 1);
  EXPECT_EQ(robot.metrics().times_lost, 1);
  EXPECT_LE(sweeps, 4);
}

// In one of ten sweeps there are new surfaces as large as a cabinet, as when a person walks by.
// They are 6 to 10 % of this sweep but only 1 % of all ten, which is less than the 6 % at which a
// confirmed place is given up.
TEST_F(LocaliserInAHall, AConfirmedPlaceIsKeptAfterOneContradictingSweep) {
  Localiser robot = localiser(pose(-2.0, 0.0, 0.0));
  ASSERT_TRUE(robot.find(sweep_at(Room::hall(), pose(-2.0, 0.0, 0.0), 98), map_.voxels, {}));
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(classify(robot, Room::hall(), 0.0), PoseState::kTracking);
  }
  EXPECT_EQ(classify(robot, look_alike_hall(), 0.0), PoseState::kTracking);
  EXPECT_TRUE(robot.has_place());
}

TEST_F(LocaliserInAHall, AMostlyUnknownSweepIsDegradedUnlessTheStartPoseWasGiven) {
  Localiser searched = localiser();
  ASSERT_TRUE(searched.find(sweep_at(Room::hall(), pose(-2.0, 0.0, 0.0), 98), map_.voxels, {}));
  EXPECT_EQ(classify(searched, Room::hall(), 1.1, 0.51), PoseState::kTracking);
  EXPECT_EQ(classify(searched, Room::hall(), 1.1, 0.49), PoseState::kDegraded);
  EXPECT_TRUE(searched.is_confirmed());
  Localiser told = localiser(pose(-2.0, 0.0, 0.0));
  ASSERT_TRUE(told.find(sweep_at(Room::hall(), pose(-2.0, 0.0, 0.0), 98), map_.voxels, {}));
  EXPECT_EQ(classify(told, Room::hall(), 1.1, 0.49), PoseState::kTracking);
}

}  // namespace localiser_test
}  // namespace nodmap::slam6d
