// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <ostream>
#include <string>

namespace nodmap::convert {

/// A result file that gets its name only when it is complete: it is written under another name in
/// the same folder, renamed by commit(), and otherwise removed.
class NewFile : private boost::noncopyable {
 public:
  /// Throws formats::UserError if `path` exists, because results are never overwritten, and
  /// std::system_error if it cannot be created. `content` explains in the first of these errors a
  /// file that the user has not named.
  explicit NewFile(std::filesystem::path path, std::string content = "");
  ~NewFile();

  /// The file to write.
  [[nodiscard]] const std::filesystem::path& partial_path() const { return partial_path_; }

  void commit();

 private:
  void refuse_to_overwrite() const;
  void try_to_create() const;

  std::filesystem::path path_;
  std::string content_;
  std::filesystem::path partial_path_;
};

/// Throws std::system_error, naming `file`, if output to `stream` has failed. To be called directly
/// after the output, because the reason is that of the last system call.
void require_written(const std::ostream& stream, const std::filesystem::path& file);

}  // namespace nodmap::convert
