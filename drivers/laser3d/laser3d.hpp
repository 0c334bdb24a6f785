// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "common/node/health.hpp"
#include "common/node/loss_meter.hpp"
#include "common/scan/scan.hpp"
#include "drivers/laser3d/nod.hpp"
#include "drivers/laser3d/params.hpp"
#include "drivers/laser3d/passive_sync.hpp"
#include "drivers/laser3d/scan_joiner.hpp"
#include "drivers/laser3d/sick/session.hpp"

namespace nodmap::laser3d {

/// What to do on a serial line, in this order.
struct LineAction {
  std::optional<int> baud;
  Bytes send;
};

/// The state of the head at one reading of the servo.
struct PitchState {
  PitchSample sample;
  Nod::Aim aim;
  std::int64_t sweep = 0;
  bool is_measured = false;
  bool is_stalled = false;
};

/// A scan with a steady time instead of a stamp: Laser3d does not know the wall clock.
struct SteadyScan {
  time::SteadyTime first_beam;
  scan::Scan scan;
};

struct Laser3dOutput {
  std::vector<LineAction> laser;
  std::vector<LineAction> servo;
  std::vector<SteadyScan> scans;
  std::vector<PitchState> pitch;
};

/// Runs the nodding 3D scanner: a session with the laser and one with the servo, whose data it
/// joins into pitched scans. Bytes and times in; bytes, scans and pitch states out.
class Laser3d {
 public:
  struct Counts {
    std::int64_t scans = 0;
    std::int64_t scans_without_pitch = 0;  ///< since the first scan with a pitch
    std::int64_t telegrams_missed = 0;     ///< by the sensor's own counter
    std::int64_t dazzled_beams = 0;
    std::int64_t scans_blind = 0;  ///< not published while the laser was blind
  };

  explicit Laser3d(const Laser3dParams& params);

  [[nodiscard]] Laser3dOutput laser_opened(time::SteadyTime now);
  [[nodiscard]] Laser3dOutput servo_opened(time::SteadyTime now);
  void laser_lost();
  void servo_lost();

  [[nodiscard]] Laser3dOutput receive_laser(ByteView bytes, time::SteadyTime now);
  [[nodiscard]] Laser3dOutput receive_servo(ByteView bytes, time::SteadyTime now);
  /// To be called at least every few milliseconds.
  [[nodiscard]] Laser3dOutput poll(time::SteadyTime now);

  /// Nods over `area`, as decided at `decided`; false if it is invalid (see Nod::command).
  bool command(const AreaOfInterest& area, time::SteadyTime decided);

  /// Ends the stream. Call poll() until is_laser_at_rest().
  [[nodiscard]] Laser3dOutput shut_down(time::SteadyTime now);
  [[nodiscard]] bool is_laser_at_rest() const {
    return sick_.state() == SickSession::State::kClosed;
  }

  [[nodiscard]] node::Health health(time::SteadyTime now) const;
  [[nodiscard]] const Counts& counts() const { return counts_; }
  [[nodiscard]] const SickSession::Counts& laser_counts() const { return sick_.counts(); }
  [[nodiscard]] ServoCounts servo_counts() const { return servo_->line_counts(); }
  [[nodiscard]] const SickParser& laser_line() const { return parser_; }

 private:
  void take(SickOutput output, Laser3dOutput& result);
  void take(ServoOutput output, time::SteadyTime now, Laser3dOutput& result);
  void take_scan(const SickScan& scan);
  void note_quality(const SickScan& scan);
  [[nodiscard]] bool sees_something(const SickScan& scan) const;
  [[nodiscard]] bool is_blind(time::SteadyTime now) const;
  [[nodiscard]] time::SteadyTime sent_at(const SickScan& scan);
  void join(time::SteadyTime now, Laser3dOutput& result);
  void watch_for_losses(time::SteadyTime now);
  /// Why the scanner does not work; empty if it does.
  [[nodiscard]] std::string failure(time::SteadyTime now) const;
  /// Why it works worse than it should; empty if it does not.
  [[nodiscard]] std::string shortcoming() const;
  [[nodiscard]] SteadyScan to_scan(PitchedRevolution pitched);

  Laser3dParams params_;
  SickSession sick_;
  SickParser parser_;
  PassiveSync mirror_sync_;
  std::optional<std::uint8_t> last_telegram_index_;
  std::int64_t connections_ = 0;  // number of connections of the sensor at that time
  std::unique_ptr<ServoSession> servo_;
  Nod nod_;
  ScanJoiner joiner_;
  geometry::SE3 T_base_mount_;
  std::int64_t scan_seq_ = 0;
  std::int64_t dropped_at_start_ = 0;
  node::LossMeter telegram_loss_;
  node::LossMeter pitch_loss_;
  time::SteadyTime last_scan_;
  std::optional<time::SteadyTime> last_sight_;  // time of the last scan with readings
  SickStatusByte status_;
  double dazzled_ratio_ = 0.0;
  double unmeasured_ratio_ = 0.0;  // including dazzled beams
  Counts counts_;
};

}  // namespace nodmap::laser3d
