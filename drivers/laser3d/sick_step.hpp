// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/laser3d/sick_command.hpp"

namespace nodmap::laser3d {

struct SickSettings {
  int baud = 500000;  ///< to stream at: 9600, 19200, 38400 or 500000
  SickVariant variant = SickVariant::k180x100;
  /// Each turn of the mirror at once, in the sensor's own 32 m mode; always over 180 degrees.
  bool interlaced = false;
  SickUnit unit = SickUnit::kMillimetre;
  SickMeasuringMode measuring_mode;
  int frozen_scans = 3;  ///< so many equal scans in a row are no measurement any more
};

/// What the conversation is at: most steps are a request that waits for its answer.
enum class SickStep : std::uint8_t {
  kClosed,
  kSearch,       // stop whatever it does, at each rate in turn
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

/// The configuration the settings ask for, everything else as it is.
[[nodiscard]] SickConfig wanted_config(const SickConfig& config, const SickSettings& settings);

/// The bytes of a step's request; none for steps that ask nothing. `config` is the one read from
/// the sensor, needed to write another.
[[nodiscard]] Bytes request_of(SickStep step, const SickSettings& settings,
                               const std::optional<SickConfig>& config);

/// Whether a telegram answers the request of a step, and how.
[[nodiscard]] SickAnswer judge_answer(SickStep step, const SickTelegram& telegram);

/// What a step is for, to be read after "the sensor did not".
[[nodiscard]] const char* purpose_of(SickStep step);

}  // namespace nodmap::laser3d
