// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>

#include "common/geometry/time.hpp"
#include "common/node/node.hpp"
#include "common/node/program.hpp"
#include "common/params/params.hpp"

namespace nodmap::node {

/// A node that also communicates with devices. It never blocks: its process calls spin_once() when
/// there is something to do.
class DeviceNode : public Node {
 public:
  /// Reads the bytes that the devices have sent and does everything that is due.
  virtual void spin_once() = 0;

  /// The descriptors of its devices; -1 for a device that is not open.
  [[nodiscard]] virtual std::array<int, 2> poll_handles() = 0;

  /// Time until spin_once() has something to do without new input.
  [[nodiscard]] virtual time::Duration wait() const = 0;

  /// Starts to send the devices their last commands, because the process must end. Then spin_once()
  /// is called until is_shut_down(), for at most half a second, and finally finish().
  virtual void shut_down() {}
  [[nodiscard]] virtual bool is_shut_down() const { return true; }

  void write_results(const std::filesystem::path& /*dir*/) override {}  // a driver leaves no files
};

using DeviceNodeFactory = std::function<std::unique_ptr<DeviceNode>(Context&)>;

/// main() of a driver: parameters, loop over bus and devices, STATUS, an orderly shutdown. `check`
/// as in Program. Returns the exit code of run_program().
int run_device_node(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                    const std::function<void()>& check, const DeviceNodeFactory& make_node);

}  // namespace nodmap::node
