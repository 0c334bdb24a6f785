// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/fault.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/formats/number.hpp"

namespace nodmap::sim {
namespace {

constexpr std::array kParts = {std::pair{"laser", Part::kLaser}, std::pair{"servo", Part::kServo},
                               std::pair{"base", Part::kBase}};
constexpr std::array kKinds = {
    std::pair{"drop", FaultKind::kDrop},     std::pair{"corrupt", FaultKind::kCorrupt},
    std::pair{"delay", FaultKind::kDelay},   std::pair{"unplug", FaultKind::kUnplug},
    std::pair{"silent", FaultKind::kSilent}, std::pair{"freeze", FaultKind::kFreeze},
    std::pair{"stall", FaultKind::kStall}};

constexpr double kLongestS = 1e6;
constexpr double kLongestDelayS = 10.0;

[[noreturn]] void fail(std::string_view text, const std::string& what) {
  throw FaultError("fault '" + std::string(text) + "': " + what +
                   " (PART:KIND@FROM+DURATION[=AMOUNT], as in laser:unplug@10+2)");
}

template <class Table, class Value>
std::string name_in(const Table& table, Value value) {
  return std::ranges::find(table, value, [](const auto& row) { return row.second; })->first;
}

template <class Table>
auto look_up(const Table& table, std::string_view word, std::string_view text) {
  std::string allowed;
  for (const auto& [name, value] : table) {
    if (word == name) {
      return value;
    }
    allowed += allowed.empty() ? "" : ", ";
    allowed += name;
  }
  fail(text, std::string(word).insert(0, 1, '\'') + "' is not one of " + allowed);
}

// The text before the mark; `rest` becomes the text after it.
std::string_view take_up_to(char mark, std::string_view& rest, std::string_view text) {
  const std::size_t at = rest.find(mark);
  if (at == std::string_view::npos) {
    fail(text, std::string{'\'', mark, '\''} + " is missing");
  }
  const std::string_view word = rest.substr(0, at);
  rest.remove_prefix(at + 1);
  return word;
}

double number(std::string_view word, double max, const char* what, std::string_view text) {
  const auto value = formats::parse_number<double>(word);
  if (!value || !(*value >= 0.0 && *value <= max)) {
    fail(text, std::string(what) + " '" + std::string(word) + "' is not a number from 0 to " +
                   std::to_string(static_cast<std::int64_t>(max)));
  }
  return *value;
}

// The largest amount of this kind; empty for kinds that have none.
std::optional<double> max_amount(FaultKind kind) {
  switch (kind) {
    case FaultKind::kDrop:
    case FaultKind::kCorrupt:
      return 1.0;
    case FaultKind::kDelay:
      return kLongestDelayS;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::string name_of(Part part) {
  return name_in(kParts, part);
}

std::string name_of(FaultKind kind) {
  return name_in(kKinds, kind);
}

time::SteadyTime Fault::begin() const {
  return time::SteadyTime(time::from_seconds(from_s));
}

time::SteadyTime Fault::end() const {
  return time::SteadyTime(time::from_seconds(from_s + duration_s));
}

bool Fault::is_active(time::SteadyTime now) const {
  return now >= begin() && now < end();
}

Fault parse_fault(std::string_view text) {
  Fault fault;
  std::string_view rest = text;
  fault.part = look_up(kParts, take_up_to(':', rest, text), text);
  fault.kind = look_up(kKinds, take_up_to('@', rest, text), text);
  fault.from_s = number(take_up_to('+', rest, text), kLongestS, "the begin", text);
  const std::optional<double> max = max_amount(fault.kind);
  if (max) {
    const std::string_view duration = take_up_to('=', rest, text);
    fault.amount = number(rest, *max, "the amount", text);
    rest = duration;
  }
  fault.duration_s = number(rest, kLongestS, "the duration", text);
  if (fault.kind == FaultKind::kFreeze && fault.part != Part::kLaser) {
    fail(text, "only the laser freezes");
  }
  if (fault.kind == FaultKind::kStall && fault.part != Part::kServo) {
    fail(text, "only the servo stalls");
  }
  return fault;
}

bool is_any_active(FaultKind kind, const std::vector<Fault>& faults, time::SteadyTime now) {
  return std::ranges::any_of(
      faults, [&](const Fault& fault) { return fault.kind == kind && fault.is_active(now); });
}

std::vector<Fault> faults_of(Part part, const std::vector<Fault>& faults) {
  std::vector<Fault> found;
  for (const Fault& fault : faults) {
    if (fault.part == part) {
      found.push_back(fault);
    }
  }
  return found;
}

FaultyDevice::FaultyDevice(SerialDevice& device, std::vector<Fault> faults, std::uint64_t seed)
    : device_(device), faults_(std::move(faults)), engine_(seed) {}

void FaultyDevice::receive(ByteView bytes, int baud, time::SteadyTime now) {
  if (!is_plugged_in(now)) {
    return;
  }
  const Bytes arrived = damaged(bytes, now);
  if (!arrived.empty()) {
    device_.receive(arrived, baud, now);
  }
}

void FaultyDevice::transmit(time::SteadyTime now, int baud, Bytes& line) {
  now_ = now;
  Bytes sent;
  device_.transmit(now, baud, sent);
  if (!is_plugged_in(now)) {
    delayed_.clear();
    return;
  }
  if (!sent.empty() && active(FaultKind::kSilent, now) == nullptr) {
    const Fault* fault = active(FaultKind::kDelay, now);
    const time::SteadyTime due = now + time::from_seconds(fault == nullptr ? 0.0 : fault->amount);
    const time::SteadyTime before = delayed_.empty() ? now : delayed_.back().due;
    // In order: no byte overtakes another.
    delayed_.push_back({std::max(due, before), damaged(sent, now)});
  }
  while (!delayed_.empty() && delayed_.front().due <= now) {
    append(line, delayed_.front().bytes);
    delayed_.pop_front();
  }
}

time::SteadyTime FaultyDevice::next_due() const {
  time::SteadyTime next = device_.next_due();
  if (!delayed_.empty()) {
    next = std::min(next, delayed_.front().due);
  }
  for (const Fault& fault : faults_) {
    for (const time::SteadyTime edge : {fault.begin(), fault.end()}) {
      if (edge > now_) {
        next = std::min(next, edge);
      }
    }
  }
  return next;
}

bool FaultyDevice::is_plugged_in(time::SteadyTime now) const {
  return active(FaultKind::kUnplug, now) == nullptr && device_.is_plugged_in(now);
}

const Fault* FaultyDevice::active(FaultKind kind, time::SteadyTime now) const {
  const auto found = std::ranges::find_if(
      faults_, [&](const Fault& fault) { return fault.kind == kind && fault.is_active(now); });
  return found == faults_.end() ? nullptr : &*found;
}

bool FaultyDevice::happens(const Fault* fault) {
  constexpr double kScale = 0x1p-64;
  return fault != nullptr && static_cast<double>(engine_()) * kScale < fault->amount;
}

Bytes FaultyDevice::damaged(ByteView bytes, time::SteadyTime now) {
  const Fault* drop = active(FaultKind::kDrop, now);
  const Fault* corrupt = active(FaultKind::kCorrupt, now);
  Bytes arrived;
  for (const std::uint8_t byte : bytes) {
    if (happens(drop)) {
      continue;
    }
    const unsigned flipped = happens(corrupt) ? 1U << (engine_() % 8) : 0U;
    arrived.push_back(static_cast<std::uint8_t>(byte ^ flipped));
  }
  return arrived;
}

}  // namespace nodmap::sim
