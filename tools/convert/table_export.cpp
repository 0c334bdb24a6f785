// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/table_export.hpp"

#include <fstream>
#include <functional>
#include <optional>
#include <ostream>
#include <set>
#include <string>
#include <tuple>

#include "common/bus/codec.hpp"
#include "common/formats/text_lines.hpp"
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

 private:
  template <class Message>
  bool add_as(Message& message, std::span<const std::byte> bytes) {
    if (!bus::decode_into(message, bytes)) {
      return false;
    }
    if (!has_header_) {
      out_ << "utime_us" << row_header(message) << '\n';
      has_header_ = true;
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
  bool has_header_ = false;
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

struct MessageCount {
  std::int64_t written = 0;
  std::int64_t left_out = 0;
};

std::string no_such_channel(const std::string& channel, const std::set<std::string>& channels) {
  std::string text = "contains no message of channel " + channel + ", but of ";
  for (const std::string& other : channels) {
    text += (other == *channels.begin() ? "" : ", ") + formats::printable(other);
  }
  return text;
}

// Calls `write` for each message of a channel; it returns whether it has written the message.
// Throws formats::UserError if none was written.
MessageCount write_channel(const std::filesystem::path& log, const std::string& channel,
                           const std::function<bool(std::span<const std::byte>)>& write) {
  MessageCount count;
  std::set<std::string> channels;
  for_each_event(log, [&](const bus::LogEvent& event) {
    channels.insert(event.channel);
    if (event.channel == channel) {
      ++(write(event.data) ? count.written : count.left_out);
    }
  });
  if (!channels.contains(channel)) {
    throw formats::UserError(log.string() + ": " + no_such_channel(channel, channels));
  }
  if (count.written == 0) {
    throw formats::UserError(log.string() + ": channel " + channel +
                             " contains no valid message of a type that fits into this file");
  }
  return count;
}

void report(const MessageCount& count, const std::string& channel) {
  log::get().info("{} messages of {} written, {} left out (invalid, or of another type)",
                  count.written, channel, count.left_out);
}

}  // namespace

void export_tum(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel) {
  NewFile file(out);
  formats::Trajectory trajectory;
  const MessageCount count = write_channel(log, channel, [&](std::span<const std::byte> bytes) {
    const auto stamped = read_stamped_pose(bytes);
    if (stamped) {
      trajectory.push_back(*stamped);
    }
    return stamped.has_value();
  });
  formats::write_tum(file.partial_path(), trajectory);
  file.commit();
  report(count, channel);
}

void export_csv(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel) {
  NewFile file(out);
  std::ofstream stream(file.partial_path());
  CsvWriter writer(stream);
  const MessageCount count = write_channel(log, channel, [&](std::span<const std::byte> bytes) {
    const bool has_row = writer.add(bytes);
    require_written(stream, out);
    return has_row;
  });
  stream.close();
  require_written(stream, out);
  file.commit();
  report(count, channel);
}

}  // namespace nodmap::convert
