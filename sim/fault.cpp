// SPDX-License-Identifier: BSD-3-Clause
#include "sim/fault.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

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
  fail(text, std::string(word).insert(0, 1, '\'') + "' is none of " + allowed);
}

/// What stands before the mark; the rest, after it, stays.
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
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value >= 0.0 && value <= max)) {
    fail(text, std::string(what) + " '" + std::string(word) + "' is no number from 0 to " +
                   std::to_string(static_cast<std::int64_t>(max)));
  }
  return value;
}

/// The most that an amount of this kind can be; nothing for kinds that have none.
std::optional<double> most(FaultKind kind) {
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

std::int64_t microseconds(double time_s) {
  return std::llround(1e6 * time_s);
}

}  // namespace

std::int64_t Fault::begin_us() const {
  return microseconds(from_s);
}

std::int64_t Fault::end_us() const {
  return microseconds(from_s + duration_s);
}

bool Fault::active(std::int64_t now_us) const {
  return now_us >= begin_us() && now_us < end_us();
}

Fault parse_fault(std::string_view text) {
  Fault fault;
  std::string_view rest = text;
  fault.part = look_up(kParts, take_up_to(':', rest, text), text);
  fault.kind = look_up(kKinds, take_up_to('@', rest, text), text);
  fault.from_s = number(take_up_to('+', rest, text), kLongestS, "the begin", text);
  const std::optional<double> max = most(fault.kind);
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

std::vector<Fault> faults_of(Part part, const std::vector<Fault>& faults) {
  std::vector<Fault> found;
  for (const Fault& fault : faults) {
    if (fault.part == part) {
      found.push_back(fault);
    }
  }
  return found;
}

}  // namespace nodmap::sim
