// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/table_export.hpp"

#include <charconv>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <ostream>
#include <stdexcept>

#include "common/bus/codec.hpp"
#include "common/formats/tum.hpp"
#include "common/log/log.hpp"
#include "common/msg/messages.hpp"
#include "tools/convert/log_events.hpp"
#include "tools/convert/new_file.hpp"

namespace nodmap::convert {
namespace {

/// As many digits as it takes to read the same number again, after a comma.
template <class Number>
void put(std::ostream& out, Number value) {
  char digits[40];
  const char* end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  out << ',';
  out.write(digits, end - digits);
}

template <class Message>
void put_pose(std::ostream& out, const Message& message) {
  for (const double value : message.position_m) {
    put(out, value);
  }
  for (const double value : message.orientation) {
    put(out, value);
  }
}

/// Rows of one channel, with a header from its first message.
class CsvWriter {
 public:
  explicit CsvWriter(std::ostream& out) : out_(out) {}

  /// False when the message is of no type that makes a row.
  [[nodiscard]] bool add(std::span<const std::byte> bytes) {
    if (bus::decode_into(scan_, bytes)) {
      begin("utime_us,pitch_first_rad,pitch_last_rad,angle_first_rad,angle_step_rad,ranges_m",
            scan_.utime);
      for (const double value : {scan_.pitch_first_rad, scan_.pitch_last_rad, scan_.angle_first_rad,
                                 scan_.angle_step_rad}) {
        put(out_, value);
      }
      for (const float range_m : scan_.ranges_m) {
        put(out_, range_m);
      }
    } else if (bus::decode_into(odometry_, bytes)) {
      begin("utime_us,x_m,y_m,z_m,qw,qx,qy,qz,forward_mps,yaw_rate_rad_s", odometry_.utime);
      put_pose(out_, odometry_);
      put(out_, odometry_.forward_mps);
      put(out_, odometry_.yaw_rate_rad_s);
    } else if (bus::decode_into(pose_, bytes)) {
      begin("utime_us,x_m,y_m,z_m,qw,qx,qy,qz,match_share,match_rms_m,pose_quality", pose_.utime);
      put_pose(out_, pose_);
      put(out_, pose_.match_share);
      put(out_, pose_.match_rms_m);
      put(out_, static_cast<int>(pose_.pose_quality));
    } else {
      return false;
    }
    out_ << '\n';
    return true;
  }

  [[nodiscard]] std::int64_t num_rows() const { return num_rows_; }

 private:
  void begin(const char* header, std::int64_t utime_us) {
    if (num_rows_++ == 0) {
      out_ << header << '\n';
    }
    out_ << utime_us;
  }

  std::ostream& out_;
  nodmap::scan_t scan_{};
  nodmap::odometry_t odometry_{};
  nodmap::pose_t pose_{};
  std::int64_t num_rows_ = 0;
};

std::optional<formats::StampedPose> read_stamped_pose(std::span<const std::byte> bytes) {
  nodmap::odometry_t odometry{};
  nodmap::pose_t pose{};
  std::optional<geometry::SE3> T_frame_base;
  std::int64_t utime_us = 0;
  if (bus::decode_into(odometry, bytes)) {
    utime_us = odometry.utime;
    T_frame_base = msg::read_odometry(odometry);
  } else if (bus::decode_into(pose, bytes)) {
    utime_us = pose.utime;
    T_frame_base = msg::read_pose(pose.position_m, pose.orientation);
  }
  if (!T_frame_base) {
    return std::nullopt;
  }
  return formats::StampedPose{utime_us, *T_frame_base};
}

void report(std::int64_t num_used, std::int64_t num_left_out, const std::filesystem::path& log,
            const std::string& channel) {
  if (num_used == 0) {
    throw std::runtime_error(log.string() + ": channel " + channel + " holds nothing to write");
  }
  log::get().info("{} messages, {} left out as invalid or of another type", num_used, num_left_out);
}

}  // namespace

void export_tum(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel) {
  NewFile file(out);
  formats::Trajectory trajectory;
  std::int64_t num_left_out = 0;
  for_each_event(log, [&](const bus::LogEvent& event) {
    if (event.channel != channel) {
      return;
    }
    if (const auto stamped = read_stamped_pose(event.data)) {
      trajectory.push_back(*stamped);
    } else {
      ++num_left_out;
    }
  });
  report(static_cast<std::int64_t>(trajectory.size()), num_left_out, log, channel);
  formats::write_tum(file.partial_path(), trajectory);
  file.commit();
}

void export_csv(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel) {
  NewFile file(out);
  std::ofstream stream(file.partial_path());
  CsvWriter writer(stream);
  std::int64_t num_left_out = 0;
  for_each_event(log, [&](const bus::LogEvent& event) {
    if (event.channel == channel && !writer.add(event.data)) {
      ++num_left_out;
    }
  });
  report(writer.num_rows(), num_left_out, log, channel);
  stream.close();
  if (!stream) {
    throw std::runtime_error(out.string() + ": cannot write");
  }
  file.commit();
}

}  // namespace nodmap::convert
