// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/bus/event_log.hpp"
#include "common/formats/file_descriptor.hpp"
#include "common/geometry/clock.hpp"
#include "common/geometry/time.hpp"
#include "common/node/node.hpp"
#include "modules/logger/log_folder.hpp"

namespace nodmap::logger {

struct RecorderSettings {
  LogFolderSettings folder;
  std::int64_t split_bytes = 0;  ///< size at which the next file begins; 0: never
};

struct RecorderCounts {
  std::int64_t written = 0;  ///< events written to a file, or buffered until the next flush
  std::int64_t dropped = 0;  ///< events for which the disk had no room, or whose file was deleted
  std::int64_t files = 0;
  std::int64_t syncs = 0;  ///< waits until the disk had everything
};

/// Writes events into a sequence of log files. If the disk is full, the complete events written so
/// far stay readable, further events are counted as dropped, and the recorder tries to start a new
/// file after 1 s, doubling up to 30 s. The same if somebody deletes or moves the file, which is
/// noticed within a second.
class Recorder : private boost::noncopyable {
 public:
  static constexpr time::Duration kFlushPeriod = 40ms;
  static constexpr time::Duration kSyncPeriod = 1s;
  static constexpr time::Duration kFirstBackOff = 1s;
  static constexpr time::Duration kMaxBackOff = 30s;

  /// Creates the first file. Throws std::runtime_error if that fails, for example because the
  /// folder's name is mistyped; otherwise users would believe that they are recording. If the
  /// disk is full except for its reserve, it is FAILED from the start.
  Recorder(RecorderSettings settings, const time::Clock& clock);
  ~Recorder() = default;

  void record(time::Timestamp received, const std::string& channel,
              std::span<const std::byte> data);

  /// Flushes to the operating system and once a second to the disk, and retries after a failure. To
  /// be called every few tens of milliseconds.
  void tick();

  /// Flushes the last event and closes the file.
  void close();

  [[nodiscard]] node::Health health() const;
  [[nodiscard]] const RecorderCounts& counts() const { return counts_; }
  /// Files deleted for quota and reserve.
  [[nodiscard]] std::int64_t num_deleted_files() const { return folder_.num_deleted(); }
  [[nodiscard]] const std::filesystem::path& current_file() const { return file_; }

 private:
  void begin_file();
  bool flush();
  bool sync();
  void begin_next_file();
  void fail(const std::string& cause);
  enum class Fate : std::uint8_t { kInPlace, kMoved, kDeleted };
  [[nodiscard]] Fate fate() const;
  void count_lost(std::int64_t events);
  void end_file();
  void truncate_to_whole_events();
  [[nodiscard]] CurrentLog current_log() const;

  LogFolder folder_;
  std::int64_t split_bytes_;
  const time::Clock& clock_;
  std::filesystem::path file_;
  formats::FileDescriptor identity_;                // of the file, wherever it may be by now
  std::unique_ptr<bus::LogWriter> writer_;          // null after a failure
  std::vector<std::int64_t> unflushed_ends_bytes_;  // file offsets at which unflushed events end
  std::int64_t flushed_bytes_ = 0;
  time::Timestamp flushed_{};
  time::Timestamp synced_{};
  time::Timestamp failed_{};
  time::Duration back_off_ = kFirstBackOff;
  std::string failure_;  // reason; empty once events reach a file again
  RecorderCounts counts_;
};

}  // namespace nodmap::logger
