// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a PLY file, read as a cloud and as a mesh: points and faces, or an error message.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>

#include "common/formats/ply.hpp"
#include "tests/fuzz/memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const nodmap::fuzz::MemoryFile file(data, size);
  try {
    if (nodmap::formats::read_ply(file.path()).size() > size) {
      std::abort();  // more points than bytes
    }
  } catch (const std::runtime_error&) {
  }
  try {
    static_cast<void>(nodmap::formats::read_ply_mesh(file.path()));
  } catch (const std::runtime_error&) {
  }
  return 0;
}
