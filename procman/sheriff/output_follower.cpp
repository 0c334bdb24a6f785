// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/output_follower.hpp"

#include <utility>

namespace nodmap::procman {

std::string OutputFollower::take_last(std::string_view text) {
  return std::exchange(is_waiting_, false) ? shown(text) : "";
}

std::string OutputFollower::take(std::string_view text) {
  if (is_waiting_) {
    waiting_ += text;
    return "";
  }
  return shown(text);
}

std::string OutputFollower::stop_waiting() {
  return std::exchange(is_waiting_, false) ? shown(waiting_) : "";
}

std::string OutputFollower::shown(std::string_view text) {
  std::string shown(text);
  if (!has_colours_) {
    std::erase_if(shown, [this](char c) { return sequences_.take(c); });
  }
  return shown;
}

}  // namespace nodmap::procman
