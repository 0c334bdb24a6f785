// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/log_history.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "common/bus/log_player.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/status_t.hpp"

namespace nodmap::viewer {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// Enough for a plot on a wide screen, because each interval has two samples.
constexpr double kIntervals = 500.0;
// Largest number of processes whose latencies are kept: more than a robot has.
constexpr std::size_t kMaxSeries = 64;
constexpr std::int64_t kEventsAtOnce = 1'000'000;

double nearest_m(const nodmap::egomap_t& map) {
  const auto nearest = std::ranges::min_element(map.distance_m);
  return nearest == map.distance_m.end() ? kNone : static_cast<double>(*nearest);
}

// Extracts the plotted quantities from the messages of a player.
class History {
 public:
  explicit History(bus::LogPlayer& player)
      : player_(player), interval_s_(time::seconds(player.duration()) / kIntervals) {
    player.subscribe<nodmap::odometry_t>(
        "ODOMETRY", [this](const auto& m) { add("forward_mps", m.forward_mps); });
    player.subscribe<nodmap::navigation_t>("NAVIGATION", [this](const auto& m) {
      add("max_forward_mps", m.max_forward_mps);
      add("clear_distance_m", m.clear_distance_m);
    });
    player.subscribe<nodmap::egomap_t>("OBSTACLE_MAP",
                                       [this](const auto& m) { add("nearest_m", nearest_m(m)); });
    player.subscribe<nodmap::pitch_state_t>(
        "PITCH_STATE", [this](const auto& m) { add("pitch_rad", m.pitch_rad); });
    player.subscribe<nodmap::scan_t>("SCAN", [this](const auto& m) {
      add("pitch_rad", 0.5 * (m.pitch_first_rad + m.pitch_last_rad));
    });
    player.subscribe<nodmap::pitch_command_t>("PITCH_COMMAND",
                                              [this](const auto& m) { add("sweep_s", m.sweep_s); });
    // A process that has handled nothing has no latency.
    player.subscribe<nodmap::status_t>("STATUS", [this](const auto& m) {
      add("latency_p99_us " + m.process_name, m.latency_p99_us > 0.0 ? m.latency_p99_us : kNone,
          kStatusGapS);
    });
  }

  [[nodiscard]] Json to_json() const {
    Json json = Json::object();
    for (const auto& [name, series] : series_) {
      json[name] = series.samples();
    }
    return json;
  }

 private:
  void add(const std::string& name, double value, double gap_s = kGapS) {
    if (series_.contains(name) || series_.size() < kMaxSeries) {
      const double time_s = time::seconds(player_.event_time().time_since_epoch());
      series_.try_emplace(name, interval_s_, gap_s).first->second.add(time_s, value);
    }
  }

  bus::LogPlayer& player_;
  double interval_s_;
  std::map<std::string, Series> series_;
};

}  // namespace

void Series::add(double time_s, double value) {
  if (!std::isfinite(value)) {
    return;
  }
  const bool is_first = samples_.empty() && extremes_.empty();
  if (!is_first && time_s - last_s_ > gap_s_) {
    close_interval();
    samples_.push_back({last_s_, kNone});
  }
  if (!extremes_.empty() && time_s >= interval_end_s_) {
    close_interval();
  }
  if (extremes_.empty()) {
    extremes_.assign(2, {time_s, value});
    interval_end_s_ = time_s + interval_s_;
  } else if (value < extremes_[0].value) {
    extremes_[0] = {time_s, value};
  } else if (value > extremes_[1].value) {
    extremes_[1] = {time_s, value};
  }
  last_s_ = time_s;
}

std::vector<Series::Sample> Series::open_samples() const {
  std::vector<Sample> samples = extremes_;
  std::ranges::sort(samples, {}, &Sample::time_s);
  if (samples.size() == 2 && samples[0].time_s == samples[1].time_s) {
    samples.pop_back();
  }
  return samples;
}

void Series::close_interval() {
  const std::vector<Sample> samples = open_samples();
  samples_.insert(samples_.end(), samples.begin(), samples.end());
  extremes_.clear();
}

Json Series::samples() const {
  Json json = Json::array();
  const auto append = [&json](const Sample& sample) {
    json.push_back({sample.time_s, std::isnan(sample.value) ? Json() : Json(sample.value)});
  };
  std::ranges::for_each(samples_, append);
  const std::vector<Sample> last = open_samples();
  std::ranges::for_each(last, append);
  return json;
}

Json log_history(const std::vector<std::filesystem::path>& logs) {
  bus::LogPlayer player(logs);
  const History history(player);
  (void)player.seek(player.duration());
  while (!player.catch_up(kEventsAtOnce)) {
  }
  return history.to_json();
}

}  // namespace nodmap::viewer
