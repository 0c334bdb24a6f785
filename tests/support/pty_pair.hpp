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

/// A pseudo-terminal: the terminal side is opened by name like a serial port, the device side is
/// here. Throws std::system_error where the machine has none.
class PtyPair : private boost::noncopyable {
 public:
  PtyPair();
  ~PtyPair();

  /// /dev/pts/N
  [[nodiscard]] const std::string& name() const { return name_; }

  /// The device sends. Must fit into the terminal's buffer (4 KiB).
  void send(std::span<const std::uint8_t> bytes) const;
  void send(const std::string& text) const;

  /// What the device receives: at least `least` bytes unless `timeout` runs out before, and all
  /// that has come by then.
  [[nodiscard]] std::vector<std::uint8_t> receive(
      std::size_t least, std::chrono::milliseconds timeout = std::chrono::seconds(5)) const;
  [[nodiscard]] std::string receive_text(
      std::size_t least, std::chrono::milliseconds timeout = std::chrono::seconds(5)) const;

  /// The rate the other side has set, bit/s.
  [[nodiscard]] int baud() const;

  /// Pulls the plug: the other side is hung up, its name is gone.
  void unplug();

  [[nodiscard]] int device_handle() const { return device_; }

 private:
  int device_ = -1;
  // Kept open, so that the device can be closed and opened again by the other side at will.
  int terminal_ = -1;
  std::string name_;
};

}  // namespace nodmap::test
