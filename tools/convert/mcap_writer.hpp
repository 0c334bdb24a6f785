// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nodmap::convert {

/// A channel of an MCAP file, with JSON messages.
struct McapChannel {
  std::string topic;
  std::string schema_name;
  std::string schema;  ///< JSON Schema
};

/// Writes MCAP, Foxglove's container format: messages in chunks compressed with zstd, indexes by
/// which a reader finds a time or a topic without reading the rest, and statistics. Source:
/// https://mcap.dev/spec
/// Throws std::system_error, naming the file, if it cannot be created or written.
class McapWriter {
 public:
  explicit McapWriter(const std::filesystem::path& path);

  /// Adds a channel and its schema; returns its number.
  std::uint16_t add_channel(const McapChannel& channel);

  /// Writes a message; times in nanoseconds since the epoch.
  void write(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
             std::string_view json);

  /// Writes the end of the file.
  void finish();

  [[nodiscard]] std::uint64_t num_messages() const { return num_messages_; }

 private:
  /// Messages that are collected before they are compressed and written.
  struct Chunk {
    std::string records;
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    /// For each channel, the times of its messages and their positions in `records`.
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index;
  };

  void put(std::string_view bytes);
  void put_record(std::uint8_t opcode, std::string_view content);
  void write_chunk();
  [[nodiscard]] std::string statistics() const;

  std::filesystem::path path_;
  std::ofstream out_;
  Chunk chunk_;
  std::string chunk_indexes_;  // records for the summary
  std::uint32_t num_chunks_ = 0;
  std::vector<std::uint64_t> counts_;  // messages of each channel
  std::string schemas_;                // records, which are repeated in the summary
  std::string channels_;
  std::uint64_t num_messages_ = 0;
  std::uint64_t first_ns_ = 0;
  std::uint64_t last_ns_ = 0;
};

}  // namespace nodmap::convert
