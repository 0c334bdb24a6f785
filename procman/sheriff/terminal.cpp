// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/terminal.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace nodmap::procman {
namespace {

constexpr int kLastWaitMs = 1000;

std::string style_of(Tone tone) {
  switch (tone) {
    case Tone::kStrong:
      return "\x1B[1m";
    case Tone::kSelected:
      return "\x1B[7m";
    case Tone::kWarning:
      return "\x1B[33m";
    case Tone::kAlarm:
      return "\x1B[31m";
    default:
      return {};
  }
}

struct Binding {
  std::string_view typed;
  Key key;
};
constexpr std::array<Binding, 16> kBindings{{{"\x1B[A", Key::kUp},
                                             {"\x1BOA", Key::kUp},
                                             {"k", Key::kUp},
                                             {"\x1B[B", Key::kDown},
                                             {"\x1BOB", Key::kDown},
                                             {"j", Key::kDown},
                                             {"s", Key::kStart},
                                             {"t", Key::kStop},
                                             {"r", Key::kRestart},
                                             {"S", Key::kStartGroup},
                                             {"T", Key::kStopGroup},
                                             {"R", Key::kRestartGroup},
                                             {"\x1B[5~", Key::kPageUp},
                                             {"\x1B[6~", Key::kPageDown},
                                             {"q", Key::kQuit},
                                             {"\x03", Key::kQuit}}};

// Number of bytes of the first key. A function key sends several bytes, and the letters and digits
// among them are not keys. 0 if the key is incomplete.
std::size_t length_of_first(std::string_view typed) {
  if (typed.front() != '\x1B') {
    return 1;
  }
  if (typed.size() < 2) {
    return 0;
  }
  if (typed[1] == 'O') {
    return typed.size() < 3 ? 0 : 3;
  }
  if (typed[1] != '[') {
    return 1;
  }
  const auto* end = std::find_if(typed.begin() + 2, typed.end(),
                                 [](char c) { return c >= '\x40' && c <= '\x7E'; });
  return end == typed.end() ? 0 : static_cast<std::size_t>(end - typed.begin()) + 1;
}

}  // namespace

std::optional<Key> take_key(std::string& typed) {
  while (!typed.empty()) {
    for (const Binding& binding : kBindings) {
      if (typed.starts_with(binding.typed)) {
        typed.erase(0, binding.typed.size());
        return binding.key;
      }
    }
    const char first = typed.front();
    const std::size_t length = length_of_first(typed);
    if (length == 0) {
      return std::nullopt;
    }
    typed.erase(0, length);
    if (first >= '1' && first <= '9') {
      return static_cast<Key>(static_cast<int>(Key::kFirstScript) + (first - '1'));
    }
  }
  return std::nullopt;
}

// Opens stdout anew: O_NONBLOCK on stdout itself would also hold for the shell that shares it.
Terminal::Terminal()
    : screen_(::open("/proc/self/fd/1", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
  ::tcgetattr(STDIN_FILENO, &before_);
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_iflag &= ~static_cast<tcflag_t>(IXON);  // Ctrl-S, beside the keys s and S, stops no output
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  raw.c_cc[VSUSP] =
      _POSIX_VDISABLE;  // no suspending: after it the screen and the key mode would be wrong
  ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  waiting_ = "\x1B[?1049h\x1B[?25l";  // alternate screen, no cursor
  write_waiting();
}

Terminal::~Terminal() {
  waiting_ = "\x1B[?25h\x1B[?1049l";
  pollfd ready{screen_.get(), POLLOUT, 0};
  ::poll(&ready, 1, kLastWaitMs);
  write_waiting();
  ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

bool Terminal::is_there() {
  return ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
}

Terminal::Size Terminal::size() {
  winsize window{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0 ||
      window.ws_row == 0) {
    return {};
  }
  return {window.ws_col, window.ws_row};
}

void Terminal::write_waiting() {
  while (!waiting_.empty()) {
    const ssize_t size = ::write(screen_.get(), waiting_.data(), waiting_.size());
    if (size <= 0) {
      return;
    }
    waiting_.erase(0, static_cast<std::size_t>(size));
  }
}

void Terminal::draw(const std::vector<ViewLine>& lines, Size size) {
  write_waiting();
  if (!waiting_.empty()) {
    return;
  }
  std::string screen = "\x1B[H";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    screen += (i == 0 ? "" : "\r\n");
    screen += style_of(lines[i].tone) + lines[i].text + "\x1B[m\x1B[K";
  }
  screen += "\x1B[J";
  if (screen != drawn_ || !(size == drawn_size_)) {
    waiting_ = screen;
    write_waiting();
    drawn_ = std::move(screen);
    drawn_size_ = size;
  }
}

std::optional<Key> Terminal::key() {
  pollfd waiting{STDIN_FILENO, POLLIN, 0};
  std::array<char, 64> buffer{};
  if (::poll(&waiting, 1, 0) > 0) {
    const ssize_t size = ::read(STDIN_FILENO, buffer.data(), buffer.size());
    pressed_.append(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(0, size)));
  }
  return take_key(pressed_);
}

}  // namespace nodmap::procman
