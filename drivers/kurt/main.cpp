// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/program.hpp"

int main(int argc, char** argv) {
  return nodmap::kurt::run_kurt(argc, argv);
}
