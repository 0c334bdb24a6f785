// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/new_file.hpp"

#include <unistd.h>

#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace nodmap::convert {

NewFile::NewFile(std::filesystem::path path) : path_(std::move(path)), partial_path_(path_) {
  refuse_to_overwrite();
  partial_path_ += ".";
  partial_path_ += std::to_string(::getpid());
  partial_path_ += ".part";
}

NewFile::~NewFile() {
  std::error_code ignored;  // after commit() there is no file to remove
  std::filesystem::remove(partial_path_, ignored);
}

void NewFile::commit() {
  refuse_to_overwrite();
  std::filesystem::rename(partial_path_, path_);
}

void NewFile::refuse_to_overwrite() const {
  if (std::filesystem::exists(std::filesystem::symlink_status(path_))) {
    throw std::runtime_error(path_.string() + ": exists and is never overwritten");
  }
}

}  // namespace nodmap::convert
