// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/udpm_url.hpp"

#include <charconv>
#include <limits>
#include <regex>
#include <sstream>

namespace nodmap::bus {
namespace {

/// Parses a whole number from 0 to `max`.
std::optional<int> parse_number(const std::string& text, int max) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0 || value > max) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

std::string UdpmUrl::group_text() const {
  std::ostringstream text;
  text << int{group[0]} << '.' << int{group[1]} << '.' << int{group[2]} << '.' << int{group[3]};
  return text.str();
}

std::optional<UdpmUrl> parse_udpm_url(const std::string& url) {
  static const std::regex kForm(
      R"(udpm://(?:(\d+)\.(\d+)\.(\d+)\.(\d+))?(?::(\d+))?/?(?:\?(.*))?)");
  static const std::regex kTtl(R"((?:^|&)ttl=(\d+)(?:&|$))");
  static const std::regex kReceiveBuffer(R"((?:^|&)recv_buf_size=(\d+)(?:&|$))");
  std::smatch part;
  if (!std::regex_match(url, part, kForm)) {
    return std::nullopt;
  }
  UdpmUrl parsed;
  for (std::size_t i = 0; part[1].matched && i < parsed.group.size(); ++i) {
    const std::optional<int> octet = parse_number(part[i + 1], 255);
    if (!octet) {
      return std::nullopt;
    }
    parsed.group.at(i) = static_cast<std::uint8_t>(*octet);
  }
  if (part[5].matched) {
    const std::optional<int> port = parse_number(part[5], 65535);
    if (!port) {
      return std::nullopt;
    }
    parsed.port = static_cast<std::uint16_t>(*port);
  }
  const std::string options = part[6];
  std::smatch number;
  if (std::regex_search(options, number, kTtl)) {
    parsed.ttl = parse_number(number[1], 255).value_or(0);
  }
  if (std::regex_search(options, number, kReceiveBuffer)) {
    parsed.receive_buffer_bytes = parse_number(number[1], std::numeric_limits<int>::max())
                                      .value_or(parsed.receive_buffer_bytes);
  }
  return parsed;
}

}  // namespace nodmap::bus
