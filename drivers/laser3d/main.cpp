// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/program.hpp"

int main(int argc, char** argv) {
  return nodmap::laser3d::run_laser3d(argc, argv);
}
