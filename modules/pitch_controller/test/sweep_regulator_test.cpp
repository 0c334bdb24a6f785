// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_regulator.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::pitch_controller {
namespace {

/// The relative error after `sweeps` sweeps of a servo that takes `gain` times what it is told.
double error_after(SweepRegulator regulator, double gain, int sweeps) {
  double measured_s = 0.0;
  for (int i = 0; i < sweeps; ++i) {
    measured_s = gain * regulator.command_s(0.5, 0.1, 5.0);
    regulator.add(0.5, measured_s);
  }
  return measured_s / 0.5 - 1.0;
}

TEST(SweepRegulator, R11_NoSteadyErrorWithAGainFault) {
  for (const double gain : {0.8, 1.2, 1.25, 1.5}) {
    // 20 sweeps at 0.73 a sweep, its slowest root: 0.2 %.
    EXPECT_NEAR(error_after(SweepRegulator(0.1, 0.6), gain, 20), 0.0, 2e-3) << gain;
  }
}

TEST(SweepRegulator, R11_WithoutTheIntegralTheErrorStays) {
  EXPECT_NEAR(error_after(SweepRegulator(0.0, 0.0), 1.25, 50), 0.25, 1e-12);
  EXPECT_GT(error_after(SweepRegulator(0.1, 0.0), 1.25, 50), 0.15);
}

TEST(SweepRegulator, R11_OvershootIsBelowTenPercent) {
  for (const double gain : {0.8, 1.25}) {
    const double sign = gain > 1.0 ? 1.0 : -1.0;
    for (int sweeps = 1; sweeps < 30; ++sweeps) {
      EXPECT_GT(sign * error_after(SweepRegulator(0.1, 0.6), gain, sweeps), -0.1);
    }
  }
}

TEST(SweepRegulator, WhatItLearntHoldsForOtherWishes) {
  SweepRegulator dut(0.1, 0.6);
  for (int i = 0; i < 30; ++i) {
    dut.add(1.0, 1.25 * dut.command_s(1.0, 0.1, 5.0));
  }
  // As above, and the step itself brings no new error.
  EXPECT_NEAR(1.25 * dut.command_s(0.3, 0.1, 5.0), 0.3, 1e-3);
}

TEST(SweepRegulator, DoesNotWindUpAtTheServosLimit) {
  SweepRegulator dut(0.1, 0.6);
  for (int i = 0; i < 100; ++i) {
    const double command_s = dut.command_s(0.3, 0.3, 5.0);
    EXPECT_GE(command_s, 0.3);
    dut.add(0.3, 1.3 * command_s);
  }
  // The fault is gone: no long memory of what was out of reach. One sweep of integration (0.6 of
  // 30 %) may have gone in before the limit was met.
  const double first_s = dut.command_s(0.5, 0.1, 5.0);
  EXPECT_GT(first_s, 0.5 * (1.0 - 0.6 * 0.3 - 0.1 * 0.3) - 1e-9);
}

TEST(SweepRegulator, OneOddSweepIsNoJump) {
  SweepRegulator dut(0.1, 0.6);
  dut.add(0.5, 100.0);
  EXPECT_GE(dut.command_s(0.5, 0.01, 5.0), 0.5 * 0.5);
}

}  // namespace
}  // namespace nodmap::pitch_controller
