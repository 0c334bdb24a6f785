// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/recorder.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
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

Recorder::Recorder(RecorderSettings settings, const time::Clock& clock)
    : folder_(std::move(settings.folder)), split_bytes_(settings.split_bytes), clock_(clock) {
  begin_file();
  // Already now: after its first events the new file would be kept instead of the last recording.
  if (!folder_.make_room(current_log())) {
    fail(kReserveReached);
  }
}

void Recorder::record(time::Timestamp received, const std::string& channel,
                      std::span<const std::byte> data) {
  const std::int64_t event_bytes = bus::LogWriter::event_bytes(channel, data);
  if (writer_ && must_split(writer_->size_bytes(), event_bytes, split_bytes_)) {
    if (flush() && sync()) {
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
  const time::Timestamp now = clock_.now();
  file_ = folder_.next_file(now);
  writer_.reset();
  writer_ = std::make_unique<bus::LogWriter>(file_);
  identity_ = formats::FileDescriptor(::open(file_.c_str(), O_PATH | O_CLOEXEC));
  unflushed_ends_bytes_.clear();
  flushed_bytes_ = 0;
  flushed_ = now;
  ++counts_.files;
  folder_.delete_oldest(current_log());
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
    folder_.keep_quota(current_log());
  }
  return true;
}

// Syncs the file, so that the events written so far survive a power cut, and keeps the disk's
// reserve free. Returns whether recording goes on; if not, the failure has been reported.
bool Recorder::sync() {
  synced_ = clock_.now();
  // The system goes on taking what is written to a file without a name.
  if (const Fate end = fate(); end != Fate::kInPlace) {
    fail(end == Fate::kDeleted ? "the file was deleted" : "the file was moved");
    return false;
  }
  const std::int64_t syncs_before = writer_->num_syncs();
  if (!writer_->sync()) {
    fail(writer_->failure().message());
    return false;
  }
  counts_.syncs += writer_->num_syncs() > syncs_before ? 1 : 0;
  if (!folder_.make_room(current_log())) {
    fail(kReserveReached);
    return false;
  }
  return true;
}

void Recorder::begin_next_file() {
  if (!folder_.make_room(current_log())) {
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
    end_file();
  }
  failed_ = clock_.now();
  failure_ = "cannot record into " + folder_.dir().string() + ": " + cause;
  log::get().error("{}; {} events dropped so far, next attempt in {} s", failure_, counts_.dropped,
                   back_off_ / 1s);
}

// Whether the file still exists, and under its name: somebody may have deleted or moved its folder.
Recorder::Fate Recorder::fate() const {
  struct stat file {};
  struct stat named {};
  if (::fstat(identity_.get(), &file) != 0 || file.st_nlink == 0) {
    return Fate::kDeleted;
  }
  const bool is_named = ::stat(file_.c_str(), &named) == 0 && named.st_dev == file.st_dev &&
                        named.st_ino == file.st_ino;
  return is_named ? Fate::kInPlace : Fate::kMoved;
}

void Recorder::count_lost(std::int64_t events) {
  counts_.written -= events;
  counts_.dropped += events;
}

// Closes the file and counts the events that it does not contain as dropped; all if it was deleted.
void Recorder::end_file() {
  const auto first_lost = std::ranges::upper_bound(unflushed_ends_bytes_, writer_->size_bytes());
  if (first_lost != unflushed_ends_bytes_.begin()) {
    flushed_bytes_ = *std::prev(first_lost);
  }
  const std::int64_t num_events = writer_->num_events();
  writer_.reset();
  const Fate end = fate();
  identity_ = formats::FileDescriptor();  // with which a deleted file would still occupy the disk
  count_lost(end == Fate::kDeleted ? num_events : unflushed_ends_bytes_.end() - first_lost);
  if (end == Fate::kInPlace) {  // otherwise another file may have its name
    truncate_to_whole_events();
  } else if (end == Fate::kDeleted) {
    --counts_.files;
  }
}

// Truncates the file after its last complete event. Removes a file without events, so that a full
// disk does not collect empty files.
void Recorder::truncate_to_whole_events() {
  std::error_code ignored;  // harmless on failure: readers skip an incomplete event
  if (flushed_bytes_ == 0) {
    std::filesystem::remove(file_, ignored);
    --counts_.files;
  } else {
    std::filesystem::resize_file(file_, static_cast<std::uintmax_t>(flushed_bytes_), ignored);
  }
}

CurrentLog Recorder::current_log() const {
  return writer_ ? CurrentLog{file_.filename().string(), flushed_bytes_} : CurrentLog{};
}

}  // namespace nodmap::logger
