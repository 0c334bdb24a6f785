// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace nodmap::formats {

/// Vertices in the frame and unit of the file; triangles as indices of vertices, in the order of
/// the file.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
};

/// Reads the vertices of a PLY, binary little-endian or ASCII, with any properties beside x, y, z.
/// Throws InputFileError naming the file and what is wrong: also where a vertex is not finite.
[[nodiscard]] std::vector<Eigen::Vector3f> read_ply(const std::filesystem::path& file);

/// Reads the vertices and faces of a PLY, binary little-endian or ASCII. A face of more than three
/// corners becomes a fan of triangles. Throws InputFileError naming the file and what is wrong:
/// also where a vertex is not finite, or where there is no face.
[[nodiscard]] TriangleMesh read_ply_mesh(const std::filesystem::path& file);

}  // namespace nodmap::formats
