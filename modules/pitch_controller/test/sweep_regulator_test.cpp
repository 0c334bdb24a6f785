// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_regulator.hpp"

#include <gtest/gtest.h>

namespace nodmap::pitch_controller {
namespace sweep_regulator_test {

// The relative error after `sweeps` sweeps of a servo whose sweeps take `gain` times the commanded
// duration.
double error_after(SweepRegulator regulator, double gain, int sweeps) {
  double measured_s = 0.0;
  for (int i = 0; i < sweeps; ++i) {
    measured_s = gain * regulator.command_s(0.5, 0.1, 5.0);
    regulator.add(0.5, measured_s);
  }
  return measured_s / 0.5 - 1.0;
}

TEST(SweepRegulator, AGainFaultLeavesNoSteadyError) {
  for (const double gain : {0.8, 1.2, 1.25, 1.5}) {
    // The error falls by a factor of 0.73 per sweep (the slowest root): 0.2 % after 20 sweeps.
    EXPECT_NEAR(error_after(SweepRegulator({0.1, 0.6}), gain, 20), 0.0, 2e-3) << gain;
  }
}

TEST(SweepRegulator, WithoutTheIntegralAGainFaultLeavesAnError) {
  EXPECT_NEAR(error_after(SweepRegulator({0.0, 0.0}), 1.25, 50), 0.25, 1e-12);
  // The error e at which 1 + e = gain * (1 - p * e).
  EXPECT_NEAR(error_after(SweepRegulator({0.1, 0.0}), 1.25, 50), 0.25 / (1.0 + 1.25 * 0.1), 1e-12);
}

TEST(SweepRegulator, OvershootIsBelowTenPercent) {
  for (const double gain : {0.8, 1.25}) {
    const double sign = gain > 1.0 ? 1.0 : -1.0;
    for (int sweeps = 1; sweeps < 30; ++sweeps) {
      EXPECT_GT(sign * error_after(SweepRegulator({0.1, 0.6}), gain, sweeps), -0.1);
    }
  }
}

TEST(SweepRegulator, ItsCorrectionHoldsForOtherSetPoints) {
  SweepRegulator dut({});
  for (int i = 0; i < 30; ++i) {
    dut.add(1.0, 1.25 * dut.command_s(1.0, 0.1, 5.0));
  }
  // As above; the step itself adds no error.
  EXPECT_NEAR(1.25 * dut.command_s(0.3, 0.1, 5.0), 0.3, 1e-3);
}

TEST(SweepRegulator, DoesNotWindUpAtTheServosLimit) {
  SweepRegulator dut({});
  for (int i = 0; i < 100; ++i) {
    const double command_s = dut.command_s(0.3, 0.3, 5.0);
    EXPECT_GE(command_s, 0.3);
    dut.add(0.3, 1.3 * command_s);
  }
  // The fault is gone, and the integral hardly contains any of it. One sweep of integration (0.6 of
  // 30 %) is possible before the limit was reached.
  const double first_s = dut.command_s(0.5, 0.1, 5.0);
  EXPECT_GT(first_s, 0.5 * (1.0 - 0.6 * 0.3 - 0.1 * 0.3) - 1e-9);
}

TEST(SweepRegulator, OneUnusualSweepCausesNoJumpOfTheCommand) {
  SweepRegulator dut({});
  dut.add(0.5, 100.0);
  EXPECT_GE(dut.command_s(0.5, 0.01, 5.0), 0.5 * 0.5);
}

}  // namespace sweep_regulator_test
}  // namespace nodmap::pitch_controller
