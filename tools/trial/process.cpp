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

void Process::turn() {
  if (running_ && running_->device_node != nullptr) {
    running_->device_node->turn();
  }
}

nlohmann::json Process::report() const {
  if (!running_) {
    return nullptr;
  }
  const node::Tally& tally = running_->tally;
  nlohmann::json rejected = nlohmann::json::object();
  for (const auto& [cause, count] : tally.rejected()) {
    rejected[cause] = count;
  }
  return {{"messages",
           {{"read", running_->bus.counts().received},
            {"used", tally.used()},
            {"rejected", rejected},
            {"corrupt", running_->bus.counts().corrupt},
            {"lost", tally.lost()},
            {"published", running_->bus.counts().published}}},
          {"figures", running_->node->figures()}};
}

}  // namespace nodmap::trial
