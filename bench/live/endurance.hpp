// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/// The whole robot at work for a while: how fast it reacts, what its processes take, and whether
/// anything grows (R47). Measured from the end of the warm-up on, in two halves; with `viewer`,
/// nodmap-viewer with one client takes part in the second half only.
class Endurance {
 public:
  struct Options {
    double duration_s = 600.0;
    double warm_up_s = 20.0;  ///< from the first reaction on; the SLAMs make their first map
    bool viewer = false;
    bool any_timing = false;  ///< a machine that is busy with something else is late, and no fault
  };

  Endurance(const RobotProcesses::Options& robot, const Options& options);

  /// Runs, and tells. Throws std::runtime_error when a program cannot be started.
  [[nodiscard]] nlohmann::ordered_json run();

  /// After run(): every process ended well, nothing was hit, nothing was lost, and the robot was as
  /// fast as is asked of it.
  [[nodiscard]] bool is_sound() const;

 private:
  struct LoadSample {
    time::Timestamp at{};
    ProcessLoad load;
  };
  struct Process {
    std::vector<LoadSample> loads;
    nodmap::status_t first_status{};  ///< of the time that is measured
    nodmap::status_t last_status{};
    double slowest_p99_us = 0.0;
    std::string last_health;  ///< the last one it had about its health
    [[nodiscard]] std::int64_t lost() const {
      return last_status.total_lost - first_status.total_lost;
    }
    [[nodiscard]] std::int64_t corrupt() const {
      return last_status.total_corrupt - first_status.total_corrupt;
    }
  };

  void on_message(const bus::LiveBus::RawMessage& message);
  void on_status(std::span<const std::byte> data);
  void sample_loads(const RobotProcesses& robot);
  void start_viewer(RobotProcesses& robot);
  /// A busy machine takes its time to start twelve processes.
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
  std::unique_ptr<ViewerClient> viewer_client_;
  std::int64_t viewer_messages_ = 0;
  std::int64_t viewer_bytes_ = 0;
  std::vector<std::string> ended_badly_;
};

}  // namespace nodmap::bench
