// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/time.hpp"
#include "modules/logger/rotation.hpp"

namespace nodmap::logger {

/// Free bytes on the disk that contains a folder, or would contain it if it were created; the
/// greatest number if this is unknown.
[[nodiscard]] std::int64_t free_bytes(const std::filesystem::path& dir);

struct LogFolderSettings {
  std::filesystem::path dir;
  LogNames names = LogNames::dated("lcmlog");
  std::int64_t quota_bytes = 0;  ///< for all logs of these names together; 0: no limit
  /// Bytes to keep free on the disk; for this, too, the oldest logs are deleted. 0: none
  std::int64_t reserve_bytes = 0;
  std::function<std::int64_t(const std::filesystem::path&)> available_bytes = &free_bytes;
};

/// The log that is being written.
struct CurrentLog {
  std::string name;                ///< empty: none
  std::int64_t flushed_bytes = 0;  ///< size of its complete events in the file; 0: none yet
};

/// The folder of a family of log files: names the next one, and deletes the oldest so that quota
/// and reserve hold. Other files, links and folders are neither counted nor deleted. Never deleted
/// are the current log and, as long as that has no events, the newest one that has some: the last
/// recording is worth more than an empty file.
class LogFolder {
 public:
  explicit LogFolder(LogFolderSettings settings) : settings_(std::move(settings)) {}

  [[nodiscard]] const std::filesystem::path& dir() const { return settings_.dir; }

  /// The path of a new file begun at `begin`; creates the folder if it is missing. Throws
  /// std::filesystem::filesystem_error if it cannot.
  [[nodiscard]] std::filesystem::path next_file(time::Timestamp begin) const;

  /// Deletes the oldest logs until quota and reserve hold. To be called when a log begins.
  void delete_oldest(const CurrentLog& current);

  /// The same if the current log has grown beyond the quota since delete_oldest().
  void keep_quota(const CurrentLog& current);

  /// Deletes the oldest logs if the reserve is used; returns whether it is free then.
  [[nodiscard]] bool make_room(const CurrentLog& current);

  [[nodiscard]] std::int64_t num_deleted() const { return num_deleted_; }

 private:
  struct Log {
    std::string name;
    std::int64_t size_bytes = 0;
  };

  [[nodiscard]] bool has_room() const;
  [[nodiscard]] std::vector<Log> logs_oldest_first() const;
  [[nodiscard]] std::int64_t allowed_bytes(std::int64_t held_bytes) const;
  [[nodiscard]] bool remove(const Log& log);

  LogFolderSettings settings_;
  std::int64_t deletable_bytes_ = 0;  // of the logs beside the current one; 0: try no more with it
  std::int64_t num_deleted_ = 0;
};

}  // namespace nodmap::logger
