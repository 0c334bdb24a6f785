// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace nodmap::formats {

/// Reads a text file line by line.
class TextLines {
 public:
  /// Throws as open_input().
  explicit TextLines(const std::filesystem::path& file);

  /// Advances to the next line; false at the end. Throws InputFileError at a line of more than a
  /// megabyte, because a file of another kind may be a single line as large as the memory, and
  /// std::runtime_error if the disk fails; both name the file.
  [[nodiscard]] bool next();
  /// The same, to the next line that is neither blank nor a comment after '#'.
  [[nodiscard]] bool next_content();
  /// The line without its end; valid until next().
  [[nodiscard]] std::string_view line() const { return line_; }
  /// FILE:NUMBER of the line, for messages.
  [[nodiscard]] std::string place() const;

 private:
  std::filesystem::path file_;
  std::ifstream in_;
  std::vector<char> buffer_;
  std::string_view line_;
  std::int64_t number_ = 0;
};

/// A text from a file or from another process, for messages on the terminal and in the log: '?' for
/// what is not printable ASCII.
[[nodiscard]] std::string printable(std::string_view text);

/// The same in quotation marks, and at most 80 characters of it.
[[nodiscard]] std::string quote(std::string_view text);

}  // namespace nodmap::formats
