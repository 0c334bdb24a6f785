// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/host.hpp"

#include <unistd.h>

#include <array>

namespace nodmap::procman {

std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::filesystem::path own_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

}  // namespace nodmap::procman
