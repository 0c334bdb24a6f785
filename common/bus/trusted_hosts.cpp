// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/trusted_hosts.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/formats/number.hpp"
#include "common/formats/user_error.hpp"

namespace nodmap::bus {
namespace {

[[noreturn]] void throw_invalid(const std::string& part, const std::string& hosts) {
  throw formats::UserError("'" + part + "' of the trusted hosts '" + hosts +
                           "' is not an address or network (examples: 10.0.0.2, 10.0.0.0/24)");
}

std::optional<std::uint32_t> parse_address(const std::string& text) {
  in_addr address{};
  if (::inet_pton(AF_INET, text.c_str(), &address) != 1) {
    return std::nullopt;
  }
  return ntohl(address.s_addr);
}

// The network mask with this number of leading bits.
std::optional<std::uint32_t> parse_mask(std::string_view bits_text) {
  const auto bits = formats::parse_number<unsigned int>(bits_text);
  if (!bits || *bits > 32) {
    return std::nullopt;
  }
  return *bits == 0 ? 0 : ~std::uint32_t{0} << (32 - *bits);
}

}  // namespace

std::string address_text(std::uint32_t address) {
  std::ostringstream text;
  text << (address >> 24U) << '.' << (address >> 16U & 255U) << '.' << (address >> 8U & 255U) << '.'
       << (address & 255U);
  return text.str();
}

std::optional<std::vector<std::uint32_t>> addresses_of_this_host() {
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) {
    return std::nullopt;
  }
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(first, &::freeifaddrs);
  std::vector<std::uint32_t> addresses;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET) {
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the C interface wants it
      const auto* address = reinterpret_cast<const sockaddr_in*>(entry->ifa_addr);
      addresses.push_back(ntohl(address->sin_addr.s_addr));
    }
  }
  return addresses;
}

TrustedHosts::TrustedHosts(const std::string& hosts,
                           std::function<std::optional<std::vector<std::uint32_t>>()> own_addresses)
    : networks_{{parse_address("127.0.0.0").value(), parse_mask("8").value()},
                {parse_address("0.0.0.0").value(), parse_mask("32").value()}},
      own_addresses_(std::move(own_addresses)) {
  std::istringstream parts(hosts);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t slash = part.find('/');
    const std::optional<std::uint32_t> address = parse_address(part.substr(0, slash));
    const std::optional<std::uint32_t> mask =
        parse_mask(slash == std::string::npos ? "32" : std::string_view(part).substr(slash + 1));
    if (!address || !mask) {
      throw_invalid(part, hosts);
    }
    networks_.push_back({*address & *mask, *mask});
  }
}

bool TrustedHosts::contains(std::uint32_t address, time::SteadyTime now) {
  const bool is_named = std::ranges::any_of(networks_, [address](const Network& network) {
    return (address & network.mask) == network.address;
  });
  if (is_named) {
    return true;
  }
  if (!asked_at_ || now - *asked_at_ >= 1s) {
    asked_at_ = now;
    if (auto addresses = own_addresses_()) {
      own_ = std::move(*addresses);
    }
  }
  return std::ranges::find(own_, address) != own_.end();
}

}  // namespace nodmap::bus
