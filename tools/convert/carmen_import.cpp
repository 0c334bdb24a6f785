// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/carmen_import.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/formats/text_lines.hpp"
#include "common/formats/user_error.hpp"
#include "common/geometry/se3.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "tools/convert/carmen.hpp"
#include "tools/convert/carmen_mounts.hpp"
#include "tools/convert/line_reader.hpp"
#include "tools/convert/recording.hpp"
#include "tools/convert/sick.hpp"

namespace nodmap::convert {
namespace {

// Assumed height of the scanner, which CARMEN's logs do not contain; typical of its robots.
constexpr double kAssumedHeightM = 0.3;

// Converts the lines of a log; one operator for each kind.
class CarmenImport {
 public:
  CarmenImport(const CarmenMounts& mounts, Recording& recording, LineReader& lines)
      : mounts_(mounts), recording_(recording), lines_(lines) {}

  void operator()(const CarmenOdometry& odometry) {
    forward_mps_ = odometry.forward_mps;
    yaw_rate_rad_s_ = odometry.yaw_rate_rad_s;
    add_odometry(odometry.stamp, odometry.T_odom_base);
  }

  void operator()(const CarmenScan& scan) {
    add_odometry(scan.stamp, scan.T_odom_base);
    nodmap::scan_t message{};
    message.utime = time::to_utime(scan.stamp);
    message.angle_first_rad = scan.angle_first_rad;
    message.angle_step_rad = scan.angle_step_rad;
    message.pitch_is_measured = 1;  // the scanner is fixed
    message.range_min_m = kSickRangeMinM;
    message.range_max_m = scan.range_max_m;
    geometry::SE3 T_base_laser = geometry::to_se3(mounts_.mount(scan.side));
    T_base_laser.translation().z() = kAssumedHeightM;
    node::write_pose(T_base_laser, message.mount_position_m, message.mount_orientation);
    message.num_ranges = static_cast<std::int32_t>(scan.ranges_m.size());
    message.ranges_m = scan.ranges_m;
    message.num_intensities = static_cast<std::int32_t>(scan.intensities.size());
    message.intensities = scan.intensities;
    recording_.add_scan(std::move(message));
  }

  void operator()(const CarmenParameter&) {}  // used by CarmenMounts only
  void operator()(const CarmenUnreadable& line) { lines_.skip_line(line.why); }
  void operator()(const CarmenOther& line) {
    if (!line.name.empty()) {
      ++not_converted_[line.name];
    }
  }

  // Names the most frequent lines of other kinds, for a file that is of another kind itself.
  [[nodiscard]] std::string describe_other_lines() const {
    std::vector<std::pair<int, std::string>> kinds;
    for (const auto& [name, count] : not_converted_) {
      kinds.emplace_back(-count, name);
    }
    std::ranges::sort(kinds);
    kinds.resize(std::min<std::size_t>(kinds.size(), 3));
    std::string text;
    for (const auto& [count, name] : kinds) {
      text += (text.empty() ? "; its lines begin with " : ", ") + formats::quote(name);
    }
    return text;
  }

  // Messages of other kinds, by name.
  [[nodiscard]] const std::map<std::string, int>& not_converted() const { return not_converted_; }

 private:
  void add_odometry(time::Timestamp stamp, const geometry::SE2& T_odom_base) {
    nodmap::odometry_t message = node::write_odometry(stamp, geometry::to_se3(T_odom_base));
    // A scan line contains no speed, so the last known one is used.
    message.forward_mps = forward_mps_;
    message.yaw_rate_rad_s = yaw_rate_rad_s_;
    recording_.add_odometry(message);
  }

  const CarmenMounts& mounts_;
  Recording& recording_;
  LineReader& lines_;
  double forward_mps_ = 0.0;
  double yaw_rate_rad_s_ = 0.0;
  std::map<std::string, int> not_converted_;
};

// What a pipe has delivered once is gone: the second pass would find nothing.
void require_two_passes(const std::filesystem::path& in) {
  std::error_code unknown;  // opening the file will report it
  const std::filesystem::file_type type = std::filesystem::status(in, unknown).type();
  if (type == std::filesystem::file_type::fifo || type == std::filesystem::file_type::character) {
    throw formats::UserError(in.string() + ": not a regular file; a CARMEN log is read twice");
  }
}

// A first pass over the whole log, because only that shows whether the poses in its scan lines are
// consistent.
CarmenMounts find_mounts(const std::filesystem::path& in) {
  CarmenMounts mounts;
  LineReader lines(in);
  while (lines.next()) {
    const CarmenLine line = parse_carmen_line(lines.line());
    if (const auto* scan = std::get_if<CarmenScan>(&line)) {
      mounts.add(*scan);
    } else if (const auto* parameter = std::get_if<CarmenParameter>(&line)) {
      mounts.add(*parameter);
    }
  }
  return mounts;
}

}  // namespace

void import_carmen(const std::filesystem::path& in, const std::filesystem::path& out) {
  require_two_passes(in);
  Recording recording(out);
  const CarmenMounts mounts = find_mounts(in);
  LineReader lines(in);
  CarmenImport import(mounts, recording, lines);
  while (lines.next()) {
    std::visit(import, parse_carmen_line(lines.line()));
  }
  recording.commit(in, "no line of a scanner or of ODOM" + import.describe_other_lines());

  log::get().info("{} scans, {} odometry messages, {} lines skipped", recording.num_scans(),
                  recording.num_odometry(), lines.num_skipped());
  for (const auto& [name, count] : import.not_converted()) {
    log::get().info("{} lines {} left out: they have no counterpart", count, name);
  }
}

}  // namespace nodmap::convert
