// SPDX-License-Identifier: BSD-3-Clause
// Measures the latency of bytes through a pseudo-terminal and through a pipe, with the kernel's
// workers at their normal and at raised priority. Prints one JSON object with times in
// microseconds: `wake_us` is how late the writer woke up, `us` the time from write to read.
// Exits 1 without the right to raise the workers. The measurements differ only on a busy machine:
//   for i in 1 2 3 4 5 6; do while :; do :; done & done; nodmap-bench-serial 20
#include <fcntl.h>
#include <sched.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "common/node/serial_workers.hpp"
#include "common/statistics/quantile.hpp"

namespace nodmap {
namespace {

using Clock = std::chrono::steady_clock;
using Latencies = std::vector<double>;  // microseconds

constexpr std::chrono::milliseconds kPeriod{5};  // of the servo's telemetry
// Priorities as in procman/sim.pmd: the simulated device (writer) above its driver.
constexpr int kWriterPriority = 30;
constexpr int kReaderPriority = 20;

struct Line {
  int write_fd = -1;
  int read_fd = -1;
};

Line open_pipe() {
  std::array<int, 2> fds{};
  if (::pipe(fds.data()) != 0) {
    throw std::runtime_error("cannot make a pipe");
  }
  return {fds[1], fds[0]};
}

Line open_pseudo_terminal() {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0) {
    throw std::runtime_error("cannot make a pseudo-terminal");
  }
  const int slave = ::open(::ptsname(master), O_RDWR | O_NOCTTY);
  termios raw{};
  if (slave < 0 || ::tcgetattr(slave, &raw) != 0) {
    throw std::runtime_error("cannot open the pseudo-terminal");
  }
  ::cfmakeraw(&raw);
  ::tcsetattr(slave, TCSANOW, &raw);
  return {master, slave};
}

void run_in_real_time(int priority) {
  const sched_param param{priority};
  if (::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &param) != 0) {
    throw std::runtime_error("needs the right to real-time priority");
  }
}

double us_since(Clock::time_point before) {
  return std::chrono::duration<double, std::micro>(Clock::now() - before).count();
}

nlohmann::json summary(const Latencies& latencies_us) {
  using statistics::quantile;
  return {{"p50", quantile(latencies_us, 0.50)},
          {"p99", quantile(latencies_us, 0.99)},
          {"worst", quantile(latencies_us, 1.0)}};
}

// Writes the current time once each period, from which the reader computes the latency.
void write_stamps(int fd, int count, Latencies& late_us) {
  run_in_real_time(kWriterPriority);
  Clock::time_point due = Clock::now();
  for (int i = 0; i < count; ++i) {
    due += kPeriod;
    std::this_thread::sleep_until(due);
    late_us.push_back(us_since(due));
    const Clock::time_point now = Clock::now();
    if (::write(fd, &now, sizeof now) != sizeof now) {
      std::cerr << "cannot write\n";
      std::exit(1);
    }
  }
}

nlohmann::json measure(const Line& line, int seconds) {
  const int count = static_cast<int>(std::chrono::seconds(seconds) / kPeriod);
  Latencies late_us;
  Latencies latencies_us;
  std::thread writer([&] { write_stamps(line.write_fd, count, late_us); });
  std::thread reader([&] {
    run_in_real_time(kReaderPriority);
    for (int i = 0; i < count; ++i) {
      Clock::time_point written;
      std::size_t size = 0;
      while (size < sizeof written) {
        const ssize_t more =
            ::read(line.read_fd, reinterpret_cast<char*>(&written) + size, sizeof written - size);
        if (more <= 0) {
          std::cerr << "cannot read\n";
          std::exit(1);
        }
        size += static_cast<std::size_t>(more);
      }
      latencies_us.push_back(us_since(written));
    }
  });
  writer.join();
  reader.join();
  ::close(line.write_fd);
  ::close(line.read_fd);
  return {{"wake_us", summary(late_us)}, {"us", summary(latencies_us)}};
}

}  // namespace
}  // namespace nodmap

int main(int argc, char** argv) {
  CLI::App app("Measures how late bytes of a pipe and of a pseudo-terminal arrive.");
  int seconds = 0;
  app.add_option("SECONDS", seconds, "duration of each measurement")
      ->required()
      ->check(CLI::Range(1, 3600));
  CLI11_PARSE(app, argc, argv);
  nlohmann::json result;
  result["pipe"] = nodmap::measure(nodmap::open_pipe(), seconds);
  result["pseudo_terminal"] = nodmap::measure(nodmap::open_pseudo_terminal(), seconds);
  nodmap::node::SerialWorkers workers;
  const bool raised = workers.raise();
  if (raised) {
    result["pseudo_terminal_raised_workers"] =
        nodmap::measure(nodmap::open_pseudo_terminal(), seconds);
  } else {
    std::cerr << "no right to raise the kernel's workers: the third measurement is left out\n";
  }
  std::cout << result.dump(2) << "\n";
  return raised ? 0 : 1;
}
