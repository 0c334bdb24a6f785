// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/control_sequences.hpp"

namespace nodmap::procman {

bool ControlSequences::take(char c) {
  constexpr char kEscape = '\x1B';
  if (c == kEscape) {
    position_ = Position::kBegun;
    return true;
  }
  if (position_ == Position::kOutside) {
    return false;
  }
  const bool is_parameter = (c >= '0' && c <= '?') || (position_ == Position::kBegun && c == '[');
  position_ = is_parameter ? Position::kInside : Position::kOutside;
  return c >= ' ';  // an incomplete sequence does not swallow the line end
}

}  // namespace nodmap::procman
