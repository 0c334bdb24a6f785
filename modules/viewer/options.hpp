// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace nodmap::viewer {

inline constexpr const char* kProgram = "nodmap-viewer";

/// What the command line says, apart from the parameters.
struct Options {
  std::string lcm_url;
  std::string bind = "127.0.0.1";  ///< address to listen on
  std::uint16_t port = 8765;
  bool control = false;                       ///< clients with the token may control the robot
  std::filesystem::path procman;              ///< and these processes; empty: none
  std::vector<std::filesystem::path> replay;  ///< recordings to play; empty: live
};

}  // namespace nodmap::viewer
