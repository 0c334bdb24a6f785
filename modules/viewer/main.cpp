// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/viewer.hpp"

int main(int argc, char** argv) {
  return nodmap::viewer::run(argc, argv);
}
