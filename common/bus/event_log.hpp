// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "common/formats/file_descriptor.hpp"

namespace nodmap::bus {

/// One event of an LCM log. `data` is valid until the next one is read.
struct LogEvent {
  std::int64_t event_number = 0;
  std::int64_t log_utime_us = 0;  ///< when it was logged, microseconds since the epoch
  std::string channel;
  std::span<const std::byte> data;
};

/// Reads the event log format of lcm-logger. After damage it continues with the next valid event
/// and counts the skipped bytes. (LCM's own reader allocates any size that a damaged header claims,
/// and stops at the first damage.)
class LogReader : private boost::noncopyable {
 public:
  /// Throws formats::InputFileError when it cannot be opened.
  explicit LogReader(const std::filesystem::path& path);
  ~LogReader();

  /// The next event, or nothing at the end. The event is valid until the next call.
  [[nodiscard]] const LogEvent* next();

  /// Throws formats::InputFileError if the file contains no event at all: then it is not a log.
  void require_event() const;

  /// Number of bytes that belong to no complete event: damage, or a truncated end.
  [[nodiscard]] std::int64_t skipped_bytes() const { return skipped_bytes_; }
  /// The same as a message for the user; empty if no bytes were skipped.
  [[nodiscard]] std::string damage() const;
  [[nodiscard]] std::int64_t size_bytes() const { return size_bytes_; }
  [[nodiscard]] std::int64_t position_bytes() const { return static_cast<std::int64_t>(at_); }

 private:
  struct Mapping;

  [[nodiscard]] bool read_event_here();

  std::filesystem::path path_;
  std::unique_ptr<Mapping> mapping_;
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::int64_t size_bytes_ = 0;
  std::int64_t skipped_bytes_ = 0;
  LogEvent event_;
};

/// Writes the event log format that lcm-logplayer plays.
class LogWriter : private boost::noncopyable {
 public:
  /// Creates the file. Throws std::system_error when it exists or cannot be made.
  explicit LogWriter(const std::filesystem::path& path);
  ~LogWriter();

  /// Appends one event. False after an error, such as a full disk; the file then ends with the last
  /// event that was written completely.
  [[nodiscard]] bool write(std::int64_t log_utime_us, const std::string& channel,
                           std::span<const std::byte> data);

  /// Flushes everything to the operating system. False as for write().
  [[nodiscard]] bool flush();

  /// Waits until everything that flush() has written is on the disk, so that it survives a power
  /// cut; the first time also the file's name. Does not flush. False as for write().
  [[nodiscard]] bool sync();
  /// How often the system has put the file, or its name, on the disk.
  [[nodiscard]] std::int64_t num_syncs() const { return num_syncs_; }

  /// Number of bytes that an event takes in a file.
  [[nodiscard]] static std::int64_t event_bytes(const std::string& channel,
                                                std::span<const std::byte> data);

  /// Why the last write(), flush() or sync() failed.
  [[nodiscard]] const std::error_code& failure() const { return failure_; }

  /// Number of bytes of all complete events, flushed or not; after a failure the number of bytes
  /// that reached the file, including an incomplete event at the end.
  [[nodiscard]] std::int64_t size_bytes() const { return size_bytes_; }
  [[nodiscard]] std::int64_t num_events() const { return num_events_; }

 private:
  [[nodiscard]] bool drain();
  void fail(const std::error_code& error);

  std::filesystem::path unsynced_name_;  // empty once it is on the disk
  formats::FileDescriptor fd_;
  std::error_code failure_;
  std::vector<std::byte> pending_;
  std::int64_t size_bytes_ = 0;
  std::int64_t flushed_bytes_ = 0;
  std::int64_t num_events_ = 0;
  std::int64_t num_syncs_ = 0;
};

}  // namespace nodmap::bus
