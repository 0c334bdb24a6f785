// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/geometry/time.hpp"
#include "sim/devices/lms_controller.hpp"
#include "sim/devices/lms_telegram.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {

/// One beam of the laser's optics: RobotModel::measure, or a substitute in tests. `angle_rad`: 0
/// ahead, positive left; `fired`: when the beam was fired.
using Beam = std::function<Echo(double angle_rad, time::SteadyTime fired)>;

struct Lms200Params {
  int baud = 9600;
  std::uint8_t address = 0;
  double boot_s = 1.0;
  double mirror_ppm = 50.0;
  bool polluted = false;
  /// The 34 bytes as on the robot: millimetres, up to 32 m, with real-time indices.
  Bytes config = {0, 0, 0x70, 0, 0x02, 0x06, 0x01, 0, 0, 2, 2, 0, 0, 0, 0, 0, 0,
                  0, 0, 0,    0, 0,    0,    0,    0, 0, 0, 0, 0, 0, 0, 0, 2, 0};

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice(
        "laser_power_on_baud", baud,
        {{"9600", 9600}, {"19200", 19200}, {"38400", 38400}, {"500000", 500000}},
        "Rate of the laser after power-on, bit/s; a value other than 9600 was made permanent.");
    v.number("laser_boot_s", boot_s, {0.0, 60.0},
             "Time from power-on to the laser's first telegram.");
    v.number("mirror_ppm", mirror_ppm, {-2000.0, 2000.0},
             "Error of the mirror's speed; positive: too slow.");
    v.flag("laser_polluted", polluted, "Let the laser report that its window is dirty.");
  }
};

/// A SICK LMS200 at the end of its serial line.
///
/// The mirror always rotates at 75 Hz from power-on. During half a revolution, 6.66 ms, the laser
/// measures beam by beam from right to left; at its end the telegram's first byte is sent.
class Lms200 final : public SerialDevice {
 public:
  Lms200(const Lms200Params& params, Beam beam, time::SteadyTime power_on = {});

  void receive(ByteView bytes, int baud, time::SteadyTime now) override;
  void transmit(time::SteadyTime now, int baud, Bytes& line) override;
  [[nodiscard]] time::SteadyTime next_due() const override;

  [[nodiscard]] int baud() const { return baud_; }
  /// End of the measuring half of a revolution, counted from power-on.
  [[nodiscard]] time::SteadyTime half_revolution_end(std::int64_t number) const;

 private:
  void update(time::SteadyTime now);
  void handle(const LmsRequest& request, time::SteadyTime now);
  void send(ByteView body, time::SteadyTime from);

  [[nodiscard]] bool measures() const;
  [[nodiscard]] bool sends_partial_scans() const;
  void end_revolution(time::SteadyTime now);
  void measure_revolution();
  void send_scan();

  Lms200Params params_;
  Beam beam_;
  LmsController controller_;
  LmsRequestReader reader_;
  SerialOutput output_;
  int baud_;
  time::SteadyTime power_on_;
  time::SteadyTime booted_;
  bool is_booting_ = true;
  int next_baud_;  // after the answer has been sent
  time::SteadyTime baud_due_ = kNever;

  std::int64_t revolution_ = 0;  // the next one to end
  int phase_ = 0;                // index among the revolutions of a scan
  bool is_collecting_ = false;
  std::vector<std::uint16_t> words_;
  std::uint8_t telegram_index_ = 0;
};

}  // namespace nodmap::sim
