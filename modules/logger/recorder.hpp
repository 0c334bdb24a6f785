// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/bus/event_log.hpp"
#include "common/node/clock.hpp"
#include "common/node/node.hpp"
#include "modules/logger/quota.hpp"
#include "modules/logger/rotation.hpp"

namespace nodmap::logger {

/// What is free on the disk of a folder; the greatest number where that cannot be known.
[[nodiscard]] std::int64_t free_bytes(const std::filesystem::path& dir);

struct RecorderSettings {
  std::filesystem::path dir;
  LogNames names = LogNames::dated("lcmlog");
  std::int64_t split_bytes = 0;  ///< 0: never
  std::int64_t quota_bytes = 0;  ///< 0: none
  /// What is to stay free on the disk; the oldest logs go for it, too.
  std::int64_t reserve_bytes = 0;
  std::function<std::int64_t(const std::filesystem::path&)> available_bytes = &free_bytes;
};

struct RecorderCounts {
  std::int64_t written = 0;  ///< events that reached a file, or will with the next flush
  std::int64_t dropped = 0;  ///< events that found no room on the disk
  std::int64_t files = 0;
  std::int64_t deleted_files = 0;  ///< for the quota
};

/// Writes events into one log after the other, and outlives a full disk: what is written stays,
/// what comes is counted as dropped, and after a while (1 s, doubled up to 30 s) a new file is
/// tried.
class Recorder : private boost::noncopyable {
 public:
  static constexpr std::int64_t kFlushPeriodUs = 40'000;
  static constexpr std::int64_t kSyncPeriodUs = 1'000'000;
  static constexpr std::int64_t kFirstBackOffUs = 1'000'000;
  static constexpr std::int64_t kMaxBackOffUs = 30'000'000;

  /// Begins the first file. Throws std::runtime_error when it cannot, as nobody should believe that
  /// a mistyped folder is being recorded into.
  Recorder(RecorderSettings settings, const time::Clock& clock);
  ~Recorder() = default;

  void record(std::int64_t utime_us, const std::string& channel, std::span<const std::byte> data);

  /// To be called every few 10 ms: hands what is written to the system, once a second to the disk,
  /// and tries again after a failure.
  void tick();

  /// Hands the last event to the system and ends the file.
  void close();

  [[nodiscard]] node::Health health() const;
  [[nodiscard]] const RecorderCounts& counts() const { return counts_; }
  [[nodiscard]] const std::filesystem::path& current_file() const { return file_; }

 private:
  void begin_file();
  bool flush();
  void sync();
  void try_again();
  [[nodiscard]] bool has_room() const;
  void fail(const std::string& cause);
  void keep_what_is_whole();
  void keep_quota();
  [[nodiscard]] std::int64_t allowed_bytes() const;
  [[nodiscard]] std::vector<SizedFile> files_in_folder() const;

  RecorderSettings settings_;
  const time::Clock& clock_;
  std::filesystem::path file_;
  std::unique_ptr<bus::LogWriter> writer_;          // none after a failure
  std::vector<std::int64_t> unflushed_ends_bytes_;  // where events end that may not be in the file
  std::int64_t flushed_bytes_ = 0;
  std::int64_t deletable_bytes_ = 0;  // of the family's other files, when there is a quota
  std::int64_t flushed_utime_us_ = 0;
  std::int64_t synced_utime_us_ = 0;
  std::int64_t failed_utime_us_ = 0;
  std::int64_t back_off_us_ = kFirstBackOffUs;
  std::string failure_;  // until events reach a file again
  RecorderCounts counts_;
};

}  // namespace nodmap::logger
