// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/bus/bus.hpp"
#include "common/node/tally.hpp"
#include "common/params/params.hpp"

namespace nodmap::node {

/// What a node works with; made by run() and outlives the node.
struct Context {
  bus::Bus& bus;
  Tally& tally;
  /// Where results go; empty when a live process was started without --out and keeps nothing.
  std::filesystem::path out_dir;
};

enum class HealthState : std::uint8_t { kOk, kDegraded, kFailed };

struct Health {
  HealthState state = HealthState::kOk;
  std::string reason;  ///< one sentence; empty when OK
  /// Whether a second without a message is a fault. Not for a driver: its input is a device.
  bool needs_messages = true;
};

/// The shell around an algorithm: messages in, messages out, nothing else. The same object runs
/// live and on a recording, and never knows which: it takes the time from its messages.
class Node {
 public:
  Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  Node(Node&&) = delete;
  Node& operator=(Node&&) = delete;
  virtual ~Node() = default;

  /// Called once when the input has ended, before write_results(): works off what is still held.
  virtual void finish() {}

  /// Writes the module's files into `dir`, which exists. Throws std::runtime_error.
  virtual void write_results(const std::filesystem::path& dir) = 0;

  /// The module's own figures, for result.json.
  [[nodiscard]] virtual nlohmann::json figures() const = 0;

  /// How the module judges its own work, for STATUS.
  [[nodiscard]] virtual Health health() const { return {}; }
};

struct ProgramInfo {
  std::string name;     ///< of the program: nodmap-slam2d
  std::string summary;  ///< one sentence for --help
};

using NodeFactory = std::function<std::unique_ptr<Node>(Context&)>;

/// The life of a process, live on LCM or with --replay: command line, parameters, message loop,
/// STATUS, results. Returns the exit code: 0 done, 1 failed, 2 wrong command line or configuration.
int run_process(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                const NodeFactory& make_node);

/// main() of a processing module.
template <class NodeType>
int run(int argc, char** argv, const ProgramInfo& info) {
  typename NodeType::Params params;
  params::Table table(params);
  return run_process(argc, argv, info, table, [&params](Context& context) {
    return std::make_unique<NodeType>(context, params);
  });
}

}  // namespace nodmap::node
