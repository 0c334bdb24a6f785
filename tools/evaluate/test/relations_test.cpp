// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/relations.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <random>

#include "common/formats/input_file.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::evaluate {
namespace relations_test {

time::Timestamp at(std::int64_t utime) {
  return time::from_utime(utime);
}

using geometry::to_se3;

TEST(Relations, PerfectTrajectoryHasNoErrorWhereverItsMapLies) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> metres(-10.0, 10.0);
  const geometry::SE3 T_map_world = geometry::make_se3(
      {3.0, -1.0, 0.5},
      Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized())));
  formats::Trajectory trajectory;
  std::vector<Relation> relations;
  geometry::SE3 before = geometry::SE3::Identity();
  for (int i = 0; i < 50; ++i) {
    const geometry::SE3 pose = to_se3({metres(random), metres(random), metres(random)});
    trajectory.push_back({at(i), T_map_world * pose});
    if (i > 0) {
      relations.push_back({at(i - 1), at(i), before.inverse() * pose});
    }
    before = pose;
  }
  const RelationErrors errors = measure_relations(trajectory, relations);
  EXPECT_EQ(errors.n, 49U);
  EXPECT_EQ(errors.missing, 0U);
  EXPECT_LT(errors.trans_max_m, 1e-12);  // rounding of some 10 m
  EXPECT_LT(errors.rot_mean_rad,
            1e-7);  // an angle near zero from a matrix: square root of rounding
}

TEST(Relations, ErrorsAreAsComputedByHand) {
  const formats::Trajectory trajectory = {{at(0), to_se3({0.0, 0.0, 0.0})},
                                          {at(1), to_se3({1.3, 0.4, 0.1})},
                                          {at(2), to_se3({2.0, 0.0, 0.0})}};
  const std::vector<Relation> relations = {{at(0), at(1), to_se3({1.0, 0.0, 0.0})},
                                           {at(0), at(2), to_se3({2.0, 0.0, -0.3})},
                                           {at(0), at(3), to_se3({})}};
  const RelationErrors errors = measure_relations(trajectory, relations);
  EXPECT_EQ(errors.n, 2U);
  EXPECT_EQ(errors.missing, 1U);
  EXPECT_NEAR(errors.trans_mean_m, 0.25, 1e-12);  // 0.5 (a 3-4-5 triangle) and 0
  EXPECT_NEAR(errors.trans_std_m, 0.25, 1e-12);
  EXPECT_NEAR(errors.trans_max_m, 0.5, 1e-12);
  EXPECT_NEAR(errors.rot_mean_rad, 0.2, 1e-12);  // 0.1 and 0.3
  EXPECT_NEAR(errors.rot_std_rad, 0.1, 1e-12);
}

TEST(Relations, FirstPoseOfAStampCounts) {
  const formats::Trajectory trajectory = {
      {at(0), to_se3({})}, {at(1), to_se3({1.0, 0.0, 0.0})}, {at(1), to_se3({9.0, 0.0, 0.0})}};
  const std::vector<Relation> relations = {{at(0), at(1), to_se3({1.0, 0.0, 0.0})}};
  EXPECT_EQ(measure_relations(trajectory, relations).trans_max_m, 0.0);
}

TEST(Relations, WithoutPosesThereAreNoErrors) {
  EXPECT_EQ(measure_relations({}, {}).n, 0U);
  const std::vector<Relation> relations = {{at(0), at(1), to_se3({})}};
  const RelationErrors errors = measure_relations({}, relations);
  EXPECT_EQ(errors.n, 0U);
  EXPECT_EQ(errors.missing, 1U);
  EXPECT_EQ(errors.trans_mean_m, 0.0);
}

TEST(Relations, ReadsStampsExactlyAndAnglesAsRollPitchYaw) {
  const test::TemporaryDir dir;
  std::ofstream(dir.path() / "a.relations") << "# t1 t2 x y z roll pitch yaw\n\n"
                                               "976052905.167303 976052911.885496 1 2 3 0 0 "
                                            << std::numbers::pi / 2 << "\n"
                                            << "1 2 0 0 0 " << std::numbers::pi / 2 << " 0 0\n";
  const auto relations = read_relations(dir.path() / "a.relations");
  ASSERT_EQ(relations.size(), 2U);
  EXPECT_EQ(relations[0].from_stamp, at(976052905167303));
  EXPECT_EQ(relations[0].to_stamp, at(976052911885496));
  // Half pi is written with six digits.
  EXPECT_TRUE(
      (relations[0].T_from_to * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(1, 3, 3), 1e-5));
  EXPECT_TRUE(
      (relations[1].T_from_to * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d(0, 0, 1), 1e-5));
}

TEST(Relations, NamesTheLineItCannotRead) {
  const test::TemporaryDir dir;
  std::ofstream(dir.path() / "a.relations") << "1 2 0 0 0 0 0 0\n1 2 0 0 0\n";
  try {
    (void)read_relations(dir.path() / "a.relations");
    FAIL() << "five numbers are no relation";
  } catch (const formats::InputFileError& error) {
    EXPECT_NE(std::string(error.what()).find("a.relations:2"), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)read_relations(dir.path() / "none"), std::runtime_error);
}

}  // namespace relations_test
}  // namespace nodmap::evaluate
