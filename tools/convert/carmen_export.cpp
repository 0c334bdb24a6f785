// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/carmen_export.hpp"

#include <cmath>
#include <fstream>
#include <optional>

#include "common/bus/codec.hpp"
#include "common/formats/user_error.hpp"
#include "common/geometry/pose_history.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "tools/convert/carmen_writer.hpp"
#include "tools/convert/log_events.hpp"
#include "tools/convert/new_file.hpp"

namespace nodmap::convert {
namespace {

// Scans with a smaller pitch count as level, because CARMEN's world is flat.
constexpr double kLevelRad = geometry::deg_to_rad(0.5);

class CarmenExport {
 public:
  explicit CarmenExport(std::ostream& out) : out_(out) {}

  void handle(const bus::LogEvent& event) {
    if (event.channel == "ODOMETRY" && bus::decode_into(odometry_message_, event.data)) {
      handle(odometry_message_);
    } else if (event.channel == "SCAN" && bus::decode_into(scan_message_, event.data)) {
      handle(scan_message_);
    }
  }

  // Writes the line that is still held back.
  void finish() { write_held(); }

  [[nodiscard]] int num_lines() const { return num_lines_; }
  [[nodiscard]] int num_left_out() const { return num_left_out_; }

 private:
  void handle(const nodmap::odometry_t& message) {
    write_held();
    const auto T_odom_base = node::read_odometry(message);
    if (!T_odom_base) {
      ++num_left_out_;
      return;
    }
    history_.add(time::from_utime(message.utime), *T_odom_base);
    held_ = CarmenOdometry{time::from_utime(message.utime), geometry::to_se2(*T_odom_base),
                           message.forward_mps, message.yaw_rate_rad_s};
  }

  void handle(const nodmap::scan_t& message) {
    scan::Scan scan;
    if (!node::read_scan(message, scan) || std::abs(scan.pitch_mid_rad()) > kLevelRad) {
      ++num_left_out_;
      return;
    }
    CarmenScan line;
    line.stamp = scan.stamp;
    const auto T_odom_base = pose_of(scan.stamp);
    if (!T_odom_base) {
      ++num_left_out_;
      return;
    }
    const geometry::SE2 T_base_laser = geometry::to_se2(
        scan.T_base_mount * Eigen::Translation3d(geometry::pitch_rotation(scan.pitch_mid_rad()) *
                                                 scan.mirror_offset_m));
    line.side =
        std::abs(T_base_laser.yaw) > 0.5 * geometry::kPi ? LaserSide::kRear : LaserSide::kFront;
    line.T_odom_base = *T_odom_base;
    line.T_odom_laser = line.T_odom_base * T_base_laser;
    line.angle_first_rad = scan.angle_first_rad;
    line.angle_step_rad = scan.angle_step_rad;
    line.range_max_m = scan.range_max_m;
    line.ranges_m = std::move(scan.ranges_m);
    line.intensities = message.intensities;
    write(line);
  }

  // The odometry pose at the time of a scan, if there is odometry within 50 ms. An ODOMETRY
  // directly before a scan becomes part of the scan line and gets no line of its own.
  std::optional<geometry::SE2> pose_of(time::Timestamp stamp) {
    if (held_ && held_->stamp == stamp) {
      const geometry::SE2 pose = held_->T_odom_base;
      held_.reset();
      return pose;
    }
    write_held();
    const auto T_odom_base = history_.at(stamp);
    return T_odom_base ? std::optional(geometry::to_se2(*T_odom_base)) : std::nullopt;
  }

  void write_held() {
    if (held_) {
      write(*held_);
      held_.reset();
    }
  }

  template <class Value>
  void write(const Value& value) {
    start_ = start_.value_or(value.stamp);
    out_ << write_carmen_line(value, *start_) << "\n";
    ++num_lines_;
  }

  std::ostream& out_;
  nodmap::odometry_t odometry_message_{};
  nodmap::scan_t scan_message_{};
  geometry::PoseHistory history_;
  std::optional<CarmenOdometry> held_;
  std::optional<time::Timestamp> start_;
  int num_lines_ = 0;
  int num_left_out_ = 0;
};

}  // namespace

void export_carmen(const std::filesystem::path& log, const std::filesystem::path& out) {
  NewFile file(out);
  std::ofstream stream(file.partial_path());
  CarmenExport writer(stream);
  for_each_event(log, [&](const bus::LogEvent& event) {
    writer.handle(event);
    require_written(stream, out);
  });
  writer.finish();
  stream.close();
  require_written(stream, out);
  if (writer.num_lines() == 0) {
    throw formats::UserError(log.string() + ": no ODOMETRY, and no SCAN without pitch");
  }
  file.commit();
  log::get().info("{} lines written, {} messages left out (invalid, pitched, or without odometry)",
                  writer.num_lines(), writer.num_left_out());
}

}  // namespace nodmap::convert
