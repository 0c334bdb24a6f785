// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/process_names.hpp"
#include "common/node/run.hpp"
#include "modules/navigator/node.hpp"

int main(int argc, char** argv) {
  using namespace nodmap;
  navigator::NavigatorParams params;
  params::Table table(params);
  return node::run_node(
      argc, argv,
      {node::kNavigator,
       "Drives the robot to a goal, or wherever there is room: by plan, or by Steer, Brake and "
       "Turn (Holz et al. 2008, III C)."},
      table,
      [&params](node::Context& context) {
        return std::make_unique<navigator::NavigatorNode>(context, params);
      },
      [&params] { navigator::check(params); });
}
