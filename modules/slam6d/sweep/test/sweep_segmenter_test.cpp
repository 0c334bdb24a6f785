// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/sweep/sweep_segmenter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace nodmap::slam6d {
namespace sweep_segmenter_test {

using geometry::deg_to_rad;
using End = Sweep::End;

scan::Scan scan_at(std::int64_t seq, time::Timestamp stamp, double pitch_deg) {
  scan::Scan scan;
  scan.seq = seq;
  scan.stamp = stamp;
  scan.pitch_first_rad = scan.pitch_last_rad = deg_to_rad(pitch_deg);
  return scan;
}

std::vector<Sweep> segment(const std::vector<scan::Scan>& scans, const SweepParams& params = {}) {
  SweepSegmenter segmenter(params);
  std::vector<Sweep> sweeps;
  for (const scan::Scan& scan : scans) {
    if (auto sweep = segmenter.add(scan)) {
      sweeps.push_back(std::move(*sweep));
    }
  }
  if (auto sweep = segmenter.flush()) {
    sweeps.push_back(std::move(*sweep));
  }
  return sweeps;
}

std::vector<scan::Scan> stream(const std::vector<double>& pitches_deg) {
  std::vector<scan::Scan> scans;
  for (const double pitch_deg : pitches_deg) {
    const auto seq = static_cast<std::int64_t>(scans.size());
    scans.push_back(scan_at(seq, time::Timestamp(seq * 13'320us), pitch_deg));
  }
  return scans;
}

// R40: expects every sequence number once, in the order of the sweeps and of the scans within them.
void expect_all_once(const std::vector<Sweep>& sweeps, std::size_t num_scans) {
  std::int64_t seq = 0;
  for (const Sweep& sweep : sweeps) {
    EXPECT_FALSE(sweep.scans.empty());
    for (const scan::Scan& scan : sweep.scans) {
      ASSERT_EQ(scan.seq, seq++);
    }
  }
  EXPECT_EQ(seq, static_cast<std::int64_t>(num_scans));
}

TEST(SweepSegmenter, R40_CutsAtReversals) {
  std::vector<double> pitches;
  for (int sweep = 0; sweep < 6; ++sweep) {
    for (int i = 0; i < 20; ++i) {
      pitches.push_back(sweep % 2 == 0 ? -20.0 + i : -i);
    }
  }
  const auto sweeps = segment(stream(pitches));
  expect_all_once(sweeps, pitches.size());
  ASSERT_EQ(sweeps.size(), 6U);
  for (std::size_t i = 0; i + 1 < sweeps.size(); ++i) {
    EXPECT_EQ(sweeps[i].end, End::kReversal);
  }
  EXPECT_EQ(sweeps[0].scans.size(), 21U);  // -20 .. -1 and the 0 of the reversal
  EXPECT_EQ(sweeps[1].scans.size(), 20U);  // -1 .. -19 and -20
  EXPECT_EQ(sweeps.back().end, End::kFlushed);
}

// A servo with steps of 0.25 degrees and 0.2 degrees of noise sometimes moves back, but never by
// the hysteresis of 1 degree.
TEST(SweepSegmenter, R40_ServoNoiseIsNoReversal) {
  std::mt19937 random(40);
  std::uniform_real_distribution<double> noise_deg(-0.2, 0.2);
  std::vector<double> pitches;
  for (int i = 0; i < 4 * 480; ++i) {
    const double phase = std::fmod(0.25 * i, 240.0);
    pitches.push_back((phase < 120.0 ? phase : 240.0 - phase) - 60.0 + noise_deg(random));
  }
  const auto sweeps = segment(stream(pitches));
  expect_all_once(sweeps, pitches.size());
  ASSERT_EQ(sweeps.size(), 4U);
  for (const Sweep& sweep : sweeps) {
    EXPECT_NEAR(static_cast<double>(sweep.scans.size()), 480.0, 3.0);
  }
}

TEST(SweepSegmenter, R40_ScansOfAStationaryHeadBelongToTheCurrentSweep) {
  std::vector<double> pitches;
  for (int i = 0; i <= 20; ++i) {
    pitches.push_back(i);
  }
  pitches.insert(pitches.end(), 50, 20.0);  // waits at the top
  for (int i = 19; i >= 10; --i) {
    pitches.push_back(i);
  }
  pitches.insert(pitches.end(), 50, 10.0);  // and in the middle of the sweep
  for (int i = 9; i >= 0; --i) {
    pitches.push_back(i);
  }
  const auto sweeps = segment(stream(pitches));
  expect_all_once(sweeps, pitches.size());
  ASSERT_EQ(sweeps.size(), 2U);
  EXPECT_EQ(sweeps[0].scans.size(), 71U);
}

// As in the recording kurt3d: three upward sweeps, each from the lowest pitch. The robot drives on
// between them.
TEST(SweepSegmenter, R40_OneWaySweepsAreCutAtThePausesBetweenThem) {
  std::vector<scan::Scan> scans;
  for (int sweep = 0; sweep < 3; ++sweep) {
    for (int i = 0; i < 226; ++i) {
      const auto seq = static_cast<std::int64_t>(scans.size());
      scans.push_back(scan_at(seq, time::Timestamp(sweep * 15s + i * 26'667us), -48.7 + 0.517 * i));
    }
  }
  const auto sweeps = segment(scans);
  expect_all_once(sweeps, scans.size());
  ASSERT_EQ(sweeps.size(), 3U);
  for (const Sweep& sweep : sweeps) {
    EXPECT_EQ(sweep.scans.size(), 226U);
  }
  EXPECT_EQ(sweeps[0].end, End::kInterrupted);
  EXPECT_FALSE(sweeps[0].follows_interruption);
  EXPECT_TRUE(sweeps[1].follows_interruption);
  EXPECT_TRUE(sweeps[2].follows_interruption);
}

TEST(SweepSegmenter, R40_OneWaySweepsWithoutPausesAreCutAtTheJumpBack) {
  std::vector<double> pitches;
  for (int i = 0; i < 90; ++i) {
    pitches.push_back(-15.0 + i % 30);
  }
  const auto sweeps = segment(stream(pitches));
  expect_all_once(sweeps, pitches.size());
  ASSERT_EQ(sweeps.size(), 3U);
  for (const Sweep& sweep : sweeps) {
    EXPECT_EQ(sweep.scans.size(), 30U);
    EXPECT_FALSE(sweep.follows_interruption);
  }
  EXPECT_EQ(sweeps[0].end, End::kJumpBack);
}

TEST(SweepSegmenter, R40_AStampThatStepsBackInterruptsTheSweep) {
  auto scans = stream({0, 1, 2, 3, 4, 5, 6, 7});
  for (std::size_t i = 4; i < scans.size(); ++i) {
    scans[i].stamp -= 30ms;
  }
  const auto sweeps = segment(scans);
  expect_all_once(sweeps, scans.size());
  ASSERT_EQ(sweeps.size(), 2U);
  EXPECT_EQ(sweeps[0].scans.size(), 4U);
  EXPECT_EQ(sweeps[0].end, End::kInterrupted);
  EXPECT_TRUE(sweeps[1].follows_interruption);
}

TEST(SweepSegmenter, R40_ASweepHasAMaximumNumberOfScans) {
  const std::vector<double> level(1050, 0.0);
  const auto sweeps = segment(stream(level), {.max_scans = 500});
  expect_all_once(sweeps, level.size());
  ASSERT_EQ(sweeps.size(), 3U);
  EXPECT_EQ(sweeps[0].scans.size(), 500U);
  EXPECT_EQ(sweeps[0].end, End::kFull);
  EXPECT_EQ(sweeps[2].scans.size(), 50U);
}

// Pitch and stamps change at random: no scan may be lost, and none may be in two sweeps.
TEST(SweepSegmenter, R40_EveryScanOfAnyStreamIsInExactlyOneSweep) {
  std::mt19937 random(41);
  std::uniform_real_distribution<double> pitch_deg(-60.0, 60.0);
  std::normal_distribution<double> step_deg(0.0, 4.0);
  std::uniform_int_distribution<int> chance(0, 30);
  for (int run = 0; run < 50; ++run) {
    std::vector<scan::Scan> scans;
    time::Timestamp stamp{};
    double pitch = 0.0;
    for (int i = 0; i < 400; ++i) {
      const int event = chance(random);
      stamp += event == 0 ? time::Duration(3s) : event == 1 ? -50ms : 13'320us;
      pitch = event == 2 ? pitch_deg(random) : pitch + step_deg(random);
      scans.push_back(scan_at(i, stamp, pitch));
    }
    expect_all_once(segment(scans, {.max_scans = 60}), scans.size());
  }
}

TEST(SweepSegmenter, NoScanGivesNoSweepAndOneScanGivesOne) {
  EXPECT_TRUE(segment({}).empty());
  const auto sweeps = segment(stream({5.0}));
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].scans.size(), 1U);
}

}  // namespace sweep_segmenter_test
}  // namespace nodmap::slam6d
