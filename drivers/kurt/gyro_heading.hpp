// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/kurt/gyro_bias.hpp"
#include "drivers/kurt/gyro_doubt.hpp"
#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/params.hpp"

namespace nodmap::kurt {

/// The motion of the wheels in one or more periods of the encoders.
struct WheelStep {
  double rotation_rad = 0.0;  ///< of the robot, by the wheels; positive turns left
  double path_m = 0.0;        ///< mean distance driven by the two sides, each positive
  double variance_rad2 = 0.0;
  int periods = 1;
};

/// Whether the heading is corrected by the gyro; if not, why.
enum class GyroUse : std::uint8_t {
  kOff,        ///< switched off by a parameter
  kAbsent,     ///< it has not sent an angle yet
  kUnsettled,  ///< the robot has not been stationary for long enough to measure its bias
  kUsed,
  kSilent,     ///< its angles no longer arrive
  kFrozen,     ///< it repeats an angle while the wheels rotate the robot
  kDisagrees,  ///< with the wheels, by more than they can slip: jumped, zeroed, of the wrong sign
  kRunsOff,    ///< its bias is larger than that of any intact gyro
};

/// What is wrong with the gyro; empty if nothing is.
[[nodiscard]] std::string_view fault_of(GyroUse use);

struct GyroCounts {
  std::int64_t used = 0;      ///< angles by which the heading was corrected
  std::int64_t refused = 0;   ///< angles that disagreed with the wheels or were frozen
  std::int64_t silences = 0;  ///< how often its angles stopped arriving
};

/// Corrects the rotation that the wheels measure by the angles of the gyro.
///
/// Between two angles the robot rotates by its wheels, which are taken to slip as in the last
/// interval. Each angle then shows by how much they erred, and this is added during the next
/// interval, so that the heading has no steps. The bias of the gyro is measured while the wheels
/// are still, and only then; meanwhile the heading stays as it is.
class GyroHeading {
 public:
  struct Rotation {
    double rotation_rad = 0.0;
    double variance_rad2 = 0.0;
  };

  explicit GyroHeading(const GyroParams& params)
      : params_(params), use_(params.use_gyro ? GyroUse::kAbsent : GyroUse::kOff), bias_(params) {}

  /// The rotation of the robot during this motion of its wheels.
  Rotation rotate(const WheelStep& wheels);

  /// Adds an angle, measured after the last motion of the wheels and before the next.
  void add(const Gyro& gyro);

  /// Begins anew after a time in which the motion is unknown.
  void interrupt();

  [[nodiscard]] GyroUse use() const { return use_; }
  [[nodiscard]] const GyroCounts& counts() const { return counts_; }
  /// The yaw rate that the gyro reports of a stationary robot; empty until it has been measured.
  [[nodiscard]] std::optional<double> bias_rad_s() const;

 private:
  /// Since the last angle.
  struct Interval {
    double wheels_rad = 0.0;
    double predicted_rad = 0.0;
    double path_m = 0.0;
    int periods = 0;
  };

  void correct(double gyro_rad, double bias_rad_s, const Interval& interval, double dt_s);
  void measure_bias(double gyro_rad, double dt_s);
  void forget_angle();
  void resume();
  [[nodiscard]] Interval end_interval();
  [[nodiscard]] double gyro_variance_rad2(double rotation_rad, double dt_s) const;

  GyroParams params_;
  GyroUse use_;
  GyroCounts counts_;
  std::optional<double> last_angle_rad_;
  Interval since_;
  Interval last_step_;
  double slip_rad_per_m_ = 0.0;
  double to_release_rad_ = 0.0;
  int release_periods_ = 0;
  int still_periods_ = 0;
  GyroBias bias_;
  GyroDoubt doubt_;
};

}  // namespace nodmap::kurt
