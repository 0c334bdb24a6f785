// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/rigid_fit.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace nodmap::registration {
namespace rigid_fit_test {

using geometry::SE3;

class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : random_(seed) {}

  Eigen::Vector3d point(double extent_m) {
    std::uniform_real_distribution<double> coordinate(-extent_m, extent_m);
    return {coordinate(random_), coordinate(random_), coordinate(random_)};
  }

  SE3 pose() {
    std::uniform_real_distribution<double> angle(-geometry::kPi, geometry::kPi);
    return geometry::make_se3(point(20.0), Eigen::Quaterniond(Eigen::AngleAxisd(
                                               angle(random_), point(1.0).normalized())));
  }

 private:
  std::mt19937 random_;
};

std::vector<PointPair> pairs_of(const std::vector<Eigen::Vector3d>& data, const SE3& T_model_data) {
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& p : data) {
    pairs.push_back({T_model_data * p, p});
  }
  return pairs;
}

double distance(const SE3& a, const SE3& b) {
  return (a.matrix() - b.matrix()).norm();
}

// The tolerance of 1e-9 is that of R33; the points lie within 40 m, where doubles resolve 1e-14 m.
TEST(RigidFit, R33_FindsTheMotionOfRandomClouds) {
  RandomScene scene(33);
  for (int run = 0; run < 1000; ++run) {
    std::vector<Eigen::Vector3d> data(static_cast<std::size_t>(3 + run % 50));
    for (Eigen::Vector3d& p : data) {
      p = scene.point(10.0);
    }
    const SE3 T_model_data = scene.pose();
    const auto fit = fit_rigid(pairs_of(data, T_model_data));
    ASSERT_TRUE(fit);
    ASSERT_LT(distance(*fit, T_model_data), 1e-9);
  }
}

// Points in a plane are fitted equally well by a reflection and by a rotation: the result must be
// the rotation.
TEST(RigidFit, R33_PointsInAPlaneAreNotMirrored) {
  RandomScene scene(34);
  for (int run = 0; run < 1000; ++run) {
    std::vector<Eigen::Vector3d> data(10);
    for (Eigen::Vector3d& p : data) {
      p = scene.point(10.0);
      p.z() = 0.0;
    }
    const SE3 T_model_data = scene.pose();
    const auto fit = fit_rigid(pairs_of(data, T_model_data));
    ASSERT_TRUE(fit);
    ASSERT_NEAR(fit->linear().determinant(), 1.0, 1e-12);
    ASSERT_LT(distance(*fit, T_model_data), 1e-9);
  }
}

// The model is the mirror image of the data, so that the best orthogonal matrix is a reflection.
// The best rotation is another matrix; it must fit at least as well as every rotation near it.
TEST(RigidFit, R33_MirroredPointsStillGiveARotation) {
  RandomScene scene(35);
  std::vector<PointPair> pairs(20);
  for (PointPair& pair : pairs) {
    pair.p_data = scene.point(1.0);
    pair.p_model = Eigen::Vector3d(pair.p_data.x(), -pair.p_data.y(), pair.p_data.z());
  }
  const auto error = [&](const SE3& T) {
    double sum = 0.0;
    for (const PointPair& pair : pairs) {
      sum += (pair.p_model - T * pair.p_data).squaredNorm();
    }
    return sum;
  };
  const auto fit = fit_rigid(pairs);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->linear().determinant(), 1.0, 1e-12);
  for (int run = 0; run < 1000; ++run) {
    SE3 nearby = *fit;
    nearby.linear() = nearby.linear() * Eigen::AngleAxisd(0.01, scene.point(1.0).normalized());
    nearby.translation() += scene.point(0.01);
    EXPECT_GE(error(nearby), error(*fit));
  }
}

TEST(RigidFit, R33_DegenerateInputGivesNoFit) {
  RandomScene scene(36);
  const SE3 T = scene.pose();
  EXPECT_FALSE(fit_rigid({}));
  EXPECT_FALSE(fit_rigid(pairs_of({{0, 0, 0}, {1, 0, 0}}, T)));

  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 10; ++i) {
    line.emplace_back(Eigen::Vector3d(1, 2, 3) + i * Eigen::Vector3d(0.1, 0.2, -0.1));
  }
  EXPECT_FALSE(fit_rigid(pairs_of(line, T)));

  const std::vector<Eigen::Vector3d> one_place(10, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(fit_rigid(pairs_of(one_place, SE3::Identity())));

  auto pairs = pairs_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, T);
  pairs[1].p_model.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fit_rigid(pairs));
}

}  // namespace rigid_fit_test
}  // namespace nodmap::registration
