// SPDX-License-Identifier: BSD-3-Clause
// Bytes as a file that is not on a disk, for readers that need a path.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/formats/file_descriptor.hpp"

namespace nodmap::fuzz {

class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : fd_(::memfd_create("fuzz", 0)) {
    if (!fd_.is_open() || ::write(fd_.get(), data, size) != static_cast<ssize_t>(size)) {
      std::abort();
    }
  }

  [[nodiscard]] std::filesystem::path path() const {
    return "/proc/self/fd/" + std::to_string(fd_.get());
  }

 private:
  formats::FileDescriptor fd_;
};

}  // namespace nodmap::fuzz
