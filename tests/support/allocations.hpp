// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace nodmap::test {

/// Counts calls of operator new since the last reset, in a test program that links
/// nodmap::test_allocations. For one thread only.
struct Allocations {
  std::size_t count = 0;
  std::size_t largest_bytes = 0;
};

[[nodiscard]] Allocations allocations();
void reset_allocations();

}  // namespace nodmap::test
