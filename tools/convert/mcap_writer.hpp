// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace nodmap::convert {

/// A channel of an MCAP file, with JSON messages.
struct McapChannel {
  std::string topic;
  std::string schema_name;
  std::string schema;  ///< JSON Schema
};

/// Writes MCAP, the container of Foxglove: without chunks and compression, with statistics.
/// Source: https://mcap.dev/spec
class McapWriter {
 public:
  /// Throws std::runtime_error when the file cannot be made.
  explicit McapWriter(const std::filesystem::path& path);

  /// Adds a channel and its schema; returns its number.
  std::uint16_t add_channel(const McapChannel& channel);

  /// Times in nanoseconds since the epoch.
  void write(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
             std::string_view json);

  /// Writes the end of the file. Throws std::runtime_error when the disk took not everything.
  void finish();

  [[nodiscard]] std::uint64_t num_messages() const { return num_messages_; }

 private:
  void put_record(std::uint8_t opcode, std::string_view content);

  std::filesystem::path path_;
  std::ofstream out_;
  std::vector<std::uint64_t> counts_;  // messages of each channel
  std::string definitions_;            // schema and channel records, again in the summary
  std::uint64_t num_messages_ = 0;
  std::uint64_t first_ns_ = 0;
  std::uint64_t last_ns_ = 0;
};

}  // namespace nodmap::convert
