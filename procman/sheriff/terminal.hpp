// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <termios.h>

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/formats/file_descriptor.hpp"
#include "procman/sheriff/view.hpp"

namespace nodmap::procman {

enum class Key : std::uint8_t {
  kUp,
  kDown,
  kStart,
  kStop,
  kRestart,
  kStartGroup,
  kStopGroup,
  kRestartGroup,
  kPageUp,
  kPageDown,
  kQuit,
  kFirstScript,  ///< the first of nine
  kLastScript = kFirstScript + 8
};

/// Uses the terminal as a full screen, and restores it at the end.
class Terminal : boost::noncopyable {
 public:
  Terminal();
  ~Terminal();

  /// Whether stdin and stdout are a terminal.
  [[nodiscard]] static bool is_there();

  struct Size {
    std::size_t width = 80;
    std::size_t height = 24;
    bool operator==(const Size&) const = default;
  };
  [[nodiscard]] static Size size();
  /// Shows the lines; writes nothing if they are already shown. Does not wait: frames that come
  /// before the terminal has taken the last one are left out.
  void draw(const std::vector<ViewLine>& lines, Size size);
  /// The next key with a meaning, if one was pressed. Does not wait.
  [[nodiscard]] std::optional<Key> key();

 private:
  void write_waiting();

  formats::FileDescriptor screen_;
  std::string waiting_;  // what the terminal has not taken yet
  termios before_{};
  std::string pressed_;
  std::string drawn_;
  Size drawn_size_;
};

/// Removes the first key from the typed bytes; skips keys without a meaning.
[[nodiscard]] std::optional<Key> take_key(std::string& typed);

}  // namespace nodmap::procman
