// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/probe.hpp"

#include <ifaddrs.h>
#include <pthread.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>
#include <thread>

namespace nodmap::doctor {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& file) {
  const std::string text = read_text(file).value_or("");
  return text.substr(0, text.find('\n'));
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

// The inode in "socket:[12345]".
std::optional<std::uint64_t> socket_inode(const std::string& link) {
  const std::string prefix = "socket:[";
  std::uint64_t inode = 0;
  if (!link.starts_with(prefix) ||
      std::from_chars(link.data() + prefix.size(), link.data() + link.size(), inode).ec !=
          std::errc()) {
    return std::nullopt;
  }
  return inode;
}

}  // namespace

std::optional<std::string> read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    return std::nullopt;
  }
  std::ostringstream text;
  text << in.rdbuf();  // an iterator would throw if a process ends while its file is read
  return text.str();
}

std::map<std::string, unsigned int> interface_flags() {
  std::map<std::string, unsigned int> flags;
  ifaddrs* interfaces = nullptr;
  if (::getifaddrs(&interfaces) == 0) {
    for (const ifaddrs* each = interfaces; each != nullptr; each = each->ifa_next) {
      flags[each->ifa_name] = each->ifa_flags;
    }
    ::freeifaddrs(interfaces);
  }
  return flags;
}

std::map<std::uint64_t, std::string> socket_owners() {
  std::map<std::uint64_t, std::string> owners;
  std::error_code error;
  for (const auto& process : fs::directory_iterator("/proc", error)) {
    const std::string pid = process.path().filename();
    if (!is_number(pid)) {
      continue;
    }
    // Errors are ignored: processes may end meanwhile, and most belong to other users.
    std::error_code not_ours;
    for (fs::directory_iterator fd(process.path() / "fd", not_ours), end; !not_ours && fd != end;
         fd.increment(not_ours)) {
      std::error_code vanished;
      if (const auto inode = socket_inode(fs::read_symlink(fd->path(), vanished).string())) {
        owners[*inode] = first_line(process.path() / "comm") + " (" + pid + ")";
      }
    }
  }
  return owners;
}

std::optional<fs::path> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): one thread
  std::istringstream dirs(path != nullptr ? path : "");
  for (std::string dir; std::getline(dirs, dir, ':');) {
    const fs::path file = fs::path(dir) / name;
    if (::access(file.c_str(), X_OK) == 0) {
      return file;
    }
  }
  return std::nullopt;
}

std::int64_t available_bytes(fs::path dir) {
  dir = fs::absolute(dir);
  std::error_code error;
  while (!fs::is_directory(dir, error) && dir.has_relative_path()) {
    dir = dir.parent_path();
  }
  const fs::space_info space = fs::space(dir, error);
  return error ? 0 : static_cast<std::int64_t>(space.available);
}

bool clock_is_synchronized() {
  struct timex state {};
  const int result = ::adjtimex(&state);  // modes 0: only queries
  return result != -1 && result != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

bool realtime_is_permitted() {
  bool is_permitted = false;
  // In a thread of its own, so that the priority ends with it.
  std::thread([&is_permitted] {
    const sched_param highest{30};
    is_permitted = ::pthread_setschedparam(::pthread_self(), SCHED_RR, &highest) == 0;
  }).join();
  return is_permitted;
}

}  // namespace nodmap::doctor
