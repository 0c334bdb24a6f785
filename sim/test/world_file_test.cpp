// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/world_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/formats/input_file.hpp"
#include "common/geometry/angle.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::sim {
namespace world_file_test {

using geometry::deg_to_rad;
using testing::HasSubstr;
namespace fs = std::filesystem;

class WorldFile : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  [[nodiscard]] World load(const std::string& text) const {
    return load_world(write("w.yaml", text));
  }

  // The error message without the folder.
  [[nodiscard]] std::string error_of(const std::string& text) const {
    try {
      static_cast<void>(load(text));
    } catch (const formats::InputFileError& error) {
      const std::string what = error.what();
      const std::string prefix = (folder_ / "w.yaml").string() + ":";
      EXPECT_EQ(what.substr(0, prefix.size()), prefix);
      return what.substr(prefix.size());
    }
    return "no error";
  }

  nodmap::test::TemporaryDir dir_;
  fs::path folder_ = dir_.path();
};

const std::string kTail = "robot: {start: [0, 0, 0]}\n";

TEST_F(WorldFile, ReadsEveryKindOfObject) {
  write("chair.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  const World world = load(R"(name: all
objects:
  - box: {center: [2.0, 0.5, 0.4], size: [0.6, 0.7, 0.8], yaw_deg: 10, reflectivity: 0.3}
  - cylinder: {center: [3.0, -1.0, 0.5], radius: 0.15, height: 1.0}
  - wall: {from: [0, 2], to: [0, 10], z: [0.5, 2.5], thickness: 0.1}
  - ramp: {from: [5, 0, 0], to: [8, 0, 0.5], width: 2.0}
  - mesh: {file: chair.ply, position: [1, 2, 3], yaw_deg: 90}
pits:
  - {min: [6, -1], max: [9, 1], depth: 0.5}
floor_reflectivity: 0.1
actors:
  - {cylinder: {radius: 0.25, height: 1.75}, path: [[0, 5, -2], [4, 5, 2]], loop: true, reacts: true, legs: true, reflectivity: 0.05, vanish_s: 60.0}
robot: {start: [1, 2, 450]}
goal: [12.0, 3.0]
goal_heading: 90
)");
  EXPECT_EQ(world.name, "all");
  ASSERT_EQ(world.objects.size(), 5U);
  const auto& box = std::get<Box>(world.objects[0].shape);
  EXPECT_EQ(box.center, Eigen::Vector3d(2.0, 0.5, 0.4));
  EXPECT_EQ(box.size, Eigen::Vector3d(0.6, 0.7, 0.8));
  EXPECT_NEAR(box.yaw_rad, deg_to_rad(10.0), 1e-15);
  EXPECT_EQ(world.objects[0].reflectivity, 0.3);
  EXPECT_EQ(world.objects[1].reflectivity, kDefaultReflectivity);
  EXPECT_EQ(std::get<Cylinder>(world.objects[1].shape).radius_m, 0.15);
  const auto& wall = std::get<Box>(world.objects[2].shape);
  EXPECT_EQ(wall.center, Eigen::Vector3d(0.0, 6.0, 1.5));
  EXPECT_EQ(wall.size, Eigen::Vector3d(8.0, 0.1, 2.0));
  EXPECT_NEAR(wall.yaw_rad, deg_to_rad(90.0), 1e-15);
  EXPECT_EQ(std::get<Ramp>(world.objects[3].shape).to, Eigen::Vector3d(8.0, 0.0, 0.5));
  const auto& mesh = std::get<Mesh>(world.objects[4].shape);
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.triangles[1], Eigen::Vector3i(0, 2, 3));
  EXPECT_TRUE(mesh.vertices[1].isApprox(Eigen::Vector3d(1.0, 3.0, 3.0)));
  EXPECT_EQ(world.pits.at(0).depth_m, 0.5);
  EXPECT_EQ(world.floor_reflectivity, 0.1);
  ASSERT_EQ(world.actors.size(), 1U);
  EXPECT_TRUE(world.actors[0].loop);
  EXPECT_TRUE(world.actors[0].reacts);
  EXPECT_TRUE(world.actors[0].has_legs);
  EXPECT_EQ(world.actors[0].reflectivity, 0.05);
  EXPECT_EQ(world.actors[0].vanish_s, 60.0);
  EXPECT_NEAR(world.T_world_start.yaw, deg_to_rad(90.0), 1e-12);
  EXPECT_THAT(world.goals, testing::ElementsAre(Eigen::Vector2d(12.0, 3.0)));
  EXPECT_NEAR(*world.goal_heading_rad, deg_to_rad(90.0), 1e-12);
}

TEST_F(WorldFile, ReadsBinaryMeshes) {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\n"
      "property double y\nproperty double z\nproperty uchar red\nelement face 1\n"
      "property list uchar uint vertex_index\nend_header\n";
  const auto put = [&](const auto& value) {
    ply.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (int i = 0; i < 3; ++i) {
    for (const double v : {0.5 * i, 1.0 * i * i, -0.25}) {
      put(v);
    }
    put(std::uint8_t{7});
  }
  put(std::uint8_t{3});
  for (const std::uint32_t i : {0U, 1U, 2U}) {
    put(i);
  }
  write("m.ply", ply);
  const std::string text =
      "name: m\nobjects:\n  - mesh: {file: m.ply, position: [0, 0, 0]}\n" + kTail;
  const auto mesh = std::get<Mesh>(load(text).objects.at(0).shape);
  EXPECT_EQ(mesh.vertices.at(2), Eigen::Vector3d(1.0, 4.0, -0.25));
  EXPECT_EQ(mesh.triangles.at(0), Eigen::Vector3i(0, 1, 2));
  write("m.ply", ply.substr(0, ply.size() - 1));
  EXPECT_THAT(error_of(text), HasSubstr("m.ply: ends too early"));
}

TEST_F(WorldFile, ErrorsNameTheLine) {
  const auto object = [](const std::string& line) {
    return "name: x\nobjects:\n  - " + line + "\n" + kTail;
  };
  const std::string box = "box: {center: [0, 0, 0], size: [1, 1, 1]";
  EXPECT_EQ(error_of("name: x\nobjets: []\n" + kTail), "2: unknown key 'objets' in world");
  EXPECT_EQ(error_of(object(box + ", colour: 3}")), "3: unknown key 'colour' in box");
  EXPECT_EQ(error_of(object("cone: {radius: 1}")),
            "3: unknown object 'cone'; known are box, cylinder, wall, ramp, mesh");
  EXPECT_EQ(error_of(object("box: {center: [0, 0, 0]}")), "3: missing key 'size'");
  EXPECT_EQ(error_of("objects: []\n" + kTail), "1: missing key 'name'");
  EXPECT_EQ(error_of("name: x\n"), "1: missing key 'robot'");
  EXPECT_EQ(error_of(object("box: {center: [0, 0], size: [1, 1, 1]}")),
            "3: 'center': expected 3 numbers");
  EXPECT_EQ(error_of(object("box: {center: [0, 0, a], size: [1, 1, 1]}")),
            "3: 'center': expected a number");
  EXPECT_EQ(error_of(object("box: {center: [0, 0, .nan], size: [1, 1, 1]}")),
            "3: 'center': the number is not finite");
  EXPECT_EQ(error_of("name: x\ngoal: [1e9, 0]\n" + kTail), "2: 'goal': the number is beyond 1e5");
  EXPECT_EQ(error_of(object("box: {center: [0, 0, 0], size: [1, -1, 1]}")),
            "3: 'size': must be greater than 0");
  EXPECT_EQ(error_of(object(box + ", reflectivity: -0.1}")),
            "3: 'reflectivity': must not be negative");
  EXPECT_EQ(error_of("name: x\nfloor_reflectivity: -1\n" + kTail),
            "2: 'floor_reflectivity': must not be negative");
  EXPECT_EQ(error_of(object(box + ", yaw_deg: 1, yaw_deg: 2}")), "3: key 'yaw_deg' is given twice");
  EXPECT_EQ(error_of(object("cylinder: {center: [0, 0, 0], radius: 0, height: 1}")),
            "3: 'radius': must be greater than 0");
  EXPECT_EQ(error_of(object("wall: {from: [0, 0], to: [0, 0], z: [0, 1], thickness: 1}")),
            "3: a wall without length");
  EXPECT_EQ(error_of(object("wall: {from: [0, 0], to: [1, 0], z: [1, 1], thickness: 1}")),
            "3: 'z': the top must be above the bottom");
  EXPECT_EQ(error_of(object("ramp: {from: [0, 0, 0], to: [0, 0, 1], width: 1}")),
            "3: a ramp without length over ground");
  EXPECT_THAT(error_of(object("mesh: {file: no.ply, position: [0, 0, 0]}")),
              HasSubstr("no.ply: cannot open"));
  EXPECT_EQ(error_of("name: x\npits:\n  - {min: [0, 0], max: [1, 0], depth: 1}\n" + kTail),
            "3: a pit whose max is not beyond its min");
  EXPECT_EQ(error_of("name: x\ngoal: 3\n" + kTail), "2: 'goal': expected 2 numbers");
  EXPECT_EQ(error_of("name: x\ngoal: [3, 4]\ngoals: [[1, 2]]\n" + kTail),
            "3: 'goals': there is a 'goal' already");
  EXPECT_EQ(error_of("name: x\ngoal_heading: 90\n" + kTail), "2: 'goal_heading': there is no goal");
  EXPECT_EQ(error_of("name: x\ngoals: [[1, 2], 3]\n" + kTail), "2: 'goals': expected 2 numbers");
  EXPECT_EQ(error_of("name: x\nobjects: 3\n" + kTail), "2: 'objects': expected a list");
  EXPECT_THAT(error_of("name: x\nobjects: [\n"), HasSubstr("3: "));
  EXPECT_EQ(error_of(""), "1: world: expected {key: value, ...}");
  EXPECT_THROW(static_cast<void>(load_world(folder_ / "missing.yaml")), formats::InputFileError);
}

TEST_F(WorldFile, ErrorsInActorsNameTheLine) {
  const auto actor = [](const std::string& rest) {
    return "name: x\nactors:\n  - {cylinder: {radius: 0.2, height: 1}, " + rest + "}\n" + kTail;
  };
  EXPECT_EQ(error_of(actor("path: []")), "3: 'path': expected at least one waypoint [t_s, x, y]");
  EXPECT_EQ(error_of(actor("path: [[0, 1]]")), "3: 'path': expected 3 numbers");
  EXPECT_EQ(error_of(actor("path: [[0, 1, 1], [0, 2, 2]]")), "3: 'path': times must ascend");
  EXPECT_EQ(error_of(actor("path: [[0, 1, 1]], reflectivity: -0.1")),
            "3: 'reflectivity': must not be negative");
  EXPECT_EQ(error_of(actor("path: [[0, 1, 1]], loop: 3")), "3: 'loop': expected true or false");
  EXPECT_EQ(error_of(actor("path: [[0, 1, 1]], appear_s: 2, vanish_s: 1")),
            "3: 'vanish_s': must be after 'appear_s'");
}

TEST(Actor, WalksItsWaypointsAndLoops) {
  Actor actor;
  actor.path = {{1.0, {0.0, 0.0}}, {3.0, {4.0, 2.0}}, {4.0, {4.0, 6.0}}};
  EXPECT_EQ(actor.position(0.0), Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(actor.position(2.0), Eigen::Vector2d(2.0, 1.0));
  EXPECT_EQ(actor.position(3.5), Eigen::Vector2d(4.0, 4.0));
  EXPECT_EQ(actor.position(9.0), Eigen::Vector2d(4.0, 6.0));
  actor.loop = true;
  EXPECT_EQ(actor.position(0.0), Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(actor.position(5.0), Eigen::Vector2d(2.0, 1.0));
  EXPECT_EQ(actor.position(11.0), Eigen::Vector2d(2.0, 1.0));
}

}  // namespace world_file_test
}  // namespace nodmap::sim
