// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace nodmap::node {

/// Makes an empty folder for results. Throws std::runtime_error when it exists and is not empty:
/// results are never overwritten.
void make_result_dir(const std::filesystem::path& dir);

/// The same for a live process, which may be started again beside its former results: where there
/// are some, makes and returns the first of DIR.2, DIR.3, ... that holds none. An empty name makes
/// no folder and is returned.
[[nodiscard]] std::filesystem::path make_next_result_dir(const std::filesystem::path& dir);

/// Writes DIR/result.json. Throws std::runtime_error naming the file when the disk does not take
/// it.
void write_result_json(const std::filesystem::path& dir, const nlohmann::json& result);

}  // namespace nodmap::node
