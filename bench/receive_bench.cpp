// SPDX-License-Identifier: BSD-3-Clause
// Measures the cost of receiving over LCM's multicast with our UdpmReceiver and with stock liblcm,
// in turn and with the same messages. Prints JSON: `*_cpu_us` is the CPU time of the process for
// each message, sending included, and `send_us` the CPU time of sending without a receiver. The
// exit code is 1 if one of the two has not handled all messages: what it lost cost it nothing.
// Needs a multicast route:
//   tests/support/private_network.sh nodmap-bench-receive
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/timing.hpp"
#include "common/bus/live_bus.hpp"

namespace nodmap {
namespace {

constexpr const char* kUrl = "udpm://239.255.76.67:7693?ttl=0&recv_buf_size=4000000";
constexpr const char* kChannel = "SCAN";
constexpr int kBurst = 20;  // these fit into a socket's buffer with the default rmem_max
constexpr int kQueue = 1000;
constexpr int kRounds = 10;

// CPU time (us) for each message. `handle_burst` is called after each burst.
template <class Handle>
double measure(lcm::LCM& sender, const std::vector<char>& message, int bursts,
               Handle handle_burst) {
  const double before_ms = bench::process_cpu_ms();
  for (int i = 0; i < bursts; ++i) {
    for (int k = 0; k < kBurst; ++k) {
      sender.publish(kChannel, message.data(), static_cast<unsigned int>(message.size()));
    }
    handle_burst();
  }
  return 1e3 * (bench::process_cpu_ms() - before_ms) / (bursts * kBurst);
}

class Stock {
 public:
  Stock() { lcm_.subscribe(kChannel, &Stock::take, this)->setQueueCapacity(kQueue); }
  void handle_burst() {
    for (const int end = count_ + kBurst; count_ < end && lcm_.handleTimeout(1000) > 0;) {
    }
  }
  [[nodiscard]] int count() const { return count_; }

 private:
  void take(const lcm::ReceiveBuffer*, const std::string&) { ++count_; }

  lcm::LCM lcm_{kUrl};
  int count_ = 0;
};

class Ours {
 public:
  Ours() {
    bus_.subscribe_bytes(
        kChannel, [this](std::span<const std::byte>) { ++count_; }, kQueue);
  }
  void handle_burst() {
    for (const int end = count_ + kBurst;
         count_ < end && bus_.handle(std::chrono::milliseconds(1000)) > 0;) {
    }
  }
  [[nodiscard]] int count() const { return count_; }

 private:
  bus::LiveBus bus_{kUrl};
  int count_ = 0;
};

nlohmann::json compare(std::size_t size, int bursts) {
  const std::vector<char> message(size);
  lcm::LCM sender(kUrl);
  double send_us = 0.0;
  double stock_us = 0.0;
  double ours_us = 0.0;
  int stock_count = 0;
  int ours_count = 0;
  for (int round = 0; round < kRounds; ++round) {
    send_us += measure(sender, message, bursts, [] {}) / kRounds;
    {
      Stock stock;
      stock_us += measure(sender, message, bursts, [&] { stock.handle_burst(); }) / kRounds;
      stock_count += stock.count();
    }
    Ours ours;
    ours_us += measure(sender, message, bursts, [&] { ours.handle_burst(); }) / kRounds;
    ours_count += ours.count();
  }
  return {{"bytes", size},
          {"sent", kRounds * bursts * kBurst},
          {"stock_handled", stock_count},
          {"ours_handled", ours_count},
          {"send_us", send_us},
          {"stock_cpu_us", stock_us},
          {"ours_cpu_us", ours_us},
          {"receive_ratio", (ours_us - send_us) / (stock_us - send_us)}};
}

}  // namespace
}  // namespace nodmap

int main(int argc, char** argv) {
  CLI::App app("Compares how long our receiver and LCM's take for bursts of messages.");
  CLI11_PARSE(app, argc, argv);
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [size, bursts] :
       {std::pair<std::size_t, int>{200, 500}, {900, 500}, {7300, 200}}) {
    rows.push_back(nodmap::compare(size, bursts));
  }
  std::cout << rows.dump(2) << "\n";
  const bool all_handled = std::ranges::all_of(rows, [](const auto& row) {
    return row["ours_handled"] == row["sent"] && row["stock_handled"] == row["sent"];
  });
  return all_handled ? 0 : 1;
}
