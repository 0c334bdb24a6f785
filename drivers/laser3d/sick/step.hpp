// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/laser3d/sick/command.hpp"

namespace nodmap::laser3d {

/// The sensor's settings and the validity of its readings.
struct SickParams {
  std::string device;
  int baud = 500000;
  SickVariant variant = SickVariant::k180x100;
  bool interlaced = false;
  SickUnit unit = SickUnit::kMillimetre;
  SickMeasuringMode reach = kReach32m;
  double range_min_m = 0.05;
  double range_max_m = 30.0;
  bool upside_down = false;
  double time_offset_s = 0.0;
  int frozen_scans = 3;

  template <class Visitor>
  void describe(Visitor& v) {
    v.text("device", device,
           "Serial port of the SICK LMS2xx, preferably /dev/serial/by-id/...; required.");
    v.choice("baud", baud, {{"9600", 9600}, {"19200", 19200}, {"38400", 38400}, {"500000", 500000}},
             "Rate of the stream, bit/s; below 500000 (RS-422) scans are lost.");
    v.choice("variant", variant,
             {{"180x1", SickVariant::k180x100},
              {"180x0.5", SickVariant::k180x050},
              {"100x1", SickVariant::k100x100},
              {"100x0.5", SickVariant::k100x050},
              {"100x0.25", SickVariant::k100x025}},
             "Field of view and resolution, degrees.");
    v.flag("interlaced", interlaced,
           "Send each mirror revolution as a scan of its own, shifted by the resolution from one "
           "to the next; always 180 degrees.");
    v.choice("unit", unit, {{"mm", SickUnit::kMillimetre}, {"cm", SickUnit::kCentimetre}},
             "Unit of the readings on the line; cm allows ranges up to 80 m.");
    v.choice("reach", reach, {{"8m", kReach8m}, {"16m", kReach16m}, {"32m", kReach32m}},
             "Measuring range if the unit is mm; with cm ten times as far, at most 80 m.");
    v.number("range_min_m", range_min_m, {0.0, 5.0},
             "Shortest valid range; shorter readings hit the housing or the robot.");
    v.number("range_max_m", range_max_m, {1.0, 80.0}, "Longest valid range.");
    v.flag("upside_down", upside_down,
           "Set this if the laser is mounted upside down: its left is the robot's right.");
    v.number("time_offset_s", time_offset_s, {-0.1, 0.1},
             "Added to the time of every beam, to correct the constant latency, which must be "
             "measured on the robot.");
    v.integer("frozen_scans", frozen_scans, {2, 1000},
              "After this many repetitions of a scan in a row the measurement counts as frozen. "
              "Because of noise, a working laser repeats ten readings to the millimetre less than "
              "once in 1e12 scans.");
  }
};

/// The steps of the session; most of them send a request and wait for its answer.
enum class SickStep : std::uint8_t {
  kClosed,
  kSearch,       // stop any stream, at one rate after another
  kSetBaud,      // answered at the old rate
  kSettle,       // time for both ends to change their rate
  kConfirmBaud,  // does the sensor answer at the new rate?
  kReadConfig,
  kInstall,
  kWriteConfig,
  kLeaveInstall,
  kSetVariant,
  kStartStream,
  kStream,
  kWait,  // back-off after a failure
  kStop,  // shutting down
  kSlowDown,
};

enum class SickAnswer : std::uint8_t { kDone, kRefused, kOther };

/// The configuration with the settings of the parameters; all other bytes are unchanged.
[[nodiscard]] SickConfig wanted_config(const SickConfig& config, const SickParams& params);

/// The bytes of a step's request; none for steps without a request. `config` is the one read from
/// the sensor, needed to write a changed one.
[[nodiscard]] Bytes request_of(SickStep step, const SickParams& params,
                               const std::optional<SickConfig>& config);

/// Whether a telegram answers the request of a step, and with what result.
[[nodiscard]] SickAnswer classify_answer(SickStep step, const SickTelegram& telegram);

/// The purpose of a step, to complete the sentence "the sensor did not ...".
[[nodiscard]] const char* purpose_of(SickStep step);

}  // namespace nodmap::laser3d
