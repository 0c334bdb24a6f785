// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/reconnecting_port.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "tests/support/data_dir.hpp"
#include "tests/support/pty_pair.hpp"

namespace nodmap::serial {
namespace {

using std::chrono::microseconds;

TEST(ReconnectingPort, TriesAgainWithGrowingPauses) {
  int attempts = 0;
  ReconnectingPort port([&attempts]() -> OpenResult {
    ++attempts;
    return {nullptr, "no such device"};
  });
  EXPECT_FALSE(port.is_open());
  // Asked every millisecond for 10 s: at 0, 0.1, 0.3, 0.7, 1.5, 3.1, 6.3 s.
  for (std::int64_t now_us = 0; now_us <= 10'000'000; now_us += 1000) {
    EXPECT_EQ(port.stream(now_us), nullptr);
  }
  EXPECT_EQ(attempts, 7);
  EXPECT_EQ(port.error(), "no such device");
  EXPECT_EQ(port.reconnects(), 0);
}

TEST(ReconnectingPort, ADeviceThatFailsAtOnceEachTimeDoesNotEscapeTheBackOff) {
  const test::PtyPair pty;
  int attempts = 0;
  ReconnectingPort port([&]() -> OpenResult {
    ++attempts;
    return open_serial_port({pty.name()});
  });
  for (std::int64_t now_us = 0; now_us <= 10'000'000; now_us += 1000) {
    if (port.stream(now_us) != nullptr) {
      port.give_up(now_us, "mute");
    }
  }
  EXPECT_EQ(attempts, 7);
  EXPECT_EQ(port.reconnects(), 6);
  EXPECT_EQ(port.error(), "mute");
}

TEST(ReconnectingPort, AfterALongLifeTheFirstAttemptIsSoon) {
  const test::PtyPair pty;
  ReconnectingPort port([&] { return open_serial_port({pty.name()}); });
  ASSERT_NE(port.stream(0), nullptr);
  EXPECT_EQ(port.error(), "");
  EXPECT_EQ(port.wait_us(0), 0);
  port.give_up(60'000'000, "mute");
  EXPECT_EQ(port.wait_us(60'000'000), BackOff::kFirstUs);
  ASSERT_NE(port.stream(60'100'000), nullptr);
  EXPECT_EQ(port.reconnects(), 1);
}

// As udev does it: the link stays, and leads to another device after replugging.
TEST(ReconnectingPort, FindsTheDeviceUnderItsNewName) {
  const test::TemporaryDir dir;
  const std::filesystem::path link = dir.path() / "scanner";
  std::optional<test::PtyPair> pty(std::in_place);
  std::filesystem::create_symlink(pty->name(), link);
  ReconnectingPort port([&] { return open_serial_port({link.string()}); });

  ByteStream* stream = port.stream(0);
  ASSERT_NE(stream, nullptr) << port.error();
  pty->unplug();
  std::array<std::uint8_t, 8> buffer{};
  ASSERT_EQ(stream->read(buffer, microseconds(5'000'000)).status, IoStatus::kDisconnected);
  port.give_up(0, "disconnected");
  EXPECT_EQ(port.stream(100'000), nullptr);
  EXPECT_NE(port.error(), "");

  pty.emplace();
  std::filesystem::remove(link);
  std::filesystem::create_symlink(pty->name(), link);
  stream = port.stream(300'000);
  ASSERT_NE(stream, nullptr) << port.error();
  pty->send("x");
  EXPECT_EQ(stream->read(buffer, microseconds(5'000'000)).count, 1U);
}

}  // namespace
}  // namespace nodmap::serial
