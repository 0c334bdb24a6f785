// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/udpm_url.hpp"

#include <algorithm>
#include <limits>
#include <regex>
#include <sstream>

#include "common/formats/number.hpp"

namespace nodmap::bus {
namespace {

// Parses a whole number from 0 to `max`.
std::optional<int> parse_up_to(const std::string& text, int max) {
  const auto value = formats::parse_number<int>(text);
  return value && *value >= 0 && *value <= max ? value : std::nullopt;
}

// Sets what NAME=VALUE says. Returns false for a name that LCM does not know, or a wrong value:
// with `tttl=1`, messages would silently stay on this host.
bool set_option(const std::string& option, UdpmUrl& url) {
  const std::size_t equals = std::min(option.find('='), option.size());
  const std::string name = option.substr(0, equals);
  const std::string value = option.substr(std::min(equals + 1, option.size()));
  if (name == "ttl") {
    const std::optional<int> ttl = parse_up_to(value, 255);
    url.ttl = ttl.value_or(0);
    return ttl.has_value();
  }
  if (name == "recv_buf_size") {
    const std::optional<int> bytes = parse_up_to(value, std::numeric_limits<int>::max());
    url.receive_buffer_bytes = bytes.value_or(url.receive_buffer_bytes);
    return bytes.has_value();
  }
  return name == "transmit_only";
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
  std::smatch part;
  if (!std::regex_match(url, part, kForm)) {
    return std::nullopt;
  }
  UdpmUrl parsed;
  for (std::size_t i = 0; part[1].matched && i < parsed.group.size(); ++i) {
    const std::optional<int> octet = parse_up_to(part[i + 1], 255);
    if (!octet) {
      return std::nullopt;
    }
    parsed.group.at(i) = static_cast<std::uint8_t>(*octet);
  }
  if (part[5].matched) {
    const std::optional<int> port = parse_up_to(part[5], 65535);
    if (!port) {
      return std::nullopt;
    }
    parsed.port = static_cast<std::uint16_t>(*port);
  }
  // As LCM does: a comma separates options, too, and nothing between two separators is no option.
  std::string text = part[6].str();
  std::ranges::replace(text, ',', '&');
  std::istringstream options(text);
  for (std::string option; std::getline(options, option, '&');) {
    if (!option.empty() && !set_option(option, parsed)) {
      return std::nullopt;
    }
  }
  return parsed;
}

}  // namespace nodmap::bus
