// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/remote_control.hpp"

#include <cmath>

#include "nodmap/goal_t.hpp"
#include "nodmap/save_request_t.hpp"

namespace nodmap::viewer {
namespace {

constexpr double kToleranceM = 0.3;
/// A robot that stands within this of the goal has arrived, and stands: wide enough that it is
/// there at once, whatever the brakes need (it drives below 2 m/s).
constexpr double kStopToleranceM = 2.0;
/// Farther than any map: a slip, or worse.
constexpr double kMaxCoordinateM = 1e4;

std::optional<double> number_in(const Json& request, const char* name) {
  const auto found = request.find(name);
  if (found == request.end() || !found->is_number()) {
    return std::nullopt;
  }
  return found->get<double>();
}

}  // namespace

std::string RemoteControl::publish(const std::string& topic, const Json& request,
                                   const std::optional<geometry::SE3>& T_map_base) {
  if (topic == "GOAL") {
    return publish_goal(request);
  }
  if (topic == "STOP") {
    return publish_stop(T_map_base);
  }
  if (topic == "SAVE_REQUEST") {
    return publish_save_request();
  }
  return "nothing is taken on this topic";
}

std::string RemoteControl::publish_goal(const Json& request) {
  if (request.contains("clear") && request["clear"] == true) {
    send_goal(false, 0.0, 0.0, kToleranceM);
    return {};
  }
  const auto x_m = number_in(request, "x_m");
  const auto y_m = number_in(request, "y_m");
  const double tolerance_m = number_in(request, "tolerance_m").value_or(kToleranceM);
  if (!x_m || !y_m || std::abs(*x_m) > kMaxCoordinateM || std::abs(*y_m) > kMaxCoordinateM ||
      tolerance_m <= 0.0 || tolerance_m > kMaxCoordinateM) {
    return "a goal needs x_m and y_m, and a tolerance_m > 0 if any";
  }
  send_goal(true, *x_m, *y_m, tolerance_m);
  return {};
}

std::string RemoteControl::publish_stop(const std::optional<geometry::SE3>& T_map_base) {
  if (!T_map_base) {
    return "no POSE_2D yet: where the robot is, is not known";
  }
  send_goal(true, T_map_base->translation().x(), T_map_base->translation().y(), kStopToleranceM);
  return {};
}

std::string RemoteControl::publish_save_request() {
  nodmap::save_request_t message{};
  message.utime = clock_.now_utime_us();
  message.requested_by = "nodmap-viewer";
  bus_.publish("SAVE_REQUEST", message);
  return {};
}

void RemoteControl::send_goal(bool is_active, double x_m, double y_m, double tolerance_m) {
  nodmap::goal_t message{};
  message.utime = clock_.now_utime_us();
  message.goal_seq = goal_seq_++;
  message.is_active = static_cast<std::int8_t>(is_active);
  message.position_m[0] = x_m;
  message.position_m[1] = y_m;
  message.tolerance_m = tolerance_m;
  bus_.publish("GOAL", message);
}

}  // namespace nodmap::viewer
