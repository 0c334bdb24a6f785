// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/process_load.hpp"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <vector>

namespace nodmap::bench {
namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) {
    words.push_back(word);
  }
  return words;
}

}  // namespace

std::optional<ProcessLoad> parse_load(const std::string& stat, double tick_s, double page_bytes) {
  // The second field is the name in parentheses; it may contain any character.
  const std::size_t name_end = stat.rfind(')');
  if (name_end == std::string::npos) {
    return std::nullopt;
  }
  // proc(5) counts fields from 1; the first word after the name is field 3.
  constexpr std::size_t kUserTime = 14 - 3;
  constexpr std::size_t kSystemTime = 15 - 3;
  constexpr std::size_t kResident = 24 - 3;
  const std::vector<std::string> words = words_of(stat.substr(name_end + 1));
  if (words.size() <= kResident) {
    return std::nullopt;
  }
  try {
    return ProcessLoad{tick_s * (std::stod(words[kUserTime]) + std::stod(words[kSystemTime])),
                       std::stod(words[kResident]) * page_bytes / (1024.0 * 1024.0)};
  } catch (const std::logic_error&) {
    return std::nullopt;
  }
}

std::optional<ProcessLoad> read_load(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string stat;
  std::getline(file, stat);
  return parse_load(stat, 1.0 / static_cast<double>(::sysconf(_SC_CLK_TCK)),
                    static_cast<double>(::sysconf(_SC_PAGESIZE)));
}

UdpQueues parse_udp_queues(std::istream& table) {
  // sl local remote state tx:rx timer retransmits uid timeout inode references pointer drops
  constexpr std::size_t kQueues = 4;
  constexpr std::size_t kDrops = 12;
  UdpQueues queues;
  for (std::string line; std::getline(table, line);) {
    const std::vector<std::string> words = words_of(line);
    if (words.size() <= kDrops || words[kQueues].find(':') == std::string::npos) {
      continue;
    }
    try {
      const std::string waiting = words[kQueues].substr(words[kQueues].find(':') + 1);
      const std::int64_t waiting_bytes = std::stoll(waiting, nullptr, 16);
      queues.dropped += std::stoll(words[kDrops]);
      queues.waiting_bytes += waiting_bytes;
    } catch (const std::logic_error&) {
      continue;
    }
  }
  return queues;
}

UdpQueues read_udp_queues() {
  std::ifstream table("/proc/net/udp");
  return parse_udp_queues(table);
}

}  // namespace nodmap::bench
