// SPDX-License-Identifier: BSD-3-Clause
#include "sim/faulty_device.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace nodmap::sim {

FaultyDevice::FaultyDevice(Device& device, std::vector<Fault> faults, std::uint64_t seed)
    : device_(device), faults_(std::move(faults)), random_(seed) {}

void FaultyDevice::receive(std::span<const std::uint8_t> bytes, int baud, std::int64_t now_us) {
  if (!plugged_in(now_us)) {
    return;
  }
  const Bytes arrived = damaged(bytes, now_us);
  if (!arrived.empty()) {
    device_.receive(arrived, baud, now_us);
  }
}

void FaultyDevice::transmit(std::int64_t now_us, int baud, std::vector<std::uint8_t>& line) {
  now_us_ = now_us;
  Bytes said;
  device_.transmit(now_us, baud, said);
  if (!plugged_in(now_us)) {
    late_.clear();
    return;
  }
  if (!said.empty() && active(FaultKind::kSilent, now_us) == nullptr) {
    const Fault* delay = active(FaultKind::kDelay, now_us);
    const std::int64_t delay_us = delay == nullptr ? 0 : std::llround(1e6 * delay->amount);
    const std::int64_t after_us = late_.empty() ? now_us : late_.back().due_us;  // none overtakes
    late_.push_back({std::max(now_us + delay_us, after_us), damaged(said, now_us)});
  }
  while (!late_.empty() && late_.front().due_us <= now_us) {
    append(line, late_.front().bytes);
    late_.pop_front();
  }
}

std::int64_t FaultyDevice::next_us() const {
  std::int64_t next = device_.next_us();
  if (!late_.empty()) {
    next = std::min(next, late_.front().due_us);
  }
  for (const Fault& fault : faults_) {
    for (const std::int64_t edge_us : {fault.begin_us(), fault.end_us()}) {
      if (edge_us > now_us_) {
        next = std::min(next, edge_us);
      }
    }
  }
  return next;
}

bool FaultyDevice::plugged_in(std::int64_t now_us) const {
  return active(FaultKind::kUnplug, now_us) == nullptr && device_.plugged_in(now_us);
}

const Fault* FaultyDevice::active(FaultKind kind, std::int64_t now_us) const {
  const auto found = std::find_if(faults_.begin(), faults_.end(), [&](const Fault& fault) {
    return fault.kind == kind && fault.active(now_us);
  });
  return found == faults_.end() ? nullptr : &*found;
}

bool FaultyDevice::happens(const Fault* fault) {
  constexpr double kScale = 0x1p-64;
  return fault != nullptr && static_cast<double>(random_()) * kScale < fault->amount;
}

Bytes FaultyDevice::damaged(ByteView bytes, std::int64_t now_us) {
  const Fault* drop = active(FaultKind::kDrop, now_us);
  const Fault* corrupt = active(FaultKind::kCorrupt, now_us);
  Bytes arrived;
  for (const std::uint8_t byte : bytes) {
    if (happens(drop)) {
      continue;
    }
    const unsigned flipped = happens(corrupt) ? 1U << (random_() % 8) : 0U;
    arrived.push_back(static_cast<std::uint8_t>(byte ^ flipped));
  }
  return arrived;
}

Beam freezing(Beam beam, std::vector<Fault> faults) {
  std::erase_if(faults, [](const Fault& fault) { return fault.kind != FaultKind::kFreeze; });
  if (faults.empty()) {
    return beam;
  }
  const auto angle_key = [](double angle_rad) { return std::lround(1e5 * angle_rad); };
  return [beam = std::move(beam), faults = std::move(faults), angle_key,
          last = std::map<std::int64_t, Echo>()](double angle_rad, std::int64_t time_us) mutable {
    const bool frozen = std::any_of(faults.begin(), faults.end(), [time_us](const Fault& fault) {
      return fault.active(time_us);
    });
    const auto known = last.find(angle_key(angle_rad));
    if (frozen && known != last.end()) {
      return known->second;
    }
    const Echo echo = beam(angle_rad, time_us);
    last[angle_key(angle_rad)] = echo;
    return echo;
  };
}

}  // namespace nodmap::sim
