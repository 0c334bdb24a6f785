// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"
#include "tools/convert/new_file.hpp"

namespace nodmap::convert {

/// Writes an LCM event log. Events keep the order in which they are added. Each is logged at its
/// utime, or at the latest previous utime if stamps step back, so that lcm-logplayer plays at the
/// speed of the recording.
class Recording {
 public:
  /// Throws std::runtime_error if the file exists or cannot be created.
  explicit Recording(const std::filesystem::path& path);

  /// Numbers the message and adds it. Throws std::runtime_error if it cannot be written.
  void add_scan(nodmap::scan_t message);
  void add_odometry(nodmap::odometry_t message);

  /// Completes the file and gives it its name. If it is empty, throws formats::UserError and leaves
  /// no file; the message says so of `in`, and adds `hint`.
  void commit(const std::filesystem::path& in, const std::string& hint);

  [[nodiscard]] std::int64_t num_scans() const { return num_scans_; }
  [[nodiscard]] std::int64_t num_odometry() const { return num_odometry_; }

 private:
  template <class Message>
  void add(const std::string& channel, const Message& message) {
    bus::encode_into(buffer_, message);
    write(channel, message.utime);
  }
  void write(const std::string& channel, std::int64_t utime_us);

  NewFile file_;
  bus::LogWriter writer_;
  std::vector<std::byte> buffer_;
  std::optional<std::int64_t> log_utime_us_;
  std::int64_t num_scans_ = 0;
  std::int64_t num_odometry_ = 0;
};

}  // namespace nodmap::convert
