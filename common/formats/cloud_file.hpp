// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/formats/file_replacement.hpp"

namespace nodmap::formats {

/// A point as it is written to a file.
struct CloudPoint {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();  ///< metres
  std::array<std::uint8_t, 3> rgb{};
  double time_s = 0.0;   ///< when it was measured, seconds since the epoch
  float sigma_m = 0.0F;  ///< standard deviation of the pose from which it was seen
};

/// Both are binary and little-endian, with x, y, z, colour, time and sigma for each point.
enum class CloudFormat : std::uint8_t {
  kPly,
  kPcd,  ///< of the Point Cloud Library, version 0.7; colour is one number, 0x00RRGGBB
};

/// Writes a cloud in parts, because a large one would be in memory several times. Their number of
/// points must be known at first. Replaces the file only when all of it is on the disk.
class CloudWriter {
 public:
  CloudWriter(std::filesystem::path file, CloudFormat format, std::size_t num_points);

  void write(std::span<const CloudPoint> points);
  /// Completes the file and replaces the old one. Throws std::system_error naming it.
  void finish();

 private:
  void append(const CloudPoint& point);

  std::filesystem::path file_;
  CloudFormat format_;
  FileReplacement replacement_;
  std::string bytes_;
};

/// The same at once.
void write_cloud(const std::filesystem::path& file, CloudFormat format,
                 std::span<const CloudPoint> points);

}  // namespace nodmap::formats
