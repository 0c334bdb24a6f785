// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/uos_import.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/formats/input_file.hpp"
#include "common/formats/number.hpp"
#include "common/formats/user_error.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "tools/convert/fields.hpp"
#include "tools/convert/line_reader.hpp"
#include "tools/convert/recording.hpp"
#include "tools/convert/sick.hpp"
#include "tools/convert/uos.hpp"

namespace nodmap::convert {
namespace {

constexpr time::Duration kDrivePeriod = 10ms;
constexpr double kDriveSpeedMps = 0.5;
constexpr double kDriveTurnRateRadS = 0.5;
constexpr double kMinDriveS = 2.0;
// Greatest distance between two scans; more is an error, because the drive between them is written
// step by step.
constexpr double kFarthestDriveM = 1000.0;

std::vector<Eigen::Vector3d> read_points(LineReader& lines) {
  std::vector<Eigen::Vector3d> points_m;
  while (lines.next()) {
    Fields fields(lines.line());
    if (fields.at_end() || lines.line().front() == '#') {
      continue;
    }
    const double x = fields.number();
    const double y = fields.number();
    const double z = fields.number();
    if (fields.ok()) {  // a fourth word, the reflectance, is ignored
      points_m.push_back(from_uos({x, y, z}));
    } else {
      lines.skip_line("expected 'x y z'");
    }
  }
  return points_m;
}

geometry::SE3 read_pose(const std::filesystem::path& file) {
  LineReader lines(file);
  std::string all;
  while (lines.next()) {
    all.append(lines.line()).append(" ");
  }
  Fields fields(all);
  double values[6] = {};
  for (double& value : values) {
    value = fields.finite();
  }
  if (!fields.ok()) {
    throw formats::UserError(file.string() + ": expected position (cm) and Euler angles (degrees)");
  }
  return from_uos_pose({values[0], values[1], values[2]}, {values[3], values[4], values[5]});
}

// The numbers NNN of the files scanNNN.3d, in order, with their paths.
std::map<int, std::filesystem::path> find_scans(const std::filesystem::path& dir,
                                                const UosRange& range) {
  std::map<int, std::filesystem::path> scans;
  std::error_code error;
  const std::filesystem::directory_iterator entries(dir, error);
  if (error) {
    throw formats::cannot_open(dir, error.value());
  }
  for (const auto& entry : entries) {
    const std::string stem = entry.path().stem().string();
    int number = -1;
    if (entry.path().extension() == ".3d" && stem.starts_with("scan")) {
      // scan001_old.3d is none
      number = formats::parse_number<int>(std::string_view(stem).substr(4)).value_or(-1);
    }
    if (number >= std::max(0, range.first) && number <= range.last) {
      scans.emplace(number, entry.path());
    }
  }
  return scans;
}

// What is missing in a folder of which nothing could be used.
std::string missing(const UosRange& range) {
  const UosRange all;
  if (range.first == all.first && range.last == all.last) {
    return "no scanNNN.3d with slices";
  }
  return "no scanNNN.3d with slices from number " + std::to_string(range.first) +
         (range.last == all.last ? " on" : " to " + std::to_string(range.last));
}

// Emulates robot and scanner, and advances the time accordingly.
class StopAndGo {
 public:
  explicit StopAndGo(Recording& recording) : recording_(recording) {}

  void drive_to(const geometry::SE3& T_odom_base) {
    if (T_odom_base_) {
      drive(*T_odom_base_, T_odom_base);
    }
    T_odom_base_ = T_odom_base;
  }

  void scan(const UosSlice& slice) {
    recording_.add_odometry(node::write_odometry(stamp_, *T_odom_base_));
    scan::Scan scan;
    scan.stamp = stamp_;
    scan.angle_first_rad = slice.angle_first_rad;
    scan.angle_step_rad = slice.angle_step_rad;
    scan.pitch_first_rad = slice.pitch_rad;
    scan.pitch_last_rad = slice.pitch_rad;
    scan.range_min_m = kSickRangeMinM;
    scan.range_max_m = slice.range_max_m;
    scan.ranges_m = slice.ranges_m;
    recording_.add_scan(node::write_scan(scan));
    stamp_ += kSickFinePeriod;
  }

 private:
  void drive(const geometry::SE3& from, const geometry::SE3& to) {
    const geometry::SE3 T_from_to = from.inverse() * to;
    const double distance_m = T_from_to.translation().norm();
    if (!(distance_m <= kFarthestDriveM)) {
      throw formats::UserError("two scans are " + std::to_string(distance_m) +
                               " m apart: poses must be in centimetres");
    }
    const double duration_s = std::max({kMinDriveS, distance_m / kDriveSpeedMps,
                                        geometry::rotation_angle(T_from_to) / kDriveTurnRateRadS});
    const auto num_steps =
        static_cast<std::int64_t>(std::ceil(duration_s / time::seconds(kDrivePeriod)));
    const double exact_s = time::seconds(num_steps * kDrivePeriod);
    for (std::int64_t step = 0; step <= num_steps; ++step) {
      const double fraction = static_cast<double>(step) / static_cast<double>(num_steps);
      nodmap::odometry_t message =
          node::write_odometry(stamp_, geometry::interpolate(from, to, fraction));
      message.forward_mps = std::copysign(distance_m, T_from_to.translation().x()) / exact_s;
      message.yaw_rate_rad_s = geometry::to_se2(T_from_to).yaw / exact_s;
      recording_.add_odometry(message);
      stamp_ += kDrivePeriod;
    }
  }

  Recording& recording_;
  time::Timestamp stamp_ = kUntimedStart;
  std::optional<geometry::SE3> T_odom_base_;
};

}  // namespace

void import_uos(const std::filesystem::path& dir, const std::filesystem::path& out,
                const UosRange& range) {
  Recording recording(out);
  StopAndGo robot(recording);
  std::int64_t num_skipped = 0;
  int num_used = 0;
  for (const auto& [number, file] : find_scans(dir, range)) {
    LineReader lines(file);
    const std::vector<UosSlice> slices = find_slices(read_points(lines));
    num_skipped += lines.num_skipped();
    if (slices.empty()) {
      log::get().warn("{}: skipped: its points do not form slices", file.string());
      continue;
    }
    robot.drive_to(read_pose(std::filesystem::path(file).replace_extension(".pose")));
    for (const UosSlice& slice : slices) {
      robot.scan(slice);
    }
    ++num_used;
  }
  recording.commit(dir, missing(range));
  log::get().info("{} scans with {} slices in total, {} odometry messages, {} lines skipped",
                  num_used, recording.num_scans(), recording.num_odometry(), num_skipped);
}

}  // namespace nodmap::convert
