// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/process_names.hpp"
#include "common/node/run.hpp"
#include "modules/navigator/node.hpp"

int main(int argc, char** argv) {
  return nodmap::node::run<nodmap::navigator::NavigatorNode>(
      argc, argv,
      {nodmap::node::kNavigator,
       "Drives the robot to a goal, or wherever there is room: by plan, or by Steer, Brake and "
       "Turn (Holz et al. 2008, III C)."});
}
