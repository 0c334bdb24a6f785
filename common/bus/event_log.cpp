// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/event_log.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/core/noncopyable.hpp>
#include <boost/endian/conversion.hpp>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "common/bus/wire_layout.hpp"
#include "common/formats/atomic_file.hpp"
#include "common/formats/input_file.hpp"

namespace nodmap::bus {
namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;
constexpr std::size_t kHeaderBytes = 28;
// LCM allows 63 characters on the network; logs made by other tools may hold longer names.
constexpr std::uint32_t kMaxChannelBytes = 1000;
// LCM's own limit for a message.
constexpr std::uint32_t kMaxDataBytes = 1U << 28U;
constexpr std::size_t kPendingLimit = 65536;

template <class Number>
void append_big_endian(std::vector<std::byte>& bytes, Number value) {
  boost::endian::native_to_big_inplace(value);
  const auto encoded = std::as_bytes(std::span(&value, 1));
  bytes.insert(bytes.end(), encoded.begin(), encoded.end());
}

std::runtime_error file_error(const std::filesystem::path& path, const char* what) {
  return std::runtime_error(path.string() + ": " + what + ": " +
                            std::system_category().message(errno));
}

}  // namespace

struct LogReader::Mapping : private boost::noncopyable {
  void* address = MAP_FAILED;
  std::size_t size = 0;

  ~Mapping() {
    if (address != MAP_FAILED) {
      ::munmap(address, size);
    }
  }
};

LogReader::LogReader(const std::filesystem::path& path)
    : path_(path), mapping_(std::make_unique<Mapping>()) {
  const formats::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) {
    throw formats::cannot_open(path, errno);
  }
  struct stat info {};
  if (::fstat(file.get(), &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0) {
    mapping_->size = static_cast<std::size_t>(info.st_size);
    mapping_->address = ::mmap(nullptr, mapping_->size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  }
  if (!S_ISREG(info.st_mode)) {
    throw formats::InputFileError(path.string() + ": cannot open: not a regular file");
  }
  if (mapping_->size > 0 && mapping_->address == MAP_FAILED) {
    throw file_error(path, "cannot read");
  }
  bytes_ = {static_cast<const std::byte*>(mapping_->size > 0 ? mapping_->address : nullptr),
            mapping_->size};
  size_bytes_ = static_cast<std::int64_t>(mapping_->size);
}

LogReader::~LogReader() = default;

void LogReader::require_event() const {
  LogReader reader(path_);
  if (reader.next() == nullptr) {
    throw formats::InputFileError(path_.string() + ": not an LCM event log (no event found)");
  }
}

std::string LogReader::damage() const {
  return skipped_bytes_ == 0
             ? std::string()
             : path_.string() + ": " + std::to_string(skipped_bytes_) +
                   " bytes are not part of a complete event: the file is damaged or truncated";
}

const LogEvent* LogReader::next() {
  while (at_ + kHeaderBytes <= bytes_.size()) {
    if (read_event_here()) {
      return &event_;
    }
    ++at_;
    ++skipped_bytes_;
  }
  skipped_bytes_ += static_cast<std::int64_t>(bytes_.size() - at_);
  at_ = bytes_.size();
  return nullptr;
}

bool LogReader::read_event_here() {
  const auto header = bytes_.subspan(at_, kHeaderBytes);
  if (read_big_endian<std::uint32_t>(header) != kSync) {
    return false;
  }
  const auto channel_size = read_big_endian<std::uint32_t>(header, 20);
  const auto data_size = read_big_endian<std::uint32_t>(header, 24);
  if (channel_size == 0 || channel_size > kMaxChannelBytes || data_size > kMaxDataBytes ||
      channel_size + std::uint64_t{data_size} > bytes_.size() - at_ - kHeaderBytes) {
    return false;
  }
  event_.event_number = read_big_endian<std::int64_t>(header, 4);
  event_.log_utime_us = read_big_endian<std::int64_t>(header, 12);
  const auto body = bytes_.subspan(at_ + kHeaderBytes, channel_size + data_size);
  event_.channel.assign(reinterpret_cast<const char*>(body.data()), channel_size);
  event_.data = body.subspan(channel_size);
  at_ += kHeaderBytes + body.size();
  return true;
}

LogWriter::LogWriter(const std::filesystem::path& path)
    : unsynced_name_(path),
      fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
  if (!fd_.is_open()) {
    throw std::system_error(errno, std::system_category(), path.string() + ": cannot create");
  }
  pending_.reserve(2 * kPendingLimit);
}

LogWriter::~LogWriter() {
  // A failure cannot be reported from here. Callers that must know call flush() first.
  [[maybe_unused]] const bool flushed = drain();
}

std::int64_t LogWriter::event_bytes(const std::string& channel, std::span<const std::byte> data) {
  return static_cast<std::int64_t>(kHeaderBytes + channel.size() + data.size());
}

bool LogWriter::write(std::int64_t log_utime_us, const std::string& channel,
                      std::span<const std::byte> data) {
  if (failure_) {
    return false;
  }
  append_big_endian(pending_, kSync);
  append_big_endian(pending_, num_events_);
  append_big_endian(pending_, log_utime_us);
  append_big_endian(pending_, static_cast<std::uint32_t>(channel.size()));
  append_big_endian(pending_, static_cast<std::uint32_t>(data.size()));
  const auto name = std::as_bytes(std::span(channel));
  pending_.insert(pending_.end(), name.begin(), name.end());
  pending_.insert(pending_.end(), data.begin(), data.end());
  ++num_events_;
  size_bytes_ += event_bytes(channel, data);
  return pending_.size() < kPendingLimit || drain();
}

bool LogWriter::flush() {
  return !failure_ && drain();
}

bool LogWriter::sync() {
  if (failure_) {
    return false;
  }
  if (::fdatasync(fd_.get()) == 0) {
    ++num_syncs_;
  } else if (errno != EINVAL) {  // EINVAL: a pipe, which cannot be synced
    fail({errno, std::system_category()});
    return false;
  }
  if (!unsynced_name_.empty()) {
    if (const std::error_code error = formats::sync_folder_of(unsynced_name_)) {
      fail(error);
      return false;
    }
    ++num_syncs_;
    unsynced_name_.clear();
  }
  return true;
}

void LogWriter::fail(const std::error_code& error) {
  failure_ = error;
  size_bytes_ = flushed_bytes_;
}

bool LogWriter::drain() {
  std::size_t done = 0;
  while (!failure_ && done < pending_.size()) {
    const ssize_t written = ::write(fd_.get(), pending_.data() + done, pending_.size() - done);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      failure_.assign(errno, std::system_category());
    }
  }
  flushed_bytes_ += static_cast<std::int64_t>(done);
  if (failure_) {
    // An incomplete event at the end is harmless: every reader of the format skips it.
    size_bytes_ = flushed_bytes_;
  }
  pending_.clear();
  return !failure_;
}

}  // namespace nodmap::bus
