// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/process_table.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <memory>
#include <set>

#include "common/formats/file_descriptor.hpp"

namespace nodmap::procman {
namespace {

// Fields of proc_pid_stat(5), counted from the one after the name.
enum Field : std::size_t {
  kState = 0,
  kParent = 1,
  kSession = 3,
  kUserTicks = 11,
  kSystemTicks = 12,
  kStartTicks = 19,
  kVsize = 20,
  kRss = 21,
  kNumFields = 22
};

template <class Number>
bool read_number(std::string_view text, Number& value) {
  return std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc();
}

std::string read_whole(const std::string& file) {
  const formats::FileDescriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  std::string text;
  std::array<char, 4096> buffer{};
  ssize_t size = 0;
  while (in.is_open() && (size = ::read(in.get(), buffer.data(), buffer.size())) > 0) {
    text.append(buffer.data(), static_cast<std::size_t>(size));
  }
  return text;
}

std::string proc_file(pid_t pid, const char* name) {
  return "/proc/" + std::to_string(pid) + "/" + name;
}

}  // namespace

std::optional<ProcessRow> parse_process(std::string_view stat) {
  // The name is in parentheses, and may itself contain blanks and parentheses.
  const std::size_t name_end = stat.rfind(')');
  if (name_end == std::string_view::npos || name_end + 2 > stat.size()) {
    return std::nullopt;
  }
  std::array<std::string_view, kNumFields> fields;
  std::size_t count = 0;
  std::string_view rest = stat.substr(name_end + 2);
  while (count < kNumFields && !rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    fields.at(count++) = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  ProcessRow row;
  std::uint64_t user = 0;
  std::uint64_t system = 0;
  if (count < kNumFields || fields[kState].size() != 1 || !read_number(stat, row.pid) ||
      !read_number(fields[kParent], row.parent) || !read_number(fields[kSession], row.session) ||
      !read_number(fields[kUserTicks], user) || !read_number(fields[kSystemTicks], system) ||
      !read_number(fields[kStartTicks], row.start_ticks) ||
      !read_number(fields[kVsize], row.vsize_bytes) || !read_number(fields[kRss], row.rss_pages)) {
    return std::nullopt;
  }
  row.state = fields[kState][0];
  row.cpu_ticks = user + system;
  return row;
}

std::optional<ProcessRow> read_process(pid_t pid) {
  return parse_process(read_whole(proc_file(pid, "stat")));
}

std::vector<ProcessRow> read_processes() {
  std::vector<ProcessRow> table;
  const std::unique_ptr<DIR, int (*)(DIR*)> dir(::opendir("/proc"), &::closedir);
  while (const dirent* entry = dir ? ::readdir(dir.get()) : nullptr) {
    pid_t pid = 0;
    if (!read_number(std::string_view(entry->d_name), pid)) {
      continue;
    }
    if (const std::optional<ProcessRow> row = read_process(pid)) {
      table.push_back(*row);
    }
  }
  return table;
}

std::optional<std::string> variable_of(pid_t pid, std::string_view name) {
  const std::string environment = read_whole(proc_file(pid, "environ"));
  std::string_view rest = environment;
  while (!rest.empty()) {
    const std::string_view variable = rest.substr(0, rest.find('\0'));
    if (variable.size() > name.size() && variable.starts_with(name) &&
        variable[name.size()] == '=') {
      return std::string(variable.substr(name.size() + 1));
    }
    rest.remove_prefix(std::min(variable.size() + 1, rest.size()));
  }
  return std::nullopt;
}

bool has_environment(pid_t pid) {
  return !read_whole(proc_file(pid, "environ")).empty();
}

std::vector<pid_t> tree_of(std::span<const ProcessRow> table,
                           const std::function<bool(const ProcessRow&)>& is_root) {
  std::set<pid_t> members;
  for (const ProcessRow& row : table) {
    if (is_root(row)) {
      members.insert(row.pid);
    }
  }
  // The table does not list parents first, so repeat until nothing is added.
  for (bool grows = !members.empty(); grows;) {
    grows = false;
    for (const ProcessRow& row : table) {
      grows |= members.contains(row.parent) && members.insert(row.pid).second;
    }
  }
  std::vector<pid_t> living;
  for (const ProcessRow& row : table) {
    if (members.contains(row.pid) && !row.is_dead()) {
      living.push_back(row.pid);
    }
  }
  return living;
}

}  // namespace nodmap::procman
