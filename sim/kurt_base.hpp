// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/plant.hpp"
#include "sim/slcan_adapter.hpp"

namespace nodmap::sim {

struct KurtBaseSettings {
  double wheel_perimeter_m = 0.379;
  double ticks_per_turn = 21'950.0;
  double clock_ppm = 20.0;  ///< by how much its clock goes too slowly
};

/// The controller of a KURT2: CAN frames in and out. It sends its encoders every 10 ms and one kind
/// of its other readings in between, and drops out when nobody steers it for 100 ms.
class KurtBase {
 public:
  KurtBase(const KurtBaseSettings& settings, Plant& plant, std::int64_t power_on_us);

  void receive(const CanFrame& frame, std::int64_t now_us);

  /// When it does something next: sends a frame, or misses the host.
  [[nodiscard]] std::int64_t next_us() const;
  /// When it sends the next frame.
  [[nodiscard]] std::int64_t next_frame_us() const;
  /// That frame; the plant is at that time.
  [[nodiscard]] CanFrame next_frame();
  /// Drops out when it is time to.
  void watch_host(std::int64_t now_us);

 private:
  void control(const CanFrame& frame);
  void control_raw(const CanFrame& frame);
  void reset(std::int64_t now_us);
  [[nodiscard]] CanFrame encoder_frame();
  [[nodiscard]] CanFrame sensor_frame(std::int64_t period) const;
  [[nodiscard]] std::int64_t ticks(double way_m) const;

  KurtBaseSettings settings_;
  Plant& plant_;
  std::int64_t start_us_;
  std::int64_t slot_ = 1;  // two in each period: encoders, then something else
  std::int64_t heard_us_;
  bool dropped_out_ = true;
  std::int64_t left_told_ = 0;  // ticks since the start
  std::int64_t right_told_ = 0;
  double gyro_zero_rad_ = 0.0;
};

}  // namespace nodmap::sim
