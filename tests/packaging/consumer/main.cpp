// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <nodmap/scan_t.hpp>
#include <procman_lcm/orders_t.hpp>

int main() {
  nodmap::scan_t scan{};
  std::printf("%d %d\n", scan.getEncodedSize(), procman_lcm::orders_t::getHash() != 0 ? 1 : 0);
  return 0;
}
