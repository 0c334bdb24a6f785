// SPDX-License-Identifier: BSD-3-Clause
#include "sim/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "nodmap/truth_t.hpp"

namespace nodmap::sim {
namespace {

constexpr std::array kNames = {"laser", "servo", "base"};
constexpr std::int64_t kTruthPeriodUs = 20'000;
/// The plant remembers 100 ms of what the laser may want to measure; well before, scans are late.
constexpr std::int64_t kTolerableLagUs = 20'000;

nodmap::truth_t to_message(const Truth& truth) {
  nodmap::truth_t message{};
  const Eigen::Vector3d position = truth.T_world_base.translation();
  const Eigen::Quaterniond orientation(truth.T_world_base.linear());
  std::copy(position.begin(), position.end(), message.position_m);
  message.orientation[0] = orientation.w();
  message.orientation[1] = orientation.x();
  message.orientation[2] = orientation.y();
  message.orientation[3] = orientation.z();
  message.forward_mps = truth.forward_mps;
  message.yaw_rate_rad_s = truth.yaw_rate_rad_s;
  message.pitch_rad = truth.pitch_rad;
  message.clearance_m = truth.clearance_m;
  message.collisions = truth.collisions;
  message.bumps = truth.bumps;
  message.num_actors = static_cast<std::int32_t>(truth.actors.size());
  for (const ActorState& actor : truth.actors) {
    message.actor_position_m.push_back({actor.position.x(), actor.position.y()});
    message.actor_radius_m.push_back(actor.radius_m);
    message.actor_height_m.push_back(actor.height_m);
  }
  return message;
}

}  // namespace

Simulator::Simulator(Robot& robot, const LinkDir& dir, bus::Bus& bus, std::int64_t start_utime_us)
    : robot_(robot),
      bus_(bus),
      start_utime_us_(start_utime_us),
      min_clearance_m_(robot.plant().truth().clearance_m),
      last_position_(robot.plant().truth().T_world_base.translation()) {
  for (const Part part : Robot::kParts) {
    const auto at = static_cast<std::size_t>(part);
    lines_[at] = std::make_unique<PtyLine>(dir, kNames[at]);
  }
  plug(0);
}

void Simulator::turn(std::int64_t now_us) {
  worst_lag_us_ = std::max(worst_lag_us_, now_us - next_us());
  while (next_us() < now_us) {
    run_devices(next_us());
  }
  now_us_ = std::max(now_us, now_us_);
  robot_.advance_to(now_us_);
  listen(now_us_);
  run_devices(now_us_);
}

std::int64_t Simulator::next_us() const {
  return std::max(now_us_ + 1, std::min(robot_.next_us(), next_truth_us_));
}

/// All that happens at one moment.
void Simulator::run_devices(std::int64_t now_us) {
  now_us_ = now_us;
  robot_.advance_to(now_us);
  plug(now_us);
  for (const Part part : Robot::kParts) {
    const PtyLine& line = *lines_[static_cast<std::size_t>(part)];
    if (robot_.device(part).next_us() > now_us) {
      continue;
    }
    Bytes bytes;
    robot_.device(part).transmit(now_us, line.plugged_in() ? line.host_baud() : 0, bytes);
    if (line.plugged_in() && !bytes.empty()) {
      line.write(bytes);
    }
  }
  if (now_us >= next_truth_us_) {
    next_truth_us_ += kTruthPeriodUs;
    tell_truth();
  }
}

void Simulator::listen(std::int64_t now_us) {
  for (const Part part : Robot::kParts) {
    const PtyLine& line = *lines_[static_cast<std::size_t>(part)];
    const Bytes bytes = line.plugged_in() ? line.read() : Bytes{};
    if (!bytes.empty()) {
      robot_.device(part).receive(bytes, line.host_baud(), now_us);
    }
  }
}

void Simulator::plug(std::int64_t now_us) {
  for (const Part part : Robot::kParts) {
    PtyLine& line = *lines_[static_cast<std::size_t>(part)];
    const bool wanted = robot_.device(part).plugged_in(now_us);
    if (wanted && !line.plugged_in()) {
      line.plug_in();
    } else if (!wanted) {
      line.unplug();
    }
  }
}

void Simulator::tell_truth() {
  const Truth truth = robot_.plant().truth();
  const Eigen::Vector3d position = truth.T_world_base.translation();
  distance_m_ += (position - last_position_).norm();
  last_position_ = position;
  min_clearance_m_ = std::min(min_clearance_m_, truth.clearance_m);
  nodmap::truth_t message = to_message(truth);
  message.utime = start_utime_us_ + now_us_;
  message.truth_seq = truth_seq_++;
  bus_.publish("TRUTH", message);
}

std::array<int, 3> Simulator::poll_handles() const {
  return {lines_[0]->handle(), lines_[1]->handle(), lines_[2]->handle()};
}

node::Health Simulator::health() const {
  if (worst_lag_us_ > kTolerableLagUs) {
    return {node::HealthState::kDegraded,
            "behind real time by up to " + std::to_string(worst_lag_us_ / 1000) + " ms", false};
  }
  return {node::HealthState::kOk, "", false};
}

nlohmann::json Simulator::metrics() const {
  const Truth truth = robot_.plant().truth();
  const Eigen::Vector3d position = truth.T_world_base.translation();
  const Eigen::Vector3d ahead = truth.T_world_base.linear().col(0);
  return {{"duration_s", 1e-6 * static_cast<double>(now_us_)},
          {"collisions", truth.collisions},
          {"bumps", truth.bumps},
          {"distance_m", distance_m_},
          {"min_clearance_m", std::isfinite(min_clearance_m_) ? nlohmann::json(min_clearance_m_)
                                                              : nlohmann::json(nullptr)},
          {"position_m", {position.x(), position.y(), position.z()}},
          {"yaw_rad", std::atan2(ahead.y(), ahead.x())}};
}

}  // namespace nodmap::sim
