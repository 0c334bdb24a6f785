// SPDX-License-Identifier: BSD-3-Clause
// Telegrams as the manual prints them, or as an independent script computed them from its rules;
// tests send requests and check the answers.
#include "sim/devices/lms200.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/geometry/angle.hpp"
#include "sim/test/host.hpp"

namespace nodmap::sim {
namespace lms200_test {

using test::hex;
using test::Host;
using test::operator+;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

const Bytes kAck = hex("06");
const Bytes kModeOk = hex("02 80 03 00 A0 00 10 16 0A");
const Bytes kNotAccepted = hex("02 80 02 00 92 10 7F 33");
const Bytes kStream = hex("02 00 02 00 20 24 34 08");
const Bytes kStop = hex("02 00 02 00 20 25 35 08");
const Bytes kInstall = hex("02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5");
const Bytes kVariant180x050 = hex("02 00 05 00 3B B4 00 32 00 3B 1F");
const Bytes kReadConfig = hex("02 00 01 00 74 50 12");
const Bytes kPowerOn =
    hex("02 80 17 00 90 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 63 5E");
const Bytes kWriteConfig = hex("02 00 23 00 77 00 00 70 00 02 06 01 00 00 02 02 00x21 02 00 51 49");

constexpr time::Duration kBootTime = 1s;
// The answer to a change of mode begins after 50 ms, and scans begin when its nine bytes have been
// sent.
constexpr time::Duration kModeTime = 50'190us;

Echo flat(double /*angle_rad*/, time::SteadyTime /*fired*/) {
  return {Echo::Kind::kRange, 1.0, 0.5};
}

// Ranges that increase by 1 mm per degree, from 1000 mm at the right.
Echo ramp(double angle_rad, time::SteadyTime /*fired*/) {
  return {Echo::Kind::kRange, 1.0 + 0.001 * (geometry::rad_to_deg(angle_rad) + 90.0), 0.5};
}

Bytes words(int count, int first, int step) {
  Bytes bytes;
  for (int i = 0; i < count; ++i) {
    append_little_endian(bytes, static_cast<std::uint32_t>(first + i * step), 2);
  }
  return bytes;
}

// A started sensor at 500 kbaud, from power-on, by default without drift.
class Lms200Test : public ::testing::Test {
 protected:
  static Lms200Params params() {
    Lms200Params params;
    params.baud = 500'000;
    params.mirror_ppm = 0.0;
    return params;
  }

  void start(const Lms200Params& params, Beam beam) {
    laser_ = std::make_unique<Lms200>(params, std::move(beam));
    host_ = std::make_unique<Host>(*laser_, params.baud);
    EXPECT_THAT(host_->bytes_for(2 * kBootTime), ElementsAreArray(kPowerOn));
  }
  void start() { start(params(), flat); }

  Bytes ask(const std::string& request, time::Duration duration = 1500ms) {
    return host_->ask(hex(request), duration);
  }

  // The times of the first bytes of the stream's telegrams within a duration.
  std::vector<time::SteadyTime> telegram_starts(std::size_t size, time::Duration duration) {
    std::vector<time::SteadyTime> starts;
    std::size_t count = 0;
    for (const auto& portion : host_->portions_until(host_->now() + duration)) {
      const std::size_t before = (count + size - 1) / size;
      count += portion.bytes.size();
      if ((count + size - 1) / size > before) {
        const auto into = static_cast<double>(count - before * size);
        starts.push_back(portion.received - time::from_seconds(into * 10.0 / host_->baud()));
      }
    }
    return starts;
  }

  std::unique_ptr<Lms200> laser_;
  std::unique_ptr<Host> host_;
};

TEST_F(Lms200Test, SendsNothingBeforeItHasStarted) {
  Lms200 laser(params(), flat);
  Host host(laser, 500'000);
  EXPECT_THAT(host.ask(kStop, kBootTime - 1us), IsEmpty());
  EXPECT_THAT(host.bytes_for(10ms), ElementsAreArray(kPowerOn));
}

TEST_F(Lms200Test, AnswersAreAsInTheManual) {
  const std::vector<std::pair<const char*, const char*>> talk = {
      {"02 00 02 00 20 25 35 08", "02 80 03 00 A0 00 10 16 0A"},
      {"02 00 02 00 20 10 00 08", "02 80 03 00 A0 00 10 16 0A"},
      {"02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5", "02 80 03 00 A0 00 10 16 0A"},
      {"02 00 05 00 3B B4 00 64 00 97 49", "02 80 07 00 BB 01 B4 00 64 00 10 5B 30"},
      {"02 00 05 00 3B B4 00 32 00 3B 1F", "02 80 07 00 BB 01 B4 00 32 00 10 03 9D"},
      {"02 00 01 00 32 16 12", "02 80 02 00 B2 10 3F 13"},
      {"02 00 01 00 3A 1E 12",
       "02 80 17 00 BA 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 22 61"},
      {"02 00 01 00 74 50 12",
       "02 80 24 00 F4 00 00 70 00 02 06 01 00 00 02 02 00x21 02 00 10 B9 F9"}};
  start();
  for (const auto& [request, answer] : talk) {
    EXPECT_THAT(ask(request), ElementsAreArray(kAck + hex(answer))) << request;
  }
}

TEST_F(Lms200Test, RefusesInvalidRequestsAsTheRealSensorDoes) {
  start();
  Bytes wrong_password = hex("02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 54");
  append_little_endian(wrong_password, lms_checksum(wrong_password), 2);
  EXPECT_THAT(host_->ask(wrong_password),
              ElementsAreArray(kAck + hex("02 80 03 00 A0 01 10 14 0B")));
  EXPECT_THAT(host_->ask(kWriteConfig), ElementsAreArray(kAck + kNotAccepted))
      << "only in installation mode";
  Bytes odd_variant = hex("02 00 05 00 3B B4 00 19 00");
  append_little_endian(odd_variant, lms_checksum(odd_variant), 2);
  EXPECT_THAT(host_->ask(odd_variant),
              ElementsAreArray(kAck + hex("02 80 07 00 BB 00 B4 00 64 00 10 7B 20")))
      << "180 degrees at 0.25 exist only as partial scans";
  EXPECT_THAT(ask("02 00 06 00 20 27 1B 00 2B 01 FF FE"), ElementsAreArray(kAck + kNotAccepted))
      << "sub-ranges are not emulated, so they are refused";
}

TEST_F(Lms200Test, AcceptsAConfigurationInInstallationModeOnly) {
  Lms200Params as_delivered = params();
  as_delivered.config = hex("00 00 46 00 00 00 01 00 00 02 02 00x21 02 00");
  start(as_delivered, flat);
  EXPECT_THAT(host_->ask(kInstall), ElementsAreArray(kAck + kModeOk));
  EXPECT_THAT(host_->ask(kWriteConfig),
              ElementsAreArray(kAck + hex("02 80 25 00 F7 01 00 00 70 00 02 06 01 00 00 02 02 "
                                          "00x21 02 00 10 40 78")));
  EXPECT_THAT(host_->ask(kStop), ElementsAreArray(kAck + kModeOk));
  EXPECT_THAT(host_->ask(kReadConfig),
              ElementsAreArray(kAck + hex("02 80 24 00 F4 00 00 70 00 02 06 01 00 00 02 02 00x21 "
                                          "02 00 10 B9 F9")));
}

TEST_F(Lms200Test, AnswersDamagedRequestsWithNakAndIgnoresOtherAddresses) {
  start();
  EXPECT_THAT(ask("02 00 02 00 20 25 35 09"), ElementsAreArray(hex("15")));
  Bytes for_another = hex("02 05 02 00 20 25");
  append_little_endian(for_another, lms_checksum(for_another), 2);
  EXPECT_THAT(host_->ask(for_another), IsEmpty());
  EXPECT_THAT(ask("02 00 02 00 20"), IsEmpty()) << "the rest comes after more than 6 ms";
  EXPECT_THAT(ask("25 35 08"), IsEmpty());
  EXPECT_THAT(host_->ask(kStop), ElementsAreArray(kAck + kModeOk));
}

TEST_F(Lms200Test, AnswersWithItsOwnAddress) {
  Lms200Params first = params();
  first.address = 1;
  laser_ = std::make_unique<Lms200>(first, flat);
  host_ = std::make_unique<Host>(*laser_, 500'000);
  host_->bytes_for(2 * kBootTime);
  EXPECT_THAT(host_->ask(kStop), ElementsAreArray(kAck + hex("02 81 03 00 A0 00 10 36 1A")));
}

TEST_F(Lms200Test, CommunicatesOnlyAtItsBaudRate) {
  Lms200Params at_9600 = params();
  at_9600.baud = 9600;
  start(at_9600, flat);
  host_->set_baud(500'000);
  EXPECT_THAT(host_->ask(kStop), IsEmpty()) << "it cannot read this";
  host_->set_baud(9600);
  host_->send(kStop);
  host_->set_baud(500'000);
  const Bytes noise = host_->bytes_for(1s);
  EXPECT_FALSE(noise.empty());
  EXPECT_THAT(noise, ::testing::Not(ElementsAreArray(kAck + kModeOk)));
}

TEST_F(Lms200Test, ChangesItsBaudRateAfterAnsweringAtTheOldOne) {
  Lms200Params at_9600 = params();
  at_9600.baud = 9600;
  start(at_9600, flat);
  EXPECT_THAT(ask("02 00 02 00 20 48 58 08"), ElementsAreArray(kAck + kModeOk));
  EXPECT_EQ(laser_->baud(), 500'000);
  host_->set_baud(500'000);
  EXPECT_THAT(host_->ask(kStop), ElementsAreArray(kAck + kModeOk));
  // After a restart it is at 9600 again, because the rate was not made permanent.
  EXPECT_THAT(ask("02 00 01 00 10 34 12", 500ms),
              ElementsAreArray(kAck + hex("02 80 02 00 91 10 79 30")));
  host_->set_baud(9600);
  EXPECT_THAT(host_->bytes_for(2 * kBootTime), ElementsAreArray(kPowerOn));
}

TEST_F(Lms200Test, APermanentBaudRateIsKeptAfterARestart) {
  Lms200Params at_9600 = params();
  at_9600.baud = 9600;
  start(at_9600, flat);
  ask("02 00 02 00 20 40 50 08");
  host_->set_baud(38'400);
  ask("02 00 02 00 66 01 9D 4E");
  ask("02 00 01 00 10 34 12", 200ms);
  EXPECT_THAT(host_->bytes_for(2 * kBootTime), ElementsAreArray(kPowerOn));
}

TEST_F(Lms200Test, TelegramsOfMeasuredValuesAreAsComputed) {
  Lms200Params no_indices = params();
  no_indices.config[4] = 0;
  start(no_indices, flat);
  const Bytes scan = ask("02 00 02 00 30 01 31 18", 60ms);
  EXPECT_THAT(scan, ElementsAreArray(kAck + hex("02 80 6E 01 B0 B5 40") + words(181, 1000, 0) +
                                     hex("10 95 6D")));
  start(no_indices, ramp);
  EXPECT_THAT(
      ask("02 00 02 00 30 01 31 18", 60ms),
      ElementsAreArray(kAck + hex("02 80 6E 01 B0 B5 40") + words(181, 1000, 1) + hex("10 B3 BE")));
  start(no_indices, flat);
  host_->ask(kVariant180x050);
  EXPECT_THAT(
      ask("02 00 02 00 30 01 31 18", 100ms),
      ElementsAreArray(kAck + hex("02 80 D6 02 B0 69 41") + words(361, 1000, 0) + hex("10 55 F1")));
}

TEST_F(Lms200Test, EncodesReadingsThatAreNotRanges) {
  const LmsFormat near{0x00, true};
  const LmsFormat far{0x06, true};
  const LmsFormat coarse{0x00, false};
  const Echo nothing{Echo::Kind::kNothing, 0.0, 0.0};
  const Echo dazzled{Echo::Kind::kDazzled, 0.0, 0.0};
  const auto range = [](double range_m) { return Echo{Echo::Kind::kRange, range_m, 0.5}; };
  EXPECT_EQ(lms_word(nothing, near), 8183);
  EXPECT_EQ(lms_word(nothing, {0x03, true}), 16375);
  EXPECT_EQ(lms_word(nothing, far), 32759);
  EXPECT_EQ(lms_word(dazzled, {0x02, true}), 8190);
  EXPECT_EQ(lms_word(dazzled, far), 32766);
  EXPECT_EQ(lms_word(dazzled, near), 0x8000 | 8190) << "mode 0 also has a flag for it";
  EXPECT_EQ(lms_word(range(8.1824), near), 8182) << "the last range in this mode";
  EXPECT_EQ(lms_word(range(9.0), near), 8183);
  EXPECT_EQ(lms_word(range(9.0), far), 9000);
  EXPECT_EQ(lms_word(range(9.004), coarse), 900);
  EXPECT_EQ(lms_word(range(0.0006), far), 1);
}

// R1: 75 mirror revolutions per second; the first byte is sent when the last beam has been
// measured.
TEST_F(Lms200Test, StreamsEachRevolutionAtTheEndOfItsMeasuringHalf) {
  start();
  EXPECT_THAT(host_->ask(kStream, kModeTime), ElementsAreArray(kAck + kModeOk));
  const std::vector<time::SteadyTime> starts = telegram_starts(374, 10s);
  ASSERT_GT(starts.size(), 700U);
  const double mean_us = time::FineDuration(starts.back() - starts.front()).count() /
                         static_cast<double>(starts.size() - 1);
  EXPECT_NEAR(mean_us, 13'320.0, 1.0);
  for (const time::SteadyTime start : starts) {
    // Revolutions start every 13.32 ms from power-on at time 0; their measuring half lasts 6.66 ms.
    // Rounding the duration of a byte and of a revolution to microseconds costs up to 2 us.
    EXPECT_NEAR(std::remainder(time::FineDuration(start - test::at(6660us)).count(), 13'320.0), 0.0,
                2.0);
  }
}

TEST_F(Lms200Test, HalfDegreesTakeTwoRevolutions) {
  start();
  host_->ask(kVariant180x050);
  host_->ask(kStream, kModeTime);
  const std::vector<time::SteadyTime> starts = telegram_starts(734, 5s);
  ASSERT_GT(starts.size(), 150U);
  const double mean_us = time::FineDuration(starts.back() - starts.front()).count() /
                         static_cast<double>(starts.size() - 1);
  // Start times are rounded to microseconds; the mean is over more than 150 of them.
  EXPECT_NEAR(mean_us, 26'640.0, 0.02);
}

TEST_F(Lms200Test, EachBeamIsMeasuredAtItsOwnTime) {
  std::vector<std::pair<double, time::SteadyTime>> beams;
  start(params(), [&beams](double angle_rad, time::SteadyTime fired) {
    beams.emplace_back(geometry::rad_to_deg(angle_rad), fired);
    return Echo{Echo::Kind::kRange, 1.0, 0.5};
  });
  host_->ask(kVariant180x050);
  beams.clear();
  ask("02 00 02 00 30 01 31 18", 100ms);
  ASSERT_EQ(beams.size(), 361U);
  EXPECT_NEAR(beams.front().first, -90.0, 1e-9);
  EXPECT_NEAR(beams[180].first, 90.0, 1e-9);
  EXPECT_NEAR(beams[181].first, -89.5, 1e-9);
  EXPECT_NEAR(beams.back().first, 89.5, 1e-9);
  EXPECT_EQ(beams[180].second - beams[0].second, 6660us) << "half a revolution";
  // The second revolution starts 13.32 ms after the first, shifted by half a degree (18.5 us).
  EXPECT_NEAR(time::FineDuration(beams[181].second - beams[0].second).count(), 13'338.5, 1.0);
}

TEST_F(Lms200Test, CountsRevolutionsAndTelegrams) {
  start();
  host_->ask(kStream, kModeTime);
  const Bytes stream = host_->bytes_for(4s);
  ASSERT_GT(stream.size(), 256U * 374U) << "so that the counts wrap around";
  for (std::size_t i = 1; (i + 1) * 374 <= stream.size(); ++i) {
    const auto index = [&stream](std::size_t telegram, std::size_t which) {
      return stream[telegram * 374 + 7 + 362 + which];
    };
    EXPECT_EQ(index(i, 0), static_cast<std::uint8_t>(index(i - 1, 0) + 1));
    EXPECT_EQ(index(i, 1), static_cast<std::uint8_t>(index(i - 1, 1) + 1));
  }
}

TEST_F(Lms200Test, OnASlowLineRevolutionsAreSkipped) {
  Lms200Params slow = params();
  slow.baud = 38'400;
  start(slow, flat);
  host_->ask(kStream, 54ms);
  std::set<int> steps;
  const std::vector<time::SteadyTime> starts = telegram_starts(374, 5s);
  ASSERT_GT(starts.size(), 40U);
  for (std::size_t i = 1; i < starts.size(); ++i) {
    steps.insert(
        static_cast<int>(std::lround((starts[i] - starts[i - 1]) / time::FineDuration(13'320.0))));
  }
  // 374 bytes take 97.4 ms: the line is free again during the eighth revolution.
  EXPECT_THAT(steps, ::testing::ElementsAre(8));
}

TEST_F(Lms200Test, PartialScansComeEveryRevolutionEachShifted) {
  start(params(), ramp);
  ask("02 00 05 00 3B 64 00 19 00 E7 72");
  ask("02 00 02 00 20 2A 3A 08", kModeTime);
  const Bytes stream = host_->bytes_for(200ms);
  std::vector<std::uint32_t> headers;
  std::vector<std::uint32_t> firsts;
  for (std::size_t at = 0; at + 7 < stream.size();) {
    ASSERT_EQ(stream[at], 0x02);
    headers.push_back(little_endian(ByteView(stream).subspan(at + 5, 2)));
    at += little_endian(ByteView(stream).subspan(at + 2, 2)) + 6;
  }
  ASSERT_GE(headers.size(), 12U);
  const std::vector<std::uint32_t> cycle = {0x60B5, 0x68B4, 0x70B4, 0x78B4};
  const auto offset =
      static_cast<std::size_t>(std::ranges::find(cycle, headers[0]) - cycle.begin());
  for (std::size_t i = 0; i < headers.size(); ++i) {
    EXPECT_EQ(headers[i], cycle[(i + offset) % 4]) << i;
  }
}

TEST_F(Lms200Test, ARequestInterruptsATelegram) {
  start();
  host_->ask(kStream, kModeTime);
  host_->bytes_for(10 * 13'320us);
  const Bytes partly = host_->bytes_for(2ms);
  const Bytes last = host_->ask(kStop, 200ms);
  ASSERT_GT(last.size(), kModeOk.size());
  EXPECT_THAT(Bytes(last.end() - static_cast<std::ptrdiff_t>(kModeOk.size()), last.end()),
              ElementsAreArray(kModeOk));
  EXPECT_NE((partly.size() + last.size() - kModeOk.size() - 1) % 374, 0U)
      << "one telegram was cut off";
}

TEST_F(Lms200Test, ReportsADirtyWindow) {
  Lms200Params dirty = params();
  dirty.polluted = true;
  laser_ = std::make_unique<Lms200>(dirty, flat);
  host_ = std::make_unique<Host>(*laser_, 500'000);
  host_->bytes_for(2 * kBootTime);
  EXPECT_EQ(host_->ask(kStop)[7], 0x90);
}

TEST_F(Lms200Test, StatusFieldsAreAtTheirOffsets) {
  start();
  host_->ask(kVariant180x050);
  const Bytes answer = ask("02 00 01 00 31 15 12");
  ASSERT_EQ(answer.size(), 1 + 4 + 153 + 1 + 2U);
  const ByteView status = ByteView(answer).subspan(5);
  EXPECT_EQ(status[0], 0xB1);
  EXPECT_EQ(std::string(status.begin() + 1, status.begin() + 8), "V02.10 ");
  EXPECT_EQ(status[8], 0x25);
  EXPECT_EQ(status[102], 0x06);
  EXPECT_EQ(little_endian(status.subspan(107, 2)), 180U);
  EXPECT_EQ(little_endian(status.subspan(109, 2)), 50U);
  EXPECT_EQ(little_endian(status.subspan(116, 2)), 0x8001U);
  EXPECT_EQ(status[122], 1);
}

}  // namespace lms200_test
}  // namespace nodmap::sim
