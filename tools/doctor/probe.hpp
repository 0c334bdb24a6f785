// SPDX-License-Identifier: BSD-3-Clause
// The input of the checks, read from this system.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace nodmap::doctor {

/// The content of a file, for example in /proc; empty if it cannot be read.
[[nodiscard]] std::optional<std::string> read_text(const std::filesystem::path& file);

/// Flags (net/if.h) of every network interface by name.
[[nodiscard]] std::map<std::string, unsigned int> interface_flags();

/// "name (pid)" of the process behind each socket, by inode; only of processes that we may inspect.
[[nodiscard]] std::map<std::uint64_t, std::string> socket_owners();

/// The path of a program in PATH.
[[nodiscard]] std::optional<std::filesystem::path> find_program(const std::string& name);

/// Free bytes for us in a folder, or in its nearest existing parent.
[[nodiscard]] std::int64_t available_bytes(std::filesystem::path dir);

/// Whether a time service synchronises the kernel's clock.
[[nodiscard]] bool clock_is_synchronized();

/// Whether we may take the highest real-time priority of our configurations (procman/*.pmd).
[[nodiscard]] bool realtime_is_permitted();

}  // namespace nodmap::doctor
