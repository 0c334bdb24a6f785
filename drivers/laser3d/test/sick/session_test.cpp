// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/session.hpp"

#include <gtest/gtest.h>

#include "drivers/laser3d/test/fake_sensor.hpp"

namespace nodmap::laser3d {
namespace session_test {

using test::telegram_of;

using test::FakeSensor;
using test::operator+;  // NOLINT(misc-unused-using-decls): an operator is used
using State = SickSession::State;

// The session and the sensor on one line, on simulated time in steps of a millisecond.
class Rig {
 public:
  explicit Rig(const SickParams& params = {}) : dut(params) {}

  void open() { handle(dut.open(now)); }

  void run(double seconds) {
    const time::SteadyTime end = now + time::from_seconds(seconds);
    for (; now < end; now += 1ms) {
      if (sensor.powered && sensor.streaming && now.time_since_epoch() % 13ms == 0ms &&
          sensor.baud == line_baud) {
        receive(sensor.next_scan());
      }
      handle(dut.poll(now));
      const Bytes arrived = std::exchange(on_the_line_, {});
      receive(arrived);
    }
  }

  void receive(const Bytes& bytes) {
    parser_.feed(bytes, now);
    while (auto event = parser_.next()) {
      if (const auto* telegram = std::get_if<SickTelegram>(&*event)) {
        handle(dut.take(*telegram, now));
      }
    }
  }

  void handle(SickOutput output) {
    if (output.baud) {
      line_baud = *output.baud;
      parser_.reset(line_baud);
      on_the_line_.clear();
    }
    if (!output.send.empty()) {
      sent.push_back(output.send);
      // The answer to a change of the rate is sent at the old one.
      on_the_line_ = on_the_line_ + sensor.answer(output.send, line_baud);
    }
    if (output.scan) {
      ++scans;
      last_scan = std::move(output.scan);
    }
  }

  SickSession dut;
  FakeSensor sensor;
  time::SteadyTime now;
  int line_baud = 0;
  int scans = 0;
  std::optional<SickScan> last_scan;
  std::vector<Bytes> sent;

 private:
  SickParser parser_;
  Bytes on_the_line_;
};

TEST(SickSession, StreamsFromASensorJustSwitchedOn) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  EXPECT_EQ(rig.dut.state(), State::kStreaming);
  EXPECT_EQ(rig.dut.last_error(), "");
  EXPECT_EQ(rig.sensor.baud, 500000);
  EXPECT_GT(rig.scans, 50);
  EXPECT_EQ(rig.last_scan->ranges_m.size(), 181U);
}

TEST(SickSession, TakesOverASensorThatStreamsAlready) {
  Rig rig;
  rig.sensor.baud = 500000;
  rig.sensor.streaming = true;
  rig.open();
  rig.run(1.0);
  EXPECT_EQ(rig.dut.state(), State::kStreaming);
  EXPECT_GT(rig.scans, 50);
}

TEST(SickSession, WritesTheConfigurationOnlyIfItDiffers) {
  Rig same;
  same.open();
  same.run(4.0);
  EXPECT_EQ(same.sensor.config_writes, 0);

  Rig other;
  other.sensor.config[5] = 0x00;
  other.sensor.config[4] = 0x00;
  other.open();
  other.run(4.0);
  EXPECT_EQ(other.sensor.config_writes, 1);
  EXPECT_EQ(other.sensor.config, same.sensor.config);
  EXPECT_FALSE(other.sensor.installing);
  EXPECT_EQ(other.dut.state(), State::kStreaming);
}

TEST(SickSession, AConfigurationThatDoesNotStayIsNotWrittenForEver) {
  Rig rig;
  rig.sensor.config[6] = 0x00;
  rig.sensor.keeps_its_unit = true;
  rig.open();
  rig.run(300.0);
  EXPECT_EQ(rig.sensor.config_writes, 2);
  EXPECT_EQ(rig.scans, 0);
  EXPECT_EQ(rig.dut.last_error(), "the sensor does not keep the configuration");
  rig.sensor.config[6] = 0x01;  // another program has corrected it
  rig.run(10.0);
  EXPECT_EQ(rig.dut.state(), State::kStreaming);
}

TEST(SickSession, RepeatsUnansweredRequests) {
  Rig rig;
  rig.sensor.baud = 500000;
  rig.sensor.ignore_next = 2;
  rig.open();
  rig.run(3.0);
  EXPECT_EQ(rig.dut.state(), State::kStreaming);
  EXPECT_EQ(rig.dut.counts().retries, 2);
}

TEST(SickSession, ANakShortensTheWait) {
  Rig rig;
  rig.sensor.baud = 500000;
  rig.sensor.ignore_next = 1;
  rig.open();
  rig.dut.take_nak(rig.now);
  rig.run(0.1);
  EXPECT_EQ(rig.dut.state(), State::kStreaming);
}

TEST(SickSession, ARefusalIsReportedAndRetriedLater) {
  Rig rig;
  rig.sensor.deaf_to_variant = true;
  rig.open();
  rig.run(6.0);
  EXPECT_NE(rig.dut.state(), State::kStreaming);
  EXPECT_NE(rig.dut.last_error().find("refused to accept the angle"), std::string::npos)
      << rig.dut.last_error();
  rig.sensor.deaf_to_variant = false;
  rig.run(10.0);
  EXPECT_EQ(rig.dut.state(), State::kStreaming);
}

TEST(SickSession, ComesBackAfterAPowerLoss) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.sensor.powered = false;
  const int scans = rig.scans;
  rig.run(0.25);
  EXPECT_EQ(rig.dut.state(), State::kWaiting);  // noticed within 200 ms and one step of the mirror
  EXPECT_EQ(rig.dut.last_error(), "the stream of scans stopped");
  rig.run(60.0);
  EXPECT_EQ(rig.scans, scans);
  rig.sensor = FakeSensor();
  rig.run(20.0);
  EXPECT_EQ(rig.dut.state(), State::kStreaming);
  EXPECT_EQ(rig.dut.counts().connections, 2);
}

TEST(SickSession, ThePowerOnTelegramStartsAgainAtOnce) {
  SickParams params;
  params.baud = 9600;
  Rig rig(params);
  rig.open();
  rig.run(1.0);
  ASSERT_EQ(rig.dut.state(), State::kStreaming);
  rig.sensor = FakeSensor();
  rig.receive(test::kPowerOn);
  EXPECT_EQ(rig.dut.state(), State::kConnecting);
  rig.run(0.2);
  EXPECT_EQ(rig.dut.state(), State::kStreaming);
  EXPECT_EQ(rig.dut.counts().power_ons, 1);
}

TEST(SickSession, FrozenMeasurementsAreRefusedUntilTheyMoveAgain) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  const int before = rig.scans;
  rig.sensor.frozen = true;
  rig.run(0.3);
  EXPECT_LE(rig.scans - before, 11);
  EXPECT_EQ(rig.dut.last_error(), "the measurement is frozen");
  const int frozen = rig.scans;
  rig.run(10.0);
  EXPECT_EQ(rig.scans, frozen) << "a restart does not make the same values new";
  rig.sensor.frozen = false;
  rig.run(10.0);
  EXPECT_GT(rig.scans, frozen);
}

TEST(SickSession, AnInterlacedStreamThatFreezesIsNoticedInEveryQuarter) {
  SickParams params;
  params.interlaced = true;
  Rig rig(params);
  rig.sensor.interlaced = true;
  rig.open();
  rig.run(4.0);
  ASSERT_EQ(rig.dut.last_error(), "");
  EXPECT_EQ(rig.last_scan->quarter.has_value(), true);
  const int before = rig.scans;
  rig.sensor.frozen = true;
  rig.run(0.2);
  EXPECT_LE(rig.scans - before, 4 + params.frozen_scans);  // once in each quarter, repetitions
  EXPECT_EQ(rig.dut.last_error(), "the measurement is frozen");
  const int frozen = rig.scans;
  rig.run(10.0);
  EXPECT_EQ(rig.scans, frozen);
  rig.sensor.frozen = false;
  rig.run(10.0);
  EXPECT_GT(rig.scans, frozen);
}

TEST(SickSession, R1_EveryVariantStreamsItsNumberOfValues) {
  for (const SickVariant variant :
       {SickVariant::k180x100, SickVariant::k180x050, SickVariant::k100x100, SickVariant::k100x050,
        SickVariant::k100x025}) {
    SickParams params;
    params.variant = variant;
    Rig rig(params);
    rig.sensor.baud = 500000;
    rig.open();
    rig.run(1.0);
    ASSERT_TRUE(rig.last_scan);
    EXPECT_EQ(static_cast<int>(rig.last_scan->ranges_m.size()), geometry_of(variant).num_values());
  }
}

TEST(SickSession, ScansOfAnotherVariantAreNoStream) {
  Rig rig;
  rig.sensor.baud = 500000;
  rig.open();
  rig.run(0.5);
  rig.sensor.values = 361;
  const int scans = rig.scans;
  rig.run(0.3);
  EXPECT_EQ(rig.scans, scans);
  rig.run(2.0);  // the variant is set again
  EXPECT_GT(rig.scans, scans);
}

TEST(SickSession, LeavesTheSensorAt9600) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.handle(rig.dut.shut_down(rig.now));
  rig.run(0.1);
  EXPECT_EQ(rig.dut.state(), State::kClosed);
  EXPECT_FALSE(rig.sensor.streaming);
  EXPECT_EQ(rig.sensor.baud, 9600);
}

TEST(SickSession, NothingIsSentWhileClosed) {
  Rig rig;
  rig.open();
  rig.dut.close();
  rig.sent.clear();
  rig.run(5.0);
  EXPECT_TRUE(rig.sent.empty());
  EXPECT_EQ(rig.dut.last_error(), "not connected");
}

TEST(SickSession, SlowLinesAreGivenTheirTime) {
  SickParams params;
  params.baud = 9600;
  const SickSession slow(params);
  Rig rig(params);
  rig.open();
  rig.run(1.0);
  EXPECT_GT(rig.dut.stream_timeout(), 2 * 387'500us);  // one telegram of 372 bytes: 387.5 ms
}

TEST(SickStep, AnswersAreClassifiedByTheStepThatAsked) {
  const SickTelegram mode = telegram_of(test::kModeOk);
  EXPECT_EQ(classify_answer(SickStep::kSearch, mode), SickAnswer::kDone);
  EXPECT_EQ(classify_answer(SickStep::kReadConfig, mode), SickAnswer::kOther);
  EXPECT_EQ(classify_answer(SickStep::kStream, mode), SickAnswer::kOther);
  EXPECT_EQ(classify_answer(SickStep::kInstall, telegram_of(test::kWrongPassword)),
            SickAnswer::kRefused);
  EXPECT_EQ(classify_answer(SickStep::kSetVariant, telegram_of(test::kVariant180x100)),
            SickAnswer::kDone);
  EXPECT_EQ(classify_answer(SickStep::kSetVariant, telegram_of(test::kVariantRefused)),
            SickAnswer::kRefused);
  EXPECT_EQ(classify_answer(SickStep::kReadConfig, telegram_of(test::kConfig)), SickAnswer::kDone);
  EXPECT_EQ(classify_answer(SickStep::kWriteConfig, telegram_of(test::kConfigWritten)),
            SickAnswer::kDone);
  EXPECT_EQ(classify_answer(SickStep::kSearch, telegram_of(test::kNotAccepted)),
            SickAnswer::kRefused);
}

TEST(SickStep, NothingIsWrittenThatWasNotRead) {
  EXPECT_TRUE(request_of(SickStep::kWriteConfig, {}, std::nullopt).empty());
  EXPECT_TRUE(request_of(SickStep::kStream, {}, std::nullopt).empty());
}

}  // namespace session_test
}  // namespace nodmap::laser3d
