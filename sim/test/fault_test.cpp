// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/fault.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "sim/devices/simulated_robot.hpp"
#include "sim/test/host.hpp"

namespace nodmap::sim {
namespace fault_test {

using test::at;
using test::Host;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Fault, ReadsEveryKindFromText) {
  const Fault unplug = parse_fault("laser:unplug@10+2");
  EXPECT_EQ(unplug.part, Part::kLaser);
  EXPECT_EQ(unplug.kind, FaultKind::kUnplug);
  EXPECT_FALSE(unplug.is_active(at(9'999'999us)));
  EXPECT_TRUE(unplug.is_active(at(10s)));
  EXPECT_TRUE(unplug.is_active(at(11'999'999us)));
  EXPECT_FALSE(unplug.is_active(at(12s)));
  const Fault corrupt = parse_fault("base:corrupt@5+10.5=0.01");
  EXPECT_EQ(corrupt.part, Part::kBase);
  EXPECT_EQ(corrupt.kind, FaultKind::kCorrupt);
  EXPECT_EQ(corrupt.end(), at(15'500ms));
  EXPECT_EQ(corrupt.amount, 0.01);
}

TEST(Fault, PartsAndKindsHaveTheNamesThatAreRead) {
  for (const char* part : {"laser", "servo", "base"}) {
    EXPECT_EQ(name_of(parse_fault(std::string(part) + ":unplug@1+1").part), part);
  }
  for (const char* kind : {"drop", "corrupt", "delay"}) {
    EXPECT_EQ(name_of(parse_fault("laser:" + std::string(kind) + "@1+1=0.5").kind), kind);
  }
  for (const char* fault : {"laser:unplug", "laser:silent", "laser:freeze", "servo:stall"}) {
    const std::string text = fault;
    EXPECT_EQ(name_of(parse_fault(text + "@1+1").kind), text.substr(text.find(':') + 1));
  }
}

TEST(Fault, ErrorsNameWhatIsAllowed) {
  const std::vector<std::pair<const char*, const char*>> wrong = {
      {"", "':' is missing"},
      {"nose:drop@1+1=0.5", "laser, servo, base"},
      {"laser:melt@1+1", "drop, corrupt, delay, unplug, silent, freeze, stall"},
      {"laser:unplug", "'@' is missing"},
      {"laser:unplug@1", "'+' is missing"},
      {"laser:unplug@x+1", "the begin 'x' is not a number"},
      {"laser:unplug@-1+1", "the begin '-1' is not a number"},
      {"laser:unplug@1+nan", "the duration 'nan' is not a number"},
      {"laser:unplug@1+2=3", "the duration '2=3' is not a number"},
      {"base:drop@1+1", "'=' is missing"},
      {"base:drop@1+1=2", "the amount '2' is not a number from 0 to 1"},
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

// A device that sends one numbered byte every millisecond and records the received bytes.
class Counter : public SerialDevice {
 public:
  Bytes received;

  void receive(std::span<const std::uint8_t> bytes, int /*baud*/,
               time::SteadyTime /*now*/) override {
    append(received, bytes);
  }
  void transmit(time::SteadyTime now, int /*baud*/, std::vector<std::uint8_t>& line) override {
    for (; next_ <= now; next_ += 1ms) {
      line.push_back(static_cast<std::uint8_t>(next_.time_since_epoch() / 1ms));
    }
  }
  time::SteadyTime next_due() const override { return next_; }

 private:
  time::SteadyTime next_ = at(1ms);
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

TEST_F(FaultyDeviceTest, HasNoEffectOutsideItsTime) {
  start("base:drop@0.1+0.05=1");
  Host host(*line_, 9600);
  EXPECT_THAT(host.bytes_for(99'999us), ElementsAreArray(numbers(1, 99)));
  EXPECT_THAT(host.bytes_for(50ms), IsEmpty());
  EXPECT_THAT(host.bytes_for(50'001us), ElementsAreArray(numbers(150, 200)));
}

TEST_F(FaultyDeviceTest, DropsThisFractionOfBytesInBothDirections) {
  start("base:drop@0+100=0.25");
  Host host(*line_, 9600);
  // 10000 draws: their standard deviation is 43.
  EXPECT_NEAR(static_cast<double>(host.bytes_for(10s).size()), 7500.0, 200.0);
  host.send(Bytes(10'000, 7));
  EXPECT_NEAR(static_cast<double>(counter_.received.size()), 7500.0, 200.0);
}

TEST_F(FaultyDeviceTest, CorruptsOneBitInThisFractionOfBytes) {
  start("base:corrupt@0+100=0.1");
  Host host(*line_, 9600);
  const Bytes received = host.bytes_for(10s);
  ASSERT_EQ(received.size(), 10'000U);
  int wrong = 0;
  for (std::size_t i = 0; i < received.size(); ++i) {
    const int bits = __builtin_popcount(received[i] ^ static_cast<std::uint8_t>(i + 1));
    EXPECT_LE(bits, 1);
    wrong += bits;
  }
  EXPECT_NEAR(wrong, 1000, 150);  // standard deviation 30
}

TEST_F(FaultyDeviceTest, DelaysBytesWithoutChangingTheirOrder) {
  start("base:delay@0.05+0.05=0.02");
  Host host(*line_, 9600);
  EXPECT_THAT(host.bytes_for(49'999us), ElementsAreArray(numbers(1, 49)));
  EXPECT_THAT(host.bytes_for(20ms), IsEmpty());
  EXPECT_THAT(host.bytes_for(10'001us), ElementsAreArray(numbers(50, 60)));
  // Bytes sent after the fault wait for the last delayed byte, that of 99 ms.
  EXPECT_THAT(host.bytes_for(38ms), ElementsAreArray(numbers(61, 98)));
  EXPECT_THAT(host.bytes_for(2ms), ElementsAreArray(numbers(99, 120)));
}

TEST_F(FaultyDeviceTest, UnpluggedItPassesNoBytesInEitherDirection) {
  start("base:unplug@0.1+0.1");
  Host host(*line_, 9600);
  host.bytes_for(99'999us);
  EXPECT_TRUE(line_->is_plugged_in(host.now()));
  EXPECT_THAT(host.bytes_for(100ms), IsEmpty());
  EXPECT_FALSE(line_->is_plugged_in(host.now()));
  host.send(Bytes{1, 2, 3});
  EXPECT_THAT(counter_.received, IsEmpty());
  EXPECT_THAT(host.bytes_for(10'001us), ElementsAreArray(numbers(200, 210)));
  host.send(Bytes{4});
  EXPECT_THAT(counter_.received, ElementsAreArray(Bytes{4}));
}

TEST_F(FaultyDeviceTest, SilentItReceivesButDoesNotSend) {
  start("base:silent@0+1");
  Host host(*line_, 9600);
  EXPECT_THAT(host.bytes_for(500ms), IsEmpty());
  host.send(Bytes{1, 2, 3});
  EXPECT_THAT(counter_.received, ElementsAreArray(Bytes{1, 2, 3}));
}

TEST(FreezeFault, RepeatsTheLastMeasurementOfEachAngle) {
  const Beam clock = [](double angle_rad, time::SteadyTime fired) {
    return Echo{Echo::Kind::kRange, angle_rad + time::seconds(fired.time_since_epoch()), 0.5};
  };
  const Beam beam = with_freeze_faults(clock, {parse_fault("laser:freeze@1+1")});
  EXPECT_EQ(beam(0.5, at(900ms)).range_m, 0.5 + 0.9);
  EXPECT_EQ(beam(0.6, at(900ms)).range_m, 0.6 + 0.9);
  EXPECT_EQ(beam(0.5, at(1500ms)).range_m, 0.5 + 0.9);
  EXPECT_EQ(beam(0.6, at(1900ms)).range_m, 0.6 + 0.9);
  EXPECT_EQ(beam(0.5, at(2s)).range_m, 2.5);
}

TEST(SimulatedRobot, AStalledServoDoesNotMove) {
  SimulatedRobot robot(World{}, {}, {parse_fault("servo:stall@1+1")}, 1);
  Host host(robot.device(Part::kServo), 1'000'000);
  host.before_each([&robot](time::SteadyTime now) { robot.advance_to(now); });
  host.bytes_for(900ms);
  host.ask(test::hex("FF FF FD 00 01 06 00 03 40 00 01 DB 66"), 200ms);        // torque
  host.ask(test::hex("FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89"), 0s);  // far down
  host.bytes_for(800ms);
  EXPECT_NEAR(robot.model().pitch_rad(), 0.0, 1e-3);
  host.bytes_for(2s);
  EXPECT_LT(robot.model().pitch_rad(), -0.5);
}

}  // namespace fault_test
}  // namespace nodmap::sim
