// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/program.hpp"

int main(int argc, char** argv) {
  return nodmap::procman::run_sheriff_program(argc, argv);
}
