// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/formats/text_lines.hpp"
#include "common/node/progress.hpp"

namespace nodmap::convert {

/// Reads a text file line by line, with a progress bar on the terminal and warnings about skipped
/// lines.
class LineReader {
 public:
  /// Throws as formats::open_input().
  explicit LineReader(const std::filesystem::path& path);

  /// Advances to the next line; false at the end. Throws as formats::TextLines, and
  /// std::runtime_error if the user has asked to stop.
  [[nodiscard]] bool next();
  [[nodiscard]] std::string_view line() const { return lines_.line(); }

  /// Reports on stderr where and why this line is skipped. After the first few, lines are only
  /// counted, so that a wrong file does not flood the terminal.
  void skip_line(std::string_view why);
  [[nodiscard]] std::int64_t num_skipped() const { return num_skipped_; }

 private:
  std::filesystem::path path_;
  formats::TextLines lines_;
  node::Progress progress_;
  std::int64_t position_bytes_ = 0;
  std::int64_t num_skipped_ = 0;
};

}  // namespace nodmap::convert
