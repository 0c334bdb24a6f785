// SPDX-License-Identifier: BSD-3-Clause
// R5: no exported map is mirrored. The stationary robot is in a world that has the shape of the
// letter F, seen from above: the stem points ahead on the right, and both arms point to the left.
// Every exported map must show an F as well.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "common/formats/ply.hpp"
#include "common/geometry/angle.hpp"
#include "tests/replay/recording.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap {
namespace orientation_test {

struct Wall {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

// The letter in base (x ahead, y left, metres), with the robot at the origin: the stem on its
// right, the long arm at the far end, the short arm nearer.
const std::vector<Wall>& letter_f() {
  static const std::vector<Wall> walls{
      {{1.0, -1.0}, {5.0, -1.0}}, {{5.0, -1.0}, {5.0, 2.0}}, {{3.0, -1.0}, {3.0, 0.2}}};
  return walls;
}

// Range of a ray from the origin in the plane; infinity if it hits no wall.
double cast(const Eigen::Vector2d& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Wall& wall : letter_f()) {
    const Eigen::Vector2d along = wall.to - wall.from;
    const double cross = ray.x() * along.y() - ray.y() * along.x();
    if (std::abs(cross) < 1e-9) {
      continue;
    }
    const double range = (wall.from.x() * along.y() - wall.from.y() * along.x()) / cross;
    const double place = (wall.from.x() * ray.y() - wall.from.y() * ray.x()) / cross;
    if (range > 0.0 && place >= 0.0 && place <= 1.0) {
      nearest = std::min(nearest, range);
    }
  }
  return nearest;
}

// Four sweeps between -15 and 15 degrees.
void record(const std::filesystem::path& file) {
  test::Recording recording(file);
  const auto pitch_deg = [](int n) { return n % 60 < 30 ? -15.0 + n % 60 : 45.0 - n % 60; };
  for (int i = 0; i < 120; ++i) {
    scan::Scan scan;
    scan.stamp = time::Timestamp(1000s + 13'320us * i);
    scan.seq = i;
    scan.angle_first_rad = geometry::deg_to_rad(-90);
    scan.angle_step_rad = geometry::deg_to_rad(0.5);
    scan.pitch_first_rad = scan.pitch_last_rad = geometry::deg_to_rad(pitch_deg(i));
    scan.range_min_m = 0.05;
    scan.range_max_m = 30.0;
    scan.T_base_mount.translation().z() = 2.0;
    for (int beam = 0; beam <= 360; ++beam) {
      const Eigen::Vector3d ray =
          scan::beam_direction(geometry::deg_to_rad(0.5 * beam - 90), scan.pitch_first_rad);
      const double flat = ray.head<2>().norm();
      scan.ranges_m.push_back(static_cast<float>(cast(ray.head<2>() / flat) / flat));
    }
    recording.odometry(scan.stamp, geometry::SE3::Identity());
    recording.scan(scan);
  }
}

class Orientation : public ::testing::Test {
 protected:
  std::filesystem::path replay(const std::string& program) {
    record(dir_.path() / "in.lcmlog");
    const auto out = dir_.path() / "out";
    const auto run =
        test::run_program(program, {"--replay", dir_.path() / "in.lcmlog", "--out", out});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return out;
  }

  // The parts of the letter that the robot sees, and their mirror images, which must stay empty.
  template <class IsOccupied>
  void expect_reads_as_f(const IsOccupied& is_occupied) {
    EXPECT_TRUE(is_occupied(2.0, -1.0)) << "stem";
    EXPECT_TRUE(is_occupied(5.0, 1.0)) << "long arm";
    EXPECT_TRUE(is_occupied(3.0, -0.3)) << "short arm";
    EXPECT_FALSE(is_occupied(2.0, 1.0)) << "mirrored left to right";
    EXPECT_FALSE(is_occupied(-2.0, -1.0)) << "mirrored front to back";
  }

  test::TemporaryDir dir_;
};

TEST_F(Orientation, R5_OccupancyGridReadsAsF) {
  const auto out = replay("nodmap-slam2d");
  std::istringstream yaml(test::slurp(out / "map.yaml"));
  double cell_m = 0.0;
  double origin_x = 0.0;
  double origin_y = 0.0;
  for (std::string line; std::getline(yaml, line);) {
    std::sscanf(line.c_str(), "resolution: %lf", &cell_m);
    std::sscanf(line.c_str(), "origin: [%lf, %lf", &origin_x, &origin_y);
  }
  ASSERT_GT(cell_m, 0.0);
  const std::string pgm = test::slurp(out / "map.pgm");
  int width = 0;
  int height = 0;
  ASSERT_EQ(std::sscanf(pgm.c_str(), "P5 %d %d", &width, &height), 2);
  const std::string pixels =
      pgm.substr(pgm.size() - static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  // ROS: the first row of the image is the farthest to the left of the robot; black is occupied.
  // Tolerance: two cells.
  expect_reads_as_f([&](double x, double y) {
    const int column = static_cast<int>((x - origin_x) / cell_m);
    const int row = height - 1 - static_cast<int>((y - origin_y) / cell_m);
    for (int r = row - 2; r <= row + 2; ++r) {
      for (int c = column - 2; c <= column + 2; ++c) {
        const bool inside = r >= 0 && c >= 0 && r < height && c < width;
        if (inside &&
            static_cast<unsigned char>(pixels[static_cast<std::size_t>(r * width + c)]) < 50) {
          return true;
        }
      }
    }
    return false;
  });
}

TEST_F(Orientation, R5_CloudReadsAsF) {
  const auto points = formats::read_ply(replay("nodmap-slam6d") / "cloud.ply");
  ASSERT_FALSE(points.empty());
  // The map begins at the first pose of base, so map and base coincide here. Tolerance: 10 cm.
  expect_reads_as_f([&](double x, double y) {
    return std::ranges::any_of(points, [&](const Eigen::Vector3f& p) {
      return std::hypot(static_cast<double>(p.x()) - x, static_cast<double>(p.y()) - y) < 0.1;
    });
  });
}

}  // namespace orientation_test
}  // namespace nodmap
