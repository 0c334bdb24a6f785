// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace nodmap::procman {

/// Recognises control sequences for a terminal, such as colours (ESC [ ... letter), in a text that
/// comes character by character.
class ControlSequences {
 public:
  /// Takes the next character; returns whether it is part of a control sequence.
  [[nodiscard]] bool take(char c);

 private:
  enum class Position : std::uint8_t { kOutside, kBegun, kInside };

  Position position_ = Position::kOutside;
};

}  // namespace nodmap::procman
