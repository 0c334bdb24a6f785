// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "sim/device.hpp"
#include "sim/lms_controller.hpp"
#include "sim/lms_telegram.hpp"
#include "sim/serial_output.hpp"

namespace nodmap::sim {

/// What the laser's optics see: Plant::measure, or what a test puts there.
using Beam = std::function<Echo(double angle_rad, std::int64_t time_us)>;

struct Lms200Settings {
  int baud = 9600;  ///< after power-on; another than 9600 was made permanent
  std::uint8_t address = 0;
  double boot_s = 1.0;       ///< from power-on to the first word
  double mirror_ppm = 50.0;  ///< by how much the mirror turns too slowly
  bool polluted = false;     ///< the front window is dirty
  /// As a robot in service has it: millimetres, up to 32 m, with real-time indices.
  Bytes config = {0, 0, 0x70, 0, 0x02, 0x06, 0x01, 0, 0, 2, 2, 0, 0, 0, 0, 0, 0,
                  0, 0, 0,    0, 0,    0,    0,    0, 0, 0, 0, 0, 0, 0, 0, 2, 0};
};

/// A SICK LMS200 at the end of its line.
///
/// The mirror turns at 75 Hz from power-on, whatever is sent. A half turn of 6.66 ms measures,
/// beam by beam, from right to left; the telegram's first byte leaves at its end.
class Lms200 : public Device {
 public:
  Lms200(const Lms200Settings& settings, Beam beam, std::int64_t power_on_us = 0);

  void receive(std::span<const std::uint8_t> bytes, int baud, std::int64_t now_us) override;
  void transmit(std::int64_t now_us, int baud, std::vector<std::uint8_t>& line) override;
  [[nodiscard]] std::int64_t next_us() const override;

  [[nodiscard]] int baud() const { return baud_; }
  /// When the measuring half of a turn ends, from power-on on.
  [[nodiscard]] std::int64_t half_turn_end_us(std::int64_t turn) const;

 private:
  void settle(std::int64_t now_us);
  void obey(const LmsRequest& request, std::int64_t now_us);
  void send(ByteView body, std::int64_t from_us);

  [[nodiscard]] bool measures() const;
  [[nodiscard]] bool sends_partial_scans() const;
  void end_turn(std::int64_t now_us);
  void measure_turn();
  void send_scan();

  Lms200Settings settings_;
  Beam beam_;
  LmsController controller_;
  LmsRequestReader reader_;
  SerialOutput output_;
  int baud_;
  std::int64_t power_on_us_;
  std::int64_t booted_us_;
  bool booting_ = true;
  int next_baud_;  // once the answer has left
  std::int64_t next_baud_us_ = kNever;

  std::int64_t turn_ = 0;  // the next to end
  int phase_ = 0;          // of the turns that make a scan
  bool collecting_ = false;
  std::vector<std::uint16_t> words_;
  std::uint8_t telegram_index_ = 0;
};

}  // namespace nodmap::sim
