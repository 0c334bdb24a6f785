// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/console.hpp"

#include <algorithm>

namespace nodmap::procman {

void Console::take(std::string_view text) {
  for (const char c : text) {
    if (!sequences_.take(c)) {
      put(c);
    }
  }
}

void Console::put(char c) {
  if (c == '\r') {
    has_line_returned_ = true;
    return;
  }
  if (has_line_ended_) {
    lines_.emplace_back();
  } else if (has_line_returned_ && c != '\n') {
    lines_.back().clear();  // a progress bar rewrites its line
  }
  has_line_returned_ = false;
  has_line_ended_ = c == '\n';
  if (!has_line_ended_ && lines_.back().size() < kMaxLineBytes) {
    lines_.back() += c;
  }
  if (lines_.size() > kMaxLines) {
    lines_.pop_front();
  }
}

std::string Console::last() const {
  const auto found = std::find_if(lines_.rbegin(), lines_.rend(), [](const std::string& line) {
    return line.find_first_not_of(" \t") != std::string::npos;
  });
  return found == lines_.rend() ? std::string() : *found;
}

}  // namespace nodmap::procman
