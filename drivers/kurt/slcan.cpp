// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/slcan.hpp"

namespace nodmap::kurt {
namespace {

constexpr std::uint8_t kCarriageReturn = '\r';
constexpr std::uint8_t kBell = 0x07;
constexpr std::size_t kStandardIdDigits = 3;
constexpr std::size_t kExtendedIdDigits = 8;
constexpr std::size_t kStampDigits = 4;
constexpr std::uint32_t kLargestStandardId = 0x7FF;
constexpr std::uint32_t kLargestExtendedId = 0x1FFFFFFF;
constexpr std::uint32_t kLargestStampMs = 59'999;

std::optional<std::uint32_t> hex_digit(char c) {
  if (c >= '0' && c <= '9') {
    return static_cast<std::uint32_t>(c - '0');
  }
  if (c >= 'A' && c <= 'F') {
    return static_cast<std::uint32_t>(c - 'A' + 10);
  }
  if (c >= 'a' && c <= 'f') {
    return static_cast<std::uint32_t>(c - 'a' + 10);
  }
  return std::nullopt;
}

// Removes `digits` hexadecimal digits from the front of `text`; returns their value.
std::optional<std::uint32_t> take_hex(std::string_view& text, std::size_t digits) {
  if (text.size() < digits) {
    return std::nullopt;
  }
  std::uint32_t value = 0;
  for (const char c : text.substr(0, digits)) {
    const auto digit = hex_digit(c);
    if (!digit) {
      return std::nullopt;
    }
    value = (value << 4U) | *digit;
  }
  text.remove_prefix(digits);
  return value;
}

void append_hex(std::string& text, std::uint32_t value, std::size_t digits) {
  for (std::size_t i = digits; i-- > 0;) {
    text += "0123456789ABCDEF"[(value >> (4 * i)) & 0xFU];
  }
}

// Reads the data and the optional stamp after it. False if `text` contains anything else.
bool take_data(std::string_view text, CanFrame& frame) {
  for (std::size_t i = 0; !frame.remote && i < frame.length; ++i) {
    const auto byte = take_hex(text, 2);
    if (!byte) {
      return false;
    }
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  if (text.size() == kStampDigits) {
    const auto stamp_ms = take_hex(text, kStampDigits);
    if (!stamp_ms || *stamp_ms > kLargestStampMs) {
      return false;
    }
    frame.stamp_ms = static_cast<std::uint16_t>(*stamp_ms);
  }
  return text.empty();
}

// Parses the answer to `F`: F and two digits.
std::optional<std::uint8_t> parse_flags(std::string_view line) {
  if (line.size() != 3 || line.front() != 'F') {
    return std::nullopt;
  }
  line.remove_prefix(1);
  const auto flags = take_hex(line, 2);
  return flags ? std::optional(static_cast<std::uint8_t>(*flags)) : std::nullopt;
}

}  // namespace

std::string to_line(const CanFrame& frame) {
  constexpr std::string_view kLetters = "tTrR";
  std::string line;
  line += kLetters[(frame.remote ? 2U : 0U) + (frame.extended ? 1U : 0U)];
  append_hex(line, frame.id, frame.extended ? kExtendedIdDigits : kStandardIdDigits);
  append_hex(line, frame.length, 1);
  for (std::size_t i = 0; !frame.remote && i < frame.length; ++i) {
    append_hex(line, frame.data[i], 2);
  }
  line += '\r';
  return line;
}

std::optional<CanFrame> parse_frame(std::string_view line) {
  if (line.empty()) {
    return std::nullopt;
  }
  const char letter = line.front();
  if (letter != 't' && letter != 'T' && letter != 'r' && letter != 'R') {
    return std::nullopt;
  }
  CanFrame frame;
  frame.extended = letter == 'T' || letter == 'R';
  frame.remote = letter == 'r' || letter == 'R';
  line.remove_prefix(1);
  const auto id = take_hex(line, frame.extended ? kExtendedIdDigits : kStandardIdDigits);
  const auto length = take_hex(line, 1);
  if (!id || *id > (frame.extended ? kLargestExtendedId : kLargestStandardId) || !length ||
      *length > frame.data.size()) {
    return std::nullopt;
  }
  frame.id = *id;
  frame.length = static_cast<std::uint8_t>(*length);
  if (!take_data(line, frame)) {
    return std::nullopt;
  }
  return frame;
}

std::optional<SlcanLine> SlcanParser::take(std::uint8_t byte) {
  if (byte == kCarriageReturn || byte == kBell) {
    return take_end(byte);
  }
  // With auto-poll they acknowledge a frame. Some clones send no CR after them.
  if (size_ == 0 && (byte == 'z' || byte == 'Z')) {
    is_acknowledged_ = true;
    ++counts_.done;
    return SlcanLine{SlcanLine::Kind::kDone, {}, 0};
  }
  if (size_ == line_.size()) {
    overflow_ = true;
  } else {
    line_[size_++] = static_cast<char>(byte);
  }
  return std::nullopt;
}

std::optional<SlcanLine> SlcanParser::take_end(std::uint8_t end) {
  const bool ends_acknowledgement = is_acknowledged_ && size_ == 0 && end == kCarriageReturn;
  const std::string_view text(line_.data(), size_);
  const bool overflow = overflow_;
  restart();
  if (overflow) {
    ++counts_.too_long;
    return std::nullopt;
  }
  return ends_acknowledgement ? std::nullopt : classify(text, end);
}

void SlcanParser::restart() {
  size_ = 0;
  overflow_ = false;
  is_acknowledged_ = false;
}

std::optional<SlcanLine> SlcanParser::classify(std::string_view text, std::uint8_t end) {
  using Kind = SlcanLine::Kind;
  if (text.empty() && end == kBell) {
    ++counts_.refused;
    return SlcanLine{Kind::kRefused, {}, 0};
  }
  if (text.empty()) {
    ++counts_.done;
    return SlcanLine{Kind::kDone, {}, 0};
  }
  if (const auto flags = parse_flags(text)) {
    return SlcanLine{Kind::kFlags, {}, *flags};
  }
  if (text.front() == 'V' && text.size() > 1) {
    return SlcanLine{Kind::kVersion, {}, 0};
  }
  if (const auto frame = parse_frame(text)) {
    ++counts_.frames;
    return SlcanLine{Kind::kFrame, *frame, 0};
  }
  const bool known = std::string_view("tTrRF").find(text.front()) != std::string_view::npos;
  ++(known ? counts_.malformed : counts_.unknown);
  return std::nullopt;
}

}  // namespace nodmap::kurt
