// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/slcan_adapter.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

namespace nodmap::sim {
namespace {

constexpr const char* kDone = "\r";
constexpr const char* kRefused = "\a";
constexpr std::size_t kLongestLine = 30;  // Tiiiiiiiildddddddddddddddd and a stamp

constexpr std::string_view kHexDigits = "0123456789ABCDEF";

void append_hex(std::string& text, unsigned value, int digits) {
  for (int digit = digits - 1; digit >= 0; --digit) {
    text += kHexDigits[value >> (4 * digit) & 0xFU];
  }
}

bool is_hex(std::string_view text) {
  return std::ranges::all_of(
      text, [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; });
}

unsigned hex_number(std::string_view digits) {
  unsigned value = 0;
  for (const char c : digits) {
    const auto upper = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    value = value << 4U | static_cast<unsigned>(kHexDigits.find(upper));
  }
  return value;
}

// Parses the text after the letter: `id_digits` of identifier, the length, and the data unless it
// is a remote request.
std::optional<CanFrame> parse_frame(std::string_view text, std::size_t id_digits, bool has_data) {
  if (text.size() < id_digits + 1 || !is_hex(text)) {
    return std::nullopt;
  }
  const unsigned length = hex_number(text.substr(id_digits, 1));
  const std::size_t data_digits = has_data ? 2 * std::size_t{length} : 0;
  if (length > 8 || text.size() != id_digits + 1 + data_digits) {
    return std::nullopt;
  }
  CanFrame frame;
  frame.id = static_cast<std::uint16_t>(hex_number(text.substr(0, id_digits)) & 0x7FFU);
  frame.length = static_cast<std::uint8_t>(length);
  for (std::size_t i = 0; i < data_digits / 2; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(hex_number(text.substr(id_digits + 1 + 2 * i, 2)));
  }
  return frame;
}

}  // namespace

SlcanAdapter::SlcanAdapter(std::function<void(const CanFrame&)> to_bus)
    : to_bus_(std::move(to_bus)) {}

std::string SlcanAdapter::take(char c) {
  if (c != '\r') {
    is_overlong_ = is_overlong_ || line_.size() >= kLongestLine;
    if (!is_overlong_) {
      line_ += c;
    }
    return "";
  }
  const std::string line = std::exchange(line_, {});
  return std::exchange(is_overlong_, false) ? kRefused : handle(line);
}

std::string SlcanAdapter::from_bus(const CanFrame& frame, time::SteadyTime now) {
  if (!on_the_bus()) {
    return "";
  }
  std::string text = "t";
  append_hex(text, frame.id, 3);
  append_hex(text, frame.length, 1);
  for (std::size_t i = 0; i < frame.length; ++i) {
    append_hex(text, frame.data[i], 2);
  }
  if (stamps_) {
    constexpr time::Duration kStampWrap = 60s;
    append_hex(text, static_cast<unsigned>(now.time_since_epoch() % kStampWrap / 1ms), 4);
  }
  return text + "\r";
}

std::string SlcanAdapter::handle(std::string_view line) {
  if (line.empty()) {
    return kDone;
  }
  if (line == "V") {
    return "V1013\r";
  }
  if (line == "v") {
    return "v1013\r";
  }
  if (line == "N") {
    return "N4242\r";
  }
  return is_open() ? handle_open(line) : handle_closed(line);
}

std::string SlcanAdapter::handle_closed(std::string_view line) {
  const char argument = line.size() == 2 ? line[1] : '\0';
  switch (line[0]) {
    case 'S':
      if (argument < '0' || argument > '8') {
        return kRefused;
      }
      rate_ = argument;
      return kDone;
    case 'O':
    case 'L':
      if (rate_ == 0 || line.size() != 1) {
        return kRefused;
      }
      channel_ = line[0] == 'O' ? Channel::kOpen : Channel::kListening;
      return kDone;
    case 'Z':
    case 'X':
      if (argument != '0' && argument != '1') {
        return kRefused;
      }
      (line[0] == 'Z' ? stamps_ : auto_poll_) = argument == '1';
      return kDone;
    default:
      return kRefused;
  }
}

std::string SlcanAdapter::handle_open(std::string_view line) {
  switch (line[0]) {
    case 'C':
      if (line.size() != 1) {
        return kRefused;
      }
      channel_ = Channel::kClosed;
      return kDone;
    case 'F':
      // At a rate other than the bus's there are only bus errors.
      return line.size() != 1 ? kRefused : on_the_bus() ? "F00\r" : "F80\r";
    case 't':
    case 'T':
    case 'r':
    case 'R':
      return send(line);
    default:
      return kRefused;
  }
}

std::string SlcanAdapter::send(std::string_view line) {
  const bool extended = line[0] == 'T' || line[0] == 'R';
  const bool has_data = line[0] == 't' || line[0] == 'T';
  const std::optional<CanFrame> frame = parse_frame(line.substr(1), extended ? 8 : 3, has_data);
  if (!frame || channel_ == Channel::kListening) {
    return kRefused;
  }
  if (!extended && has_data && on_the_bus()) {
    to_bus_(*frame);  // the base ignores the other kinds
  }
  return !auto_poll_ ? kDone : extended ? "Z\r" : "z\r";
}

}  // namespace nodmap::sim
