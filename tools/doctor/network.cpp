// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/network.hpp"

#include <net/if.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "common/bus/trusted_hosts.hpp"
#include "tools/doctor/channel_loads.hpp"

namespace nodmap::doctor {
namespace {

constexpr const char* kLoopbackRoute =
    "sudo ip link set lo multicast on; sudo ip route add 224.0.0.0/4 dev lo";

template <class Number>
std::optional<Number> parse(std::string_view text, int base) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

std::vector<std::vector<std::string>> words_by_line(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<std::string> split;
    for (std::string word; words >> word;) {
      split.push_back(word);
    }
    lines.push_back(std::move(split));
  }
  return lines;
}

struct Route {
  std::string interface;
  int prefix_bits = 0;
};

// The most specific route to the address that is up and not a reject route.
std::optional<Route> route_to(const std::array<std::uint8_t, 4>& address,
                              const std::string& proc_net_route) {
  constexpr unsigned int kUp = 0x0001;      // RTF_UP and
  constexpr unsigned int kReject = 0x0200;  // RTF_REJECT of linux/route.h
  // The kernel prints addresses as words in the host's byte order.
  const auto wanted = std::bit_cast<std::uint32_t>(address);
  std::optional<Route> best;
  for (const std::vector<std::string>& words : words_by_line(proc_net_route)) {
    if (words.size() < 8) {
      continue;
    }
    const auto destination = parse<std::uint32_t>(words[1], 16);
    const auto flags = parse<unsigned int>(words[3], 16);
    const auto mask = parse<std::uint32_t>(words[7], 16);
    if (!destination || !flags || !mask || (wanted & *mask) != *destination ||
        (*flags & (kUp | kReject)) != kUp) {
      continue;
    }
    const int prefix_bits = std::popcount(*mask);
    if (!best || prefix_bits > best->prefix_bits) {
      best = Route{words[0], prefix_bits};
    }
  }
  return best;
}

std::string megabytes(std::int64_t bytes) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f MB", 1e-6 * static_cast<double>(bytes));
  return text.data();
}

std::string set_sysctl(const std::string& key, std::int64_t value) {
  const std::string assignment = "net.core." + key + "=" + std::to_string(value);
  return "echo " + assignment + " | sudo tee -a /etc/sysctl.d/60-nodmap.conf; sudo sysctl -w " +
         assignment;
}

Finding check_rmem(const std::string& key, const std::string& text, const std::string& who) {
  const std::string trimmed = text.substr(0, text.find_last_not_of(" \n") + 1);
  const auto value = parse<std::int64_t>(trimmed, 10);
  if (!value) {
    return {key, Status::kWarn, "net.core." + key + " cannot be read.", ""};
  }
  // The proposed size has a reserve, and is a power of two.
  const auto proposed =
      static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(full_buffer_bytes())));
  const std::string is = "net.core." + key + " is " + megabytes(*value) + ", " + who;
  if (*value < steady_buffer_bytes()) {
    return {key, Status::kFail,
            is + ": too small for " + std::to_string(kStallMs) + " ms of our channels (" +
                megabytes(steady_buffer_bytes()) + ").",
            set_sysctl(key, proposed)};
  }
  if (*value < full_buffer_bytes()) {
    return {key, Status::kWarn,
            is + ": too small if a cloud and a map arrive at once (" +
                megabytes(full_buffer_bytes()) + ").",
            set_sysctl(key, proposed)};
  }
  return {key, Status::kOk, is + ".", ""};
}

std::string owner_of(const UdpSocket& socket, const std::map<std::uint64_t, std::string>& owners) {
  const auto found = owners.find(socket.inode);
  return found != owners.end() ? found->second : "a process of another user";
}

bool speaks_lcm(const std::string& process) {
  return process.starts_with("nodmap-") || process.starts_with("lcm-") ||
         process.starts_with("java");
}

std::string join(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

std::string use_next_port(const bus::UdpmUrl& url) {
  const int next = url.port == 65535 ? 7668 : url.port + 1;
  return "export LCM_DEFAULT_URL='udpm://" + url.group_text() + ":" + std::to_string(next) +
         "?ttl=" + std::to_string(url.ttl) + "'";
}

}  // namespace

Finding check_multicast_route(const std::string& proc_net_route, const bus::UdpmUrl& url,
                              const std::map<std::string, unsigned int>& interface_flags) {
  const std::string check = "multicast route";
  const std::optional<Route> route = route_to(url.group, proc_net_route);
  if (!route) {
    return {check, Status::kFail, "There is no route to " + url.group_text() + ".", kLoopbackRoute};
  }
  const std::string way = url.group_text() + " goes over " + route->interface;
  const auto found = interface_flags.find(route->interface);
  const unsigned int flags = found != interface_flags.end() ? found->second : 0;
  if ((flags & IFF_UP) == 0) {
    return {check, Status::kFail, way + ", which is down.",
            "sudo ip link set " + route->interface + " up"};
  }
  // The loopback carries multicast even without the flag.
  if ((flags & (IFF_MULTICAST | IFF_LOOPBACK)) == 0) {
    return {check, Status::kFail, way + ", which does not carry multicast.",
            "sudo ip link set " + route->interface + " multicast on"};
  }
  if (route->prefix_bits == 0) {
    return {check, Status::kWarn,
            way + " by the default route: LCM stops working when that network is disconnected.",
            kLoopbackRoute};
  }
  return {check, Status::kOk, way + ".", ""};
}

Finding check_rmem_default(const std::string& text) {
  return check_rmem("rmem_default", text, "the default size of a socket's buffer");
}

Finding check_rmem_max(const std::string& text) {
  return check_rmem("rmem_max", text, "the limit for recv_buf_size in the LCM URL");
}

std::vector<UdpSocket> parse_udp_sockets(const std::string& proc_net_udp) {
  std::vector<UdpSocket> sockets;
  for (const std::vector<std::string>& words : words_by_line(proc_net_udp)) {
    constexpr std::size_t kNumColumns = 13;
    if (words.size() < kNumColumns) {
      continue;
    }
    const auto port = parse<std::uint16_t>(
        std::string_view(words[1]).substr(std::min(words[1].size(), words[1].find(':') + 1)), 16);
    const auto inode = parse<std::uint64_t>(words[9], 10);
    const auto drops = parse<std::int64_t>(words[12], 10);
    if (port && inode && drops) {
      sockets.push_back({*port, *inode, *drops});
    }
  }
  return sockets;
}

Finding check_port_users(const std::vector<UdpSocket>& sockets,
                         const std::map<std::uint64_t, std::string>& owners, std::uint16_t port) {
  std::set<std::string> ours;
  std::set<std::string> others;
  for (const UdpSocket& socket : sockets) {
    if (socket.port == port) {
      const std::string owner = owner_of(socket, owners);
      (speaks_lcm(owner) ? ours : others).insert(owner);
    }
  }
  const std::string where = "port " + std::to_string(port);
  if (!others.empty()) {
    return {"port", Status::kWarn, "On " + where + " there is also " + join(others) + ".",
            "sudo ss -uanp sport = :" + std::to_string(port)};
  }
  return {"port", Status::kOk,
          ours.empty() ? "No process listens on " + where + " yet."
                       : "On " + where + ": " + join(ours) + ".",
          ""};
}

Finding check_drops(const std::vector<UdpSocket>& sockets,
                    const std::map<std::uint64_t, std::string>& owners, std::uint16_t port) {
  std::int64_t total = 0;
  std::set<std::string> losers;
  for (const UdpSocket& socket : sockets) {
    if (socket.port == port && socket.drops > 0) {
      total += socket.drops;
      losers.insert(owner_of(socket, owners));
    }
  }
  if (total == 0) {
    return {"drops", Status::kOk, "No socket on the port has lost a datagram.", ""};
  }
  return {"drops", Status::kWarn,
          std::to_string(total) +
              " datagrams were dropped because the buffer was full: " + join(losers) + ".",
          set_sysctl("rmem_default", static_cast<std::int64_t>(std::bit_ceil(
                                         static_cast<std::uint64_t>(full_buffer_bytes()))))};
}

Finding check_self_test(const SelfTest& test, const std::string& url) {
  const std::string check = "LCM self test";
  if (!test.opened) {
    return {check, Status::kFail, "LCM cannot use " + url + ".",
            bus::parse_udpm_url(url) ? kLoopbackRoute
                                     : "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'"};
  }
  if (!test.latency_ms) {
    return {check, Status::kFail, "A message sent on " + url + " was not received within a second.",
            "sudo iptables -L INPUT -n  # a firewall? Let 224.0.0.0/4 pass"};
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "was received after %.1f ms.", *test.latency_ms);
  return {check, Status::kOk, "A message sent on " + url + " " + text.data(), ""};
}

Finding check_traffic(const std::vector<ReceivedChannel>& received,
                      const std::set<std::int64_t>& our_fingerprints, const bus::UdpmUrl& url) {
  std::int64_t num_ours = 0;
  std::int64_t num_foreign = 0;
  std::set<std::string> foreign;
  for (const ReceivedChannel& channel : received) {
    if (our_fingerprints.contains(channel.fingerprint)) {
      num_ours += channel.count;
    } else {
      num_foreign += channel.count;
      foreign.insert(channel.channel);
    }
  }
  if (num_foreign > 0) {
    return {"traffic", Status::kWarn,
            std::to_string(num_foreign) +
                " messages of foreign types were received within a second on " + join(foreign) +
                ".",
            use_next_port(url)};
  }
  return {"traffic", Status::kOk,
          num_ours > 0 ? std::to_string(num_ours) +
                             " messages were received within a second, all of nodmap's types."
                       : "The port is silent.",
          ""};
}

Finding check_silence(const std::vector<ReceivedChannel>& received, const bus::UdpmUrl& url) {
  std::set<std::string> channels;
  for (const ReceivedChannel& channel : received) {
    channels.insert(channel.channel);
  }
  const std::string port = "port " + std::to_string(url.port);
  if (channels.empty()) {
    return {"silence", Status::kOk, "Nobody sends on " + port + ".", ""};
  }
  return {"silence", Status::kFail, "Others send on " + port + ": " + join(channels) + ".",
          use_next_port(url)};
}

Finding check_trusted_hosts(const std::string& trusted_hosts, const bus::UdpmUrl& url) {
  const std::string check = "trusted hosts";
  const std::string name_them =
      "export NODMAP_TRUSTED_HOSTS=10.0.0.2  # the other hosts' addresses";
  try {
    bus::TrustedHosts hosts(trusted_hosts, [] { return std::vector<std::uint32_t>(); });
    constexpr std::uint32_t kOfNobody = 0xC0000201;  // 192.0.2.1, reserved for documentation
    if (hosts.contains(kOfNobody, {})) {
      return {check, Status::kWarn, "Messages of any host are accepted.", name_them};
    }
  } catch (const std::runtime_error& error) {
    return {check, Status::kFail, error.what(), name_them};
  }
  if (!trusted_hosts.empty()) {
    return {check, Status::kOk, "Messages of this host and of " + trusted_hosts + " are accepted.",
            ""};
  }
  if (url.ttl > 0) {
    return {check, Status::kWarn,
            "ttl=" + std::to_string(url.ttl) +
                " sends to other hosts, but only messages of this host are accepted.",
            name_them};
  }
  return {check, Status::kOk, "Only messages of this host are accepted.", ""};
}

}  // namespace nodmap::doctor
