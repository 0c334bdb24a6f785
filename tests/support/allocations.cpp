// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/allocations.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace nodmap::test {
namespace {

Allocations g_allocations;  // NOLINT: operator new has no other place for its state

}  // namespace

Allocations allocations() {
  return g_allocations;
}
void reset_allocations() {
  g_allocations = {};
}

}  // namespace nodmap::test

// NOLINTBEGIN: counting requires replacing the global operators
void* operator new(std::size_t size) {
  using nodmap::test::g_allocations;
  ++g_allocations.count;
  g_allocations.largest_bytes = std::max(g_allocations.largest_bytes, size);
  if (void* memory = std::malloc(size)) {
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
// NOLINTEND
