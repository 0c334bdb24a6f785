// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/recorder.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/node/log.hpp"

namespace nodmap::logger {
namespace {

constexpr const char* kReserveReached = "the disk is full except for its reserve";

// Whether a period has passed. Also when the clock was set back, however little (unlike
// time::is_due): the disk must have everything after a second.
bool has_passed(time::Duration period, time::Timestamp since, time::Timestamp now) {
  const time::Duration elapsed = now - since;
  return elapsed < 0us || elapsed >= period;
}

}  // namespace

std::int64_t free_bytes(const std::filesystem::path& dir) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(dir, error);
  constexpr auto kGreatest = std::numeric_limits<std::int64_t>::max();
  return error ? kGreatest
               : static_cast<std::int64_t>(std::min<std::uintmax_t>(
                     space.available, static_cast<std::uintmax_t>(kGreatest)));
}

Recorder::Recorder(RecorderSettings settings, const time::Clock& clock)
    : settings_(std::move(settings)), clock_(clock) {
  begin_file();
  // Already now: after its first events the new file would be kept instead of the last recording.
  if (!make_room()) {
    fail(kReserveReached);
  }
}

void Recorder::record(time::Timestamp received, const std::string& channel,
                      std::span<const std::byte> data) {
  const std::int64_t event_bytes = bus::LogWriter::event_bytes(channel, data);
  if (writer_ && must_split(writer_->size_bytes(), event_bytes, settings_.split_bytes)) {
    if (flush()) {
      sync();
      begin_next_file();
    }
  }
  if (!writer_) {
    ++counts_.dropped;
    return;
  }
  ++counts_.written;
  unflushed_ends_bytes_.push_back(writer_->size_bytes() + event_bytes);
  if (!writer_->write(time::to_utime(received), channel, data)) {
    fail(writer_->failure().message());
  }
}

void Recorder::tick() {
  const time::Timestamp now = clock_.now();
  if (writer_ && has_passed(kFlushPeriod, flushed_, now)) {
    if (flush() && has_passed(kSyncPeriod, synced_, now)) {
      sync();
    }
  } else if (!writer_ && has_passed(back_off_, failed_, now)) {
    back_off_ = std::min(2 * back_off_, kMaxBackOff);
    begin_next_file();
  }
}

void Recorder::close() {
  if (writer_ && flush()) {
    sync();
  }
  writer_.reset();
}

node::Health Recorder::health() const {
  if (failure_.empty()) {
    return {};
  }
  return {node::HealthState::kFailed, failure_};
}

void Recorder::begin_file() {
  std::filesystem::create_directories(settings_.dir);
  std::vector<std::string> existing;
  for (const auto& entry : std::filesystem::directory_iterator(settings_.dir)) {
    existing.push_back(entry.path().filename().string());
  }
  const time::Timestamp now = clock_.now();
  file_ = settings_.dir / settings_.names.next(now, existing);
  writer_.reset();
  writer_ = std::make_unique<bus::LogWriter>(file_);
  unflushed_ends_bytes_.clear();
  flushed_bytes_ = 0;
  flushed_ = now;
  ++counts_.files;
  keep_quota();
  log::get().info("recording into {}", file_.string());
}

bool Recorder::flush() {
  if (!writer_) {
    return false;
  }
  flushed_ = clock_.now();
  if (!writer_->flush()) {
    fail(writer_->failure().message());
    return false;
  }
  if (!unflushed_ends_bytes_.empty()) {
    unflushed_ends_bytes_.clear();
    flushed_bytes_ = writer_->size_bytes();
    back_off_ = kFirstBackOff;
    failure_.clear();
    if (settings_.quota_bytes > 0 && deletable_bytes_ > 0 &&
        deletable_bytes_ + flushed_bytes_ > settings_.quota_bytes) {
      keep_quota();
    }
  }
  return true;
}

// Syncs the file, so that the events written so far survive a power cut, and keeps the disk's
// reserve free.
void Recorder::sync() {
  synced_ = clock_.now();
  const std::int64_t syncs_before = writer_->num_syncs();
  if (!writer_->sync()) {
    fail(writer_->failure().message());
    return;
  }
  counts_.syncs += writer_->num_syncs() > syncs_before ? 1 : 0;
  if (!make_room()) {
    fail(kReserveReached);
  }
}

bool Recorder::has_room() const {
  return settings_.reserve_bytes == 0 ||
         settings_.available_bytes(settings_.dir) >= settings_.reserve_bytes;
}

// Deletes old files if the disk's reserve is used; returns whether it is free then.
bool Recorder::make_room() {
  if (!has_room()) {
    keep_quota();
  }
  return has_room();
}

void Recorder::begin_next_file() {
  if (!make_room()) {
    fail(kReserveReached);
    return;
  }
  try {
    begin_file();
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void Recorder::fail(const std::string& cause) {
  if (writer_) {
    truncate_to_whole_events();
  }
  failed_ = clock_.now();
  failure_ = "cannot record into " + settings_.dir.string() + ": " + cause;
  log::get().error("{}; {} events dropped so far, next attempt in {} s", failure_, counts_.dropped,
                   back_off_ / 1s);
}

// Truncates the file after its last complete event, and counts the events that did not reach it as
// dropped. Removes a file without events, so that a full disk does not collect empty files.
void Recorder::truncate_to_whole_events() {
  const auto first_lost = std::ranges::upper_bound(unflushed_ends_bytes_, writer_->size_bytes());
  if (first_lost != unflushed_ends_bytes_.begin()) {
    flushed_bytes_ = *std::prev(first_lost);
  }
  const std::int64_t num_lost = unflushed_ends_bytes_.end() - first_lost;
  counts_.written -= num_lost;
  counts_.dropped += num_lost;
  writer_.reset();
  std::error_code ignored;  // harmless on failure: readers skip an incomplete event
  if (flushed_bytes_ == 0) {
    std::filesystem::remove(file_, ignored);
    --counts_.files;
  } else {
    std::filesystem::resize_file(file_, static_cast<std::uintmax_t>(flushed_bytes_), ignored);
  }
}

// Deletes the oldest files until the logs comply with the quota and the disk's reserve.
void Recorder::keep_quota() {
  deletable_bytes_ = 0;
  if (settings_.quota_bytes == 0 && settings_.reserve_bytes == 0) {
    return;
  }
  const std::vector<SizedFile> files = files_in_folder();
  for (const std::string& name :
       files_over_quota(settings_.names, files, kept_files(files), allowed_bytes())) {
    std::error_code error;
    if (std::filesystem::remove(settings_.dir / name, error)) {
      ++counts_.deleted_files;
      log::get().info("deleted {} to make room", name);
    } else {
      log::get().warn("cannot delete {} to make room: {}", name, error.message());
    }
  }
  const std::string current = writer_ ? file_.filename().string() : "";
  for (const SizedFile& file : files_in_folder()) {
    const bool is_ours = settings_.names.order_of(file.name).has_value() && file.name != current;
    deletable_bytes_ += is_ours ? file.size_bytes : 0;
  }
}

// The files that are never deleted: the one being written and, while that has no events or there
// is none, the newest one with events.
std::vector<std::string> Recorder::kept_files(const std::vector<SizedFile>& files) const {
  const std::string current = writer_ ? file_.filename().string() : "";
  std::optional<LogOrder> newest;
  std::string newest_name;
  for (const SizedFile& file : files) {
    const std::optional<LogOrder> order = settings_.names.order_of(file.name);
    if (order && file.size_bytes > 0 && file.name != current && order > newest) {
      newest = order;
      newest_name = file.name;
    }
  }
  return writer_ && flushed_bytes_ > 0 ? std::vector{current} : std::vector{current, newest_name};
}

// The total size that the logs of this name may have.
std::int64_t Recorder::allowed_bytes() const {
  constexpr auto kGreatest = std::numeric_limits<std::int64_t>::max();
  const std::int64_t quota_bytes = settings_.quota_bytes > 0 ? settings_.quota_bytes : kGreatest;
  if (has_room()) {
    return quota_bytes;
  }
  std::int64_t held_bytes = 0;
  for (const SizedFile& file : files_in_folder()) {
    held_bytes += settings_.names.order_of(file.name) ? file.size_bytes : 0;
  }
  const std::int64_t missing_bytes =
      settings_.reserve_bytes - settings_.available_bytes(settings_.dir);
  return std::min(quota_bytes, std::max<std::int64_t>(0, held_bytes - missing_bytes));
}

// The regular files; links and folders are never ours.
std::vector<SizedFile> Recorder::files_in_folder() const {
  std::vector<SizedFile> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(settings_.dir, error)) {
    if (entry.symlink_status(error).type() == std::filesystem::file_type::regular) {
      const std::uintmax_t size_bytes = entry.file_size(error);
      files.push_back(
          {entry.path().filename().string(), error ? 0 : static_cast<std::int64_t>(size_bytes)});
    }
  }
  return files;
}

}  // namespace nodmap::logger
