// SPDX-License-Identifier: BSD-3-Clause
// In a program of its own: it links an operator new that counts.
#include <gtest/gtest.h>

#include <vector>

#include "modules/map_server/map_server.hpp"
#include "modules/map_server/test/world.hpp"
#include "tests/support/allocations.hpp"

namespace nodmap::map_server {
namespace {

std::size_t allocations_after_first_scan(Rule rule) {
  MapServerParams params;
  params.update_rule = rule;
  MapServer server(params);
  test::NoddingScanner scanner;
  const test::World world = test::room(-2, 10, -3, 3);
  std::vector<scan::Scan> scans;
  for (int i = 0; i < 500; ++i) {
    scans.push_back(scanner.scan(world, {0.004 * i, 0, 0.002 * i}));
  }
  server.add_scan(scans[0], geometry::SE3::Identity());
  nodmap::test::reset_allocations();
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const auto k = static_cast<double>(i);
    server.add_scan(scans[i], geometry::to_se3({0.004 * k, 0, 0.002 * k}));
  }
  return nodmap::test::allocations().count;
}

TEST(NoAllocation, R27_NoneAfterTheFirstScan) {
  EXPECT_EQ(allocations_after_first_scan(Rule::kPaper), 0U);
  EXPECT_EQ(allocations_after_first_scan(Rule::kConfirmed), 0U);
}

}  // namespace
}  // namespace nodmap::map_server
