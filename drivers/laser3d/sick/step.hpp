// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/laser3d/sick/command.hpp"

namespace nodmap::laser3d {

/// How the sensor is set up, and what its readings are worth.
struct SickParams {
  std::string device = "/dev/scanner";
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
    v.text("device", device, "Serial line of the SICK LMS2xx.");
    v.choice("baud", baud, {{"9600", 9600}, {"19200", 19200}, {"38400", 38400}, {"500000", 500000}},
             "Rate to stream at, bit/s; only 500000 (RS-422) loses no scan.");
    v.choice("variant", variant,
             {{"180x1", SickVariant::k180x100},
              {"180x0.5", SickVariant::k180x050},
              {"100x1", SickVariant::k100x100},
              {"100x0.5", SickVariant::k100x050},
              {"100x0.25", SickVariant::k100x025}},
             "Field of view and resolution, degrees.");
    v.flag("interlaced", interlaced,
           "Stream each mirror revolution at once, the next one shifted by the resolution; always "
           "180 degrees.");
    v.choice("unit", unit, {{"mm", SickUnit::kMillimetre}, {"cm", SickUnit::kCentimetre}},
             "Unit of the readings on the line; cm reaches 80 m.");
    v.choice("reach", reach, {{"8m", kReach8m}, {"16m", kReach16m}, {"32m", kReach32m}},
             "Largest reading in mm; ten times as far in cm, at most 80 m.");
    v.number("range_min_m", range_min_m, {0.0, 5.0},
             "Readings below are the housing or the robot.");
    v.number("range_max_m", range_max_m, {1.0, 80.0}, "How far readings are trusted.");
    v.flag("upside_down", upside_down, "The laser hangs head down: its left is the robot's right.");
    v.number("time_offset_s", time_offset_s, {-0.1, 0.1},
             "Added to the time of every beam: the constant latency, which only a measurement on "
             "the robot can tell.");
    v.integer("frozen_scans", frozen_scans, {2, 1000},
              "So many repetitions of one scan in a row are no measurement any more. With its "
              "noise a laser repeats ten readings to the millimetre less than once in 1e12 scans.");
  }
};

/// The steps of the conversation; most of them are a request that waits for its answer.
enum class SickStep : std::uint8_t {
  kClosed,
  kSearch,       // stop whatever the sensor does, at one rate after the other
  kSetBaud,      // answered at the old rate
  kSettle,       // both ends change their rate
  kConfirmBaud,  // heard at the new rate?
  kReadConfig,
  kInstall,
  kWriteConfig,
  kLeaveInstall,
  kSetVariant,
  kStartStream,
  kStream,
  kWait,  // back-off
  kStop,  // shutting down
  kSlowDown,
};

enum class SickAnswer : std::uint8_t { kDone, kRefused, kOther };

/// The configuration that the parameters ask for; everything else stays as it is.
[[nodiscard]] SickConfig wanted_config(const SickConfig& config, const SickParams& params);

/// The bytes of a step's request; none for steps that ask nothing. `config` is the one read from
/// the sensor, needed to write another.
[[nodiscard]] Bytes request_of(SickStep step, const SickParams& params,
                               const std::optional<SickConfig>& config);

/// Whether a telegram answers the request of a step, and how.
[[nodiscard]] SickAnswer classify_answer(SickStep step, const SickTelegram& telegram);

/// What a step is for, to complete the sentence "the sensor did not ...".
[[nodiscard]] const char* purpose_of(SickStep step);

}  // namespace nodmap::laser3d
