// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nodmap::doctor {
namespace host_test {

TEST(Host, AMissingProgramIsReportedWithTheCommandThatInstallsIt) {
  EXPECT_EQ(check_present("java", "java", true, "x", "get").status, Status::kOk);
  EXPECT_TRUE(check_present("java", "java", true, "x", "get").command.empty());
  const Finding missing = check_present("java", "java", false, "lcm-spy needs it", "get");
  EXPECT_EQ(missing.status, Status::kWarn);
  EXPECT_EQ(missing.command, "get");
}

TEST(Host, RecognisesDebiansSpyScriptThatDoesNotStart) {
  // From liblcm-bin 1.3.1+repack1-3.
  const char* debian =
      "#!/bin/sh\nexec java -server -Djava.net.preferIPv4Stack=true -Xincgc -Xmx128m -Xms64m -ea "
      "-cp /usr/share/java/lcm.jar:/usr/share/java/jchart2d.jar lcm.spy.Spy $*\n";
  EXPECT_EQ(check_spy_script(debian).status, Status::kWarn);
  EXPECT_EQ(check_spy_script(debian).command, "./nodmap spy");
  EXPECT_EQ(check_spy_script("#!/bin/sh\nexec java -cp lcm.jar lcm.spy.Spy\n").status, Status::kOk);
  EXPECT_EQ(check_spy_script(std::nullopt).status, Status::kWarn);
}

TEST(Host, DiskSpaceIsRatedByTheRecordingTimeThatItAllows) {
  EXPECT_EQ(check_disk("logs", 100'000'000'000).status, Status::kOk);
  EXPECT_EQ(check_disk("logs", 1'000'000'000).status, Status::kWarn);
  EXPECT_EQ(check_disk("logs", 0).status, Status::kFail);
  EXPECT_THAT(check_disk("logs", 1'000'000'000).sentence, ::testing::HasSubstr("1000 MB"));
}

TEST(Host, WarnsIfTheKernelsSerialThreadsMayNotBeRaised) {
  EXPECT_EQ(check_serial_workers(true).status, Status::kOk);
  EXPECT_EQ(check_serial_workers(false).status, Status::kWarn);
  EXPECT_THAT(check_serial_workers(false).command, ::testing::HasSubstr("CAP_SYS_NICE"));
}

TEST(Host, WarnsIfThereIsNoRealTimePriority) {
  EXPECT_EQ(check_realtime(true).status, Status::kOk);
  EXPECT_EQ(check_realtime(false).status, Status::kWarn);
  EXPECT_THAT(check_realtime(false).command, ::testing::HasSubstr("rtprio"));
}

TEST(Host, AnUnsynchronisedClockIsNotAFailure) {
  EXPECT_EQ(check_clock(true).status, Status::kOk);
  EXPECT_EQ(check_clock(false).status, Status::kWarn);
}

}  // namespace host_test
}  // namespace nodmap::doctor
