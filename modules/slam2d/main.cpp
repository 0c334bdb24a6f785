// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/process_names.hpp"
#include "common/node/run.hpp"
#include "modules/slam2d/localiser_node.hpp"
#include "modules/slam2d/node.hpp"

int main(int argc, char** argv) {
  using namespace nodmap;
  slam2d::Slam2dParams values;
  params::Table table(values);
  return node::run_map_node(
      argc, argv,
      {node::kSlam2d,
       "2D SLAM: estimates the robot's pose in the plane from level scans, and draws the 2D map; "
       "with --localise, the pose in a finished map."},
      table,
      [&values](node::Context& context,
                const node::MapOptions& options) -> std::unique_ptr<node::Node> {
        if (!options.localise_in.empty()) {
          return std::make_unique<slam2d::LocaliserNode>(context, values, options);
        }
        return std::make_unique<slam2d::Slam2dNode>(context, values, options);
      });
}
