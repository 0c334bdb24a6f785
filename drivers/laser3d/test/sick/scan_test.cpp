// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/scan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angle.hpp"
#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace scan_test {

constexpr time::SteadyTime kSent{1s};

using test::hex;
using test::telegram_of;
using test::operator+;  // NOLINT(misc-unused-using-decls): an operator is used

constexpr SickMeasuringMode k8m{0x00};
constexpr SickMeasuringMode k32m{0x06};

TEST(SickScan, ReadsMillimetresAndCodes) {
  const SickScan scan = *read_scan(telegram_of(test::kThreeMm), k8m);
  ASSERT_EQ(scan.ranges_m.size(), 3U);
  EXPECT_FLOAT_EQ(scan.ranges_m[0], 1.0F);
  EXPECT_TRUE(std::isinf(scan.ranges_m[1]));  // 8183: beyond reach
  EXPECT_TRUE(std::isnan(scan.ranges_m[2]));  // 8190: dazzled
  EXPECT_EQ(scan.num_dazzled, 1);
  EXPECT_EQ(scan.num_unmeasured, 0);
  EXPECT_DOUBLE_EQ(scan.range_max_m, 8.182);
  EXPECT_FALSE(scan.indices);
  EXPECT_FALSE(scan.quarter);
}

TEST(SickScan, TheSameValuesAreRangesInTheWideMode) {
  const SickScan scan = *read_scan(telegram_of(test::kThreeMm), k32m);
  EXPECT_FLOAT_EQ(scan.ranges_m[1], 8.183F);
  EXPECT_FLOAT_EQ(scan.ranges_m[2], 8.190F);
  EXPECT_DOUBLE_EQ(scan.range_max_m, 32.758);
}

TEST(SickScan, ReadsTheIndicesOfScanAndTelegram) {
  const SickScan scan = *read_scan(telegram_of(test::kThreeMmIndexed), k8m);
  ASSERT_TRUE(scan.indices);
  EXPECT_EQ(scan.indices->scan, 0x2A);
  EXPECT_EQ(scan.indices->telegram, 7);
  EXPECT_EQ(scan.ranges_m.size(), 3U);
}

TEST(SickScan, ReadsCentimetres) {
  const SickScan scan = *read_scan(telegram_of(test::kThreeCm), k8m);
  EXPECT_FLOAT_EQ(scan.ranges_m[0], 0.01F);
  EXPECT_FLOAT_EQ(scan.ranges_m[2], 0.03F);
  EXPECT_DOUBLE_EQ(scan.range_max_m, 80.0);  // 81.82 could be encoded, but the optics reach only 80
}

TEST(SickScan, WholeScansOfBothResolutions) {
  EXPECT_EQ(read_scan(telegram_of(test::kFlat181), k32m)->ranges_m, std::vector(181, 1.0F));
  EXPECT_EQ(read_scan(telegram_of(test::kFlat361), k32m)->ranges_m, std::vector(361, 1.0F));
  const SickScan ramp = *read_scan(telegram_of(test::kRamp181Indexed), k32m);
  for (std::size_t i = 0; i < ramp.ranges_m.size(); ++i) {
    EXPECT_FLOAT_EQ(ramp.ranges_m[i], 0.001F * static_cast<float>(1000 + i));
  }
}

TEST(SickScan, ReadsPartialScansWithAndWithoutAMark) {
  for (const Bytes* frame : {&test::kPartial50, &test::kPartial50Marked}) {
    const SickScan scan = *read_scan(telegram_of(*frame), kInterlacedMode);
    EXPECT_EQ(scan.quarter, 2);
    EXPECT_EQ(scan.ranges_m.size(), 180U);
  }
}

TEST(SickScan, EveryCodeOfEveryModeIsItsMeaning) {
  for (const auto& [mode, top] : {std::pair{0x00, 8191},
                                  {0x01, 8191},
                                  {0x02, 8191},
                                  {0x03, 16383},
                                  {0x04, 16383},
                                  {0x05, 32767},
                                  {0x06, 32767},
                                  {0x0F, 32767}}) {
    Bytes words;
    for (const int below : {0, 1, 2, 4, 5, 8, 9}) {
      serial::append_little(words, static_cast<std::uint16_t>(top - below));
    }
    const auto frame = test::sick_frame(hex("B0 07 40") + words);
    const SickScan scan = *read_scan(telegram_of(frame), {static_cast<std::uint8_t>(mode)});
    EXPECT_EQ(scan.num_unmeasured, 4) << mode;
    EXPECT_EQ(scan.num_dazzled, 1) << mode;
    EXPECT_TRUE(std::isinf(scan.ranges_m[5])) << mode;
    EXPECT_NEAR(scan.ranges_m[6], 0.001 * (top - 9), 1e-5) << mode;  // float near 32
  }
}

TEST(SickScan, FlagBitsAreNoRange) {
  for (const auto& [mode, flags] : {std::pair{0x00, 0x6000},
                                    {0x01, 0xE000},
                                    {0x02, 0xE000},
                                    {0x03, 0xC000},
                                    {0x04, 0xC000},
                                    {0x05, 0x8000},
                                    {0x06, 0x8000}}) {
    Bytes word;
    serial::append_little(word, static_cast<std::uint16_t>(0x03E8 | flags));
    const auto frame = test::sick_frame(hex("B0 01 40") + word);
    const SickScan scan = *read_scan(telegram_of(frame), {static_cast<std::uint8_t>(mode)});
    EXPECT_FLOAT_EQ(scan.ranges_m[0], 1.0F) << mode;
  }
}

TEST(SickScan, TheDazzleFlagIsDazzling) {
  const auto frame = test::sick_frame(hex("B0 01 40 E8 83"));
  const SickScan scan = *read_scan(telegram_of(frame), k8m);
  EXPECT_TRUE(std::isnan(scan.ranges_m[0]));
  EXPECT_EQ(scan.num_dazzled, 1);
}

TEST(SickScan, ReflectivityIsNoRange) {
  EXPECT_FALSE(read_scan(telegram_of(test::kRamp181), {0x3F}));
  EXPECT_FALSE(read_scan(telegram_of(test::kModeOk), k8m));
}

TEST(SickScan, ReadsTheStatusByte) {
  const auto frame = test::sick_frame(hex("B0 01 40 E8 03"), 0xB2);
  const SickScan scan = *read_scan(telegram_of(frame), k8m);
  EXPECT_EQ(scan.status.severity(), 2);
  EXPECT_TRUE(scan.status.polluted());
}

using geometry::deg_to_rad;

SickScan numbered(int count) {
  SickScan scan;
  for (int i = 0; i < count; ++i) {
    scan.ranges_m.push_back(static_cast<float>(i));
  }
  return scan;
}

TEST(MirrorRevolutions, R1_OneDegreeIsOneRevolutionOf6660Microseconds) {
  const auto revolutions = mirror_revolutions(numbered(181), SickVariant::k180x100, kSent);
  ASSERT_EQ(revolutions.size(), 1U);
  EXPECT_EQ(revolutions[0].last_beam, kSent);
  EXPECT_EQ(revolutions[0].first_beam, kSent - 6660us);
  EXPECT_DOUBLE_EQ(revolutions[0].angle_first_rad, deg_to_rad(-90.0));
  EXPECT_DOUBLE_EQ(revolutions[0].angle_step_rad, deg_to_rad(1.0));
  EXPECT_EQ(revolutions[0].ranges_m.size(), 181U);
}

TEST(MirrorRevolutions, R1_EveryBeamOfEveryVariantKeepsItsAngle) {
  for (const SickVariant variant :
       {SickVariant::k180x100, SickVariant::k180x050, SickVariant::k100x100, SickVariant::k100x050,
        SickVariant::k100x025}) {
    const SickGeometry geometry = geometry_of(variant);
    const auto revolutions = mirror_revolutions(numbered(geometry.num_values()), variant, kSent);
    ASSERT_EQ(static_cast<int>(revolutions.size()), geometry.revolutions);
    std::size_t beams = 0;
    for (std::size_t k = 0; k < revolutions.size(); ++k) {
      beams += revolutions[k].ranges_m.size();
      for (std::size_t i = 0; i < revolutions[k].ranges_m.size(); ++i) {
        const double value = static_cast<double>(revolutions[k].ranges_m[i]);
        const double expected_deg =
            -0.5 * geometry.field_deg + 0.01 * geometry.resolution_cdeg * value;
        EXPECT_NEAR(
            revolutions[k].angle_first_rad + revolutions[k].angle_step_rad * static_cast<double>(i),
            deg_to_rad(expected_deg), 1e-12);
      }
    }
    EXPECT_EQ(static_cast<int>(beams), geometry.num_values());
  }
}

TEST(MirrorRevolutions, ThoseOfOneScanAreAPeriodApart) {
  const auto revolutions = mirror_revolutions(numbered(401), SickVariant::k100x025, kSent);
  ASSERT_EQ(revolutions.size(), 4U);
  for (std::size_t k = 1; k < 4; ++k) {
    // And a quarter of a degree further, 9 us.
    const time::FineDuration apart = revolutions[k].first_beam - revolutions[k - 1].first_beam;
    EXPECT_NEAR(apart.count(), 13'320.0 + 9.25, 1.0);
  }
}

TEST(MirrorRevolutions, InterlacedScansAreShifted) {
  SickScan scan = numbered(180);
  scan.quarter = 2;
  const MirrorRevolution revolution = interlaced_revolution(scan, kSent);
  EXPECT_DOUBLE_EQ(revolution.angle_first_rad, deg_to_rad(-89.5));
  EXPECT_LT(revolution.last_beam,
            kSent);  // it ends half a degree before the half revolution does
}

TEST(MirrorRevolutions, AnEmptyScanDoesNotCrash) {
  EXPECT_TRUE(mirror_revolutions({}, SickVariant::k180x050, kSent).at(1).ranges_m.empty());
}

}  // namespace scan_test
}  // namespace nodmap::laser3d
