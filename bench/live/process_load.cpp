// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/process_load.hpp"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "procman/deputy/process_table.hpp"

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

std::optional<ProcessLoad> read_load(pid_t pid) {
  const auto row = procman::read_process(pid);
  if (!row) {
    return std::nullopt;
  }
  constexpr double kMib = 1024.0 * 1024.0;
  return ProcessLoad{
      static_cast<double>(row->cpu_ticks) / static_cast<double>(::sysconf(_SC_CLK_TCK)),
      static_cast<double>(row->rss_pages) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / kMib};
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
