// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/mcap_writer.hpp"

#include <zstd.h>

#include <algorithm>
#include <stdexcept>

#include "tools/convert/new_file.hpp"

namespace nodmap::convert {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

// Opcodes.
constexpr std::uint8_t kHeader = 0x01;
constexpr std::uint8_t kFooter = 0x02;
constexpr std::uint8_t kSchema = 0x03;
constexpr std::uint8_t kChannel = 0x04;
constexpr std::uint8_t kMessage = 0x05;
constexpr std::uint8_t kChunk = 0x06;
constexpr std::uint8_t kMessageIndex = 0x07;
constexpr std::uint8_t kChunkIndex = 0x08;
constexpr std::uint8_t kStatistics = 0x0B;
constexpr std::uint8_t kSummaryOffset = 0x0E;
constexpr std::uint8_t kDataEnd = 0x0F;

// How much a reader must unpack to get one message: a few seconds of the robot's data.
constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;

// Builds the content of a record: little-endian numbers, and strings preceded by their length.
class Content {
 public:
  template <class Unsigned>
  Content& number(Unsigned value) {
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
      bytes_.push_back(static_cast<char>((value >> (8 * i)) & 0xFFU));
    }
    return *this;
  }
  Content& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    return raw(value);
  }
  Content& raw(std::string_view value) {
    bytes_.append(value);
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(std::uint8_t opcode, std::string_view content) {
  return Content()
      .number(opcode)
      .number(static_cast<std::uint64_t>(content.size()))
      .raw(content)
      .bytes();
}

std::string compressed(const std::string& bytes) {
  std::string packed(::ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ::ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(),
                                           ZSTD_CLEVEL_DEFAULT);
  if (::ZSTD_isError(size) != 0) {
    throw std::runtime_error(std::string("zstd: ") + ::ZSTD_getErrorName(size));
  }
  packed.resize(size);
  return packed;
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path)
    : path_(path), out_(path, std::ios::binary) {
  put(kMagic);
  put_record(kHeader, Content().text("").text("nodmap " NODMAP_VERSION).bytes());
}

void McapWriter::put(std::string_view bytes) {
  out_ << bytes;
  require_written(out_, path_);
}

void McapWriter::put_record(std::uint8_t opcode, std::string_view content) {
  put(record(opcode, content));
}

std::uint16_t McapWriter::add_channel(const McapChannel& channel) {
  const auto number = static_cast<std::uint16_t>(counts_.size());
  counts_.push_back(0);
  // Each channel has a schema with a related number; 0 would mean "no schema".
  const auto schema = static_cast<std::uint16_t>(number + 1);
  const std::string schema_record = record(kSchema, Content()
                                                        .number(schema)
                                                        .text(channel.schema_name)
                                                        .text("jsonschema")
                                                        .text(channel.schema)
                                                        .bytes());
  const std::string channel_record = record(kChannel, Content()
                                                          .number(number)
                                                          .number(schema)
                                                          .text(channel.topic)
                                                          .text("json")
                                                          .number(std::uint32_t{0})  // no metadata
                                                          .bytes());
  schemas_ += schema_record;
  channels_ += channel_record;
  put(schema_record + channel_record);
  return number;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t log_time_ns,
                       std::uint64_t publish_time_ns, std::string_view json) {
  chunk_.first_ns = chunk_.records.empty() ? log_time_ns : std::min(chunk_.first_ns, log_time_ns);
  chunk_.last_ns = std::max(chunk_.last_ns, log_time_ns);
  chunk_.index[channel].emplace_back(log_time_ns, chunk_.records.size());
  chunk_.records += record(kMessage, Content()
                                         .number(channel)
                                         .number(static_cast<std::uint32_t>(counts_[channel]))
                                         .number(log_time_ns)
                                         .number(publish_time_ns)
                                         .raw(json)
                                         .bytes());
  first_ns_ = num_messages_ == 0 ? log_time_ns : std::min(first_ns_, log_time_ns);
  last_ns_ = std::max(last_ns_, log_time_ns);
  ++counts_[channel];
  ++num_messages_;
  if (chunk_.records.size() >= kChunkBytes) {
    write_chunk();
  }
}

// Writes the chunk, then for each channel the positions of its messages in it, and remembers the
// positions of all this for the summary.
void McapWriter::write_chunk() {
  if (chunk_.records.empty()) {
    return;
  }
  const std::string packed = compressed(chunk_.records);
  const auto chunk_start = static_cast<std::uint64_t>(out_.tellp());
  put_record(kChunk, Content()
                         .number(chunk_.first_ns)
                         .number(chunk_.last_ns)
                         .number(static_cast<std::uint64_t>(chunk_.records.size()))
                         .number(std::uint32_t{0})  // no checksum
                         .text("zstd")
                         .number(static_cast<std::uint64_t>(packed.size()))
                         .raw(packed)
                         .bytes());
  const auto index_start = static_cast<std::uint64_t>(out_.tellp());
  Content index_offsets;
  for (auto& [channel, places] : chunk_.index) {
    std::ranges::stable_sort(places,
                             [](const auto& a, const auto& b) { return a.first < b.first; });
    Content entries;
    for (const auto& [time_ns, offset] : places) {
      entries.number(time_ns).number(offset);
    }
    index_offsets.number(channel).number(static_cast<std::uint64_t>(out_.tellp()));
    put_record(kMessageIndex, Content().number(channel).text(entries.bytes()).bytes());
  }
  const auto end = static_cast<std::uint64_t>(out_.tellp());
  chunk_indexes_ +=
      record(kChunkIndex, Content()
                              .number(chunk_.first_ns)
                              .number(chunk_.last_ns)
                              .number(chunk_start)
                              .number(index_start - chunk_start)
                              .text(index_offsets.bytes())
                              .number(end - index_start)
                              .text("zstd")
                              .number(static_cast<std::uint64_t>(packed.size()))
                              .number(static_cast<std::uint64_t>(chunk_.records.size()))
                              .bytes());
  ++num_chunks_;
  chunk_ = {};
}

std::string McapWriter::statistics() const {
  Content counts;
  for (std::size_t channel = 0; channel < counts_.size(); ++channel) {
    counts.number(static_cast<std::uint16_t>(channel)).number(counts_[channel]);
  }
  return record(kStatistics, Content()
                                 .number(num_messages_)
                                 .number(static_cast<std::uint16_t>(counts_.size()))
                                 .number(static_cast<std::uint32_t>(counts_.size()))
                                 .number(std::uint32_t{0})  // attachments
                                 .number(std::uint32_t{0})  // metadata
                                 .number(num_chunks_)
                                 .number(first_ns_)
                                 .number(last_ns_)
                                 .text(counts.bytes())
                                 .bytes());
}

void McapWriter::finish() {
  write_chunk();
  put_record(kDataEnd, Content().number(std::uint32_t{0}).bytes());  // no checksum
  const auto summary_start = static_cast<std::uint64_t>(out_.tellp());
  Content offsets;
  const auto put_group = [&](std::uint8_t opcode, const std::string& records) {
    if (records.empty()) {
      return;
    }
    offsets.raw(record(kSummaryOffset, Content()
                                           .number(opcode)
                                           .number(static_cast<std::uint64_t>(out_.tellp()))
                                           .number(static_cast<std::uint64_t>(records.size()))
                                           .bytes()));
    put(records);
  };
  put_group(kSchema, schemas_);
  put_group(kChannel, channels_);
  put_group(kStatistics, statistics());
  put_group(kChunkIndex, chunk_indexes_);
  const auto offsets_start = static_cast<std::uint64_t>(out_.tellp());
  put(offsets.bytes());
  put_record(kFooter, Content()
                          .number(summary_start)
                          .number(offsets_start)
                          .number(std::uint32_t{0})  // no checksum
                          .bytes());
  put(kMagic);
  out_.flush();
  require_written(out_, path_);
}

}  // namespace nodmap::convert
