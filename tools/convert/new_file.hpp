// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <filesystem>

namespace nodmap::convert {

/// A result that appears under its name only when it is whole: written beside it under another
/// name, renamed by commit(), removed when that is never reached.
class NewFile : private boost::noncopyable {
 public:
  /// Throws std::runtime_error when `path` exists: results are never overwritten.
  explicit NewFile(std::filesystem::path path);
  ~NewFile();

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& partial_path() const { return partial_path_; }

  void commit();

 private:
  void refuse_to_overwrite() const;

  std::filesystem::path path_;
  std::filesystem::path partial_path_;
};

}  // namespace nodmap::convert
