// SPDX-License-Identifier: BSD-3-Clause
// MCAP files, read by a reader written from the specification alone.
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "modules/viewer/foxglove/test/robot_log.hpp"
#include "modules/viewer/foxglove/test/robot_messages.hpp"
#include "nodmap/odometry_t.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/convert/mcap_export.hpp"
#include "tools/convert/mcap_writer.hpp"

namespace nodmap::convert {
namespace mcap_test {

using Json = nlohmann::json;

class Reader {
 public:
  explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}

  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= std::uint64_t{static_cast<unsigned char>(bytes_.at(at_ + i))} << (8 * i);
    }
    at_ += size;
    return value;
  }
  std::string raw(std::size_t size) {
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  std::string text() { return raw(number(4)); }
  std::string rest() { return raw(bytes_.size() - at_); }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

struct File {
  std::string bytes;
  std::size_t num_chunks = 0;
  std::uint64_t num_indexed = 0;  // messages found through the indexes
  std::map<std::uint64_t, std::string> schemas;
  std::map<std::uint64_t, std::pair<std::string, std::uint64_t>>
      topics;  // channel -> topic, schema
  std::map<std::string, std::vector<std::pair<std::uint64_t, Json>>> messages;
  std::uint64_t count_in_statistics = 0;
  std::size_t data_end_at = 0;
  std::uint64_t summary_start = 0;
};

std::string unpacked(const std::string& packed, std::uint64_t size) {
  std::string bytes(size, '\0');
  EXPECT_EQ(::ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size()), size);
  return bytes;
}

// The records of a chunk.
std::string records_of(Reader& chunk) {
  chunk.number(8);
  chunk.number(8);
  const std::uint64_t size = chunk.number(8);
  EXPECT_EQ(chunk.number(4), 0U) << "checksum";
  EXPECT_EQ(chunk.text(), "zstd");
  return unpacked(chunk.raw(chunk.number(8)), size);
}

// Counts messages as a reader does that searches for a topic: from the index of a chunk to the
// indexes of its channels to the messages.
void follow_index(File& file, Reader index) {
  const std::uint64_t first_ns = index.number(8);
  const std::uint64_t last_ns = index.number(8);
  Reader in_file(file.bytes);
  in_file.raw(index.number(8));
  EXPECT_EQ(in_file.number(1), 6U);
  const std::uint64_t chunk_bytes = in_file.number(8);
  EXPECT_EQ(index.number(8), chunk_bytes + 9);
  Reader chunk(in_file.raw(chunk_bytes));
  const std::string records = records_of(chunk);
  Reader offsets(index.text());
  while (offsets.at() < offsets.size()) {
    const std::uint64_t channel = offsets.number(2);
    Reader places(file.bytes);
    places.raw(offsets.number(8));
    EXPECT_EQ(places.number(1), 7U);
    places.number(8);
    EXPECT_EQ(places.number(2), channel);
    Reader entries(places.text());
    while (entries.at() < entries.size()) {
      const std::uint64_t time_ns = entries.number(8);
      Reader message(records);
      message.raw(entries.number(8));
      EXPECT_EQ(message.number(1), 5U);
      message.number(8);
      EXPECT_EQ(message.number(2), channel);
      message.number(4);
      EXPECT_EQ(message.number(8), time_ns);
      EXPECT_TRUE(first_ns <= time_ns && time_ns <= last_ns);
      ++file.num_indexed;
    }
  }
}

void take(File& file, std::uint64_t opcode, Reader content, std::size_t end);

void take_all(File& file, const std::string& records) {
  Reader reader(records);
  while (reader.at() < reader.size()) {
    const std::uint64_t opcode = reader.number(1);
    std::string content = reader.raw(reader.number(8));
    take(file, opcode, Reader(std::move(content)), 0);
  }
}

void take(File& file, std::uint64_t opcode, Reader content, std::size_t end) {
  if (opcode == 6) {
    ++file.num_chunks;
    take_all(file, records_of(content));
  } else if (opcode == 8) {
    follow_index(file, content);
  } else if (opcode == 3) {
    const std::uint64_t id = content.number(2);
    file.schemas[id] = content.text();
    EXPECT_EQ(content.text(), "jsonschema");
    EXPECT_TRUE(Json::accept(content.text()));
  } else if (opcode == 4) {
    const std::uint64_t id = content.number(2);
    const std::uint64_t schema = content.number(2);
    file.topics[id] = {content.text(), schema};
    EXPECT_EQ(content.text(), "json");
  } else if (opcode == 5) {
    const std::string topic = file.topics.at(content.number(2)).first;
    auto& list = file.messages[topic];
    EXPECT_EQ(content.number(4), list.size()) << "sequence";
    const std::uint64_t log_time = content.number(8);
    content.number(8);
    list.emplace_back(log_time, Json::parse(content.rest()));
  } else if (opcode == 11) {
    file.count_in_statistics = content.number(8);
  } else if (opcode == 15) {
    file.data_end_at = end;
  } else if (opcode == 2) {
    file.summary_start = content.number(8);
  }
}

File read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  File file;
  file.bytes = std::string(std::istreambuf_iterator<char>(in), {});
  Reader reader(file.bytes);
  const std::string magic("\x89MCAP0\r\n", 8);
  EXPECT_EQ(reader.raw(8), magic);
  std::uint64_t opcode = 0;
  while (opcode != 2 && reader.at() < reader.size()) {
    opcode = reader.number(1);
    const std::uint64_t size = reader.number(8);
    std::string content = reader.raw(size);
    take(file, opcode, Reader(std::move(content)), reader.at());
  }
  EXPECT_EQ(reader.rest(), magic);
  return file;
}

TEST(McapWriter, WritesWhatAReaderFinds) {
  const nodmap::test::TemporaryDir dir;
  McapWriter writer(dir.path() / "a.mcap");
  const std::uint16_t channel = writer.add_channel({"A", "a.b", "{}"});
  writer.write(channel, 5, 4, R"({"x":1})");
  writer.write(channel, 7, 6, R"({"x":2})");
  writer.finish();
  const File file = read(dir.path() / "a.mcap");
  ASSERT_EQ(file.messages.at("A").size(), 2U);
  EXPECT_EQ(file.messages.at("A")[1].first, 7U);
  EXPECT_EQ(file.messages.at("A")[1].second["x"], 2);
  EXPECT_EQ(file.count_in_statistics, 2U);
  EXPECT_EQ(file.summary_start, file.data_end_at);
  EXPECT_EQ(file.num_indexed, 2U);
  EXPECT_EQ(file.schemas.at(file.topics.at(0).second), "a.b");
}

// Times that step back, as in a log merged from several, are also found by the index.
TEST(McapWriter, ManyChunksAreIndexedWhateverTheOrderOfTimes) {
  const nodmap::test::TemporaryDir dir;
  McapWriter writer(dir.path() / "a.mcap");
  const std::uint16_t a = writer.add_channel({"A", "a.b", "{}"});
  const std::uint16_t b = writer.add_channel({"B", "a.b", "{}"});
  const std::string json = "\"" + std::string(1000, 'x') + "\"";
  constexpr std::uint64_t kNum = 5000;
  for (std::uint64_t i = 0; i < kNum; ++i) {
    writer.write(i % 3 == 0 ? a : b, 1'000'000 - 7 * (i % 100) + i, 0, json);
  }
  writer.finish();
  const File file = read(dir.path() / "a.mcap");
  EXPECT_GT(file.num_chunks, 4U);
  EXPECT_EQ(file.num_indexed, kNum);
  EXPECT_EQ(file.messages.at("A").size() + file.messages.at("B").size(), kNum);
  EXPECT_EQ(file.count_in_statistics, kNum);
  EXPECT_LT(file.bytes.size(), kNum * 100) << "not compressed";
}

TEST(McapExport, HoldsEveryMessageOfTheLog) {
  const nodmap::test::TemporaryDir dir;
  foxglove::test::write_robot_log(dir.path() / "robot.lcmlog", {.duration_s = 2.0});
  export_mcap(dir.path() / "robot.lcmlog", dir.path() / "robot.mcap");
  const File file = read(dir.path() / "robot.mcap");
  EXPECT_EQ(file.messages.at("PITCH_STATE").size(), 400U);
  EXPECT_EQ(file.messages.at("SCAN").size(), 150U);
  EXPECT_EQ(file.messages.at("CLOUD").size(), 2U);
  EXPECT_EQ(file.messages.at("MAP_2D").size(), 2U);
  EXPECT_EQ(file.messages.at("OCTOMAP").size(), 2U);
  EXPECT_EQ(file.messages.at("ODOMETRY")[100].first,
            1000U * (foxglove::test::kBeginUs + 1'000'000));
  EXPECT_EQ(file.messages.at("ODOMETRY")[100].second["position_m"][0], 0.5);
  // A reader that uses the summary, as Foxglove does, finds all of them.
  std::uint64_t num_messages = 0;
  for (const auto& [topic, messages] : file.messages) {
    num_messages += messages.size();
  }
  EXPECT_EQ(file.count_in_statistics, num_messages);
  EXPECT_EQ(file.num_indexed, num_messages);
}

// A pause of an hour, which playing skips.
TEST(McapExport, KeepsTheLogTimesAfterAPause) {
  const nodmap::test::TemporaryDir dir;
  {
    bus::LogWriter log(dir.path() / "a.lcmlog");
    std::vector<std::byte> bytes;
    for (const std::int64_t utime_us : {1'000'000'000LL, 1'001'000'000LL, 4'600'000'000LL}) {
      nodmap::odometry_t message{};
      message.utime = utime_us;
      message.orientation[0] = 1.0;
      bus::encode_into(bytes, message);
      ASSERT_TRUE(log.write(utime_us, "ODOMETRY", bytes));
    }
  }
  export_mcap(dir.path() / "a.lcmlog", dir.path() / "a.mcap");
  const auto messages = read(dir.path() / "a.mcap").messages.at("ODOMETRY");
  ASSERT_EQ(messages.size(), 3U);
  EXPECT_EQ(messages.back().first, 4'600'000'000'000U);
}

// The field of a message that a panel of a layout names: "SCAN.angle_step_rad".
void expect_field(const File& file, const std::string& path) {
  const std::size_t dot = path.find('.');
  const std::string topic = path.substr(0, dot);
  ASSERT_TRUE(file.messages.contains(topic)) << path;
  if (dot != std::string::npos) {
    EXPECT_TRUE(file.messages.at(topic).front().second.contains(path.substr(dot + 1))) << path;
  }
}

TEST(McapExport, ContainsEveryFieldOfTheFoxgloveLayout) {
  const nodmap::test::TemporaryDir dir;
  foxglove::test::write_robot_log(dir.path() / "robot.lcmlog", {.duration_s = 2.0});
  export_mcap(dir.path() / "robot.lcmlog", dir.path() / "robot.mcap");
  const File file = read(dir.path() / "robot.mcap");
  std::ifstream in(NODMAP_FOXGLOVE_LAYOUT);
  const Json panels = Json::parse(in).at("configById");
  for (const auto& [topic, settings] : panels.at("3D!nodmap").at("topics").items()) {
    EXPECT_TRUE(std::ranges::any_of(file.topics, [&topic = topic](const auto& entry) {
      return entry.second.first == topic;
    })) << topic;
  }
  for (const char* plot : {"Plot!speed", "Plot!pitch"}) {
    for (const Json& path : panels.at(plot).at("paths")) {
      expect_field(file, path.at("value"));
    }
  }
  expect_field(file, panels.at("RawMessages!navigation").at("topicPath"));
  expect_field(file, panels.at("Table!processes").at("topicPath"));
}

TEST(McapExport, NeverOverwrites) {
  const nodmap::test::TemporaryDir dir;
  foxglove::test::write_robot_log(dir.path() / "robot.lcmlog", {.duration_s = 0.1});
  export_mcap(dir.path() / "robot.lcmlog", dir.path() / "robot.mcap");
  EXPECT_THROW(export_mcap(dir.path() / "robot.lcmlog", dir.path() / "robot.mcap"),
               std::runtime_error);
}

}  // namespace mcap_test
}  // namespace nodmap::convert
