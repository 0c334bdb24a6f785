// SPDX-License-Identifier: BSD-3-Clause
#include "sim/slcan_kurt_emulator.hpp"

#include <algorithm>

#include "sim/uart.hpp"

namespace nodmap::sim {

SlcanKurtEmulator::SlcanKurtEmulator(const SlcanKurtSettings& settings, Plant& plant,
                                     std::int64_t power_on_us)
    : baud_(settings.baud),
      base_(settings.base, plant, power_on_us),
      now_us_(power_on_us),
      adapter_([this](const CanFrame& frame) { base_.receive(frame, now_us_); }) {}

void SlcanKurtEmulator::receive(std::span<const std::uint8_t> bytes, int baud,
                                std::int64_t now_us) {
  now_us_ = now_us;
  for (const std::uint8_t byte : heard_at(baud_, bytes, baud)) {
    send(adapter_.take(static_cast<char>(byte)), now_us);
  }
}

void SlcanKurtEmulator::transmit(std::int64_t now_us, int baud, std::vector<std::uint8_t>& line) {
  base_.watch_host(now_us);
  while (base_.next_frame_us() <= now_us) {
    const std::int64_t sent_us = base_.next_frame_us();
    send(adapter_.from_bus(base_.next_frame(), sent_us), sent_us);
  }
  output_.take(now_us, baud, line);
}

std::int64_t SlcanKurtEmulator::next_us() const {
  return std::min(base_.next_us(), output_.next_us());
}

void SlcanKurtEmulator::send(const std::string& text, std::int64_t from_us) {
  output_.send({text.begin(), text.end()}, baud_, from_us);
}

}  // namespace nodmap::sim
