// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/table_export.hpp"

#include <fstream>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <tuple>

#include "common/bus/codec.hpp"
#include "common/formats/tum.hpp"
#include "common/formats/user_error.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "tools/convert/log_events.hpp"
#include "tools/convert/new_file.hpp"
#include "tools/convert/table_rows.hpp"

namespace nodmap::convert {
namespace {

// Writes the rows of one channel, with a header from its first message.
class CsvWriter {
 public:
  explicit CsvWriter(std::ostream& out) : out_(out) {}

  // Adds a row; returns false if there is no row for this type of message.
  [[nodiscard]] bool add(std::span<const std::byte> bytes) {
    return std::apply([&](auto&... message) { return (add_as(message, bytes) || ...); }, messages_);
  }

  [[nodiscard]] std::int64_t num_rows() const { return num_rows_; }

 private:
  template <class Message>
  bool add_as(Message& message, std::span<const std::byte> bytes) {
    if (!bus::decode_into(message, bytes)) {
      return false;
    }
    if (num_rows_++ == 0) {
      out_ << "utime_us" << row_header(message) << '\n';
    }
    out_ << message.utime;
    put_row(out_, message);
    out_ << '\n';
    return true;
  }

  std::ostream& out_;
  std::tuple<nodmap::scan_t, nodmap::odometry_t, nodmap::pose_t, nodmap::truth_t, nodmap::egomap_t,
             nodmap::pitch_state_t, nodmap::pitch_command_t, nodmap::navigation_t>
      messages_;
  std::int64_t num_rows_ = 0;
};

std::optional<formats::StampedPose> read_stamped_pose(std::span<const std::byte> bytes) {
  nodmap::odometry_t odometry{};
  nodmap::pose_t pose{};
  std::optional<geometry::SE3> T_frame_base;
  time::Timestamp stamp{};
  if (bus::decode_into(odometry, bytes)) {
    stamp = node::stamp_of(odometry);
    T_frame_base = node::read_odometry(odometry);
  } else if (bus::decode_into(pose, bytes)) {
    stamp = node::stamp_of(pose);
    T_frame_base = node::read_pose(pose.position_m, pose.orientation);
  }
  if (!T_frame_base) {
    return std::nullopt;
  }
  return formats::StampedPose{stamp, *T_frame_base};
}

void report(std::int64_t num_used, std::int64_t num_left_out, const std::filesystem::path& log,
            const std::string& channel) {
  if (num_used == 0) {
    throw formats::UserError(log.string() + ": channel " + channel + " contains nothing to write");
  }
  log::get().info("{} messages of {}, {} omitted, which were invalid or of another type", num_used,
                  channel, num_left_out);
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
