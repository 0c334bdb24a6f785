// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"

namespace nodmap::test {

/// Reads the points (m) of a cloud file of the nodding sequences: uint64 count, then float32 x y z
/// of each. Throws std::runtime_error if the size does not match the count.
inline std::vector<Eigen::Vector3f> read_cloud_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::uint64_t count = 0;
  std::array<char, sizeof count> head{};
  in.read(head.data(), head.size());
  std::memcpy(&count, head.data(), sizeof count);
  std::vector<Eigen::Vector3f> points;
  for (std::array<char, 12> bytes{}; in.read(bytes.data(), bytes.size());) {
    std::memcpy(points.emplace_back().data(), bytes.data(), bytes.size());
  }
  if (points.size() != count) {
    throw std::runtime_error(file.string() + ": holds " + std::to_string(points.size()) +
                             " points, not the " + std::to_string(count) + " it announces");
  }
  return points;
}

/// Reads a pose written as a 4x4 matrix, row by row. Throws std::runtime_error if there is none.
inline geometry::SE3 read_matrix_file(const std::filesystem::path& file) {
  std::ifstream in(file);
  geometry::SE3 pose = geometry::SE3::Identity();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      in >> pose.matrix()(row, column);
    }
  }
  if (!in) {
    throw std::runtime_error(file.string() + ": is no 4x4 matrix");
  }
  return pose;
}

}  // namespace nodmap::test
