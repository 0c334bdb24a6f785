// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/log_folder.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "common/node/log.hpp"

namespace nodmap::logger {
namespace {

constexpr auto kGreatest = std::numeric_limits<std::int64_t>::max();

}  // namespace

std::int64_t free_bytes(const std::filesystem::path& dir) {
  std::error_code error;
  std::filesystem::path existing = std::filesystem::absolute(dir, error);
  while (existing.has_relative_path() && !std::filesystem::exists(existing, error)) {
    existing = existing.parent_path();
  }
  const std::filesystem::space_info space = std::filesystem::space(existing, error);
  return error ? kGreatest
               : static_cast<std::int64_t>(std::min<std::uintmax_t>(
                     space.available, static_cast<std::uintmax_t>(kGreatest)));
}

std::filesystem::path LogFolder::next_file(time::Timestamp begin) const {
  std::filesystem::create_directories(settings_.dir);
  std::vector<std::string> existing;
  for (const auto& entry : std::filesystem::directory_iterator(settings_.dir)) {
    existing.push_back(entry.path().filename().string());
  }
  return settings_.dir / settings_.names.next(begin, existing);
}

void LogFolder::delete_oldest(const CurrentLog& current) {
  deletable_bytes_ = 0;
  if (settings_.quota_bytes == 0 && settings_.reserve_bytes == 0) {
    return;
  }
  std::vector<Log> logs = logs_oldest_first();
  std::int64_t held_bytes = 0;
  for (const Log& log : logs) {
    held_bytes += log.size_bytes;
  }
  std::erase_if(logs, [&](const Log& log) { return log.name == current.name; });
  const auto newest = std::ranges::find_if(logs.rbegin(), logs.rend(),
                                           [](const Log& log) { return log.size_bytes > 0; });
  const std::int64_t allowed = allowed_bytes(held_bytes);
  bool all_removed = true;
  for (const Log& log : logs) {
    const bool is_kept =
        newest != logs.rend() && log.name == newest->name && current.flushed_bytes == 0;
    if (held_bytes > allowed && !is_kept) {
      const bool is_removed = remove(log);
      held_bytes -= is_removed ? log.size_bytes : 0;
      all_removed &= is_removed;
    } else {
      deletable_bytes_ += log.size_bytes;
    }
  }
  if (!all_removed) {
    // Tried again with the next log, not at each flush as keep_quota() would.
    deletable_bytes_ = 0;
  }
}

void LogFolder::keep_quota(const CurrentLog& current) {
  if (settings_.quota_bytes > 0 && deletable_bytes_ > 0 &&
      deletable_bytes_ + current.flushed_bytes > settings_.quota_bytes) {
    delete_oldest(current);
  }
}

bool LogFolder::make_room(const CurrentLog& current) {
  if (!has_room()) {
    delete_oldest(current);
  }
  return has_room();
}

bool LogFolder::has_room() const {
  return settings_.reserve_bytes == 0 ||
         settings_.available_bytes(settings_.dir) >= settings_.reserve_bytes;
}

// The regular files with a name of the family.
std::vector<LogFolder::Log> LogFolder::logs_oldest_first() const {
  std::map<LogOrder, Log> logs;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(settings_.dir, error)) {
    const std::string name = entry.path().filename().string();
    const std::optional<LogOrder> order = settings_.names.order_of(name);
    if (order && entry.symlink_status(error).type() == std::filesystem::file_type::regular) {
      const std::uintmax_t size_bytes = entry.file_size(error);
      logs[*order] = {name, error ? 0 : static_cast<std::int64_t>(size_bytes)};
    }
  }
  std::vector<Log> oldest_first;
  oldest_first.reserve(logs.size());
  for (const auto& [order, log] : logs) {
    oldest_first.push_back(log);
  }
  return oldest_first;
}

// What the logs may take: the quota, or less if some of the reserve is used.
std::int64_t LogFolder::allowed_bytes(std::int64_t held_bytes) const {
  const std::int64_t quota_bytes = settings_.quota_bytes > 0 ? settings_.quota_bytes : kGreatest;
  if (has_room()) {
    return quota_bytes;
  }
  const std::int64_t missing_bytes =
      settings_.reserve_bytes - settings_.available_bytes(settings_.dir);
  return std::min(quota_bytes, std::max<std::int64_t>(0, held_bytes - missing_bytes));
}

bool LogFolder::remove(const Log& log) {
  std::error_code error;
  std::filesystem::remove(settings_.dir / log.name, error);
  if (error) {
    log::get().warn("cannot delete {} to make room: {}", log.name, error.message());
    return false;
  }
  ++num_deleted_;
  log::get().info("deleted {} to make room", log.name);
  return true;
}

}  // namespace nodmap::logger
