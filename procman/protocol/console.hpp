// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

#include "procman/protocol/control_sequences.hpp"

namespace nodmap::procman {

/// The last lines of a command's output, without colours. The pieces in which it arrives may end
/// anywhere.
class Console {
 public:
  static constexpr std::size_t kMaxLines = 200;
  static constexpr std::size_t kMaxLineBytes = 400;  ///< of each line; the rest is left out

  void take(std::string_view text);

  /// The lines, oldest first; the last one may be incomplete.
  [[nodiscard]] const std::deque<std::string>& lines() const { return lines_; }
  /// The newest line that is not empty; empty if there is none.
  [[nodiscard]] std::string last() const;

 private:
  void put(char c);

  ControlSequences sequences_;
  std::deque<std::string> lines_;
  bool has_line_ended_ = true;
  bool has_line_returned_ = false;
};

}  // namespace nodmap::procman
