// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/simulated_line.hpp"

#include <gtest/gtest.h>

#include <array>

namespace nodmap::trial {
namespace simulated_line_test {

using serial::IoStatus;
using std::chrono::microseconds;

constexpr std::array<std::uint8_t, 2> kWord{7, 8};

// Sends the time as one byte every millisecond.
class Ticker : public sim::SerialDevice {
 public:
  void receive(std::span<const std::uint8_t> bytes, int baud, time::SteadyTime now) override {
    received_bytes.insert(received_bytes.end(), bytes.begin(), bytes.end());
    received_baud = baud;
    received = now;
  }
  void transmit(time::SteadyTime now, int /*baud*/, std::vector<std::uint8_t>& line) override {
    for (; next <= now; next += 1ms) {
      line.push_back(static_cast<std::uint8_t>(next.time_since_epoch() / 1ms));
    }
  }
  [[nodiscard]] time::SteadyTime next_due() const override { return next; }
  [[nodiscard]] bool is_plugged_in(time::SteadyTime /*now*/) const override { return plugged; }

  std::vector<std::uint8_t> received_bytes;
  int received_baud = 0;
  time::SteadyTime received{};
  time::SteadyTime next{1ms};
  bool plugged = true;
};

class SimulatedLineTest : public ::testing::Test {
 protected:
  Ticker device_;
  SimulatedLine line_{device_};
  std::array<std::uint8_t, 16> buffer_{};

  serial::ReadResult read(serial::ByteStream& stream) {
    return stream.read(buffer_, microseconds(0));
  }
};

TEST_F(SimulatedLineTest, CarriesBytesBothWaysAtTheHostsRate) {
  const auto stream = line_.open(38400).stream;
  line_.move_bytes(time::SteadyTime(2ms));
  ASSERT_TRUE(stream->set_baud(500000));
  EXPECT_EQ(stream->write(kWord, microseconds(0)), IoStatus::kOk);
  EXPECT_EQ(device_.received_bytes, (std::vector<std::uint8_t>{7, 8}));
  EXPECT_EQ(device_.received_baud, 500000);
  EXPECT_EQ(device_.received, time::SteadyTime(2ms));
  EXPECT_EQ(read(*stream).count, 2U);
  EXPECT_EQ(buffer_[1], 2);
  EXPECT_EQ(read(*stream).status, IoStatus::kTimeout);
}

TEST_F(SimulatedLineTest, BytesWithoutAReaderAreLost) {
  line_.move_bytes(time::SteadyTime(5ms));
  const auto stream = line_.open(9600).stream;
  line_.move_bytes(time::SteadyTime(6ms));
  EXPECT_EQ(read(*stream).count, 1U);
  EXPECT_EQ(buffer_[0], 6);
}

TEST_F(SimulatedLineTest, AnUnpluggedDeviceDisconnectsForGood) {
  const auto stream = line_.open(9600).stream;
  device_.plugged = false;
  line_.move_bytes(time::SteadyTime(1ms));
  EXPECT_EQ(line_.open(9600).stream, nullptr);
  device_.plugged = true;  // back before the driver has looked
  line_.move_bytes(time::SteadyTime(2ms));
  EXPECT_EQ(read(*stream).status, IoStatus::kDisconnected);
  EXPECT_FALSE(stream->connected());
  EXPECT_NE(line_.open(9600).stream, nullptr);
}

TEST_F(SimulatedLineTest, HasOneHostAtATime) {
  auto first = line_.open(9600).stream;
  EXPECT_EQ(line_.open(9600).stream, nullptr);
  first.reset();
  EXPECT_NE(line_.open(9600).stream, nullptr);
}

// The last thing that a driver writes is the stop command; a killed driver does not write it.
TEST_F(SimulatedLineTest, NothingComesThroughACutLine) {
  const auto stream = line_.open(9600).stream;
  line_.cut();
  EXPECT_EQ(stream->write(kWord, microseconds(0)), IoStatus::kDisconnected);
  EXPECT_TRUE(device_.received_bytes.empty());
}

}  // namespace simulated_line_test
}  // namespace nodmap::trial
