// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/remote_control.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "common/node/process_names.hpp"
#include "common/node/status.hpp"
#include "modules/viewer/json.hpp"
#include "modules/viewer/options.hpp"
#include "nodmap/explore_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::viewer {
namespace {

// Who carries out requests, by the names in STATUS.
constexpr std::array<std::string_view, 5> kRecipients = {
    node::kBaseDriver, node::kNavigator, node::kExplorer, node::kSlam2d, node::kSlam6d};
constexpr double kToleranceM = 0.3;

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

std::string log_line(const Json& request, const Answer& answer) {
  return fmt::format("asked for {:.200}: {:.200}", foxglove::to_text(request), answer.text);
}

RemoteControl::RemoteControl(bus::Bus& bus, Clock clock, ProcessControl* processes)
    : bus_(bus),
      clock_(std::move(clock)),
      processes_(processes),
      goal_sender_(bus),
      stop_sender_(bus, kProgram) {
  bus.subscribe<nodmap::stop_t>("STOP", [this](const auto& m) { stop_sender_.take(m); });
  bus.subscribe<nodmap::goal_t>("GOAL", [this](const auto& m) { goal_sender_.take(m); });
  bus.subscribe<nodmap::navigation_t>("NAVIGATION",
                                      [this](const auto& m) { goal_sender_.take(m); });
  bus.subscribe<nodmap::grid_chunk_t>("MAP_2D", [this](const auto& m) { on_map(m); });
  bus.subscribe<nodmap::status_t>("STATUS", [this](const auto& m) { on_status(m); });
}

Answer RemoteControl::answer(const Json& request, time::Duration age) {
  using procman::Verb;
  const std::string command = text_in(request, "command");
  const ControlRequest requests[] = {
      {"goal", Age::kFresh, [&] { return do_goal(request); }},
      {"home", Age::kFresh, [&] { return do_home(); }},
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
  if (!x_m || !y_m || !tolerance_m || *tolerance_m <= 0.0) {
    return {.ok = false, .text = "A goal needs x_m and y_m, and a tolerance_m > 0 if any."};
  }
  if (*tolerance_m > node::kMaxGoalToleranceM) {
    return {.ok = false, .text = "The tolerance of a goal is at most 10 m."};
  }
  if (std::abs(*x_m) > node::kMaxCoordinateM || std::abs(*y_m) > node::kMaxCoordinateM) {
    return {.ok = false,
            .text = "A goal lies at most 10000 m from the map's origin along x and y."};
  }
  return send_goal({*x_m, *y_m}, *tolerance_m,
                   fmt::format("Goal: x {:.2f} m, y {:.2f} m.", *x_m, *y_m));
}

Answer RemoteControl::do_home() {
  return send_goal(Eigen::Vector2d(node::kHomeM.data()), kToleranceM,
                   "Goal: home, the origin of the map.");
}

Answer RemoteControl::send_goal(const Eigen::Vector2d& p_map, double tolerance_m,
                                std::string text) {
  nodmap::goal_t goal{};
  goal.position_m[0] = p_map.x();
  goal.position_m[1] = p_map.y();
  goal.tolerance_m = tolerance_m;
  const time::Moment now = clock_();
  goal_asked_ = now.steady;
  goal_sender_.set(goal, now.wall);
  const bool is_outside = map_m_ && !map_m_->contains(p_map);
  return {.ok = true,
          .text = std::move(text) +
                  (is_outside ? " It lies outside of the map that is known so far." : "") +
                  note_if_silent({node::kNavigator})};
}

Answer RemoteControl::do_roam() {
  const time::Moment now = clock_();
  goal_asked_ = now.steady;
  goal_sender_.cancel(now.wall);
  return {
      .ok = true,
      .text = "Goal cancelled: without one the robot roams." + note_if_silent({node::kNavigator})};
}

Answer RemoteControl::do_stop(bool is_stopped) {
  is_stopped ? stop_sender_.stop(clock_().wall) : stop_sender_.release(clock_().wall);
  return {.ok = true,
          .text = (is_stopped ? "STOP is sent until the robot is released. The banner says whether "
                                "the base driver has confirmed it."
                              : "Release is sent. The banner says if the base driver is still "
                                "stopped.") +
                  note_if_silent({node::kBaseDriver})};
}

Answer RemoteControl::do_explore(bool is_active) {
  goal_asked_.reset();
  nodmap::explore_t message{};
  message.utime = time::to_utime(clock_().wall);
  message.is_active = static_cast<std::int8_t>(is_active);
  message.requested_by = kProgram;
  bus_.publish("EXPLORE", message);
  return {.ok = true,
          .text = (is_active ? "Exploration asked for. It ends when everything has been seen and "
                               "the robot is back here."
                             : "End of the exploration asked for; the robot stays where it is.") +
                  note_if_silent({node::kExplorer})};
}

Answer RemoteControl::do_save_maps() {
  nodmap::save_request_t message{};
  message.utime = time::to_utime(clock_().wall);
  message.requested_by = kProgram;
  bus_.publish("SAVE_REQUEST", message);
  return {.ok = true, .text = "Maps asked for." + note_if_silent({node::kSlam2d, node::kSlam6d})};
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

void RemoteControl::on_map(const nodmap::grid_chunk_t& tile) {
  const Eigen::Vector2d first(tile.origin_x_m, tile.origin_y_m);
  const Eigen::Vector2d size =
      tile.cell_size_m * Eigen::Vector2d(tile.grid_width, tile.grid_height);
  if (first.allFinite() && size.allFinite() && size.minCoeff() > 0.0) {
    map_m_ = Eigen::AlignedBox2d(first, first + size);
  }
}

void RemoteControl::on_status(const nodmap::status_t& status) {
  const auto* const process = std::ranges::find(kRecipients, status.process_name);
  if (process != kRecipients.end()) {
    reported_[status.process_name] = clock_().steady;
  }
}

std::string RemoteControl::note_if_silent(std::initializer_list<const char*> processes) const {
  const time::SteadyTime now = clock_().steady;
  const bool is_silent = std::ranges::none_of(processes, [&](const char* name) {
    const auto last = reported_.find(name);
    return last != reported_.end() && now - last->second < node::kStatusSilence;
  });
  return is_silent ? fmt::format(" But no {} reports.", fmt::join(processes, " or ")) : "";
}

// The robot must not begin to drive to a goal of which nobody thinks any more, for a navigator that
// is started later.
void RemoteControl::poll() {
  const time::Moment now = clock_();
  stop_sender_.repeat_if_due(now.wall);
  const bool is_asked = goal_asked_ && now.steady - *goal_asked_ <= kMaxAge;
  if (is_asked && goal_sender_.status() == node::GoalSender::Status::kSent) {
    goal_sender_.repeat_if_due(now.wall);
  }
}

}  // namespace nodmap::viewer
