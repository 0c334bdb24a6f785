// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/servo/dynamixel_session.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "drivers/laser3d/test/fake_servo.hpp"

namespace nodmap::laser3d {
namespace dynamixel_session_test {

using test::FakeServo;
using test::operator+;  // NOLINT(misc-unused-using-decls): an operator is used

class Rig {
 public:
  explicit Rig(const ServoParams& params = {}) : dut(params, 40.0), baud_(params.baud) {
    servo.registers[11] = 3;
    for (std::size_t i = 0; i < 4; ++i) {  // the goal is where it stands
      servo.registers[116 + i] = static_cast<std::uint8_t>(2048U >> (8 * i));
    }
  }

  void open() { handle(dut.open(now)); }

  void run(double seconds) {
    const time::SteadyTime end = now + time::from_seconds(seconds);
    for (; now < end; now += 1ms) {
      servo.step_ms(static_cast<int>(now.time_since_epoch() / 1ms));
      const bool is_sent = now >= answer_sent_;
      const Bytes arrived =
          is_sent ? std::exchange(on_the_line_, std::exchange(delayed_, {})) : Bytes();
      handle(dut.receive(arrived, now));
      handle(dut.poll(now));
    }
  }

  DynamixelSession dut;
  FakeServo servo;
  time::SteadyTime now;
  std::vector<PitchSample> samples;
  struct {
    Bytes bytes;
    int before_answer = -1;  // to the n-th request, from 0
    bool arrives_with_it = false;
  } stale;  // an answer to an earlier request

 private:
  void handle(const ServoOutput& output) {
    if (!output.send.empty() && now < answer_sent_) {
      on_the_line_.clear();  // both directions share the line: each damages the other
    } else if (!output.send.empty()) {
      Bytes answer = servo.answer(output.send);
      const double bits = 10.0 * static_cast<double>(output.send.size() + answer.size());
      answer_sent_ = now + time::from_seconds(bits / baud_);
      if (num_requests_++ == stale.before_answer) {
        on_the_line_ = on_the_line_ + stale.bytes;
        if (!stale.arrives_with_it) {
          delayed_ = std::exchange(answer, {});
        }
      }
      on_the_line_ = on_the_line_ + answer;
    }
    if (output.sample) {
      samples.push_back(*output.sample);
    }
  }

  double baud_;  // bit/s
  time::SteadyTime answer_sent_;
  Bytes on_the_line_;
  Bytes delayed_;  // by a millisecond
  int num_requests_ = 0;
};

TEST(DynamixelSession, RunsAndReportsItsPosition) {
  Rig rig;
  rig.open();
  rig.run(0.5);
  EXPECT_TRUE(rig.dut.is_running());
  EXPECT_GT(rig.samples.size(), 90U);  // every 5 ms
  EXPECT_EQ(rig.samples.back().pitch_rad, 0.0);
  EXPECT_EQ(rig.servo.registers[64], 1);   // torque
  EXPECT_EQ(rig.servo.registers[98], 10);  // watchdog, 200 ms
}

TEST(DynamixelSession, AReadingMayTakeLongerThanAnAnswerOnAFastLine) {
  ServoParams params;
  params.baud = 9600;
  Rig rig(params);
  rig.open();
  rig.dut.aim(0.5, 1.0);
  rig.run(2.0);
  EXPECT_TRUE(rig.dut.is_running());
  EXPECT_GT(rig.samples.size(), 30U);  // a reading is 41 bytes, or 43 ms
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.5, dynamixel_x::kRadPerStep);
  EXPECT_EQ(rig.dut.line_counts().unanswered, 0);
}

// The driver before this one was killed while the servo answered, or the servo answered a request
// so late that it was repeated.
TEST(DynamixelSession, NoRequestIsLeftOutBecauseOfAStaleAnswer) {
  const Bytes written = test::hex("FF FF FD 00 01 04 00 55 00 A1 0C");
  const Bytes reading = FakeServo().answer(dynamixel_x::read_state(1));
  for (const Bytes& stale : {written, reading}) {
    for (const bool together : {true, false}) {
      for (int request = 0; request < 12; ++request) {
        SCOPED_TRACE(::testing::Message()
                     << (stale == written ? "written" : "reading") << " before answer " << request
                     << (together ? ", together" : ""));
        Rig rig;
        rig.stale = {stale, request, together};
        rig.servo.registers[98] = 0xFF;  // the watchdog triggered after the last session
        rig.dut.aim(0.5, 1.0);
        rig.open();
        rig.run(1.0);
        EXPECT_EQ(rig.servo.registers[64], 1);   // torque
        EXPECT_EQ(rig.servo.registers[98], 10);  // watchdog, 200 ms
        EXPECT_EQ(boost::endian::load_little_u32(&rig.servo.registers[108]), 107U);  // 40 rad/s^2
        EXPECT_NEAR(rig.servo.position, 2048.0 + 0.5 / dynamixel_x::kRadPerStep, 1.0);
        EXPECT_TRUE(rig.dut.is_running());
      }
    }
  }
}

TEST(DynamixelSession, AnotherServosAnswersAreNone) {
  ServoParams params;
  params.id = 2;  // the fake answers as 1
  Rig rig(params);
  rig.open();
  rig.run(0.5);
  EXPECT_FALSE(rig.dut.is_running());
  EXPECT_EQ(rig.dut.last_error(), "the servo does not answer");
}

TEST(DynamixelSession, MovesAtTheSpeedAsked) {
  Rig rig;
  rig.open();
  rig.run(0.5);
  rig.dut.aim(0.5, 1.0);
  rig.run(0.25);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.25, 2e-3);  // 2 ms of delay at 1 rad/s
  rig.run(1.0);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.5, dynamixel_x::kRadPerStep);
}

TEST(DynamixelSession, AnInvertedServoLooksUpForSmallerPositions) {
  ServoParams params;
  params.dynamixel.inverted = true;
  Rig rig(params);
  rig.open();
  rig.run(0.1);
  rig.dut.aim(0.5, 2.0);
  rig.run(1.0);
  EXPECT_LT(rig.servo.position, 2048.0);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.5, dynamixel_x::kRadPerStep);
}

TEST(DynamixelSession, TheModeIsWrittenOnlyIfItDiffers) {
  Rig same;
  same.open();
  same.run(0.3);
  EXPECT_EQ(same.servo.mode_writes, 0);
  Rig other;
  other.servo.registers[11] = 4;
  other.open();
  other.run(0.3);
  EXPECT_EQ(other.servo.mode_writes, 1);
  EXPECT_TRUE(other.dut.is_running());
}

TEST(DynamixelSession, ALostServoIsNoticedAndFoundAgain) {
  Rig rig;
  rig.open();
  rig.run(0.3);
  rig.servo.powered = false;
  rig.run(0.2);  // four times 40 ms without an answer
  EXPECT_FALSE(rig.dut.is_running());
  EXPECT_EQ(rig.dut.last_error(), "the servo does not answer");
  rig.run(20.0);
  rig.servo.powered = true;
  rig.run(6.0);  // the longest back-off is 5 s
  EXPECT_TRUE(rig.dut.is_running());
  EXPECT_EQ(rig.dut.line_counts().connections, 2);
}

TEST(DynamixelSession, AnAlertIsReportedAndTheServoRestarted) {
  Rig rig;
  rig.open();
  rig.run(0.3);
  rig.servo.registers[70] = 0x20;
  rig.servo.alert = true;
  rig.run(0.1);
  EXPECT_FALSE(rig.dut.is_running());
  EXPECT_EQ(rig.dut.last_error(), "the servo switched itself off: overload");
  EXPECT_EQ(rig.dut.line_counts().shutdowns, 1);
  rig.run(2.0);
  EXPECT_EQ(rig.servo.reboots, 1);
  EXPECT_TRUE(rig.dut.is_running());
}

// The servo keeps its torque at this error, so a restart would only drop the head; and while the
// supply stays weak, again and again.
TEST(DynamixelSession, AnAlertThatDoesNotSwitchTheServoOffIsOnlyReported) {
  for (const bool from_the_start : {true, false}) {
    Rig rig;
    rig.servo.registers[70] = 0x01;
    rig.servo.alert = from_the_start;
    rig.open();
    rig.run(0.3);
    rig.servo.alert = true;
    rig.run(0.1);
    const std::size_t samples = rig.samples.size();
    for (int i = 0; i < 1000; ++i) {
      rig.run(0.001);
      EXPECT_TRUE(rig.dut.is_running());
    }
    EXPECT_GT(rig.samples.size(), samples + 180);  // every 5 ms; some are left out for the alert
    EXPECT_EQ(rig.servo.reboots, 0);
    EXPECT_EQ(rig.dut.warning(), "the servo reports a fault: supply voltage");
    rig.servo.alert = false;
    rig.run(0.1);
    EXPECT_EQ(rig.dut.warning(), "");
    rig.servo.registers[70] = 0x21;
    rig.servo.alert = true;
    rig.run(0.3);
    EXPECT_EQ(rig.servo.reboots, 1);
    EXPECT_EQ(rig.dut.last_error(), "the servo switched itself off: supply voltage overload");
  }
}

TEST(DynamixelSession, ADamagedRequestIsRepeatedAlsoDuringAnAlert) {
  Rig rig;
  rig.servo.registers[70] = 0x01;
  rig.servo.alert = true;
  rig.open();
  rig.run(0.3);
  // At any time between two readings of the errors, which are 200 ms apart.
  for (int i = 0; i < 100; ++i) {
    const double goal_rad = i % 2 == 0 ? 0.02 : -0.02;
    rig.dut.aim(goal_rad, 5.0);
    rig.servo.damage_next = 1;
    rig.run(0.021);
    EXPECT_TRUE(rig.dut.is_running());
    EXPECT_NEAR(rig.servo.position, 2048.0 + goal_rad / dynamixel_x::kRadPerStep, 1.0);
  }
  EXPECT_EQ(rig.dut.line_counts().connections, 1);
  EXPECT_EQ(rig.dut.line_counts().damaged, 100);
}

TEST(DynamixelSession, AMoveThatIsRefusedAtAnAlertIsRepeated) {
  Rig rig;
  rig.servo.registers[70] = 0x01;
  rig.open();
  rig.run(0.3);
  rig.servo.alert = true;
  rig.servo.refuse_next = 1;
  rig.dut.aim(0.5, 5.0);
  rig.run(0.3);
  EXPECT_EQ(rig.dut.line_counts().connections, 1);
  EXPECT_NEAR(rig.servo.position, 2048.0 + 0.5 / dynamixel_x::kRadPerStep, 1.0);
}

TEST(DynamixelSession, AfterARestartItContinuesToItsGoal) {
  Rig rig;
  rig.open();
  rig.run(0.1);
  rig.dut.aim(0.4, 2.0);
  rig.run(1.0);
  rig.servo = FakeServo();
  rig.servo.registers[11] = 3;
  rig.servo.booted_ms =
      static_cast<int>(rig.now.time_since_epoch() / 1ms);  // without torque, but answering
  rig.run(2.0);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.4, dynamixel_x::kRadPerStep);
}

TEST(DynamixelSession, ADamagedRequestIsRepeatedAndOnlyManyInARowAreALoss) {
  Rig rig;
  rig.open();
  rig.run(0.2);
  rig.servo.damage_next = 3;
  rig.run(0.2);
  EXPECT_TRUE(rig.dut.is_running());
  EXPECT_EQ(rig.dut.line_counts().connections, 1);
  EXPECT_EQ(rig.dut.line_counts().damaged, 3);
  EXPECT_EQ(rig.dut.line_counts().unanswered, 0);
  rig.servo.damage_next = 1000;
  rig.run(0.05);
  EXPECT_FALSE(rig.dut.is_running());
}

TEST(DynamixelSession, PositionsWhereTheHeadCannotBeAreDropped) {
  Rig rig;
  rig.open();
  rig.run(0.2);
  for (const std::int32_t position :
       {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(),
        2048 + 4097, 2048 - 4097}) {
    rig.servo.told_position = position;
    rig.run(0.01);  // what is on the line already
    const std::size_t samples = rig.samples.size();
    const std::int64_t implausible = rig.dut.line_counts().implausible;
    rig.run(0.1);
    EXPECT_EQ(rig.samples.size(), samples) << position;
    EXPECT_GT(rig.dut.line_counts().implausible, implausible + 10) << position;
  }
  rig.servo.told_position = 2048 + 4096;
  rig.run(0.1);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 2.0 * geometry::kPi, 1e-9);
}

TEST(DynamixelSession, SamplesAreStampedWithinAMillisecond) {
  Rig rig;
  rig.open();
  rig.run(0.2);
  rig.dut.aim(1.0, 1.0);
  rig.run(0.6);
  // The fake moves at 42 units of 0.229 rpm (1.007 rad/s) in steps of 1 ms and answers 1 ms after
  // it was read: pitch and stamp must lie on one line.
  const PitchSample& a = rig.samples[rig.samples.size() - 60];
  const PitchSample& b = rig.samples.back();
  const double rate = (b.pitch_rad - a.pitch_rad) / time::seconds(b.stamp - a.stamp);
  EXPECT_NEAR(rate, 1.007, 0.0086);  // 1 ms and one step of 0.088 degrees in 0.3 s
}

TEST(DynamixelSession, AServoThatIsBackAfterLongIsFoundWithinASecond) {
  Rig rig;
  rig.open();
  rig.run(1.0);
  ASSERT_TRUE(rig.dut.is_running());
  rig.servo.powered = false;
  rig.run(20.0);
  EXPECT_FALSE(rig.dut.is_running());
  rig.servo.powered = true;
  // The pause, four questions that were not answered, and a session of a dozen requests.
  rig.run(1.0 + 4 * 0.041 + 0.1);
  EXPECT_TRUE(rig.dut.is_running());
}

}  // namespace dynamixel_session_test
}  // namespace nodmap::laser3d
