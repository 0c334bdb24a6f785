// SPDX-License-Identifier: BSD-3-Clause
// Measures how well the scans of a uos folder (KURT3D) agree with each other at given poses: the
// distance of each scan's points from the planes of the scan before. Prints a line for each pair,
// distances in centimetres.
//   nodmap-bench-kurt3d-planes DIR POSES
// POSES: a trajectory (.tum) with one pose of the scanner for each scan, in order; "odometry", the
// poses in the .pose files; or "3dtk", 3DTK's result in the .frames files.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "bench/plane_residual.hpp"
#include "common/formats/text_lines.hpp"
#include "common/formats/tum.hpp"
#include "tools/convert/uos.hpp"

namespace nodmap::bench {
namespace {

using geometry::SE3;

// The numbers of each line, which may be followed by other words.
std::vector<std::vector<double>> read_lines(const std::filesystem::path& file) {
  std::vector<std::vector<double>> lines;
  formats::TextLines text(file);
  while (text.next()) {
    std::istringstream words{std::string(text.line())};
    auto& numbers = lines.emplace_back();
    for (double number = 0.0; words >> number;) {
      numbers.push_back(number);
    }
  }
  return lines;
}

std::vector<Eigen::Vector3d> read_scan(const std::filesystem::path& file) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& line : read_lines(file)) {
    if (line.size() >= 3) {
      points.push_back(convert::from_uos({line[0], line[1], line[2]}));
    }
  }
  return voxel_means(points);
}

SE3 read_odometry(const std::filesystem::path& file) {
  std::vector<double> all;
  for (const auto& line : read_lines(file)) {
    all.insert(all.end(), line.begin(), line.end());
  }
  return convert::from_uos_pose({all.at(0), all.at(1), all.at(2)},
                                {all.at(3), all.at(4), all.at(5)});
}

// The last matrix of a .frames file, column by column.
SE3 read_frames(const std::filesystem::path& file) {
  std::vector<double> m;
  for (const auto& line : read_lines(file)) {
    m = line.size() >= 16 ? line : m;
  }
  Eigen::Matrix3d R_uos;
  Eigen::Matrix3d metres_from_uos;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(4 * i);
    R_uos.col(i) << m.at(at), m.at(at + 1), m.at(at + 2);
    metres_from_uos.col(i) = convert::from_uos(Eigen::Vector3d::Unit(i));
  }
  SE3 pose = SE3::Identity();
  pose.linear() = metres_from_uos * R_uos * metres_from_uos.inverse();
  pose.translation() = convert::from_uos({m.at(12), m.at(13), m.at(14)});
  return pose;
}

struct Scan {
  std::vector<Eigen::Vector3d> points;
  SE3 T_map_scan;
};

std::vector<Scan> read_scans(const std::filesystem::path& dir, const std::string& poses) {
  const bool is_trajectory = poses != "odometry" && poses != "3dtk";
  const formats::Trajectory trajectory =
      is_trajectory ? formats::read_tum(poses) : formats::Trajectory{};
  std::vector<Scan> scans;
  for (int number = 0;; ++number) {
    char stem[16];
    std::snprintf(stem, sizeof stem, "scan%03d", number);
    const auto file = [&](const char* ending) { return dir / (std::string(stem) + ending); };
    if (!std::filesystem::exists(file(".3d"))) {
      break;
    }
    const SE3 pose = poses == "odometry" ? read_odometry(file(".pose"))
                     : poses == "3dtk"   ? read_frames(file(".frames.4cc29d4c"))
                                         : trajectory.at(scans.size()).pose;
    scans.push_back({read_scan(file(".3d")), pose});
  }
  return scans;
}

}  // namespace
}  // namespace nodmap::bench

int main(int argc, char** argv) {
  using namespace nodmap::bench;
  if (argc != 3) {
    std::fprintf(stderr, "usage: nodmap-bench-kurt3d-planes DIR POSES\n");
    return 2;
  }
  try {
    const std::vector<Scan> scans = read_scans(argv[1], argv[2]);
    for (std::size_t k = 1; k < scans.size(); ++k) {
      const PlaneResidual found =
          plane_residual(scans[k - 1].points, scans[k].points,
                         scans[k - 1].T_map_scan.inverse() * scans[k].T_map_scan);
      std::printf("scan %zu on %zu: planes hit %.3f, residual median %.2f cm, p90 %.2f cm\n", k,
                  k - 1, found.share, 100.0 * found.median_m, 100.0 * found.p90_m);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nodmap-bench-kurt3d-planes: %s\n", error.what());
    return 1;
  }
  return 0;
}
