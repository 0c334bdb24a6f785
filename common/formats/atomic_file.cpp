// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "common/formats/file_descriptor.hpp"
#include "common/formats/file_replacement.hpp"

namespace nodmap::formats {
namespace {

std::error_code last_error() {
  return {errno, std::generic_category()};
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
  const FileDescriptor folder(::open(file.has_parent_path() ? file.parent_path().c_str() : ".",
                                     O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  const std::error_code error =
      folder.is_open() && ::fsync(folder.get()) == 0 ? std::error_code() : last_error();
  return error == std::errc::invalid_argument ? std::error_code() : error;
}

std::error_code replace_file(const std::filesystem::path& file, std::string_view bytes) {
  FileReplacement replacement(file);
  replacement.write(bytes);
  return replacement.replace();
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  if (const std::error_code error = replace_file(file, bytes)) {
    throw std::system_error(error, file.string() + ": cannot write");
  }
}

}  // namespace nodmap::formats
