// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>

#include "common/node/map_options.hpp"
#include "common/node/node.hpp"
#include "common/node/program.hpp"
#include "common/params/params.hpp"

namespace nodmap::node {

using NodeFactory = std::function<std::unique_ptr<Node>(Context&)>;
using MapNodeFactory = std::function<std::unique_ptr<Node>(Context&, const MapOptions&)>;

/// main() of a process that handles messages, live on LCM or with --replay: reads the parameters,
/// runs the message loop, publishes STATUS and writes the results. `check`: throws what is wrong
/// with the parameters. Returns the exit code of run_program().
int run_node(int argc, char** argv, const ProgramInfo& info, params::Table& table,
             const NodeFactory& make_node, const std::function<void()>& check = nullptr);

/// run_node() for a process that also has the options --localise, --map-in and --start-pose.
int run_map_node(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                 const MapNodeFactory& make_node, const std::function<void()>& check = nullptr);

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
