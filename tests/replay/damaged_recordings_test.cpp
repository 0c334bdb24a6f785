// SPDX-License-Identifier: BSD-3-Clause
// Damaged recordings. Whatever is in them, every module ends with exit code 0 and counts in
// result.json what it could not use.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string_view>

#include "common/bus/event_log.hpp"
#include "common/geometry/angle.hpp"
#include "tests/replay/recording.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap {
namespace damaged_recordings_test {

constexpr time::Duration kScanPeriod = 13'320us;
constexpr int kNumScans = 300;

// The scans of a nodding scanner in a square room of 8 m.
scan::Scan scan_number(int i) {
  scan::Scan scan;
  scan.stamp = time::Timestamp(1000s + i * kScanPeriod);
  scan.duration = 6'660us;
  scan.seq = i;
  scan.angle_first_rad = geometry::deg_to_rad(-90);
  scan.angle_step_rad = geometry::deg_to_rad(1);
  const auto pitch_deg = [](int n) {
    const int phase = n % 100;
    return phase < 50 ? -20.0 + 0.6 * phase : 10.0 - 0.6 * (phase - 50);
  };
  scan.pitch_first_rad = geometry::deg_to_rad(pitch_deg(i));
  scan.pitch_last_rad = geometry::deg_to_rad(pitch_deg(i + 1));
  scan.range_min_m = 0.05;
  scan.range_max_m = 32.0;
  scan.T_base_mount.translation() = Eigen::Vector3d(0.1, 0, 0.38);
  for (int beam = 0; beam <= 180; ++beam) {
    const double angle = geometry::deg_to_rad(beam - 90);
    scan.ranges_m.push_back(static_cast<float>(
        4.0 / std::max({std::abs(std::cos(angle)), std::abs(std::sin(angle)), 0.1})));
  }
  return scan;
}

// Writes the recording; `damage` changes each scan before it is written.
void record(const std::filesystem::path& file,
            const std::function<void(int, scan::Scan&)>& damage) {
  test::Recording recording(file);
  for (int i = 0; i < kNumScans; ++i) {
    scan::Scan scan = scan_number(i);
    const double x_m = 0.5 * time::seconds(i * kScanPeriod);  // 0.5 m/s
    recording.odometry(scan.stamp, geometry::to_se3({x_m, 0, 0}));
    damage(i, scan);
    recording.scan(scan);
  }
}

class DamagedRecording : public ::testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] std::filesystem::path log() const { return dir_.path() / "in.lcmlog"; }

  nlohmann::json replay(int exit_code = 0) {
    const auto out = dir_.path() / "out";
    const auto run = test::run_program(GetParam(), {"--replay", log(), "--out", out});
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    return nlohmann::json::parse(test::slurp(out / "result.json"));
  }

  // All odometry and nearly all scans; not those that cannot be placed, at the ends and where a
  // stamp is wrong. 2D SLAM uses only the level scan of each of the six sweeps.
  [[nodiscard]] static int least_used() {
    return kNumScans + (std::string_view(GetParam()) == "nodmap-slam2d" ? 6 : kNumScans - 20);
  }

  test::TemporaryDir dir_;
};

TEST_P(DamagedRecording, ATruncatedLastEventIsSkipped) {
  record(log(), [](int, scan::Scan&) {});
  std::filesystem::resize_file(log(), std::filesystem::file_size(log()) - 100);
  const auto result = replay();
  EXPECT_EQ(result["log"]["events"], 2 * kNumScans - 1);
  EXPECT_GT(result["log"]["skipped_bytes"], 0);
  EXPECT_EQ(result["messages"]["corrupt"], 0);
}

TEST_P(DamagedRecording, RangesThatAreNotNumbersAreIgnored) {
  record(log(), [](int i, scan::Scan& scan) {
    for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
      if (i % 7 == 0 || beam % 3 == 0) {
        scan.ranges_m[beam] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  });
  EXPECT_GE(replay()["messages"]["used"], least_used());
}

TEST_P(DamagedRecording, ScansWithoutBeamsAreRefused) {
  record(log(), [](int i, scan::Scan& scan) {
    if (i % 2 == 0) {
      scan.ranges_m.clear();
    }
  });
  const auto result = replay();
  EXPECT_EQ(result["messages"]["corrupt"], 0);
  EXPECT_EQ(result["messages"]["rejected"]["empty_scan"], kNumScans / 2);
}

TEST_P(DamagedRecording, AfterStampsThatStepBackScansAreStillUsed) {
  record(log(), [](int i, scan::Scan& scan) {
    if (i % 50 == 49) {
      scan.stamp -= 900ms;
    }
  });
  const auto result = replay();
  EXPECT_GE(result["messages"]["used"], least_used());
  EXPECT_EQ(result["messages"]["read"], 2 * kNumScans);
}

TEST_P(DamagedRecording, ScansWithAnInvalidGeometryAreRefused) {
  record(log(), [](int i, scan::Scan& scan) {
    if (i % 10 == 0) {
      scan.pitch_first_rad = std::numeric_limits<double>::quiet_NaN();
    } else if (i % 10 == 1) {
      scan.range_max_m = -1.0;
    }
  });
  EXPECT_EQ(replay()["messages"]["rejected"]["implausible_scan"], kNumScans / 5);
}

TEST_P(DamagedRecording, WithoutOdometryNoScanIsUsed) {
  {
    test::Recording recording(log());
    for (int i = 0; i < kNumScans; ++i) {
      recording.scan(scan_number(i));
    }
  }
  const auto result = replay(1);
  EXPECT_EQ(result["messages"]["read"], kNumScans);
  EXPECT_EQ(result["messages"]["used"], 0);
}

TEST_P(DamagedRecording, AMillionRandomBytesOnScanAreCorruptMessages) {
  {
    test::Recording recording(log());
    std::mt19937 random(5);
    for (int i = 0; i < 1000; ++i) {
      std::vector<std::byte> noise(1000);
      for (std::byte& b : noise) {
        b = static_cast<std::byte>(random() & 0xFFU);
      }
      recording.bytes(time::from_utime(i), "SCAN", noise);
    }
  }
  const auto result = replay(1);
  EXPECT_EQ(result["messages"]["corrupt"], 1000);
  EXPECT_EQ(result["messages"]["read"], 0);
}

TEST_P(DamagedRecording, AnEmptyLogIsNotARecording) {
  { const bus::LogWriter empty(log()); }
  const auto out = dir_.path() / "out";
  const auto run = test::run_program(GetParam(), {"--replay", log(), "--out", out});
  EXPECT_EQ(run.exit_code, 2) << "a file without an event is not a recording: " << run.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

INSTANTIATE_TEST_SUITE_P(EveryModule, DamagedRecording,
                         ::testing::Values("nodmap-map-server", "nodmap-slam2d", "nodmap-slam6d"));

}  // namespace damaged_recordings_test
}  // namespace nodmap
