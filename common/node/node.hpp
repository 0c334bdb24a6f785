// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/bus/bus.hpp"
#include "common/node/message_counts.hpp"
#include "common/params/params.hpp"

namespace nodmap::node {

/// What a node works with. run_node() makes it; it outlives the node.
struct Context {
  bus::Bus& bus;
  MessageCounts& counts;
  /// Folder for the results; empty when a live process was started without --out.
  std::filesystem::path out_dir;
};

enum class HealthState : std::uint8_t { kOk, kDegraded, kFailed };

struct Health {
  HealthState state = HealthState::kOk;
  std::string reason;  ///< one sentence; empty when OK
  /// Whether a second without a message is a fault. False for a driver, whose input is a device.
  bool needs_messages = true;
};

/// The shell around an algorithm: messages in, messages out, nothing else. The same object runs
/// live and on a recording and cannot tell which: it takes the time from its messages.
class Node : boost::noncopyable {
 public:
  virtual ~Node() = default;

  /// Called once when the input has ended, before write_results(): processes what is still queued.
  virtual void finish() {}

  /// Writes the module's files into `dir`, which exists. Throws std::runtime_error.
  virtual void write_results(const std::filesystem::path& dir) = 0;

  /// What the module measured of its own work, for result.json.
  [[nodiscard]] virtual nlohmann::json metrics() const = 0;

  /// How well the module can do its work right now, for STATUS.
  [[nodiscard]] virtual Health health() const { return {}; }
};

struct ProgramInfo {
  std::string name;     ///< of the program: nodmap-slam2d
  std::string summary;  ///< one sentence for --help
};

using NodeFactory = std::function<std::unique_ptr<Node>(Context&)>;

/// main() of a process that handles messages, live on LCM or with --replay: parameters, message
/// loop, STATUS, results. Returns the exit code of run_program().
int run_node(int argc, char** argv, const ProgramInfo& info, params::Table& table,
             const NodeFactory& make_node);

/// main() of a processing module.
template <class NodeType>
int run(int argc, char** argv, const ProgramInfo& info) {
  typename NodeType::Params params;
  params::Table table(params);
  return run_node(argc, argv, info, table, [&params](Context& context) {
    return std::make_unique<NodeType>(context, params);
  });
}

}  // namespace nodmap::node
