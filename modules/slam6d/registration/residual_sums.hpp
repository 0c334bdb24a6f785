// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>

#include "common/geometry/se3.hpp"
#include "common/registration/motion_solver.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"

namespace nodmap::slam6d {

/// Residuals below this, in metres, are due to the rounding of voxel means.
inline constexpr double kMinResidualM = 2e-3;

/// Weighted sums over correspondences, for the motion of the middle of the sweep (N = 6), or also
/// for its change per unit of time (N = 12): a point measured at `time` moves by m0 + time * m1.
/// Row and column 6 of each sum belong to the residual.
template <int N>
class ResidualSums {
 public:
  /// Adds a correspondence. `kernel`: its robust weight, 0..1; `precision`: inverse variance of the
  /// distance between both points, relative to that of single points.
  void add(const Eigen::Vector3f& normal, const Eigen::Vector3f& arm, float residual_m, float time,
           float kernel, float precision) {
    const Eigen::Vector3f moment = arm.cross(normal);
    const Eigen::Matrix<float, 8, 1> row{normal.x(), normal.y(), normal.z(), moment.x(),
                                         moment.y(), moment.z(), residual_m, 0.0F};
    const Eigen::Vector4f arm_row{arm.x(), arm.y(), arm.z(), 1.0F};
    float weight = kernel * precision;
    for (std::size_t power = 0; power < kPowers; ++power, weight *= time) {
      part_[power].noalias() += (weight * row) * row.transpose();
      arms_part_[power].noalias() += (weight * arm_row) * arm_row.transpose();
    }
    kernel_part_ += kernel;
    // Floats are summed in short parts only.
    if (++in_part_ == 256) {
      flush();
    }
  }

  void flush() {
    for (std::size_t power = 0; power < kPowers; ++power) {
      sums_[power] += part_[power].template cast<double>();
      arms_[power] += arms_part_[power].template cast<double>();
      part_[power].setZero();
      arms_part_[power].setZero();
    }
    kernel_ += static_cast<double>(kernel_part_);
    kernel_part_ = 0.0F;
    in_part_ = 0;
  }

  [[nodiscard]] double mean_square_m2() const {
    return sums_[0](6, 6) / std::max(arms_[0](3, 3), 1e-9);
  }

  /// About the motion, in units of `scale()`.
  [[nodiscard]] registration::Information<N> information() const {
    registration::Information<N> information;
    for (int i = 0; i < N / 6; ++i) {
      information.b.template segment<6>(6 * i) = sums_[at(i)].template block<6, 1>(0, 6);
      for (int j = 0; j < N / 6; ++j) {
        information.H.template block<6, 6>(6 * i, 6 * j) =
            sums_[at(i + j)].template topLeftCorner<6, 6>();
      }
    }
    return information;
  }

  // The information that normals wrong by `normal_error_rad`, in random directions e, would
  // imitate: the mean of J J^T for J = (e, arm x e).
  [[nodiscard]] Eigen::Matrix<double, N, N> imitated_information(double normal_error_rad) const {
    Eigen::Matrix<double, N, N> H;
    for (int i = 0; i < N / 6; ++i) {
      for (int j = 0; j < N / 6; ++j) {
        const Eigen::Matrix4d& arms = arms_[at(i + j)];
        const Eigen::Matrix3d cross = geometry::skew(arms.block<3, 1>(0, 3));
        const Eigen::Matrix3d arm_squares = arms.topLeftCorner<3, 3>();
        auto block = H.template block<6, 6>(6 * i, 6 * j);
        block.template topLeftCorner<3, 3>() = arms(3, 3) * Eigen::Matrix3d::Identity();
        block.template bottomLeftCorner<3, 3>() = cross;
        block.template topRightCorner<3, 3>() = cross.transpose();
        block.template bottomRightCorner<3, 3>() =
            arm_squares.trace() * Eigen::Matrix3d::Identity() - arm_squares;
      }
    }
    return normal_error_rad * normal_error_rad * H;
  }

  // The unit of information(), if `num_correlated` neighbours count as one measurement. The
  // variance is estimated from the residuals.
  [[nodiscard]] double scale(double num_correlated) const {
    const double unit_variance =
        std::max(sums_[0](6, 6), kMinResidualM * kMinResidualM * arms_[0](3, 3)) /
        std::max(kernel_, 1e-9);
    return 1.0 / std::max(unit_variance * num_correlated, 1e-12);
  }

 private:
  static constexpr std::size_t kPowers = N == 6 ? 1 : 3;  // of time
  static std::size_t at(int power) { return static_cast<std::size_t>(power); }

  template <class Matrix>
  static std::array<Matrix, kPowers> zeros() {
    std::array<Matrix, kPowers> all;
    all.fill(Matrix::Zero());
    return all;
  }

  std::array<Eigen::Matrix<double, 8, 8>, kPowers> sums_ = zeros<Eigen::Matrix<double, 8, 8>>();
  std::array<Eigen::Matrix<float, 8, 8>, kPowers> part_ = zeros<Eigen::Matrix<float, 8, 8>>();
  std::array<Eigen::Matrix4d, kPowers> arms_ = zeros<Eigen::Matrix4d>();
  std::array<Eigen::Matrix4f, kPowers> arms_part_ = zeros<Eigen::Matrix4f>();
  double kernel_ = 0.0;
  float kernel_part_ = 0.0F;
  int in_part_ = 0;
};

}  // namespace nodmap::slam6d
