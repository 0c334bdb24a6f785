// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "common/formats/file_descriptor.hpp"

namespace nodmap::formats {

/// replace_file() for a file that is written in parts.
class FileReplacement : private boost::noncopyable {
 public:
  explicit FileReplacement(std::filesystem::path file);
  /// Without replace(), the old file stays and the temporary one is removed.
  ~FileReplacement();

  void write(std::string_view bytes);

  /// Completes the file. Returns the first error, if any; the old file then stays.
  [[nodiscard]] std::error_code replace();

 private:
  std::filesystem::path file_;
  FileDescriptor fd_;
  std::error_code error_;
};

}  // namespace nodmap::formats
