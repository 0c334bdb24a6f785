// SPDX-License-Identifier: BSD-3-Clause
#include "sim/program.hpp"

int main(int argc, char** argv) {
  return nodmap::sim::run_sim(argc, argv);
}
