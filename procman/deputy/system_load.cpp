// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/system_load.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

namespace nodmap::procman {
namespace {

std::string read_text(const char* file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Removes blanks and a number from the front of `text`; returns the number.
std::optional<std::uint64_t> take_number(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) {
    return std::nullopt;
  }
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

}  // namespace

std::int64_t parse_memory_bytes(std::string_view meminfo, std::string_view name) {
  std::size_t at = 0;
  while (at < meminfo.size()) {
    std::string_view line = meminfo.substr(at, meminfo.find('\n', at) - at);
    at += line.size() + 1;
    if (line.starts_with(name) && line.size() > name.size() && line[name.size()] == ':') {
      line.remove_prefix(name.size() + 1);
      return static_cast<std::int64_t>(take_number(line).value_or(0)) * 1024;
    }
  }
  return 0;
}

void SystemLoad::sample(const std::vector<pid_t>& pids) {
  const std::string meminfo = read_text("/proc/meminfo");
  memory_ = {.total_bytes = parse_memory_bytes(meminfo, "MemTotal"),
             .free_bytes = parse_memory_bytes(meminfo, "MemFree"),
             .swap_total_bytes = parse_memory_bytes(meminfo, "SwapTotal"),
             .swap_free_bytes = parse_memory_bytes(meminfo, "SwapFree")};
  cpu_.sample();
  std::vector<Usage> usages;
  const std::int64_t page_bytes = ::sysconf(_SC_PAGESIZE);
  for (const pid_t pid : pids) {
    const std::optional<ProcessRow> row = read_process(pid);
    if (!row) {
      continue;
    }
    Usage usage{pid,  row->start_ticks, row->cpu_ticks,
                0.0F, row->vsize_bytes, row->rss_pages * page_bytes};
    const Usage* before = find(pid);
    if (before != nullptr && before->start_ticks == row->start_ticks) {
      usage.share = node::share_of(row->cpu_ticks - before->cpu_ticks, cpu_.elapsed_ticks());
    }
    usages.push_back(usage);
  }
  usages_ = std::move(usages);
}

const SystemLoad::Usage* SystemLoad::find(pid_t pid) const {
  const auto found = std::ranges::find(usages_, pid, &Usage::pid);
  return found == usages_.end() ? nullptr : &*found;
}

void SystemLoad::describe_host(DeputyInfo& info) const {
  info.cpu_load = cpu_.share();
  info.memory = memory_;
}

void SystemLoad::describe_process(CommandStatus& status) const {
  const Usage* usage = status.pid != 0 ? find(status.pid) : nullptr;
  if (usage != nullptr) {
    status.cpu_share = usage->share;
    status.vsize_bytes = usage->vsize_bytes;
    status.rss_bytes = usage->rss_bytes;
  }
}

}  // namespace nodmap::procman
