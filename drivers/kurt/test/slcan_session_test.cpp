// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/slcan_session.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace nodmap::kurt {
namespace {

using Kind = SlcanLine::Kind;

/// A session asked every 10 ms, and an adapter that answers what the test says.
struct Bench {
  SlcanSession session;
  std::int64_t now_us = 0;
  std::vector<std::string> sent;
  std::function<std::vector<Kind>(const std::string&)> answer = [](const std::string&) {
    return std::vector<Kind>{Kind::kDone};
  };
  bool frames_come = true;

  void run_us(std::int64_t duration_us) {
    for (const std::int64_t end_us = now_us + duration_us; now_us < end_us; now_us += 10'000) {
      if (session.is_open() && frames_come) {
        session.take({Kind::kFrame, {}, 0}, now_us);
      }
      const std::string text = session.poll(now_us);
      if (text.empty()) {
        continue;
      }
      sent.push_back(text);
      for (const Kind kind : answer(text)) {
        session.take({kind, {}, 0x80}, now_us);
      }
    }
  }
};

TEST(SlcanSession, ClosesSetsTheRateAndOpens) {
  Bench bench;
  bench.run_us(100'000);
  EXPECT_TRUE(bench.sent.empty());  // not before the port is open
  bench.session.start(bench.now_us);
  bench.run_us(200'000);
  EXPECT_TRUE(bench.session.is_open());
  EXPECT_EQ(bench.sent, (std::vector<std::string>{"\r\r\rC\r", "S8\r", "O\r"}));
}

// A BEL on C says only that the channel was closed before.
TEST(SlcanSession, RefusingToCloseWhatIsClosedIsFine) {
  Bench bench;
  bench.answer = [](const std::string& text) {
    return text.back() == '\r' && text.find('C') != std::string::npos
               ? std::vector<Kind>{Kind::kRefused, Kind::kRefused, Kind::kRefused, Kind::kRefused}
               : std::vector<Kind>{Kind::kDone};
  };
  bench.session.start(0);
  bench.run_us(200'000);
  EXPECT_TRUE(bench.session.is_open());
}

TEST(SlcanSession, AMuteAdapterIsTriedThreeTimesThenThePortIsGivenUp) {
  Bench bench;
  bench.answer = [](const std::string&) { return std::vector<Kind>{}; };
  bench.session.start(0);
  bench.run_us(2'000'000);
  EXPECT_TRUE(bench.session.gave_up());
  EXPECT_EQ(std::count(bench.sent.begin(), bench.sent.end(), "\r\r\rC\r"), 3);
  bench.sent.clear();
  bench.answer = [](const std::string&) { return std::vector<Kind>{Kind::kDone}; };
  bench.session.start(bench.now_us);  // the port has been opened anew
  bench.run_us(300'000);
  EXPECT_TRUE(bench.session.is_open());
}

TEST(SlcanSession, ARefusedOpenIsTriedAgain) {
  Bench bench;
  int refused = 0;
  bench.answer = [&refused](const std::string& text) {
    return std::vector<Kind>{text == "O\r" && refused++ == 0 ? Kind::kRefused : Kind::kDone};
  };
  bench.session.start(0);
  bench.run_us(400'000);
  EXPECT_TRUE(bench.session.is_open());
  EXPECT_EQ(bench.session.restarts(), 1);
}

TEST(SlcanSession, AMuteBusIsOpenedAgainAndComesBack) {
  Bench bench;
  bench.session.start(0);
  bench.run_us(300'000);
  ASSERT_TRUE(bench.session.is_open());
  bench.frames_come = false;
  bench.run_us(490'000);
  EXPECT_EQ(bench.session.restarts(), 0);
  bench.run_us(30'000);
  EXPECT_EQ(bench.session.restarts(), 1);
  EXPECT_FALSE(bench.session.is_open());
  bench.frames_come = true;
  bench.run_us(300'000);
  EXPECT_TRUE(bench.session.is_open());
  bench.run_us(5'000'000);
  EXPECT_EQ(bench.session.restarts(), 1);
}

TEST(SlcanSession, ABusThatStaysMuteEndsWithTheUseOfThePort) {
  Bench bench;
  bench.frames_come = false;
  bench.session.start(0);
  bench.run_us(5'000'000);
  EXPECT_TRUE(bench.session.gave_up());
}

// An adapter that has reset itself has its channel closed and refuses every frame.
TEST(SlcanSession, RefusalsInARowOpenAgain) {
  Bench bench;
  bench.session.start(0);
  bench.run_us(300'000);
  for (int i = 0; i < 9; ++i) {
    bench.session.take({Kind::kRefused, {}, 0}, bench.now_us);
  }
  bench.session.take({Kind::kDone, {}, 0}, bench.now_us);  // a full queue that has emptied
  bench.run_us(20'000);
  EXPECT_EQ(bench.session.restarts(), 0);
  for (int i = 0; i < 10; ++i) {
    bench.session.take({Kind::kRefused, {}, 0}, bench.now_us);
  }
  bench.run_us(20'000);
  EXPECT_EQ(bench.session.restarts(), 1);
}

TEST(SlcanSession, AsksForTheFlagsOnceASecond) {
  Bench bench;
  bench.answer = [](const std::string& text) {
    return std::vector<Kind>{text == "F\r" ? Kind::kFlags : Kind::kDone};
  };
  bench.session.start(0);
  bench.run_us(10'200'000);
  EXPECT_EQ(std::count(bench.sent.begin(), bench.sent.end(), "F\r"), 10);
  EXPECT_EQ(bench.session.flags(), kBusError);
  bench.session.stop();
  EXPECT_FALSE(bench.session.is_open());
  EXPECT_EQ(bench.session.poll(bench.now_us), "");
}

}  // namespace
}  // namespace nodmap::kurt
