// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/robot_software.hpp"

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "common/node/results.hpp"
#include "modules/slam2d/localiser_node.hpp"
#include "tools/trial/level_scanner_node.hpp"

namespace nodmap::trial {

Process::Process(std::string name, bus::LoopNetwork& network, node::NodeFactory make_node)
    : name_(std::move(name)), network_(network), make_node_(std::move(make_node)) {
  start();
}

void Process::start() {
  running_ = std::make_unique<Running>(network_);
  running_->node = make_node_(running_->context);
  running_->device_node = dynamic_cast<node::DeviceNode*>(running_->node.get());
}

void Process::spin_once() {
  if (running_ && running_->device_node != nullptr) {
    running_->device_node->spin_once();
  }
}

nlohmann::json Process::report() const {
  if (!running_) {
    return nullptr;
  }
  return {{"messages", node::messages_json(running_->bus, running_->counts)},
          {"metrics", running_->node->metrics()}};
}

RobotSoftware::RobotSoftware(sim::SimulatedRobot& hardware, bus::LoopNetwork& network,
                             AllParams params, Robot robot, std::set<std::string> without,
                             node::MapOptions map)
    : hardware_(hardware),
      network_(network),
      person_(network),
      params_(std::move(params)),
      without_(std::move(without)),
      map_(std::move(map)),
      laser_line_(hardware.device(sim::Part::kLaser)),
      servo_line_(hardware.device(sim::Part::kServo)),
      base_line_(hardware.device(sim::Part::kBase)) {
  const auto clock = [this] {
    const time::SteadyTime now = hardware_.model().now();
    return time::Moment{kStart.wall_at(now), now};
  };
  processes_.reserve(8);
  add("kurt", [this, clock](node::Context& context) {
    return std::make_unique<kurt::KurtNode>(
        context, params_.kurt, [this] { return base_line_.open(params_.kurt.baud); }, clock);
  });
  add_scanner(robot, clock);
  add("pitch_controller", [this](node::Context& context) {
    return std::make_unique<pitch_controller::PitchControllerNode>(context,
                                                                   params_.pitch_controller);
  });
  add("map_server", [this](node::Context& context) {
    return std::make_unique<map_server::MapServerNode>(context, params_.map_server);
  });
  add("navigator", [this](node::Context& context) {
    return std::make_unique<navigator::NavigatorNode>(context, params_.navigator);
  });
  add("explorer", [this](node::Context& context) {
    return std::make_unique<explorer::ExplorerNode>(context, params_.explorer);
  });
  add("slam2d", [this](node::Context& context) -> std::unique_ptr<node::Node> {
    if (!map_.localise_in.empty()) {
      return std::make_unique<slam2d::LocaliserNode>(context, params_.slam2d, map_);
    }
    return std::make_unique<slam2d::Slam2dNode>(context, params_.slam2d, map_);
  });
  add("slam6d", [this](node::Context& context) {
    return std::make_unique<slam6d::Slam6dNode>(context, params_.slam6d);
  });
}

void RobotSoftware::add_scanner(Robot robot, const std::function<time::Moment()>& clock) {
  if (robot == Robot::kJackal) {
    add("laser3d", [this](node::Context& context) {
      return std::make_unique<LevelScannerNode>(context, params_.navigator.robot.mount,
                                                hardware_.model());
    });
    return;
  }
  add("laser3d", [this, clock](node::Context& context) {
    return std::make_unique<laser3d::Laser3dNode>(
        context, params_.laser3d,
        laser3d::Laser3dNode::Openers{
            .laser = [this] { return laser_line_.open(params_.laser3d.laser.baud); },
            .servo = [this] { return servo_line_.open(params_.laser3d.servo.baud); }},
        clock);
  });
}

void RobotSoftware::add(const std::string& name, node::NodeFactory make_node) {
  if (!without_.contains(name)) {
    processes_.emplace_back(name, network_, std::move(make_node));
  }
}

void RobotSoftware::release_robot() {
  nodmap::stop_t message{};
  message.utime = time::to_utime(stamp_at(hardware_.model().now()));
  message.stop_seq = stop_seq_++;
  message.requested_by = "nodmap-trial";
  person_.publish("STOP", message);
}

void RobotSoftware::step() {
  if (stop_seq_ == 0) {
    release_robot();
  }
  for (SimulatedLine* line : {&base_line_, &laser_line_, &servo_line_}) {
    line->move_bytes(hardware_.model().now());
  }
  for (Process& process : processes_) {
    process.spin_once();
  }
}

Process& RobotSoftware::process(const std::string& name) {
  for (Process& process : processes_) {
    if (process.name() == name) {
      return process;
    }
  }
  throw std::invalid_argument("no process " + name);
}

void RobotSoftware::kill(const std::string& name) {
  if (name == "kurt") {
    base_line_.cut();
  } else if (name == "laser3d") {
    laser_line_.cut();
    servo_line_.cut();
  }
  process(name).kill();
}

void RobotSoftware::start(const std::string& name) {
  process(name).start();
  if (name == "kurt" || name == "navigator") {
    release_robot();
  }
}

void RobotSoftware::finish() {
  for (Process& process : processes_) {
    if (process.is_running()) {
      process.node()->finish();
    }
  }
}

void RobotSoftware::write_results(const std::filesystem::path& dir) const {
  for (const Process& process : processes_) {
    if (!process.is_running()) {
      continue;
    }
    std::string folder = process.name();  // as its program is called: map-server
    std::ranges::replace(folder, '_', '-');
    const std::filesystem::path own = dir / folder;
    std::filesystem::create_directory(own);
    process.node()->write_results(own);
    if (std::filesystem::is_empty(own)) {
      std::filesystem::remove(own);
    }
  }
}

nlohmann::json RobotSoftware::report() const {
  nlohmann::json report = nlohmann::json::object();
  for (const Process& process : processes_) {
    report[process.name()] = process.report();
  }
  return report;
}

}  // namespace nodmap::trial
