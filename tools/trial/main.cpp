// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/program.hpp"

int main(int argc, char** argv) {
  return nodmap::trial::run_trial(argc, argv);
}
