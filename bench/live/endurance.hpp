// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "bench/live/process_load.hpp"
#include "bench/live/robot_processes.hpp"
#include "bench/live/viewer_client.hpp"
#include "common/bus/live_bus.hpp"
#include "common/geometry/time.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/truth_t.hpp"
#include "tools/latency/reaction.hpp"

namespace nodmap::bench {

/// Runs the whole robot for a while and measures its reaction times, the CPU time and memory of its
/// processes, and whether anything grows (R47). The time after the warm-up is measured in two
/// halves; with `viewer`, nodmap-viewer and one client run in the second half only. A run of hours
/// that is ended early leaves what it measured: every ten minutes the report so far replaces
/// `report.json` in the folder of the logs, and one line on standard error summarises it.
class Endurance {
 public:
  struct Options {
    double duration_s = 600.0;
    double warm_up_s = 20.0;  ///< after the first reaction; both SLAMs build their first map
    bool viewer = false;
    bool any_timing = false;  ///< is_sound() ignores the reaction times (for a busy machine)
  };

  Endurance(const RobotProcesses::Options& robot, const Options& options);

  /// Runs the robot and returns the report. Throws std::runtime_error if a program cannot be
  /// started.
  [[nodiscard]] nlohmann::ordered_json run();

  /// After run(): whether every process exited with 0, nothing was hit, no message was lost, and
  /// the reaction times met the requirements.
  [[nodiscard]] bool is_sound() const;

 private:
  struct LoadSample {
    time::Timestamp at{};
    ProcessLoad load;
  };
  struct Process {
    std::vector<LoadSample> loads;
    nodmap::status_t first_status{};  ///< of the measured time
    nodmap::status_t last_status{};
    double slowest_p99_us = 0.0;
    std::int64_t times_not_ok = 0;  ///< STATUS with a health other than OK
    std::string last_health;        ///< the newest health other than OK
    [[nodiscard]] std::int64_t lost() const {
      return last_status.total_lost - first_status.total_lost;
    }
    [[nodiscard]] std::int64_t corrupt() const {
      return last_status.total_corrupt - first_status.total_corrupt;
    }
  };

  void on_message(const bus::LiveBus::RawMessage& message);
  void on_status(std::span<const std::byte> data);
  void on_truth(std::span<const std::byte> data);
  void sample_loads(const RobotProcesses& robot);
  void save_progress() const;
  void start_viewer(RobotProcesses& robot);
  /// Starting twelve processes takes long on a busy machine.
  void wait_for_first_reaction(bus::LiveBus& bus);
  [[nodiscard]] bool is_measured(time::Timestamp at) const;
  [[nodiscard]] bool is_anything_lost() const;
  [[nodiscard]] bool is_in_time(const std::vector<latency::Sample>& samples,
                                time::Duration target) const;
  [[nodiscard]] nlohmann::ordered_json report_reaction(const std::vector<latency::Sample>& samples,
                                                       time::Duration target) const;
  [[nodiscard]] static nlohmann::ordered_json cpu_percent(const Process& process,
                                                          time::Timestamp from, time::Timestamp to);
  [[nodiscard]] nlohmann::ordered_json report_process(const Process& process) const;
  [[nodiscard]] nlohmann::ordered_json report() const;

  RobotProcesses::Options robot_options_;
  Options options_;
  time::Timestamp begin_{};
  time::Timestamp half_{};
  time::Timestamp end_{};
  latency::Reaction reaction_;
  std::map<std::string, std::vector<latency::Sample>> lags_;  // by channel
  std::map<std::string, Process> processes_;
  std::vector<UdpQueues> udp_;
  nodmap::status_t status_{};
  nodmap::truth_t truth_{};
  std::int64_t collisions_ = 0;
  std::int64_t bumps_ = 0;
  double driven_m_ = 0.0;
  std::unique_ptr<ViewerClient> viewer_client_;
  std::int64_t viewer_messages_ = 0;
  std::int64_t viewer_bytes_ = 0;
  std::vector<std::string> ended_badly_;
};

}  // namespace nodmap::bench
