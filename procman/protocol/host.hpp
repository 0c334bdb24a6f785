// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace nodmap::procman {

/// The name of this host.
[[nodiscard]] std::string host_name();

/// The folder of the running program. Throws std::filesystem::filesystem_error.
[[nodiscard]] std::filesystem::path own_folder();

}  // namespace nodmap::procman
