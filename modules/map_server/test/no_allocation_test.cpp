// SPDX-License-Identifier: BSD-3-Clause
// In a program of its own: it replaces operator new by one that counts.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <vector>

#include "modules/map_server/map_server.hpp"
#include "modules/map_server/test/world.hpp"

namespace {
std::size_t allocations = 0;
}

// NOLINTBEGIN(misc-new-delete-overloads,cppcoreguidelines-no-malloc): this is what the test is for.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) {
    return memory;
  }
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
// NOLINTEND(misc-new-delete-overloads,cppcoreguidelines-no-malloc)

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
  const std::size_t before = allocations;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const double k = static_cast<double>(i);
    server.add_scan(scans[i], geometry::to_se3({0.004 * k, 0, 0.002 * k}));
  }
  return allocations - before;
}

TEST(NoAllocation, R27_NoneAfterTheFirstScan) {
  const std::size_t before = allocations;
  EXPECT_FALSE(std::vector<int>(10).empty());
  ASSERT_GT(allocations, before) << "the counter does not count";
  EXPECT_EQ(allocations_after_first_scan(Rule::kPaper), 0U);
  EXPECT_EQ(allocations_after_first_scan(Rule::kConfirmed), 0U);
}

}  // namespace
}  // namespace nodmap::map_server
