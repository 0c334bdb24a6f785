// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/process_names.hpp"
#include "common/node/run.hpp"
#include "modules/slam6d/node.hpp"

int main(int argc, char** argv) {
  using namespace nodmap;
  slam6d::Slam6dParams values;
  params::Table table(values);
  return node::run_map_node(
      argc, argv,
      {node::kSlam6d,
       "6D SLAM: registers the sweeps of a nodding laser into a 3D model and an OctoMap."},
      table,
      [&values](node::Context& context,
                const node::MapOptions& options) -> std::unique_ptr<node::Node> {
        return std::make_unique<slam6d::Slam6dNode>(context, values, options);
      },
      [&values] { slam6d::check(values); });
}
