// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/slcan_session.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace nodmap::kurt {
namespace slcan_session_test {

using Kind = SlcanLine::Kind;

// A session polled every 10 ms, and an adapter that answers as the test demands.
struct Bench {
  SlcanSession session;
  time::SteadyTime now;
  std::vector<std::string> sent;
  std::function<std::vector<Kind>(const std::string&)> answer = [](const std::string&) {
    return std::vector<Kind>{Kind::kDone};
  };
  bool frames_come = true;

  void run_for(time::Duration duration) {
    for (const time::SteadyTime end = now + duration; now < end; now += 10ms) {
      if (session.is_open() && frames_come) {
        session.take({Kind::kFrame, {}, 0}, now);
      }
      const std::string text = session.poll(now);
      if (text.empty()) {
        continue;
      }
      sent.push_back(text);
      for (const Kind kind : answer(text)) {
        session.take({kind, {}, 0x80}, now);
      }
    }
  }
};

TEST(SlcanSession, ClosesSetsTheRateAndOpens) {
  Bench bench;
  bench.run_for(100ms);
  EXPECT_TRUE(bench.sent.empty());  // not before the port is open
  bench.session.start(bench.now);
  bench.run_for(200ms);
  EXPECT_TRUE(bench.session.is_open());
  EXPECT_EQ(bench.sent, (std::vector<std::string>{"\r\r\rC\r", "S8\r", "O\r"}));
}

// A BEL on C says only that the channel was closed before.
TEST(SlcanSession, ARefusalToCloseAClosedBusIsFine) {
  Bench bench;
  bench.answer = [](const std::string& text) {
    return text.back() == '\r' && text.find('C') != std::string::npos
               ? std::vector<Kind>{Kind::kRefused, Kind::kRefused, Kind::kRefused, Kind::kRefused}
               : std::vector<Kind>{Kind::kDone};
  };
  bench.session.start({});
  bench.run_for(200ms);
  EXPECT_TRUE(bench.session.is_open());
}

TEST(SlcanSession, AMuteAdapterIsTriedThreeTimesThenThePortIsGivenUp) {
  Bench bench;
  bench.answer = [](const std::string&) { return std::vector<Kind>{}; };
  bench.session.start({});
  bench.run_for(2s);
  EXPECT_TRUE(bench.session.gave_up());
  EXPECT_EQ(std::ranges::count(bench.sent, "\r\r\rC\r"), 3);
  bench.sent.clear();
  bench.answer = [](const std::string&) { return std::vector<Kind>{Kind::kDone}; };
  bench.session.start(bench.now);  // the port has been opened anew
  bench.run_for(300ms);
  EXPECT_TRUE(bench.session.is_open());
}

TEST(SlcanSession, ARefusedOpenIsTriedAgain) {
  Bench bench;
  int refused = 0;
  bench.answer = [&refused](const std::string& text) {
    return std::vector<Kind>{text == "O\r" && refused++ == 0 ? Kind::kRefused : Kind::kDone};
  };
  bench.session.start({});
  bench.run_for(400ms);
  EXPECT_TRUE(bench.session.is_open());
  EXPECT_EQ(bench.session.restarts(), 1);
}

TEST(SlcanSession, AMuteBusIsOpenedAgainAndComesBack) {
  Bench bench;
  bench.session.start({});
  bench.run_for(300ms);
  ASSERT_TRUE(bench.session.is_open());
  bench.frames_come = false;
  bench.run_for(490ms);
  EXPECT_EQ(bench.session.restarts(), 0);
  bench.run_for(30ms);
  EXPECT_EQ(bench.session.restarts(), 1);
  EXPECT_FALSE(bench.session.is_open());
  bench.frames_come = true;
  bench.run_for(300ms);
  EXPECT_TRUE(bench.session.is_open());
  bench.run_for(5s);
  EXPECT_EQ(bench.session.restarts(), 1);
}

// Only attempts in a row count.
TEST(SlcanSession, ABusThatIsMuteNowAndThenKeepsItsPort) {
  Bench bench;
  bench.session.start({});
  bench.run_for(300ms);
  for (int i = 1; i <= 5; ++i) {
    bench.frames_come = false;
    bench.run_for(520ms);
    EXPECT_EQ(bench.session.restarts(), i);
    bench.frames_come = true;
    bench.run_for(1s);
    EXPECT_TRUE(bench.session.is_open());
  }
}

TEST(SlcanSession, ABusThatStaysMuteEndsWithGivingUpThePort) {
  Bench bench;
  bench.frames_come = false;
  bench.session.start({});
  bench.run_for(5s);
  EXPECT_TRUE(bench.session.gave_up());
}

// An adapter that has reset itself has its channel closed and refuses every frame.
TEST(SlcanSession, RefusalsInARowOpenAgain) {
  Bench bench;
  bench.session.start({});
  bench.run_for(300ms);
  for (int i = 0; i < 9; ++i) {
    bench.session.take({Kind::kRefused, {}, 0}, bench.now);
  }
  bench.session.take({Kind::kDone, {}, 0}, bench.now);  // a full queue that has emptied
  for (int i = 0; i < 9; ++i) {
    bench.session.take({Kind::kRefused, {}, 0}, bench.now);
  }
  bench.run_for(20ms);
  EXPECT_EQ(bench.session.restarts(), 0);
  bench.session.take({Kind::kDone, {}, 0}, bench.now);
  for (int i = 0; i < 10; ++i) {
    bench.session.take({Kind::kRefused, {}, 0}, bench.now);
  }
  bench.run_for(20ms);
  EXPECT_EQ(bench.session.restarts(), 1);
}

TEST(SlcanSession, AsksForTheFlagsOnceASecond) {
  Bench bench;
  bench.answer = [](const std::string& text) {
    return std::vector<Kind>{text == "F\r" ? Kind::kFlags : Kind::kDone};
  };
  bench.session.start({});
  bench.run_for(10'200ms);
  EXPECT_EQ(std::ranges::count(bench.sent, "F\r"), 10);
  EXPECT_EQ(bench.session.flags(), kBusError);
  bench.session.stop();
  EXPECT_FALSE(bench.session.is_open());
  EXPECT_EQ(bench.session.poll(bench.now), "");
}

}  // namespace slcan_session_test
}  // namespace nodmap::kurt
