// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/endurance.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "common/bus/codec.hpp"
#include "common/formats/atomic_file.hpp"
#include "common/geometry/clock.hpp"

namespace nodmap::bench {
namespace {

using Json = nlohmann::ordered_json;
using latency::Sample;

constexpr std::size_t kParts = 10;
constexpr int kQueue = 10'000;  // the measuring process itself must lose nothing
constexpr std::uint16_t kViewerPort = 8765;
constexpr std::chrono::seconds kSamplePeriod(1);
constexpr std::chrono::minutes kReportPeriod(10);
constexpr double kMaxStartS = 60.0;  // wait for the first reaction, then measure anyway
// Requirements on the robot.
constexpr time::Duration kScanToMap = 2ms;
constexpr time::Duration kScanToDrive = 10ms;

time::Timestamp now() {
  return time::SystemClock().now();
}

time::Timestamp after(time::Timestamp begin, double duration_s) {
  return begin + time::from_seconds(duration_s);
}

double to_tenths(double value) {
  return std::round(10.0 * value) / 10.0;
}

std::vector<Sample> within(const std::vector<Sample>& samples, time::Timestamp from,
                           time::Timestamp to) {
  std::vector<Sample> part;
  std::ranges::copy_if(samples, std::back_inserter(part),
                       [&](const Sample& sample) { return sample.at >= from && sample.at < to; });
  return part;
}

Json to_json(const std::vector<Sample>& samples) {
  const latency::Summary summary = latency::summarize(samples);
  return {{"n", summary.n},
          {"p50_us", time::to_us(summary.p50)},
          {"p99_us", time::to_us(summary.p99)},
          {"max_us", time::to_us(summary.max)}};
}

// The timestamp of an encoded message: every nodmap_*_t begins with it, in network byte order,
// after the eight bytes of the type's fingerprint. The epoch if the message is too short.
time::Timestamp stamp_of(std::span<const std::byte> data) {
  constexpr std::size_t kBegin = bus::kFingerprintBytes;
  constexpr std::size_t kEnd = kBegin + sizeof(std::int64_t);
  return time::from_utime(data.size() < kEnd ? 0
                                             : bus::read_big_endian<std::int64_t>(data, kBegin));
}

}  // namespace

Endurance::Endurance(const RobotProcesses::Options& robot, const Options& options)
    : robot_options_(robot), options_(options) {}

bool Endurance::is_measured(time::Timestamp at) const {
  return at >= begin_ && at < end_;
}

bool Endurance::is_anything_lost() const {
  return !reaction_.lost().empty() || reaction_.corrupt() > 0 ||
         std::ranges::any_of(processes_, [this](const auto& entry) {
           const auto& [name, process] = entry;
           // Messages lost by the viewer do not affect the robot. Scans lost by the laser driver
           // never became messages: it or the simulated devices were scheduled too late.
           const bool counts_losses =
               name != "nodmap-viewer" && !(name == "nodmap-laser3d" && options_.any_timing);
           return (counts_losses && process.lost() > 0) ||
                  (name != "nodmap-viewer" && process.corrupt() > 0);
         });
}

bool Endurance::is_in_time(const std::vector<Sample>& samples, time::Duration target) const {
  const auto summary = latency::summarize(within(samples, begin_, end_));
  return summary.n > 0 && summary.p99 <= target;
}

bool Endurance::is_sound() const {
  const bool fast_enough = is_in_time(reaction_.scan_to_map(), kScanToMap) &&
                           is_in_time(reaction_.scan_to_drive(), kScanToDrive);
  return ended_badly_.empty() && collisions_ == 0 && !is_anything_lost() &&
         (fast_enough || options_.any_timing);
}

void Endurance::on_message(const bus::LiveBus::RawMessage& message) {
  reaction_.add(message.channel, message.data, message.received);
  constexpr std::string_view kNotOurs = "LCM_SELF_TEST";  // by LCM, at the start of a process
  if (!is_measured(message.received) || message.channel == kNotOurs) {
    return;
  }
  lags_[message.channel].push_back({message.received, message.received - stamp_of(message.data)});
  if (message.channel == "STATUS") {
    on_status(message.data);
  } else if (message.channel == "TRUTH") {
    on_truth(message.data);
  }
}

void Endurance::on_truth(std::span<const std::byte> data) {
  const time::Timestamp last = time::from_utime(truth_.utime);
  if (!bus::decode_into(truth_, data)) {
    return;
  }
  collisions_ = truth_.collisions;
  bumps_ = truth_.bumps;
  if (is_measured(last)) {
    const double passed_s = time::seconds(time::from_utime(truth_.utime) - last);
    driven_m_ += std::abs(truth_.forward_mps) * passed_s;
  }
}

void Endurance::on_status(std::span<const std::byte> data) {
  if (!bus::decode_into(status_, data)) {
    return;
  }
  Process& process = processes_[status_.process_name];
  if (process.first_status.utime == 0) {
    process.first_status = status_;
  }
  process.last_status = status_;
  process.slowest_p99_us = std::max(process.slowest_p99_us, status_.latency_p99_us);
  if (status_.health != nodmap::status_t::OK) {
    ++process.times_not_ok;
    process.last_health = status_.health_reason;
  }
}

void Endurance::start_viewer(RobotProcesses& robot) {
  robot.start("viewer");
  viewer_client_ = std::make_unique<ViewerClient>(kViewerPort);
}

void Endurance::wait_for_first_reaction(bus::LiveBus& bus) {
  const time::Timestamp latest = after(now(), kMaxStartS);
  while (reaction_.scan_to_drive().empty() && now() < latest) {
    bus.handle(std::chrono::milliseconds(20));
  }
}

Json Endurance::run() {
  bus::LiveBus bus("");
  bus.subscribe_all([this](const auto& message) { on_message(message); }, kQueue);
  RobotProcesses robot(robot_options_);
  wait_for_first_reaction(bus);
  begin_ = after(now(), options_.warm_up_s);
  half_ = after(begin_, 0.5 * options_.duration_s);
  end_ = after(begin_, options_.duration_s);
  auto next_sample = std::chrono::steady_clock::now();
  auto next_report = next_sample + kReportPeriod;
  while (now() < end_) {
    bus.handle(std::chrono::milliseconds(20));
    if (options_.viewer && !viewer_client_ && now() >= half_) {
      start_viewer(robot);
    }
    if (is_measured(now()) && std::chrono::steady_clock::now() >= next_sample) {
      sample_loads(robot);
      next_sample = std::chrono::steady_clock::now() + kSamplePeriod;
    }
    if (std::chrono::steady_clock::now() >= next_report) {
      save_progress();
      next_report += kReportPeriod;
    }
  }
  if (viewer_client_) {
    viewer_messages_ = viewer_client_->messages();
    viewer_bytes_ = viewer_client_->bytes();
    viewer_client_.reset();
  }
  ended_badly_ = robot.stop();
  return report();
}

void Endurance::sample_loads(const RobotProcesses& robot) {
  for (const auto& [name, pid] : robot.pids()) {
    if (const auto load = read_load(pid)) {
      processes_["nodmap-" + name].loads.push_back({now(), *load});
    }
  }
  udp_.push_back(read_udp_queues());
}

void Endurance::save_progress() const {
  double resident_mib = 0.0;
  for (const auto& [name, process] : processes_) {
    resident_mib += process.loads.empty() ? 0.0 : process.loads.back().load.resident_mib;
  }
  std::cerr << "After " << std::lround(time::seconds(now() - begin_)) << " of "
            << std::lround(options_.duration_s) << " s: " << std::lround(driven_m_) << " m driven, "
            << collisions_ << " collisions, " << std::lround(resident_mib)
            << " MiB in all processes\n";
  const auto error =
      formats::replace_file(robot_options_.out / "report.json", report().dump(2) + "\n");
  if (error) {
    std::cerr << "report.json cannot be written: " << error.message() << "\n";
  }
}

Json Endurance::report_reaction(const std::vector<Sample>& samples, time::Duration target) const {
  const auto measured = within(samples, begin_, end_);
  Json json = to_json(measured);
  json["target_p99_us"] = time::to_us(target);
  json["min_us_over_time"] = latency::us_over_time(measured, kParts, &latency::Summary::min);
  json["p99_us_over_time"] = latency::us_over_time(measured, kParts, &latency::Summary::p99);
  if (options_.viewer) {
    json["without_viewer"] = to_json(within(samples, begin_, half_));
    json["with_viewer"] = to_json(within(samples, half_, end_));
  }
  return json;
}

// CPU time between two moments, percent of one core; null if the process did not run.
Json Endurance::cpu_percent(const Process& process, time::Timestamp from, time::Timestamp to) {
  const auto is_within = [&](const LoadSample& sample) {
    return sample.at >= from && sample.at < to;
  };
  const auto first = std::ranges::find_if(process.loads, is_within);
  const auto last = std::find_if(process.loads.rbegin(), process.loads.rend(), is_within);
  if (first == process.loads.end() || last->at <= first->at) {
    return nullptr;
  }
  const double percent =
      100.0 * (last->load.cpu_s - first->load.cpu_s) / time::seconds(last->at - first->at);
  return to_tenths(percent);
}

Json Endurance::report_process(const Process& process) const {
  Json resident_mib = Json::array();
  for (std::size_t i = 0; i <= kParts && !process.loads.empty(); ++i) {
    const double mib = process.loads[i * (process.loads.size() - 1) / kParts].load.resident_mib;
    resident_mib.push_back(to_tenths(mib));
  }
  const auto& first = process.first_status;
  const auto& last = process.last_status;
  return {{"cpu_percent_by_half",
           {cpu_percent(process, begin_, half_), cpu_percent(process, half_, end_)}},
          {"resident_mib_over_time", resident_mib},
          {"handled", last.total_handled - first.total_handled},
          {"slowest_handling_p99_us", process.slowest_p99_us},
          {"lost", process.lost()},
          {"corrupt", process.corrupt()},
          {"rejected", last.total_rejected - first.total_rejected},
          {"times_not_ok", process.times_not_ok},
          {"last_health", process.last_health}};
}

Json Endurance::report() const {
  Json lags;
  for (const auto& [channel, samples] : lags_) {
    lags[channel] = {
        {"n", samples.size()},
        {"p99_us_over_time", latency::us_over_time(samples, kParts, &latency::Summary::p99)}};
  }
  Json processes;
  for (const auto& [name, process] : processes_) {
    processes[name] = report_process(process);
  }
  std::int64_t most_waiting_bytes = 0;
  for (const UdpQueues& queues : udp_) {
    most_waiting_bytes = std::max(most_waiting_bytes, queues.waiting_bytes);
  }
  const std::int64_t dropped = udp_.empty() ? 0 : udp_.back().dropped - udp_.front().dropped;
  return {{"duration_s", options_.duration_s},
          {"measured_s", std::min(time::seconds(now() - begin_), options_.duration_s)},
          {"driven_m", to_tenths(driven_m_)},
          {"scans", reaction_.scans()},
          {"lost", reaction_.lost()},
          {"collisions", collisions_},
          {"bumps", bumps_},
          {"scan_to_obstacle_map", report_reaction(reaction_.scan_to_map(), kScanToMap)},
          {"scan_to_drive", report_reaction(reaction_.scan_to_drive(), kScanToDrive)},
          {"from_measurement_to_message", lags},
          {"processes", processes},
          {"kernel_queues", {{"most_waiting_bytes", most_waiting_bytes}, {"dropped", dropped}}},
          {"viewer_client", {{"messages", viewer_messages_}, {"bytes", viewer_bytes_}}},
          {"ended_badly", ended_badly_}};
}

}  // namespace nodmap::bench
