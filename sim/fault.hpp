// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace nodmap::sim {

enum class Part : std::uint8_t { kLaser, kServo, kBase };

enum class FaultKind : std::uint8_t {
  kDrop,     ///< bytes are lost, each with probability `amount`
  kCorrupt,  ///< one bit of a byte is flipped, in each with probability `amount`
  kDelay,    ///< what the device says comes `amount` seconds late
  kUnplug,   ///< the port is gone
  kSilent,   ///< the device hears, but nothing comes from it
  kFreeze,   ///< the laser repeats what it measured last
  kStall,    ///< the servo's gear is blocked
};

/// Something that breaks, and for how long. Seconds since the simulation's start.
struct Fault {
  Part part = Part::kLaser;
  FaultKind kind = FaultKind::kDrop;
  double from_s = 0.0;
  double duration_s = 0.0;
  double amount = 0.0;  ///< of drop, corrupt and delay

  [[nodiscard]] std::int64_t begin_us() const;
  [[nodiscard]] std::int64_t end_us() const;
  [[nodiscard]] bool active(std::int64_t now_us) const;
};

/// A text that is no fault; what() is one line that says what is allowed.
class FaultError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "laser:unplug@10+2", "base:corrupt@5+10=0.01": part, kind, from when, how long, how much.
/// Throws FaultError.
[[nodiscard]] Fault parse_fault(std::string_view text);

/// Those of one part.
[[nodiscard]] std::vector<Fault> faults_of(Part part, const std::vector<Fault>& faults);

}  // namespace nodmap::sim
