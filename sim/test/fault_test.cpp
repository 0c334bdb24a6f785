// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/fault.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "sim/devices/simulated_robot.hpp"
#include "sim/test/host.hpp"

namespace nodmap::sim {
namespace {

using test::Host;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Fault, IsReadFromText) {
  const Fault unplug = parse_fault("laser:unplug@10+2");
  EXPECT_EQ(unplug.part, Part::kLaser);
  EXPECT_EQ(unplug.kind, FaultKind::kUnplug);
  EXPECT_FALSE(unplug.active(9'999'999));
  EXPECT_TRUE(unplug.active(10'000'000));
  EXPECT_TRUE(unplug.active(11'999'999));
  EXPECT_FALSE(unplug.active(12'000'000));
  const Fault corrupt = parse_fault("base:corrupt@5+10.5=0.01");
  EXPECT_EQ(corrupt.part, Part::kBase);
  EXPECT_EQ(corrupt.kind, FaultKind::kCorrupt);
  EXPECT_EQ(corrupt.end_us(), 15'500'000);
  EXPECT_EQ(corrupt.amount, 0.01);
}

TEST(Fault, WrongTextsSayWhatIsAllowed) {
  const std::vector<std::pair<const char*, const char*>> wrong = {
      {"", "':' is missing"},
      {"nose:drop@1+1=0.5", "laser, servo, base"},
      {"laser:melt@1+1", "drop, corrupt, delay, unplug, silent, freeze, stall"},
      {"laser:unplug", "'@' is missing"},
      {"laser:unplug@1", "'+' is missing"},
      {"laser:unplug@x+1", "the begin 'x' is no number"},
      {"laser:unplug@-1+1", "the begin '-1' is no number"},
      {"laser:unplug@1+nan", "the duration 'nan' is no number"},
      {"laser:unplug@1+2=3", "the duration '2=3' is no number"},
      {"base:drop@1+1", "'=' is missing"},
      {"base:drop@1+1=2", "the amount '2' is no number from 0 to 1"},
      {"base:freeze@1+1", "only the laser freezes"},
      {"laser:stall@1+1", "only the servo stalls"}};
  for (const auto& [text, reason] : wrong) {
    try {
      static_cast<void>(parse_fault(text));
      ADD_FAILURE() << text;
    } catch (const FaultError& error) {
      EXPECT_THAT(error.what(), HasSubstr(reason)) << text;
      EXPECT_THAT(error.what(), HasSubstr("PART:KIND@FROM+DURATION[=AMOUNT]"));
    }
  }
}

/// Says one numbered byte each millisecond, and remembers what it hears.
class Counter : public SerialDevice {
 public:
  Bytes heard;

  void receive(std::span<const std::uint8_t> bytes, int /*baud*/,
               std::int64_t /*now_us*/) override {
    append(heard, bytes);
  }
  void transmit(std::int64_t now_us, int /*baud*/, std::vector<std::uint8_t>& line) override {
    for (; next_us_ <= now_us; next_us_ += 1000) {
      line.push_back(static_cast<std::uint8_t>(next_us_ / 1000));
    }
  }
  std::int64_t next_us() const override { return next_us_; }

 private:
  std::int64_t next_us_ = 1000;
};

Bytes numbers(int from, int to) {
  Bytes bytes;
  for (int i = from; i <= to; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i));
  }
  return bytes;
}

class FaultyDeviceTest : public ::testing::Test {
 protected:
  void start(const char* fault) { line_.emplace(counter_, std::vector{parse_fault(fault)}, 1); }

  Counter counter_;
  std::optional<FaultyDevice> line_;
};

TEST_F(FaultyDeviceTest, OutsideOfItsTimeNothingIsAmiss) {
  start("base:drop@0.1+0.05=1");
  Host host(*line_, 9600);
  EXPECT_THAT(host.bytes_for(99'999), ElementsAreArray(numbers(1, 99)));
  EXPECT_THAT(host.bytes_for(50'000), IsEmpty());
  EXPECT_THAT(host.bytes_for(50'001), ElementsAreArray(numbers(150, 200)));
}

TEST_F(FaultyDeviceTest, DropsAShareInBothDirections) {
  start("base:drop@0+100=0.25");
  Host host(*line_, 9600);
  // 10000 draws: the standard deviation is 43.
  EXPECT_NEAR(static_cast<double>(host.bytes_for(10'000'000).size()), 7500.0, 200.0);
  host.send(Bytes(10'000, 7));
  EXPECT_NEAR(static_cast<double>(counter_.heard.size()), 7500.0, 200.0);
}

TEST_F(FaultyDeviceTest, CorruptsABitInAShare) {
  start("base:corrupt@0+100=0.1");
  Host host(*line_, 9600);
  const Bytes heard = host.bytes_for(10'000'000);
  ASSERT_EQ(heard.size(), 10'000U);
  int wrong = 0;
  for (std::size_t i = 0; i < heard.size(); ++i) {
    const int bits = __builtin_popcount(heard[i] ^ static_cast<std::uint8_t>(i + 1));
    EXPECT_LE(bits, 1);
    wrong += bits;
  }
  EXPECT_NEAR(wrong, 1000, 150);  // standard deviation 30
}

TEST_F(FaultyDeviceTest, DelaysWithoutOvertaking) {
  start("base:delay@0.05+0.05=0.02");
  Host host(*line_, 9600);
  EXPECT_THAT(host.bytes_for(49'999), ElementsAreArray(numbers(1, 49)));
  EXPECT_THAT(host.bytes_for(20'000), IsEmpty());
  EXPECT_THAT(host.bytes_for(10'001), ElementsAreArray(numbers(50, 60)));
  // Those of after the fault wait for the last late one, of 99 ms.
  EXPECT_THAT(host.bytes_for(38'000), ElementsAreArray(numbers(61, 98)));
  EXPECT_THAT(host.bytes_for(2'000), ElementsAreArray(numbers(99, 120)));
}

TEST_F(FaultyDeviceTest, UnpluggedNothingPassesEitherWay) {
  start("base:unplug@0.1+0.1");
  Host host(*line_, 9600);
  host.bytes_for(99'999);
  EXPECT_TRUE(line_->plugged_in(host.now_us()));
  EXPECT_THAT(host.bytes_for(100'000), IsEmpty());
  EXPECT_FALSE(line_->plugged_in(host.now_us()));
  host.send(Bytes{1, 2, 3});
  EXPECT_THAT(counter_.heard, IsEmpty());
  EXPECT_THAT(host.bytes_for(10'001), ElementsAreArray(numbers(200, 210)));
  host.send(Bytes{4});
  EXPECT_THAT(counter_.heard, ElementsAreArray(Bytes{4}));
}

TEST_F(FaultyDeviceTest, SilentItStillReceives) {
  start("base:silent@0+1");
  Host host(*line_, 9600);
  EXPECT_THAT(host.bytes_for(500'000), IsEmpty());
  host.send(Bytes{1, 2, 3});
  EXPECT_THAT(counter_.heard, ElementsAreArray(Bytes{1, 2, 3}));
}

TEST(FreezeFault, RepeatsTheLastMeasurementOfEachAngle) {
  const Beam clock = [](double angle_rad, std::int64_t time_us) {
    return Echo{Echo::Kind::kRange, angle_rad + 1e-6 * static_cast<double>(time_us), 0.5};
  };
  const Beam beam = with_freeze_faults(clock, {parse_fault("laser:freeze@1+1")});
  EXPECT_EQ(beam(0.5, 900'000).range_m, 0.5 + 0.9);
  EXPECT_EQ(beam(0.6, 900'000).range_m, 0.6 + 0.9);
  EXPECT_EQ(beam(0.5, 1'500'000).range_m, 0.5 + 0.9);
  EXPECT_EQ(beam(0.6, 1'900'000).range_m, 0.6 + 0.9);
  EXPECT_EQ(beam(0.5, 2'000'000).range_m, 2.5);
}

TEST(SimulatedRobot, AStalledServoStays) {
  SimulatedRobot robot(World{}, {}, {parse_fault("servo:stall@1+1")}, 1);
  Host host(robot.device(Part::kServo), 1'000'000);
  host.before_each([&robot](std::int64_t now_us) { robot.advance_to(now_us); });
  host.bytes_for(900'000);
  host.ask(test::hex("FF FF FD 00 01 06 00 03 40 00 01 DB 66"), 200'000);     // torque
  host.ask(test::hex("FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89"), 0);  // far down
  host.bytes_for(800'000);
  EXPECT_NEAR(robot.model().pitch_rad(), 0.0, 1e-3);
  host.bytes_for(2'000'000);
  EXPECT_LT(robot.model().pitch_rad(), -0.5);
}

}  // namespace
}  // namespace nodmap::sim
