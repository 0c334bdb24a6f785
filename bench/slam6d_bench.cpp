// SPDX-License-Identifier: BSD-3-Clause
// Measures how long 6D SLAM blocks the handling of messages: the CPU time of the handling thread
// for each SCAN of a recording. Prints one JSON object, times in ms.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "common/bus/replay_bus.hpp"
#include "common/statistics/quantile.hpp"
#include "modules/slam6d/node.hpp"

namespace nodmap::slam6d {
namespace {

std::vector<double> scan_durations_ms(const std::filesystem::path& log) {
  const std::filesystem::path out_log =
      std::filesystem::temp_directory_path() / ("slam6d_bench." + std::to_string(getpid()));
  bus::ReplayBus bus(log, out_log);
  std::filesystem::remove(out_log);  // published messages are discarded
  node::MessageCounts counts;
  node::Context context{bus, counts, {}};
  bool is_scan = false;
  bus.subscribe_bytes("SCAN", [&is_scan](std::span<const std::byte>) { is_scan = true; });
  Slam6dNode slam(context, {});
  std::vector<double> durations_ms;
  for (bool goes_on = true; goes_on;) {
    is_scan = false;
    const double start_ms = bench::thread_cpu_ms();
    goes_on = bus.step();
    if (is_scan) {
      durations_ms.push_back(bench::thread_cpu_ms() - start_ms);
    }
  }
  slam.finish();
  return durations_ms;
}

}  // namespace
}  // namespace nodmap::slam6d

int main(int argc, char** argv) {
  CLI::App app{"Measures the CPU time of 6D SLAM for each SCAN of a recording."};
  std::string log;
  app.add_option("LOG", log, "LCM event log")->required()->check(CLI::ExistingFile);
  CLI11_PARSE(app, argc, argv);
  const std::vector<double> durations_ms = nodmap::slam6d::scan_durations_ms(log);
  if (durations_ms.empty()) {
    std::fputs("no SCAN in the log\n", stderr);
    return 1;
  }
  using nodmap::statistics::quantile;
  const nlohmann::json metrics{{"scans", durations_ms.size()},
                               {"p50_ms", quantile(durations_ms, 0.50)},
                               {"p99_ms", quantile(durations_ms, 0.99)},
                               {"max_ms", quantile(durations_ms, 1.0)}};
  std::puts(metrics.dump(2).c_str());
}
