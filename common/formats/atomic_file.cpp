// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "common/formats/file_descriptor.hpp"

namespace nodmap::formats {
namespace {

std::error_code last_error() {
  return {errno, std::generic_category()};
}

class File {
 public:
  File(const std::filesystem::path& path, int flags) : fd_(::open(path.c_str(), flags, 0644)) {}

  [[nodiscard]] std::error_code write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(fd_.get(), bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) {
        return last_error();
      }
      bytes.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
    }
    return {};
  }

  [[nodiscard]] std::error_code sync() const {
    return ::fsync(fd_.get()) == 0 ? std::error_code() : last_error();
  }

  // Some file systems report a full disk only here.
  [[nodiscard]] std::error_code close() {
    const int fd = fd_.release();
    return fd < 0 || ::close(fd) == 0 ? std::error_code() : last_error();
  }

  [[nodiscard]] bool is_open() const { return fd_.is_open(); }

 private:
  FileDescriptor fd_;
};

std::error_code write_new(const std::filesystem::path& path, std::string_view bytes) {
  File file(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
  if (!file.is_open()) {
    return last_error();
  }
  if (const auto error = file.write(bytes)) {
    return error;
  }
  if (const auto error = file.sync()) {
    return error;
  }
  return file.close();
}

}  // namespace

std::filesystem::path unfinished_name(const std::filesystem::path& file) {
  return file.string() + ".part";
}

std::error_code replace_file_by(const std::filesystem::path& file,
                                const std::filesystem::path& unfinished) {
  std::error_code error;
  std::filesystem::rename(unfinished, file, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    return error;
  }
  return sync_folder_of(file);
}

std::error_code sync_folder_of(const std::filesystem::path& file) {
  const File folder(file.has_parent_path() ? file.parent_path() : ".",
                    O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const std::error_code error = folder.is_open() ? folder.sync() : last_error();
  return error == std::errc::invalid_argument ? std::error_code() : error;
}

std::error_code replace_file(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path unfinished = unfinished_name(file);
  if (const std::error_code error = write_new(unfinished, bytes)) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    return error;
  }
  return replace_file_by(file, unfinished);
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  if (const std::error_code error = replace_file(file, bytes)) {
    throw std::system_error(error, file.string() + ": cannot write");
  }
}

}  // namespace nodmap::formats
