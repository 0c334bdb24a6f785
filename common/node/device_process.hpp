// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "common/node/node.hpp"

namespace nodmap::node {

/// A node with devices beside the bus. It never waits for them: its process wakes it.
class DeviceNode : public Node {
 public:
  /// Takes in what the devices have sent and does what is due.
  virtual void turn() = 0;

  /// The descriptors of its devices; -1 while there is none.
  [[nodiscard]] virtual std::array<int, 2> poll_handles() = 0;

  /// Time until turn() has something to do by itself, microseconds.
  [[nodiscard]] virtual std::int64_t wait_us() const = 0;

  /// The process is asked to end: begins what has to be said to the devices. The node is turned on
  /// until at_rest(), for half a second at most, then finish() comes.
  virtual void shut_down() {}
  [[nodiscard]] virtual bool at_rest() const { return true; }

  void write_results(const std::filesystem::path& /*dir*/) override {}  // a driver leaves no files
};

using DeviceNodeFactory = std::function<std::unique_ptr<DeviceNode>(Context&)>;

/// The life of a driver's process: command line, parameters, loop over bus and devices, STATUS, an
/// end in order. `check` says in one sentence what is wrong with parameters that are valid one by
/// one; empty: nothing. Returns the exit code: 0 done, 1 failed, 2 wrong command line or
/// configuration.
int run_device_process(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                       const std::function<std::string()>& check,
                       const DeviceNodeFactory& make_node);

}  // namespace nodmap::node
