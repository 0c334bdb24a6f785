// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "common/geometry/time.hpp"

namespace nodmap::sim {

/// A data frame with 11-bit identifier.
struct CanFrame {
  std::uint16_t id = 0;
  std::uint8_t length = 8;
  std::array<std::uint8_t, 8> data{};
};

/// A Lawicel CANUSB adapter between serial line and CAN bus, text in and text out. It answers each
/// line with CR or BEL; frames pass only while the channel is open at 1 Mbit/s.
class SlcanAdapter {
 public:
  /// `to_bus` receives the frames that the host sends.
  explicit SlcanAdapter(std::function<void(const CanFrame&)> to_bus);

  /// Takes a character from the host; returns the answer.
  [[nodiscard]] std::string take(char c);
  /// The line that reports a frame on the bus to the host; empty while the channel is closed.
  [[nodiscard]] std::string from_bus(const CanFrame& frame, time::SteadyTime now);

  [[nodiscard]] bool is_open() const { return channel_ != Channel::kClosed; }

 private:
  enum class Channel : std::uint8_t { kClosed, kOpen, kListening };

  [[nodiscard]] std::string handle(std::string_view line);
  [[nodiscard]] std::string handle_closed(std::string_view line);
  [[nodiscard]] std::string handle_open(std::string_view line);
  [[nodiscard]] std::string send(std::string_view line);
  [[nodiscard]] bool on_the_bus() const { return is_open() && rate_ == kBusRate; }

  static constexpr char kBusRate = '8';

  std::function<void(const CanFrame&)> to_bus_;
  std::string line_;
  bool is_overlong_ = false;
  Channel channel_ = Channel::kClosed;
  char rate_ = 0;  // the digit of S, 0 while none is set
  bool stamps_ = false;
  bool auto_poll_ = true;
};

}  // namespace nodmap::sim
