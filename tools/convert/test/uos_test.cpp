// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/uos.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/geometry/angle.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::convert {
namespace uos_test {

using geometry::deg_to_rad;

// A point of a beam, in our frame.
Eigen::Vector3d beam_end(double angle_rad, double pitch_rad, double range_m) {
  return range_m * Eigen::Vector3d(std::cos(angle_rad) * std::cos(pitch_rad), std::sin(angle_rad),
                                   std::cos(angle_rad) * std::sin(pitch_rad));
}

// Slices of random ranges, 180 degrees by halves from right to left.
struct Made {
  std::vector<UosSlice> slices;
  std::vector<Eigen::Vector3d> points_m;
};

Made make(int num_slices, int num_beams, double step_deg) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> metres(0.2F, 20.0F);
  Made made;
  for (int k = 0; k < num_slices; ++k) {
    UosSlice slice;
    slice.pitch_rad = deg_to_rad(-48.7 + 0.517 * k);
    slice.angle_first_rad = deg_to_rad(step_deg > 0.0 ? -90.0 : 90.0);
    slice.angle_step_rad = deg_to_rad(step_deg);
    for (int i = 0; i < num_beams; ++i) {
      slice.ranges_m.push_back(metres(random));
      made.points_m.push_back(beam_end(slice.angle_first_rad + i * slice.angle_step_rad,
                                       slice.pitch_rad,
                                       static_cast<double>(slice.ranges_m.back())));
    }
    made.slices.push_back(slice);
  }
  return made;
}

void expect_same(const std::vector<UosSlice>& found, const std::vector<UosSlice>& made) {
  ASSERT_EQ(found.size(), made.size());
  for (std::size_t k = 0; k < made.size(); ++k) {
    EXPECT_NEAR(found[k].pitch_rad, made[k].pitch_rad, 1e-12) << k;
    EXPECT_NEAR(found[k].angle_first_rad, made[k].angle_first_rad, 1e-12) << k;
    EXPECT_NEAR(found[k].angle_step_rad, made[k].angle_step_rad, 1e-12) << k;
    ASSERT_EQ(found[k].ranges_m.size(), made[k].ranges_m.size()) << k;
    for (std::size_t i = 0; i < made[k].ranges_m.size(); ++i) {
      if (std::isnan(made[k].ranges_m[i])) {
        EXPECT_TRUE(std::isnan(found[k].ranges_m[i])) << k << " " << i;
      } else {
        EXPECT_FLOAT_EQ(found[k].ranges_m[i], made[k].ranges_m[i]) << k << " " << i;
      }
    }
  }
}

TEST(Uos, ConvertsFramesAsComputedByHand) {
  // One metre to the right, two up, three ahead.
  EXPECT_TRUE(from_uos({100.0, 200.0, 300.0}).isApprox(Eigen::Vector3d(3.0, -1.0, 2.0)));
  const geometry::SE3 moved = from_uos_pose({100.0, 200.0, 300.0}, {0.0, 0.0, 0.0});
  EXPECT_TRUE(moved.translation().isApprox(Eigen::Vector3d(3.0, -1.0, 2.0)));
  EXPECT_TRUE(moved.linear().isIdentity());
  // 3DTK rotates about the file's y axis, which points up, from z (ahead) towards x (right).
  const geometry::SE3 turned = from_uos_pose({0.0, 0.0, 0.0}, {0.0, 90.0, 0.0});
  EXPECT_TRUE((turned * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));
}

TEST(Uos, PoseIsThatOf3dtksMatrix) {
  // 3DTK's EulerToMatrix4, written out, in its own frame.
  const Eigen::Vector3d euler_deg(10.0, -20.0, 30.0);
  const Eigen::Vector3d e = euler_deg * deg_to_rad(1.0);
  const double sx = std::sin(e[0]), cx = std::cos(e[0]), sy = std::sin(e[1]), cy = std::cos(e[1]),
               sz = std::sin(e[2]), cz = std::cos(e[2]);
  Eigen::Matrix3d R_uos;
  R_uos << cy * cz, -cy * sz, sy, cz * sx * sy + cx * sz, cx * cz - sx * sy * sz, -cy * sx,
      sx * sz - cx * cz * sy, cz * sx + cx * sy * sz, cx * cy;
  const geometry::SE3 pose = from_uos_pose({10.0, 20.0, 30.0}, euler_deg);
  const Eigen::Vector3d p_cm(100.0, -50.0, 25.0);
  const Eigen::Vector3d expected = from_uos(R_uos * p_cm + Eigen::Vector3d(10.0, 20.0, 30.0));
  EXPECT_TRUE((pose * from_uos(p_cm)).isApprox(expected, 1e-12));
}

TEST(Uos, FindsSlicesOfAnyLengthAndDirection) {
  for (const auto& [num_beams, step_deg] :
       {std::pair{360, 0.5}, {361, 0.5}, {181, 1.0}, {721, 0.25}, {361, -0.5}}) {
    SCOPED_TRACE(testing::Message() << num_beams << " beams, step " << step_deg);
    const Made made = make(12, num_beams, step_deg);
    expect_same(find_slices(made.points_m), made.slices);
  }
}

TEST(Uos, BeamsThatAreLeftOutAreNoMeasurement) {
  Made made = make(12, 361, 0.5);
  std::mt19937 random(4);
  std::bernoulli_distribution leave_out(0.3);
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t k = 0; k < made.slices.size(); ++k) {
    for (std::size_t i = 0; i < 361; ++i) {
      // Slice 5 ends early and slice 6 begins late: the beam angle continues, and only the plane
      // changes.
      const bool cut = (k == 5 && i > 100) || (k == 6 && i < 250);
      const bool outermost = k == 0 && (i == 0 || i == 360);
      if (!outermost && (cut || leave_out(random))) {
        made.slices[k].ranges_m[i] = std::nanf("");
      } else {
        kept.push_back(made.points_m[361 * k + i]);
      }
    }
  }
  expect_same(find_slices(kept), made.slices);
}

TEST(Uos, FarReadingsAreNoReturn) {
  Made made = make(3, 361, 0.5);
  made.points_m[5] *= 32.765 / made.points_m[5].norm();
  const auto slices = find_slices(made.points_m);
  ASSERT_EQ(slices.size(), 3U);
  EXPECT_TRUE(std::isinf(slices[0].ranges_m[5]));
  EXPECT_EQ(slices[0].range_max_m, 32.76);
}

// A SICK in indoor mode cannot have measured 40 m.
TEST(Uos, FarPointsOfAnotherScannerAreEchoes) {
  Made made = make(3, 361, 0.5);
  for (const auto& [point, range_m] : {std::pair{5U, 32.765}, {6U, 40.0}, {400U, 35.0}}) {
    made.points_m[point] *= range_m / made.points_m[point].norm();
  }
  const auto slices = find_slices(made.points_m);
  ASSERT_EQ(slices.size(), 3U);
  EXPECT_FLOAT_EQ(slices[0].ranges_m[5], 32.765F);
  EXPECT_FLOAT_EQ(slices[0].ranges_m[6], 40.0F);
  EXPECT_FLOAT_EQ(slices[1].ranges_m[39], 35.0F);
  for (const UosSlice& slice : slices) {
    EXPECT_GT(slice.range_max_m, 40.0);
    EXPECT_LT(slice.range_max_m, 40.001);
  }
}

TEST(Uos, AnAbsurdPointDoesNotSpoilItsScan) {
  Made made = make(3, 361, 0.5);
  made.points_m[5] *= 5000.0 / made.points_m[5].norm();
  const auto slices = find_slices(made.points_m);
  ASSERT_EQ(slices.size(), 3U);
  EXPECT_TRUE(std::isinf(slices[0].ranges_m[5]));
  EXPECT_EQ(slices[0].range_max_m, scan::kFarthestRangeM);
}

TEST(Uos, DegenerateInputHasNoSlices) {
  EXPECT_TRUE(find_slices({}).empty());
  const std::vector<Eigen::Vector3d> one = {{1.0, 0.0, 0.0}};
  EXPECT_TRUE(find_slices(one).empty());
  const std::vector<Eigen::Vector3d> nothing(10, Eigen::Vector3d::Zero());
  EXPECT_TRUE(find_slices(nothing).empty());
  const std::vector<Eigen::Vector3d> same(10, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_TRUE(find_slices(same).empty());
  const std::vector<Eigen::Vector3d> nan(10, Eigen::Vector3d::Constant(std::nan("")));
  EXPECT_TRUE(find_slices(nan).empty());
}

}  // namespace uos_test
}  // namespace nodmap::convert
