// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/access.hpp"

#include <array>
#include <random>

namespace nodmap::viewer {
namespace {

constexpr std::array<std::string_view, 2> kProtocols{"foxglove.websocket.v1", "foxglove.sdk.v1"};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  const std::size_t last = text.find_last_not_of(" \t");
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, last - first + 1);
}

// The host of "host:port" or "[::1]:port".
std::string_view without_port(std::string_view host) {
  const std::size_t from = host.starts_with('[') ? host.find(']') : 0;
  return from == std::string_view::npos ? host : host.substr(0, host.find(':', from));
}

// The value of the parameter `token` in a query.
std::string_view token_in(std::string_view target) {
  constexpr std::string_view kKey = "token=";
  std::string_view query = target.substr(std::min(target.find('?'), target.size()));
  while (!query.empty()) {
    query.remove_prefix(1);  // '?' or '&'
    const std::string_view item = query.substr(0, query.find('&'));
    if (item.starts_with(kKey)) {
      return item.substr(kKey.size());
    }
    query.remove_prefix(item.size());
  }
  return {};
}

// Compares in a time that does not depend on where the first difference is.
bool equal_in_constant_time(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |=
        static_cast<unsigned char>(a[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(b[i]));
  }
  return difference == 0U;
}

bool is_ours(const Request& request) {
  return request.origin.empty() || request.origin == "http://" + request.host ||
         request.origin == "https://" + request.host;  // behind a proxy that does TLS
}

}  // namespace

bool is_this_host(std::string_view host) {
  const std::string_view name = without_port(host);
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]";
}

std::optional<std::string> choose_protocol(std::string_view offered) {
  while (!offered.empty()) {
    const std::string_view item = offered.substr(0, offered.find(','));
    for (const std::string_view known : kProtocols) {
      if (trimmed(item) == known) {
        return std::string(known);
      }
    }
    offered.remove_prefix(std::min(item.size() + 1, offered.size()));
  }
  return std::nullopt;
}

Access decide_access(const Request& request, const AccessPolicy& policy) {
  Access access;
  if (policy.loopback_only && !is_this_host(request.host)) {
    access.refusal = Refusal::kHost;
    return access;
  }
  const auto protocol = choose_protocol(request.protocols);
  if (!protocol) {
    access.refusal = Refusal::kProtocol;
    return access;
  }
  access.protocol = *protocol;
  access.rights.may_play = is_ours(request);
  const std::string_view token = token_in(request.target);
  if (token.empty()) {
    return access;
  }
  if (policy.token.empty() || !is_ours(request) || !equal_in_constant_time(token, policy.token)) {
    access.refusal = Refusal::kToken;
    return access;
  }
  access.rights.may_control = true;
  return access;
}

std::string make_token() {
  std::random_device random;  // random numbers of the operating system
  constexpr char kDigits[] = "0123456789abcdef";
  std::string token;
  for (int i = 0; i < 32; ++i) {
    token.push_back(kDigits[random() & 15U]);
  }
  return token;
}

}  // namespace nodmap::viewer
