// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/slcan_session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <string>
#include <utility>
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
  // Of the adapter's answers and the base's frames.
  std::function<time::Duration(time::SteadyTime)> late = [](time::SteadyTime) { return 0ms; };
  int answers_to_lose = 0;
  bool has_flags = true;         // otherwise F is refused
  time::SteadyTime waits_until;  // the driver's process is not scheduled until then
  std::deque<std::pair<time::SteadyTime, Kind>> on_the_line;

  void run_for(time::Duration duration) {
    for (const time::SteadyTime end = now + duration; now < end; now += 10ms) {
      if (session.is_open() && frames_come) {
        on_the_line.push_back({now + late(now), Kind::kFrame});
      }
      if (now < waits_until) {
        continue;
      }
      while (!on_the_line.empty() && on_the_line.front().first <= now) {
        session.take({on_the_line.front().second, {}, 0x80}, now);
        on_the_line.pop_front();
      }
      const std::string text = session.poll(now);
      if (text.empty()) {
        continue;
      }
      sent.push_back(text);
      if (text == "F\r" || text == "V\r") {
        if (answers_to_lose > 0) {
          --answers_to_lose;
        } else {
          const Kind kind = text == "V\r" ? Kind::kVersion
                            : has_flags   ? Kind::kFlags
                                          : Kind::kRefused;
          on_the_line.push_back({now + std::max<time::Duration>(late(now), 10ms), kind});
        }
        continue;
      }
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
  bench.session.start({});
  bench.run_for(10'200ms);
  EXPECT_EQ(std::ranges::count(bench.sent, "F\r"), 10);
  EXPECT_EQ(bench.session.flags(), kBusError);
  bench.session.stop();
  EXPECT_FALSE(bench.session.is_open());
  EXPECT_EQ(bench.session.poll(bench.now), "");
}

// At a delay of 100 ms the silence at its begin ends before the base counts as absent.
TEST(SlcanSession, ALateLineIsNoticedUntilItIsInTimeAgain) {
  for (const time::Duration delay : {100ms, 150ms, 300ms}) {
    for (const time::Duration moment : {0ms, 30ms, 60ms, 500ms}) {
      Bench bench;
      bench.session.start({});
      bench.run_for(3s + moment);
      const time::SteadyTime begin = bench.now;
      bench.late = [&](time::SteadyTime now) { return now < begin + 3s ? delay : 0ms; };
      EXPECT_EQ(bench.session.delay(), 0ms);
      // 40 ms without a frame, 70 ms for the answer, and two periods.
      bench.run_for(130ms);
      for (int i = 0; i < 287; ++i) {
        ASSERT_GT(bench.session.delay(), 70ms) << i;
        bench.run_for(10ms);
      }
      // The late answer arrives, the next question is asked within 0.1 s and answered.
      bench.run_for(delay + 200ms);
      EXPECT_EQ(bench.session.delay(), 0ms);
      bench.run_for(5s);
      EXPECT_EQ(bench.session.delay(), 0ms);
      EXPECT_EQ(bench.session.restarts(), 0);
    }
  }
}

TEST(SlcanSession, ALineThatIsLateFromTheStartIsNoticed) {
  Bench bench;
  bench.late = [](time::SteadyTime) { return 150ms; };
  bench.session.start({});
  bench.run_for(1500ms);
  EXPECT_EQ(bench.session.delay(), 150ms);
}

// A USB adapter with a latency of 16 ms, and an answer in a hundred that is damaged.
TEST(SlcanSession, ASlowAdapterAndALostAnswerAreNoDelay) {
  Bench bench;
  bench.late = [](time::SteadyTime now) { return now.time_since_epoch() % 37ms; };
  bench.session.start({});
  for (int i = 0; i < 1000; ++i) {
    bench.answers_to_lose = i % 100 == 99 ? 1 : 0;
    bench.run_for(100ms);
    EXPECT_EQ(bench.session.delay(), 0ms) << i;
  }
}

// What has arrived meanwhile is read at once. It has waited for the driver, not on the line.
TEST(SlcanSession, AProcessThatWasNotScheduledSeesNoDelay) {
  Bench bench;
  bench.session.start({});
  bench.run_for(400ms);
  for (int i = 0; i < 100; ++i) {
    bench.waits_until = bench.now + 150ms;
    bench.run_for(330ms);
    EXPECT_EQ(bench.session.delay(), 0ms) << i;
  }
}

// The base is switched off, the adapter answers: its frames are missing, not late.
TEST(SlcanSession, ASilentBaseIsNotLate) {
  Bench bench;
  bench.session.start({});
  bench.run_for(2s);
  bench.frames_come = false;
  for (int i = 0; i < 45; ++i) {
    bench.run_for(10ms);
    EXPECT_EQ(bench.session.delay(), 0ms);
  }
}

TEST(SlcanSession, AnAdapterThatRefusesToTellItsFlagsIsInTimeAllTheSame) {
  Bench bench;
  bench.has_flags = false;
  bench.session.start({});
  for (int i = 0; i < 1000; ++i) {
    bench.run_for(10ms);
    ASSERT_EQ(bench.session.delay(), 0ms) << i;
  }
  EXPECT_TRUE(bench.session.lacks_flags());
  EXPECT_FALSE(bench.session.is_unanswered());
  EXPECT_EQ(std::ranges::count(bench.sent, "F\r"), 3);
  EXPECT_EQ(bench.session.restarts(), 0);
  // It is noticed as before when the line is late.
  const time::SteadyTime begin = bench.now;
  bench.late = [&](time::SteadyTime now) { return now < begin + 2s ? 150ms : 0ms; };
  bench.run_for(130ms);
  EXPECT_GT(bench.session.delay(), 70ms);
  bench.run_for(4s);
  EXPECT_EQ(bench.session.delay(), 0ms);
}

TEST(SlcanSession, ALostAnswerDoesNotMeanThatThereAreNoFlags) {
  Bench bench;
  bench.session.start({});
  bench.run_for(500ms);
  for (int i = 0; i < 10; ++i) {
    bench.answers_to_lose = 1;
    bench.run_for(5s);
    EXPECT_FALSE(bench.session.lacks_flags());
    EXPECT_FALSE(bench.session.is_unanswered());
  }
}

// A refusal may be one of a frame: it says nothing about the line.
TEST(SlcanSession, ARefusalIsNoAnswer) {
  Bench bench;
  bench.session.start({});
  bench.run_for(500ms);
  bench.answers_to_lose = 1'000'000;
  for (int i = 0; i < 14; ++i) {
    bench.session.take({Kind::kDone, {}, 0}, bench.now);
    bench.session.take({Kind::kRefused, {}, 0}, bench.now);
    bench.run_for(100ms);
  }
  EXPECT_GT(bench.session.delay(), 70ms);
  EXPECT_TRUE(bench.session.is_unanswered());
}

}  // namespace slcan_session_test
}  // namespace nodmap::kurt
