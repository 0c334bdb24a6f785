// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/mcap_writer.hpp"

#include <algorithm>
#include <stdexcept>

namespace nodmap::convert {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

// Opcodes.
constexpr std::uint8_t kHeader = 0x01;
constexpr std::uint8_t kFooter = 0x02;
constexpr std::uint8_t kSchema = 0x03;
constexpr std::uint8_t kChannel = 0x04;
constexpr std::uint8_t kMessage = 0x05;
constexpr std::uint8_t kStatistics = 0x0B;
constexpr std::uint8_t kDataEnd = 0x0F;

/// The content of a record: little-endian numbers, strings with their length before them.
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

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path)
    : path_(path), out_(path, std::ios::binary) {
  out_ << kMagic;
  put_record(kHeader, Content().text("").text("nodmap " NODMAP_VERSION).bytes());
  if (!out_) {
    throw std::runtime_error(path.string() + ": cannot create");
  }
}

void McapWriter::put_record(std::uint8_t opcode, std::string_view content) {
  out_ << record(opcode, content);
}

std::uint16_t McapWriter::add_channel(const McapChannel& channel) {
  const auto number = static_cast<std::uint16_t>(counts_.size());
  counts_.push_back(0);
  // A schema for each channel, under the same number; 0 would mean "no schema".
  const auto schema = static_cast<std::uint16_t>(number + 1);
  const std::string definition = record(kSchema, Content()
                                                     .number(schema)
                                                     .text(channel.schema_name)
                                                     .text("jsonschema")
                                                     .text(channel.schema)
                                                     .bytes()) +
                                 record(kChannel, Content()
                                                      .number(number)
                                                      .number(schema)
                                                      .text(channel.topic)
                                                      .text("json")
                                                      .number(std::uint32_t{0})  // no metadata
                                                      .bytes());
  definitions_ += definition;
  out_ << definition;
  return number;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t log_time_ns,
                       std::uint64_t publish_time_ns, std::string_view json) {
  put_record(kMessage, Content()
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
}

void McapWriter::finish() {
  put_record(kDataEnd, Content().number(std::uint32_t{0}).bytes());  // no checksum
  const auto summary_start = static_cast<std::uint64_t>(out_.tellp());
  out_ << definitions_;
  Content counts;
  for (std::size_t channel = 0; channel < counts_.size(); ++channel) {
    counts.number(static_cast<std::uint16_t>(channel)).number(counts_[channel]);
  }
  put_record(kStatistics, Content()
                              .number(num_messages_)
                              .number(static_cast<std::uint16_t>(counts_.size()))
                              .number(static_cast<std::uint32_t>(counts_.size()))
                              .number(std::uint32_t{0})  // attachments
                              .number(std::uint32_t{0})  // metadata
                              .number(std::uint32_t{0})  // chunks
                              .number(first_ns_)
                              .number(last_ns_)
                              .text(counts.bytes())
                              .bytes());
  put_record(kFooter, Content()
                          .number(summary_start)
                          .number(std::uint64_t{0})  // no offsets
                          .number(std::uint32_t{0})  // no checksum
                          .bytes());
  out_ << kMagic;
  out_.flush();
  if (!out_) {
    throw std::runtime_error(path_.string() + ": the disk takes no more");
  }
}

}  // namespace nodmap::convert
