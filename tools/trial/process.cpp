// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/process.hpp"

#include <nlohmann/json.hpp>
#include <utility>

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
  const node::MessageCounts& counts = running_->counts;
  nlohmann::json rejected = nlohmann::json::object();
  for (const auto& [cause, count] : counts.rejected()) {
    rejected[cause] = count;
  }
  return {{"messages",
           {{"read", running_->bus.counts().received},
            {"used", counts.used()},
            {"rejected", rejected},
            {"corrupt", running_->bus.counts().corrupt},
            {"lost", counts.lost()},
            {"published", running_->bus.counts().published}}},
          {"metrics", running_->node->metrics()}};
}

}  // namespace nodmap::trial
