// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/logger.hpp"

int main(int argc, char** argv) {
  return nodmap::logger::run(argc, argv);
}
