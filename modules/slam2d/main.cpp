// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/node.hpp"

int main(int argc, char** argv) {
  return nodmap::node::run<nodmap::slam2d::Slam2dNode>(
      argc, argv,
      {"nodmap-slam2d",
       "3DOF SLAM: matches level scans against a 2D point map and corrects the pose."});
}
