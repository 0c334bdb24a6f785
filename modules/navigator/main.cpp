// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/run.hpp"
#include "modules/navigator/node.hpp"

int main(int argc, char** argv) {
  return nodmap::node::run<nodmap::navigator::NavigatorNode>(
      argc, argv,
      {"nodmap-navigator",
       "Drives the robot through free space, or to a goal, by the obstacle map (Holz et al. 2008, "
       "III C)."});
}
