// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "common/bus/bus.hpp"
#include "common/node/background_job.hpp"
#include "common/node/health.hpp"
#include "common/node/message_counts.hpp"

namespace nodmap::node {

/// The environment of a node. Whoever runs the node creates it; it outlives the node.
struct Context {
  bus::Bus& bus;
  MessageCounts& counts;
  /// Folder for the results; empty when a live process was started without --out.
  std::filesystem::path out_dir;
  /// kWhenReady in a live process: the only difference between live operation and a replay.
  ResultsUsed results_used = ResultsUsed::kAtFixedMessage;
};

/// The layer around an algorithm that receives and publishes its messages. The same class runs live
/// and on a recording: it takes the time from its messages. The only difference is when it uses the
/// results of work in the background (Context::results_used).
class Node : boost::noncopyable {
 public:
  virtual ~Node() = default;

  /// Processes the remaining queued data. Called once when the input has ended, before
  /// write_results().
  virtual void finish() {}

  /// Writes the module's files into `dir`, which exists. Throws std::runtime_error.
  virtual void write_results(const std::filesystem::path& dir) = 0;

  /// What the module has measured about its own work, for result.json.
  [[nodiscard]] virtual nlohmann::json metrics() const = 0;

  /// How well the module can do its work right now, for STATUS.
  [[nodiscard]] virtual Health health() const { return {}; }
};

}  // namespace nodmap::node
