// SPDX-License-Identifier: BSD-3-Clause
// MCAP files, read again by a reader written from the specification alone.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "modules/viewer/foxglove/test/robot_log.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/convert/mcap_export.hpp"
#include "tools/convert/mcap_writer.hpp"

namespace nodmap::convert {
namespace {

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
  std::map<std::uint64_t, std::string> schemas;
  std::map<std::uint64_t, std::pair<std::string, std::uint64_t>>
      topics;  // channel -> topic, schema
  std::map<std::string, std::vector<std::pair<std::uint64_t, Json>>> messages;
  std::uint64_t count_in_statistics = 0;
  std::size_t data_end_at = 0;
  std::uint64_t summary_start = 0;
};

void take(File& file, std::uint64_t opcode, Reader content, std::size_t end) {
  if (opcode == 3) {
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
  Reader reader(std::string(std::istreambuf_iterator<char>(in), {}));
  const std::string magic("\x89MCAP0\r\n", 8);
  EXPECT_EQ(reader.raw(8), magic);
  File file;
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
  EXPECT_EQ(file.schemas.at(file.topics.at(0).second), "a.b");
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
}

TEST(McapExport, NeverOverwrites) {
  const nodmap::test::TemporaryDir dir;
  foxglove::test::write_robot_log(dir.path() / "robot.lcmlog", {.duration_s = 0.1});
  export_mcap(dir.path() / "robot.lcmlog", dir.path() / "robot.mcap");
  EXPECT_THROW(export_mcap(dir.path() / "robot.lcmlog", dir.path() / "robot.mcap"),
               std::runtime_error);
}

}  // namespace
}  // namespace nodmap::convert
