// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/new_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "common/formats/file_descriptor.hpp"
#include "common/formats/user_error.hpp"

namespace nodmap::convert {

NewFile::NewFile(std::filesystem::path path, std::string content)
    : path_(std::move(path)), content_(std::move(content)), partial_path_(path_) {
  refuse_to_overwrite();
  partial_path_ += ".";
  partial_path_ += std::to_string(::getpid());
  partial_path_ += ".part";
  try_to_create();
}

NewFile::~NewFile() {
  std::error_code ignored;  // after commit() there is no file to remove
  std::filesystem::remove(partial_path_, ignored);
}

// Fails at once for a folder that is missing, rather than after the whole input has been read.
void NewFile::try_to_create() const {
  const formats::FileDescriptor file(
      ::open(partial_path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644));
  if (!file.is_open()) {
    throw std::system_error(errno, std::system_category(), path_.string() + ": cannot write");
  }
  std::filesystem::remove(partial_path_);
}

void NewFile::commit() {
  refuse_to_overwrite();
  std::filesystem::rename(partial_path_, path_);
}

void NewFile::refuse_to_overwrite() const {
  if (std::filesystem::exists(std::filesystem::symlink_status(path_))) {
    throw formats::UserError(path_.string() + ": exists and is never overwritten" +
                             (content_.empty() ? "" : "; needed for " + content_));
  }
}

void require_written(const std::ostream& stream, const std::filesystem::path& file) {
  if (!stream) {
    throw std::system_error(errno, std::system_category(), file.string() + ": cannot write");
  }
}

}  // namespace nodmap::convert
