// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/device.hpp"
#include "sim/kurt_base.hpp"
#include "sim/serial_output.hpp"
#include "sim/slcan_adapter.hpp"

namespace nodmap::sim {

struct SlcanKurtSettings {
  int baud = 1'000'000;
  KurtBaseSettings base;
};

/// A KURT2 behind an SLCAN adapter: the plant's wheels at the end of a serial line.
class SlcanKurtEmulator : public Device {
 public:
  SlcanKurtEmulator(const SlcanKurtSettings& settings, Plant& plant, std::int64_t power_on_us = 0);

  void receive(std::span<const std::uint8_t> bytes, int baud, std::int64_t now_us) override;
  void transmit(std::int64_t now_us, int baud, std::vector<std::uint8_t>& line) override;
  [[nodiscard]] std::int64_t next_us() const override;

 private:
  void send(const std::string& text, std::int64_t from_us);

  int baud_;
  KurtBase base_;
  std::int64_t now_us_;  // of what the host is saying
  SlcanAdapter adapter_;
  SerialOutput output_;
};

}  // namespace nodmap::sim
