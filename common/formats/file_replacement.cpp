// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/file_replacement.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "common/formats/atomic_file.hpp"

namespace nodmap::formats {
namespace {

std::error_code failure_now() {
  return {errno, std::generic_category()};
}

std::error_code write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      return failure_now();
    }
    bytes.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
  }
  return {};
}

std::error_code sync(const FileDescriptor& fd) {
  return fd.is_open() && ::fsync(fd.get()) == 0 ? std::error_code() : failure_now();
}

// Some file systems report a full disk only here.
std::error_code close(FileDescriptor& fd) {
  return ::close(fd.release()) == 0 ? std::error_code() : failure_now();
}

}  // namespace

FileReplacement::FileReplacement(std::filesystem::path file)
    : file_(std::move(file)),
      fd_(::open(unfinished_name(file_).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)),
      error_(fd_.is_open() ? std::error_code() : failure_now()) {}

FileReplacement::~FileReplacement() {
  if (fd_.is_open()) {
    std::error_code ignored;
    std::filesystem::remove(unfinished_name(file_), ignored);
  }
}

void FileReplacement::write(std::string_view bytes) {
  if (!error_) {
    error_ = write_all(fd_.get(), bytes);
  }
}

std::error_code FileReplacement::replace() {
  if (!error_) {
    error_ = sync(fd_);
  }
  if (error_) {
    return error_;
  }
  if (const std::error_code error = close(fd_)) {
    std::error_code ignored;
    std::filesystem::remove(unfinished_name(file_), ignored);
    return error;
  }
  return replace_file_by(file_, unfinished_name(file_));
}

}  // namespace nodmap::formats
