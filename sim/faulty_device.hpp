// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <random>

#include "sim/bytes.hpp"
#include "sim/device.hpp"
#include "sim/fault.hpp"
#include "sim/lms200.hpp"

namespace nodmap::sim {

/// A device whose line has faults: drop, corrupt, delay, unplug, silent. The device itself goes on
/// as if nothing were.
class FaultyDevice : public Device {
 public:
  /// `device` must outlive this.
  FaultyDevice(Device& device, std::vector<Fault> faults, std::uint64_t seed);

  void receive(std::span<const std::uint8_t> bytes, int baud, std::int64_t now_us) override;
  void transmit(std::int64_t now_us, int baud, std::vector<std::uint8_t>& line) override;
  [[nodiscard]] std::int64_t next_us() const override;
  [[nodiscard]] bool plugged_in(std::int64_t now_us) const override;

 private:
  struct Late {
    std::int64_t due_us = 0;
    Bytes bytes;
  };

  [[nodiscard]] const Fault* active(FaultKind kind, std::int64_t now_us) const;
  [[nodiscard]] Bytes damaged(ByteView bytes, std::int64_t now_us);
  [[nodiscard]] bool happens(const Fault* fault);

  Device& device_;
  std::vector<Fault> faults_;
  std::mt19937_64 random_;
  std::deque<Late> late_;
  std::int64_t now_us_ = 0;
};

/// A laser that repeats its last measurement while one of these faults freezes it.
[[nodiscard]] Beam freezing(Beam beam, std::vector<Fault> faults);

}  // namespace nodmap::sim
