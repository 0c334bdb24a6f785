// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/ply.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <string>

#include "common/formats/cloud_file.hpp"
#include "common/formats/input_file.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::formats {
namespace ply_test {

TEST(Ply, ReadsAsciiWithOtherPropertiesInBetween) {
  const test::TemporaryDir dir;
  std::ofstream(dir.path() / "a.ply")
      << "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 1\nproperty float x\n"
         "property float intensity\nproperty double y\nproperty float z\nelement face 0\n"
         "property list uchar int vertex_indices\nend_header\n1 99 2 3\n";
  const auto points = read_ply(dir.path() / "a.ply");
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0], Eigen::Vector3f(1, 2, 3));
}

TEST(Ply, EmptyCutOffAndForeignFiles) {
  const test::TemporaryDir dir;
  write_cloud(dir.path() / "empty.ply", CloudFormat::kPly, {});
  EXPECT_TRUE(read_ply(dir.path() / "empty.ply").empty());
  std::ofstream(dir.path() / "cut.ply")
      << "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
         "property float z\nend_header\n1\n";
  EXPECT_THROW((void)read_ply(dir.path() / "cut.ply"), InputFileError);
  std::ofstream(dir.path() / "endless.ply")
      << "ply\nformat ascii 1.0\nelement vertex 9223372036854775808\nend_header\n1\n";
  EXPECT_THROW((void)read_ply(dir.path() / "endless.ply"), InputFileError);
  std::ofstream(dir.path() / "text.ply") << "hello\n";
  EXPECT_THROW((void)read_ply(dir.path() / "text.ply"), InputFileError);
}

TEST(Ply, RefusesAHeaderWithoutEnd) {
  EXPECT_THROW((void)read_ply("/dev/zero"), InputFileError);
}

TEST(Ply, AVertexThatIsNotFiniteIsRefused) {
  const test::TemporaryDir dir;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& p : {Eigen::Vector3f(kNan, 0, 0), Eigen::Vector3f(0, 0, kInfinity)}) {
    const CloudPoint points[] = {{.p = {1, 2, 3}}, {.p = p}};
    write_cloud(dir.path() / "a.ply", CloudFormat::kPly, points);
    EXPECT_THROW((void)read_ply(dir.path() / "a.ply"), InputFileError);
  }
}

TEST(Ply, WithoutAllThreeCoordinatesOfAVertexItIsRefused) {
  const test::TemporaryDir dir;
  const std::string vertex = "element vertex 1\n";
  const std::string x = "property float x\n";
  const std::string y = "property float y\n";
  const std::string z = "property float z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  for (const std::string& elements :
       {vertex + x + y + face, vertex + "property float X\n" + y + z + face,
        vertex + x + y + "property list uchar float z\n" + face, vertex + x + y + z + z + face,
        "element point 1\n" + x + y + z + face, face}) {
    std::ofstream(dir.path() / "a.ply") << "ply\nformat ascii 1.0\n"
                                        << elements << "end_header\n1 2 3\n3 0 0 0\n";
    EXPECT_THROW((void)read_ply(dir.path() / "a.ply"), InputFileError) << elements;
    EXPECT_THROW((void)read_ply_mesh(dir.path() / "a.ply"), InputFileError) << elements;
  }
}

TEST(Ply, FacesBecomeFansOfTriangles) {
  const test::TemporaryDir dir;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n";
  std::ofstream(dir.path() / "m.ply") << head << square << "4 0 1 2 3\n";
  const TriangleMesh mesh = read_ply_mesh(dir.path() / "m.ply");
  ASSERT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.vertices[3], Eigen::Vector3d(0.0, 1.0, 0.5));
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.triangles[0], Eigen::Vector3i(0, 1, 2));
  EXPECT_EQ(mesh.triangles[1], Eigen::Vector3i(0, 2, 3));
  EXPECT_EQ(read_ply(dir.path() / "m.ply").size(), 4U);  // the same vertices without the faces
  for (const std::string face : {"3 0 1 4", "2 0 1", "3 0 1 -1", "3 0 1", "2000 1", "3 0 1 x"}) {
    std::ofstream(dir.path() / "bad.ply") << head << square << face << '\n';
    EXPECT_THROW((void)read_ply_mesh(dir.path() / "bad.ply"), InputFileError) << face;
  }
}

}  // namespace ply_test
}  // namespace nodmap::formats
