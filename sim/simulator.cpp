// SPDX-License-Identifier: BSD-3-Clause
#include "sim/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/truth_message.hpp"

namespace nodmap::sim {
namespace {

constexpr time::Duration kTruthPeriod = 20ms;
// Above this lag the health is degraded, because scans are late. The robot model stores 100 ms for
// the laser.
constexpr time::Duration kMaxLag = 20ms;

}  // namespace

Simulator::Simulator(SimulatedRobot& robot, const LinkDir& dir, bus::Bus& bus,
                     time::Timestamp start)
    : robot_(robot),
      bus_(bus),
      start_{start, {}},
      min_clearance_m_(robot.model().ground_truth().clearance_m),
      last_position_(robot.model().ground_truth().T_world_base.translation()) {
  for (const Part part : SimulatedRobot::kParts) {
    const auto at = static_cast<std::size_t>(part);
    lines_[at] = std::make_unique<PtyLine>(dir, name_of(part));
  }
  update_plugs({});
}

void Simulator::spin_once(time::SteadyTime now) {
  max_lag_ = std::max(max_lag_, now - next_due());
  while (next_due() < now) {
    update_devices(next_due());
  }
  now_ = std::max(now, now_);
  robot_.advance_to(now_);
  read_lines(now_);
  update_devices(now_);
}

time::SteadyTime Simulator::next_due() const {
  return std::max(now_ + 1us, std::min(robot_.next_due(), next_truth_));
}

// Does everything that is due at this time.
void Simulator::update_devices(time::SteadyTime now) {
  now_ = now;
  robot_.advance_to(now);
  update_plugs(now);
  for (const Part part : SimulatedRobot::kParts) {
    const PtyLine& line = *lines_[static_cast<std::size_t>(part)];
    if (robot_.device(part).next_due() > now) {
      continue;
    }
    Bytes bytes;
    robot_.device(part).transmit(now, line.is_plugged_in() ? line.host_baud() : 0, bytes);
    if (line.is_plugged_in() && !bytes.empty()) {
      line.write(bytes);
    }
  }
  if (now >= next_truth_) {
    next_truth_ += kTruthPeriod;
    publish_truth();
  }
}

void Simulator::read_lines(time::SteadyTime now) {
  for (const Part part : SimulatedRobot::kParts) {
    const PtyLine& line = *lines_[static_cast<std::size_t>(part)];
    const Bytes bytes = line.is_plugged_in() ? line.read() : Bytes{};
    if (!bytes.empty()) {
      robot_.device(part).receive(bytes, line.host_baud(), now);
    }
  }
}

void Simulator::update_plugs(time::SteadyTime now) {
  for (const Part part : SimulatedRobot::kParts) {
    PtyLine& line = *lines_[static_cast<std::size_t>(part)];
    const bool wanted = robot_.device(part).is_plugged_in(now);
    if (wanted && !line.is_plugged_in()) {
      line.plug_in();
    } else if (!wanted) {
      line.unplug();
    }
  }
}

void Simulator::publish_truth() {
  const GroundTruth truth = robot_.model().ground_truth();
  const Eigen::Vector3d position = truth.T_world_base.translation();
  distance_m_ += (position - last_position_).norm();
  last_position_ = position;
  min_clearance_m_ = std::min(min_clearance_m_, truth.clearance_m);
  nodmap::truth_t message = write_truth(truth, start_.wall_at(now_));
  message.truth_seq = truth_seq_++;
  bus_.publish("TRUTH", message);
}

std::array<int, 3> Simulator::poll_handles() const {
  return {lines_[0]->handle(), lines_[1]->handle(), lines_[2]->handle()};
}

node::Health Simulator::health() const {
  if (max_lag_ > kMaxLag) {
    return {node::HealthState::kDegraded,
            "behind real time by up to " + std::to_string(max_lag_ / 1ms) + " ms", false};
  }
  return {node::HealthState::kOk, "", false};
}

nlohmann::json Simulator::metrics() const {
  const GroundTruth truth = robot_.model().ground_truth();
  const Eigen::Vector3d position = truth.T_world_base.translation();
  const Eigen::Vector3d ahead = truth.T_world_base.linear().col(0);
  return {{"duration_s", time::seconds(now_.time_since_epoch())},
          {"collisions", truth.contacts.collisions},
          {"bumps", truth.contacts.bumps},
          {"distance_m", distance_m_},
          {"min_clearance_m", std::isfinite(min_clearance_m_) ? nlohmann::json(min_clearance_m_)
                                                              : nlohmann::json(nullptr)},
          {"position_m", {position.x(), position.y(), position.z()}},
          {"yaw_rad", std::atan2(ahead.y(), ahead.x())}};
}

}  // namespace nodmap::sim
