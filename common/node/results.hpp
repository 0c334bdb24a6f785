// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>

#include "common/bus/bus.hpp"
#include "common/formats/file_descriptor.hpp"
#include "common/node/message_counts.hpp"

namespace nodmap::node {

/// Creates an empty folder for results. Throws std::runtime_error if it exists and is not empty, so
/// that results are never overwritten.
void make_result_dir(const std::filesystem::path& dir);

/// The folder of a live process, which has it alone for as long as this object lives: another
/// process would overwrite what it writes at its end.
struct LiveResultDir {
  std::filesystem::path path;
  formats::FileDescriptor lock = formats::FileDescriptor();
};

/// The same for a live process, which may be restarted: if `dir` contains results, or belongs to a
/// process that is running, creates and returns the first of DIR.2, DIR.3, ... that does not.
/// Returns an empty name unchanged.
[[nodiscard]] LiveResultDir make_next_result_dir(const std::filesystem::path& dir);

/// What has become of a process's messages: "messages" of result.json.
[[nodiscard]] nlohmann::json messages_json(const bus::Bus& bus, const MessageCounts& counts);

/// Calls all of these, each of which writes one result: one that cannot be written does not prevent
/// the others. Afterwards throws what the first of those that failed has thrown.
void write_each(std::initializer_list<std::function<void()>> writers);

/// Writes DIR/result.json; an older one stays in place until the new one is complete. Bytes that
/// are not UTF-8 become U+FFFD. Throws std::runtime_error, naming the file, if it cannot be
/// written.
void write_result_json(const std::filesystem::path& dir, const nlohmann::json& result);

}  // namespace nodmap::node
