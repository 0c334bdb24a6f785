// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/bus/loop_bus.hpp"
#include "common/node/device_node.hpp"
#include "common/node/node.hpp"

namespace nodmap::trial {

/// One process of the robot: its node and what surrounds it, as long as it runs.
class Process {
 public:
  /// Starts it.
  Process(std::string name, bus::LoopNetwork& network, node::NodeFactory make_node);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_running() const { return running_ != nullptr; }
  /// Null while it does not run.
  [[nodiscard]] node::Node* node() const { return running_ ? running_->node.get() : nullptr; }

  /// A driver's turn; nothing for others.
  void spin_once();

  void start();
  /// As by kill -9: what it knew is lost, nothing is written. A driver's lines must be cut before.
  void kill() { running_.reset(); }

  /// What came of its messages, and its own figures; without latencies, which are of the wall
  /// clock.
  [[nodiscard]] nlohmann::json report() const;

 private:
  struct Running {
    explicit Running(bus::LoopNetwork& network) : bus(network), context{bus, counts, {}} {}

    bus::LoopBus bus;
    node::MessageCounts counts;
    node::Context context;
    std::unique_ptr<node::Node> node;
    node::DeviceNode* device_node = nullptr;
  };

  std::string name_;
  bus::LoopNetwork& network_;
  node::NodeFactory make_node_;
  std::unique_ptr<Running> running_;
};

}  // namespace nodmap::trial
