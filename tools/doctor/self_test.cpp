// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/self_test.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <system_error>

#include "common/bus/live_bus.hpp"

namespace nodmap::doctor {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

// Additional time for the other process, also on a busy machine: start, LCM's own set-up, end.
constexpr milliseconds kGrace = 3s;
constexpr const char* kChannel = "NODMAP_DOCTOR";
constexpr const char* kLcmProbe = "LCM_SELF_TEST";  // sent by every process when it subscribes

double ms_since(SteadyClock::time_point start) {
  return std::chrono::duration<double, std::milli>(SteadyClock::now() - start).count();
}

SelfTest listen_and_send(const std::string& url, milliseconds duration) {
  SelfTest test;
  bus::LiveBus bus(url);
  test.opened = true;
  const std::string text = "nodmap-doctor " + std::to_string(::getpid());
  const auto own = std::as_bytes(std::span(text));
  const auto start = SteadyClock::now();
  bus.subscribe_all(
      [&](const bus::LiveBus::RawMessage& message) {
        if (message.channel == kChannel) {
          if (std::ranges::equal(message.data, own) && !test.latency_ms) {
            test.latency_ms = ms_since(start);
          }
          return;
        }
        if (message.channel == kLcmProbe) {
          return;
        }
        const std::int64_t fingerprint = bus::fingerprint_of(message.data);
        auto known = std::ranges::find_if(test.received, [&](const ReceivedChannel& other) {
          return other.channel == message.channel && other.fingerprint == fingerprint;
        });
        if (known == test.received.end()) {
          known = test.received.insert(known, {message.channel, fingerprint, 0});
        }
        ++known->count;
      },
      10'000);
  bus.publish_bytes(kChannel, own);
  while (ms_since(start) < static_cast<double>(duration.count())) {
    bus.handle(milliseconds(20));
  }
  return test;
}

std::string to_text(const SelfTest& test) {
  nlohmann::json received = nlohmann::json::array();
  for (const ReceivedChannel& channel : test.received) {
    received.push_back({channel.channel, channel.fingerprint, channel.count});
  }
  // A negative time means none. Channel names are bytes from the network and may be invalid UTF-8.
  return nlohmann::json{{"latency_ms", test.latency_ms.value_or(-1.0)}, {"received", received}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

SelfTest from_text(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) {
    return {};
  }
  SelfTest test;
  test.opened = true;
  if (json["latency_ms"] >= 0.0) {
    test.latency_ms = json["latency_ms"].get<double>();
  }
  for (const nlohmann::json& row : json["received"]) {
    test.received.push_back({row[0], row[1], row[2]});
  }
  return test;
}

[[noreturn]] void be_the_child(const std::string& url, milliseconds duration, int result_fd) {
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(nowhere, STDERR_FILENO);
  try {
    const std::string text = to_text(listen_and_send(url, duration));
    const ssize_t written = ::write(result_fd, text.data(), text.size());
    ::_exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
  } catch (const std::exception&) {
    ::_exit(1);  // no output: LCM could not be opened
  }
}

std::string read_all(int fd, milliseconds timeout) {
  const auto deadline = SteadyClock::now() + timeout;
  std::string text;
  std::array<char, 4096> buffer{};
  struct pollfd waiting {
    fd, POLLIN, 0
  };
  while (true) {
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - SteadyClock::now());
    const bool is_ready =
        left.count() > 0 && ::poll(&waiting, 1, static_cast<int>(left.count())) > 0;
    const ssize_t size = is_ready ? ::read(fd, buffer.data(), buffer.size()) : 0;
    if (size <= 0) {
      return text;
    }
    text.append(buffer.data(), static_cast<std::size_t>(size));
  }
}

}  // namespace

SelfTest run_self_test(const std::string& url, milliseconds duration) {
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) {
    throw std::system_error(errno, std::system_category(), "pipe");
  }
  const pid_t child = ::fork();
  if (child < 0) {
    throw std::system_error(errno, std::system_category(), "fork");
  }
  if (child == 0) {
    be_the_child(url, duration, pipe[1]);
  }
  ::close(pipe[1]);
  const std::string text = read_all(pipe[0], duration + kGrace);
  ::close(pipe[0]);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  return from_text(text);
}

}  // namespace nodmap::doctor
