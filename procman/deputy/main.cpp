// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/deputy.hpp"

int main(int argc, char** argv) {
  return nodmap::procman::run_deputy_program(argc, argv);
}
