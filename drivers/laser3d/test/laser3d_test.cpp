// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/laser3d.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "drivers/laser3d/test/laser3d_rig.hpp"

namespace nodmap::laser3d {
namespace laser3d_test {

time::SteadyTime last_beam(const scan::Scan& scan) {
  return time::SteadyTime(scan.last_stamp().time_since_epoch());
}

using test::kRevolution;
using test::Rig;

TEST(Laser3d, R1_PublishesPitchedScansAt75Hz) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  const std::size_t before = rig.scans.size();
  const std::size_t num_pitches_before = rig.pitch.size();
  rig.run(10.0);
  // 750.75 revolutions: one more or less at either end.
  EXPECT_NEAR(static_cast<double>(rig.scans.size() - before), 750.0, 1.0);
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
  EXPECT_EQ(rig.dut.counts().scans_without_pitch, 0);
  EXPECT_GT(rig.pitch.size() - num_pitches_before, 1000U) << "a reading each 10 ms or sooner";
  for (std::size_t i = before; i < rig.scans.size(); ++i) {
    const scan::Scan& scan = rig.scans[i];
    EXPECT_TRUE(scan::is_plausible(scan));
    EXPECT_EQ(scan.ranges_m.size(), 181U);
    EXPECT_EQ(scan.duration, 6660us);
    EXPECT_EQ(scan.seq, static_cast<std::int64_t>(i));
    EXPECT_GT(scan.stamp, rig.scans[i - 1].stamp);
    EXPECT_TRUE(scan.pitch_measured);
  }
}

TEST(Laser3d, R2_PitchIsThatOfTheBeamsTime) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  // In mid-sweep the head moves at a constant rate, so a scan's pitches lie on the line through the
  // servo's readings.
  int compared = 0;
  for (const scan::Scan& scan : rig.scans) {
    const auto after = std::ranges::find_if(
        rig.pitch, [&](const PitchState& state) { return state.sample.stamp >= last_beam(scan); });
    if (after == rig.pitch.end() || std::abs(scan.pitch_mid_rad()) > 0.2) {
      continue;
    }
    ++compared;
    const double rate = (scan.pitch_last_rad - scan.pitch_first_rad) / 0.00666;
    const double expected =
        scan.pitch_last_rad + rate * time::seconds(after->sample.stamp - last_beam(scan));
    // Half a position step of the servo, which is 1.534 mrad.
    EXPECT_NEAR(after->sample.pitch_rad, expected, 7.7e-4);
  }
  EXPECT_GT(compared, 44);  // 4/5 of 55
}

TEST(Laser3d, NodsBetweenTheCommandedBounds) {
  Rig rig;
  rig.open();
  rig.run(3.0);
  rig.pitch.clear();
  for (int i = 0; i < 20; ++i) {
    rig.dut.command({-0.3, 0.1, 0.5}, rig.now);
    rig.run(0.5);
    if (i == 1) {
      rig.pitch.clear();
    }
  }
  const auto by_pitch = [](const PitchState& a, const PitchState& b) {
    return a.sample.pitch_rad < b.sample.pitch_rad;
  };
  const auto [low, high] = std::minmax_element(rig.pitch.begin(), rig.pitch.end(), by_pitch);
  // 1.25 times what is measured at the lower end, 0.66 mrad: half of a servo's step.
  EXPECT_NEAR(low->sample.pitch_rad, -0.3, 8e-4);
  EXPECT_NEAR(high->sample.pitch_rad, 0.1, 8e-4);
  // The first or the last reversal may fall outside of the time.
  EXPECT_NEAR(static_cast<double>(rig.pitch.back().sweep - rig.pitch.front().sweep), 18.0, 1.0);
}

TEST(Laser3d, WithoutTheServoThereIsNoScan) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.servo.powered = false;
  rig.run(0.3);
  const std::size_t scans = rig.scans.size();
  rig.run(5.0);
  EXPECT_EQ(rig.scans.size(), scans);
  EXPECT_EQ(rig.health().state, node::HealthState::kFailed);
  EXPECT_EQ(rig.health().reason, "servo: the servo does not answer");
  rig.servo.powered = true;
  rig.run(6.0);
  EXPECT_GT(rig.scans.size(), scans);
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
}

TEST(Laser3d, WithoutTheLaserThereIsNoScan) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.dut.laser_lost();
  const std::size_t scans = rig.scans.size();
  rig.run(1.0);
  EXPECT_LE(rig.scans.size(), scans + 2);  // what was whole already
  EXPECT_EQ(rig.health().state, node::HealthState::kFailed);
  EXPECT_EQ(rig.health().reason, "laser: not connected");
  const std::size_t after = rig.scans.size();
  rig.handle(rig.dut.laser_opened(rig.now));
  rig.run(3.0);
  EXPECT_GT(rig.scans.size(), after + 180);  // 4/5 of 225 in 3 s
}

TEST(Laser3d, AFrozenLaserAndAStalledServoAreFailures) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.servo.jammed = true;
  rig.run(0.35);
  EXPECT_EQ(rig.health().reason, "servo: does not move when commanded to");
  EXPECT_TRUE(rig.pitch.back().is_stalled);
  rig.servo.jammed = false;
  rig.run(1.0);
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
  rig.sensor.frozen = true;
  rig.run(0.3);
  EXPECT_EQ(rig.health().reason, "laser: the measurement is frozen");
  rig.sensor.frozen = false;
  rig.run(8.0);
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
}

TEST(Laser3d, ALaserThatSeesNothingIsBlind) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.sensor.blind = true;
  rig.run(1.5);  // less than the default nod of 1.6 s: the laser may look at the sky
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
  rig.run(0.5);
  EXPECT_EQ(rig.health().state, node::HealthState::kFailed);
  EXPECT_EQ(rig.health().reason, "laser: blind (no readings)");
  const std::size_t scans = rig.scans.size();
  rig.run(10.0);
  EXPECT_EQ(rig.scans.size(), scans);
  EXPECT_GT(rig.dut.counts().scans_blind, 700);
  rig.sensor.blind = false;
  rig.run(0.2);
  EXPECT_GT(rig.scans.size(), scans + 10);
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
}

TEST(Laser3d, ACoveredWindowIsBlind) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.sensor.covered = true;
  rig.run(2.0);
  EXPECT_EQ(rig.health().reason, "laser: blind (no readings)");
  const std::size_t scans = rig.scans.size();
  rig.run(2.0);
  EXPECT_EQ(rig.scans.size(), scans);
}

// Fewer than ten readings may be dust.
TEST(Laser3d, TenReadingsAreSight) {
  for (const auto& [num_echoes, is_blind] : {std::pair(9, true), std::pair(10, false)}) {
    Rig rig;
    rig.open();
    rig.run(4.0);
    rig.sensor.num_echoes = num_echoes;
    rig.run(2.5);
    EXPECT_EQ(rig.health().reason == "laser: blind (no readings)", is_blind) << num_echoes;
  }
}

// The servo answers, but with positions that the head cannot have.
TEST(Laser3d, WithoutAPitchItIsFailed) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.servo.told_position = 100'000;
  rig.run(1.0);
  EXPECT_EQ(rig.health().state, node::HealthState::kFailed);
  EXPECT_EQ(rig.health().reason, "no scan could be given a pitch");
}

TEST(Laser3d, TheTimeOffsetIsAddedToEveryBeam) {
  const auto last_stamp = [](double offset_s) {
    Laser3dParams params;
    params.laser.time_offset_s = offset_s;
    Rig rig(params);
    rig.open();
    rig.run(4.0);
    return rig.scans.at(100).stamp;
  };
  EXPECT_EQ(last_stamp(-0.004) - last_stamp(0.0), -4ms);
}

TEST(Laser3d, ALaserThatNeverSawAnythingIsBlindAtOnce) {
  Rig rig;
  rig.sensor.blind = true;
  rig.open();
  rig.run(4.0);
  EXPECT_TRUE(rig.scans.empty());
  EXPECT_EQ(rig.health().reason, "laser: blind (no readings)");
}

TEST(Laser3d, AFastNodMakesBlindnessKnownInASecondASlowOneInItsNod) {
  for (const auto& [sweep_s, known_s] :
       {std::pair(0.3, 1.0), std::pair(3.0, 6.6), std::pair(10.0, 15.0)}) {
    Rig rig;
    rig.open();
    rig.run(4.0);
    rig.sensor.blind = true;
    double blind_s = 0.0;
    while (rig.health().state != node::HealthState::kFailed && blind_s < 20.0) {
      rig.dut.command({-0.6, 0.2, sweep_s}, rig.now);
      rig.run(0.1);
      blind_s += 0.1;
    }
    EXPECT_NEAR(blind_s, known_s, 0.05);  // polled every 0.1 s
  }
}

TEST(Laser3d, BeamsWithoutAMeasurementDegradeAndDoNotCountAsSight) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.sensor.too_weak = true;
  rig.run(0.2);
  EXPECT_EQ(rig.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(rig.health().reason, "laser: many beams are not measured");
  rig.run(2.0);
  EXPECT_EQ(rig.health().reason, "laser: blind (no readings)");
}

TEST(Laser3d, PollutionDegrades) {
  Rig rig;
  rig.open();
  rig.sensor.status = 0x90;
  rig.run(4.0);
  EXPECT_EQ(rig.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(rig.health().reason, "laser: the front window is dirty");
}

TEST(Laser3d, AnErrorOfTheSensorDegrades) {
  Rig rig;
  rig.open();
  rig.sensor.status = 0x13;
  rig.run(4.0);
  EXPECT_EQ(rig.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(rig.health().reason, "laser: reports an error");
}

TEST(Laser3d, ReadingsThatTheSensorDoesNotBelieveDegrade) {
  Rig rig;
  rig.open();
  rig.sensor.status = 0x50;
  rig.run(4.0);
  EXPECT_EQ(rig.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(rig.health().reason, "laser: calls its own readings implausible");
  rig.sensor.status = 0x10;
  rig.run(0.1);
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
}

// The pitch controller plans as if every scan came.
TEST(Laser3d, LostScansDegrade) {
  using node::HealthState;
  struct Case {
    std::function<bool(int)> is_lost;
    HealthState state;
  };
  for (const Case& c : {Case{[](int scan) { return scan % 20 == 0; }, HealthState::kOk},
                        Case{[](int scan) { return scan % 5 == 0; }, HealthState::kDegraded},
                        Case{[](int scan) { return scan % 6 != 0; }, HealthState::kDegraded}}) {
    Rig rig;
    rig.open();
    rig.run(4.0);
    rig.is_lost = c.is_lost;
    rig.run(2.0);  // the share is that of the last whole second
    for (int i = 0; i < 20; ++i) {
      rig.run(0.1);
      EXPECT_EQ(rig.health().state, c.state) << rig.health().reason;
    }
    rig.is_lost = [](int) { return false; };
    rig.run(2.0);
    EXPECT_EQ(rig.health().state, HealthState::kOk) << rig.health().reason;
  }
}

// Scans keep the time at which they were measured, by which the navigator sees how old they are.
TEST(Laser3d, ALateLaserDegradesAndItsScansStayOld) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  const auto age_after = [&rig](double seconds) {
    rig.run(seconds);
    return rig.now - last_beam(rig.scans.back());
  };
  const time::Duration age = age_after(1.0);
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
  rig.laser_delay = 100ms;
  for (int i = 0; i < 10; ++i) {
    // A revolution, as it is not known when in it the run ends; the drift in ten seconds.
    EXPECT_NEAR(time::seconds(age_after(1.0) - age), 0.1, 0.0134 + 0.02);
  }
  EXPECT_EQ(rig.health().state, node::HealthState::kDegraded);
  EXPECT_THAT(rig.health().reason, ::testing::StartsWith("laser: its data arrive"));
  rig.laser_delay = 0ms;
  EXPECT_NEAR(time::seconds(age_after(1.0) - age), 0.0, 0.0134);
  EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
}

TEST(Laser3d, ScansWithoutAPitchDegrade) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  // Readings are missing for 100 ms of each 300 ms: fewer than it takes to be a silent servo.
  for (int i = 0; i < 10; ++i) {
    rig.servo.powered = false;
    rig.run(0.1);
    rig.servo.powered = true;
    rig.run(0.2);
  }
  EXPECT_EQ(rig.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(rig.health().reason, "servo: many scans are without a pitch: check its line");
}

TEST(Laser3d, HalfADegreeGivesTwoScansEach) {
  Laser3dParams params;
  params.laser.variant = SickVariant::k180x050;
  Rig rig(params);
  rig.open();
  rig.run(4.0);
  ASSERT_GT(rig.scans.size(), 20U);
  for (std::size_t i = 10; i < rig.scans.size(); ++i) {
    EXPECT_EQ(rig.scans[i].ranges_m.size(), i % 2 == 0 ? 181U : 180U);
  }
}

// A telegram of 732 bytes takes 763 ms.
TEST(Laser3d, OnASlowLineTheNextScanIsAwaited) {
  Laser3dParams params;
  params.laser.variant = SickVariant::k180x050;
  params.laser.baud = 9600;
  Rig rig(params);
  rig.scan_period = 59 * kRevolution;
  rig.open();
  rig.run(8.0);
  ASSERT_GT(rig.scans.size(), 5U);
  for (int i = 0; i < 20; ++i) {
    rig.run(0.1);
    EXPECT_EQ(rig.health().state, node::HealthState::kOk) << rig.health().reason;
  }
}

TEST(Laser3d, UpsideDownSwapsLeftAndRight) {
  Laser3dParams params;
  params.laser.upside_down = true;
  Rig rig(params);
  rig.open();
  rig.run(4.0);
  ASSERT_FALSE(rig.scans.empty());
  EXPECT_DOUBLE_EQ(rig.scans.back().angle_first_rad, geometry::deg_to_rad(90.0));
  EXPECT_DOUBLE_EQ(rig.scans.back().angle_step_rad, geometry::deg_to_rad(-1.0));
}

TEST(Laser3d, LeavesTheLaserAtRest) {
  Rig rig;
  rig.open();
  rig.run(4.0);
  rig.handle(rig.dut.shut_down(rig.now));
  rig.run(0.1);
  EXPECT_TRUE(rig.dut.is_laser_at_rest());
  EXPECT_FALSE(rig.sensor.streaming);
}

}  // namespace laser3d_test
}  // namespace nodmap::laser3d
