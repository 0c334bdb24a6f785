// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/remote_control.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <string_view>

#include "common/node/messages.hpp"
#include "modules/viewer/json.hpp"
#include "nodmap/explore_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/save_request_t.hpp"

namespace nodmap::viewer {
namespace {

constexpr const char* kName = "nodmap-viewer";
constexpr double kToleranceM = 0.3;
// Farther than any map: a mistake or an attack.
constexpr double kMaxCoordinateM = 1e4;

// A member that is a number; `fallback` if it is missing, empty if it is not a number.
std::optional<double> number_in(const Json& request, const char* name,
                                std::optional<double> fallback = {}) {
  const auto found = request.find(name);
  if (found == request.end()) {
    return fallback;
  }
  return found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

// How old a request may be.
enum class Age : std::uint8_t { kFresh, kAny };

struct ControlRequest {
  std::string_view name;
  Age age;
  std::function<Answer()> execute;
};

Answer no_control_over_processes() {
  return {.ok = false, .text = "No control over processes: start the viewer with --procman."};
}

}  // namespace

RemoteControl::RemoteControl(bus::Bus& bus, const time::Clock& clock, ProcessControl* processes)
    : bus_(bus), clock_(clock), processes_(processes) {
  stop_.stop_seq = -1;
  stop_.requested_by = kName;
  bus.subscribe<nodmap::stop_t>("STOP", [this](const auto& message) { on_stop(message); });
  bus.subscribe<nodmap::grid_chunk_t>("MAP_2D", [this](const auto& message) { on_map(message); });
}

Answer RemoteControl::answer(const Json& request, time::Duration age) {
  using procman::Verb;
  const std::string command = text_in(request, "command");
  const ControlRequest requests[] = {
      {"goal", Age::kFresh, [&] { return do_goal(request); }},
      {"roam", Age::kFresh, [&] { return do_roam(); }},
      {"explore", Age::kFresh, [&] { return do_explore(true); }},
      {"end_exploration", Age::kFresh, [&] { return do_explore(false); }},
      {"stop", Age::kAny, [&] { return do_stop(true); }},
      {"go", Age::kFresh, [&] { return do_stop(false); }},
      {"save_maps", Age::kAny, [&] { return do_save_maps(); }},
      {"start_process", Age::kFresh, [&] { return do_process(Verb::kStart, command); }},
      {"stop_process", Age::kFresh, [&] { return do_process(Verb::kStop, command); }},
      {"restart_process", Age::kFresh, [&] { return do_process(Verb::kRestart, command); }},
      {"start_recording", Age::kFresh, [&] { return do_recording(Verb::kStart); }},
      {"stop_recording", Age::kFresh, [&] { return do_recording(Verb::kStop); }},
      {"process_output", Age::kAny, [&] { return do_process_output(command); }},
  };
  const std::string what = text_in(request, "do");
  const auto* const asked = std::ranges::find(requests, what, &ControlRequest::name);
  if (asked == std::end(requests)) {
    return {.ok = false, .text = "Unknown request \"" + what + "\"."};
  }
  if (age > kMaxAge && asked->age == Age::kFresh) {
    return {.ok = false, .text = "Too old: not done."};
  }
  return asked->execute();
}

Answer RemoteControl::do_goal(const Json& request) {
  const auto x_m = number_in(request, "x_m");
  const auto y_m = number_in(request, "y_m");
  const auto tolerance_m = number_in(request, "tolerance_m", kToleranceM);
  if (!x_m || !y_m || !tolerance_m || *tolerance_m <= 0.0 || *tolerance_m > kMaxCoordinateM) {
    return {.ok = false, .text = "A goal needs x_m and y_m, and a tolerance_m > 0 if any."};
  }
  if (std::abs(*x_m) > kMaxCoordinateM || std::abs(*y_m) > kMaxCoordinateM) {
    return {.ok = false,
            .text = "A goal lies at most 10000 m from the map's origin along x and y."};
  }
  send_goal(true, *x_m, *y_m, *tolerance_m);
  const bool is_outside = map_m_ && !map_m_->contains(Eigen::Vector2d(*x_m, *y_m));
  return {.ok = true,
          .text = fmt::format("Goal: x {:.2f} m, y {:.2f} m.", *x_m, *y_m) +
                  (is_outside ? " It lies outside of the map that is known so far." : "")};
}

Answer RemoteControl::do_roam() {
  send_goal(false, 0.0, 0.0, kToleranceM);
  return {.ok = true, .text = "Goal cancelled: the robot roams."};
}

Answer RemoteControl::do_stop(bool is_stopped) {
  stop_.utime = time::to_utime(clock_.now());
  stop_.is_stopped = static_cast<std::int8_t>(is_stopped);
  send_stop();
  return {.ok = true, .text = is_stopped ? "Stopped until you say go." : "The robot may drive."};
}

Answer RemoteControl::do_explore(bool is_active) {
  nodmap::explore_t message{};
  message.utime = time::to_utime(clock_.now());
  message.is_active = static_cast<std::int8_t>(is_active);
  message.requested_by = kName;
  bus_.publish("EXPLORE", message);
  return {
      .ok = true,
      .text = is_active
                  ? "Exploring. It ends when everything has been seen and the robot is back here."
                  : "Exploration ended; the robot stays where it is."};
}

Answer RemoteControl::do_save_maps() {
  nodmap::save_request_t message{};
  message.utime = time::to_utime(clock_.now());
  message.requested_by = kName;
  bus_.publish("SAVE_REQUEST", message);
  return {.ok = true, .text = "Maps are being saved."};
}

Answer RemoteControl::do_process(procman::Verb verb, const std::string& command) {
  return processes_ == nullptr ? no_control_over_processes() : processes_->change(verb, command);
}

Answer RemoteControl::do_recording(procman::Verb verb) {
  return processes_ == nullptr ? no_control_over_processes() : processes_->change_recording(verb);
}

Answer RemoteControl::do_process_output(const std::string& command) {
  return processes_ == nullptr ? no_control_over_processes() : processes_->output(command);
}

// A message that releases the robot also ends our stop; otherwise two viewers would contradict
// each other.
void RemoteControl::on_stop(const nodmap::stop_t& message) {
  if (message.is_stopped == 0 && message.utime > stop_.utime) {
    stop_.is_stopped = 0;
  }
}

void RemoteControl::on_map(const nodmap::grid_chunk_t& tile) {
  const Eigen::Vector2d first(tile.origin_x_m, tile.origin_y_m);
  const Eigen::Vector2d size =
      tile.cell_size_m * Eigen::Vector2d(tile.grid_width, tile.grid_height);
  if (first.allFinite() && size.allFinite() && size.minCoeff() > 0.0) {
    map_m_ = Eigen::AlignedBox2d(first, first + size);
  }
}

void RemoteControl::poll() {
  if (stop_.is_stopped != 0 && std::chrono::abs(clock_.now() - stop_sent_) >= kRepeat) {
    send_stop();
  }
}

// A repetition has the time of the decision: a release since then is newer.
void RemoteControl::send_stop() {
  stop_sent_ = clock_.now();
  ++stop_.stop_seq;
  bus_.publish("STOP", stop_);
}

void RemoteControl::send_goal(bool is_active, double x_m, double y_m, double tolerance_m) {
  nodmap::goal_t message{};
  message.utime = time::to_utime(clock_.now());
  message.goal_seq = goal_seq_++;
  message.is_active = static_cast<std::int8_t>(is_active);
  message.position_m[0] = x_m;
  message.position_m[1] = y_m;
  message.tolerance_m = tolerance_m;
  bus_.publish("GOAL", message);
}

}  // namespace nodmap::viewer
