// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/probe.hpp"

#include <gtest/gtest.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/data_dir.hpp"

namespace nodmap::doctor {
namespace probe_test {

TEST(Probe, ReadsWhatTheSystemShows) {
  EXPECT_FALSE(read_text("/proc/no/such/file"));
  EXPECT_EQ(read_text("/proc/self/comm").value_or("").substr(0, 6), "doctor");
  EXPECT_TRUE(find_program("sh"));
  EXPECT_FALSE(find_program("no-such-program"));
}

TEST(Probe, FindsTheLoopbackInterface) {
  const auto flags = interface_flags();
  ASSERT_TRUE(flags.contains("lo"));
  EXPECT_NE(flags.at("lo") & IFF_LOOPBACK, 0U);
}

TEST(Probe, FindsTheOwnerOfASocket) {
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM, 0);
  struct stat info {};
  ASSERT_EQ(::fstat(fd, &info), 0);
  const auto owners = socket_owners();
  ::close(fd);
  ASSERT_TRUE(owners.contains(info.st_ino));
  EXPECT_EQ(owners.at(info.st_ino), "doctor_test (" + std::to_string(::getpid()) + ")");
}

TEST(Probe, FreeSpaceOfAMissingFolderIsThatOfItsParent) {
  const test::TemporaryDir dir;
  const std::int64_t there = available_bytes(dir.path());
  EXPECT_GT(there, 0);
  // Other processes may write meanwhile, but not more than a gigabyte between two statements.
  EXPECT_NEAR(static_cast<double>(available_bytes(dir.path() / "a" / "b")),
              static_cast<double>(there), 1e9);
}

}  // namespace probe_test
}  // namespace nodmap::doctor
