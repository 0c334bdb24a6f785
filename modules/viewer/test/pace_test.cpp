// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/pace.hpp"

#include <gtest/gtest.h>

namespace nodmap::viewer {
namespace pace_test {

constexpr time::SteadyTime kStart{10s};

// In how many of `turns` turns, 20 ms apart, an update is sent.
int due_of(Pace& pace, int turns) {
  int due = 0;
  for (int i = 0; i < turns; ++i) {
    due += pace.take_update(kStart + i * 20ms) ? 1 : 0;
  }
  return due;
}

TEST(Pace, SendsEveryTimeWhileTheMachineIsFree) {
  Pace pace(20ms);
  for (int i = 0; i < 10; ++i) {
    pace.note_load(0.89F);
  }
  EXPECT_EQ(due_of(pace, 100), 100);
  EXPECT_FALSE(pace.is_slowed());
}

TEST(Pace, FallsToTwiceASecondWhileTheMachineIsBusy) {
  Pace pace(20ms);
  int seconds = 0;
  for (; pace.period() < Pace::kSlowest; ++seconds) {
    pace.note_load(1.0F);
  }
  EXPECT_EQ(seconds, 5);  // 40, 80, 160, 320, 500 ms
  pace.note_load(1.0F);
  EXPECT_EQ(pace.period(), Pace::kSlowest);
  EXPECT_EQ(due_of(pace, 100), 4);  // in two seconds
}

TEST(Pace, RecoversWhenTheMachineIsFreeAndElseKeepsItsPace) {
  Pace pace(20ms);
  for (int i = 0; i < 5; ++i) {
    pace.note_load(1.0F);
  }
  pace.note_load(0.8F);
  EXPECT_EQ(pace.period(), Pace::kSlowest) << "neither busy nor free";
  for (int i = 0; i < 12; ++i) {  // 500 ms * 0.75^12 < 20 ms
    pace.note_load(0.5F);
  }
  EXPECT_FALSE(pace.is_slowed());
  EXPECT_EQ(due_of(pace, 10), 10);
}

TEST(Pace, APaceThatIsSlowFromTheStartDoesNotChange) {
  Pace pace(1s);
  pace.note_load(1.0F);
  EXPECT_EQ(pace.period(), 1s);
}

}  // namespace pace_test
}  // namespace nodmap::viewer
