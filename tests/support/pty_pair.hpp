// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace nodmap::test {

/// A pseudo-terminal: the code under test opens the terminal side by name, like a serial port; this
/// class is the device side. Throws std::system_error if the system has no pseudo-terminals.
class PtyPair : private boost::noncopyable {
 public:
  PtyPair();
  ~PtyPair();

  /// /dev/pts/N
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Sends as the device. The bytes must fit into the terminal's buffer (4 KiB).
  void send(std::span<const std::uint8_t> bytes) const;
  void send(const std::string& text) const;

  /// Receives as the device: waits for at least `least` bytes or until `timeout`, and returns
  /// everything that has arrived.
  [[nodiscard]] std::vector<std::uint8_t> receive(
      std::size_t least, std::chrono::milliseconds timeout = std::chrono::seconds(5)) const;
  [[nodiscard]] std::string receive_text(
      std::size_t least, std::chrono::milliseconds timeout = std::chrono::seconds(5)) const;

  /// The rate set by the terminal side (bit/s).
  [[nodiscard]] int baud() const;

  /// Unplugs the device: the terminal side hangs up and its name disappears.
  void unplug();

 private:
  int device_ = -1;
  // Kept open, so that the code under test can close and reopen the terminal.
  int terminal_ = -1;
  std::string name_;
};

}  // namespace nodmap::test
