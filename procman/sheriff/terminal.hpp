// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <termios.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nodmap::procman {

enum class Key : std::uint8_t { kUp, kDown, kStart, kStop, kRestart, kQuit };

/// The terminal as a full screen, given back as it was at the end.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  Terminal(Terminal&&) = delete;
  Terminal& operator=(Terminal&&) = delete;

  /// Whether stdin and stdout are one.
  [[nodiscard]] static bool is_there();

  struct Size {
    std::size_t width = 80;
    std::size_t height = 24;
  };
  [[nodiscard]] static Size size();
  static void draw(const std::vector<std::string>& lines);
  /// The next key that means something, if one was pressed. Does not wait.
  [[nodiscard]] std::optional<Key> key();

 private:
  termios before_{};
  std::string pressed_;
};

/// Takes the first key from what was typed; what means nothing is skipped.
[[nodiscard]] std::optional<Key> take_key(std::string& typed);

}  // namespace nodmap::procman
