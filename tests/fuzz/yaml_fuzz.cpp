// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a configuration and as a world: accepted, or an error message.
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "common/params/params.hpp"
#include "drivers/kurt/params.hpp"
#include "sim/world/world_file.hpp"
#include "tests/fuzz/memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const nodmap::fuzz::MemoryFile file(data, size);
  nodmap::kurt::KurtParams params;
  nodmap::params::Table table(params);
  try {
    table.load_yaml(file.path());
  } catch (const std::runtime_error&) {
  }
  try {
    static_cast<void>(nodmap::sim::load_world(file.path()));
  } catch (const std::runtime_error&) {
  }
  return 0;
}
