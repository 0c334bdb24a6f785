// SPDX-License-Identifier: BSD-3-Clause
// What the checks are fed with: texts and facts read from this system.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace nodmap::doctor {

/// The content of a file (of /proc, for one); nothing when it cannot be read.
[[nodiscard]] std::optional<std::string> read_text(const std::filesystem::path& file);

/// Flags (net/if.h) of every network interface by name.
[[nodiscard]] std::map<std::string, unsigned int> interface_flags();

/// "name (pid)" of the process behind each socket, by inode; only of processes we may look into.
[[nodiscard]] std::map<std::uint64_t, std::string> socket_owners();

/// Where in PATH a program is.
[[nodiscard]] std::optional<std::filesystem::path> find_program(const std::string& name);

/// Bytes we may still write in a folder, or in the nearest one above that exists.
[[nodiscard]] std::int64_t available_bytes(std::filesystem::path dir);

/// Whether the kernel's clock is being steered by a time service.
[[nodiscard]] bool clock_is_synchronized();

/// Whether we may take the highest real-time priority of our configurations (procman/*.pmd).
[[nodiscard]] bool realtime_is_permitted();

}  // namespace nodmap::doctor
