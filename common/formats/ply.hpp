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

struct ColouredPoint {
  Eigen::Vector3f p_map = Eigen::Vector3f::Zero();  ///< metres
  std::array<std::uint8_t, 3> rgb{};
};

/// Vertices in the frame and unit of the file; triangles as indices of vertices, in the order of
/// the file.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
};

/// Writes a binary little-endian PLY with x, y, z, red, green, blue. Replaces the
/// file only when all of it is on the disk. Throws std::runtime_error naming it.
void write_ply(const std::filesystem::path& file, const std::vector<ColouredPoint>& points);

/// The same in parts, for a cloud that would be large in memory. Their number of points must be
/// known at first.
class PlyWriter {
 public:
  PlyWriter(std::filesystem::path file, std::size_t num_points);

  void write(std::span<const ColouredPoint> points);
  /// Completes the file and replaces the old one. Throws std::runtime_error naming it.
  void finish();

 private:
  std::filesystem::path file_;
  FileReplacement replacement_;
  std::string bytes_;
};

/// Reads the vertices of a PLY, binary little-endian or ASCII, with any properties beside x, y, z.
/// Throws InputFileError naming the file and what is wrong: also where a vertex is not finite.
[[nodiscard]] std::vector<Eigen::Vector3f> read_ply(const std::filesystem::path& file);

/// Reads the vertices and faces of a PLY, binary little-endian or ASCII. A face of more than three
/// corners becomes a fan of triangles. Throws InputFileError naming the file and what is wrong:
/// also where a vertex is not finite, or where there is no face.
[[nodiscard]] TriangleMesh read_ply_mesh(const std::filesystem::path& file);

}  // namespace nodmap::formats
