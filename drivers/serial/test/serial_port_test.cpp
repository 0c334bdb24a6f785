// SPDX-License-Identifier: BSD-3-Clause
// Tests of a port, over a pseudo-terminal. Built twice: plain, where the terminal is opened
// directly, and with the shim, where libserialport opens it.
#include "drivers/serial/serial_port.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>
#include <thread>
#include <vector>

#include "tests/support/data_dir.hpp"
#include "tests/support/pty_pair.hpp"

namespace nodmap::serial {
namespace serial_port_test {

using std::chrono::microseconds;
using std::chrono::steady_clock;

constexpr microseconds kLong{5'000'000};  // never reached unless something is broken
constexpr microseconds kNoWait{0};

std::vector<std::uint8_t> all_bytes() {
  std::vector<std::uint8_t> bytes(256);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

// Reads until `count` bytes are there.
std::vector<std::uint8_t> read_exactly(ByteStream& stream, std::size_t count) {
  std::vector<std::uint8_t> received;
  std::array<std::uint8_t, 64> buffer{};
  while (received.size() < count) {
    const ReadResult result = stream.read(buffer, kLong);
    if (result.status != IoStatus::kOk) {
      break;
    }
    received.insert(received.end(), buffer.begin(), buffer.begin() + result.count);
  }
  return received;
}

TEST(SerialPort, BytesPassUnchangedBothWays) {
  const test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name()});
  ASSERT_NE(port.stream, nullptr) << port.error;
  EXPECT_TRUE(port.stream->connected());
  EXPECT_EQ(port.stream->write(all_bytes(), kLong), IoStatus::kOk);
  EXPECT_EQ(pty.receive(256), all_bytes());
  pty.send(all_bytes());
  EXPECT_EQ(read_exactly(*port.stream, 256), all_bytes());
}

TEST(SerialPort, TimeOutsAreBounded) {
  const test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name()});
  ASSERT_NE(port.stream, nullptr) << port.error;
  std::array<std::uint8_t, 8> buffer{};
  const auto start = steady_clock::now();
  EXPECT_EQ(port.stream->read(buffer, kNoWait).status, IoStatus::kTimeout);
  EXPECT_EQ(port.stream->read(buffer, microseconds(20'000)).status, IoStatus::kTimeout);
  // Not earlier; how much later depends on the machine's load.
  EXPECT_GE(steady_clock::now() - start, microseconds(20'000));
}

// What the line has not taken is dropped. Otherwise closing a serial line would wait until it is
// sent. A pseudo-terminal has no output queue (TIOCOUTQ is 0), but what is written waits in its
// buffers: some 10 kB, of which the device can already have 4 kB.
TEST(SerialPort, AFullLineEndsTheWriteInTimeAndDropsTheRest) {
  const test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name()});
  ASSERT_NE(port.stream, nullptr) << port.error;
  const std::vector<std::uint8_t> more_than_fits(1'000'000, 'x');
  EXPECT_EQ(port.stream->write(more_than_fits, microseconds(20'000)), IoStatus::kTimeout);
  EXPECT_TRUE(port.stream->connected());
  constexpr std::size_t kTaken = 4096;
  EXPECT_LE(pty.receive(kTaken + 1, std::chrono::milliseconds(100)).size(), kTaken);
}

TEST(SerialPort, APulledPlugIsSeenByTheReadAtOnce) {
  test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name()});
  ASSERT_NE(port.stream, nullptr) << port.error;
  std::array<std::uint8_t, 8> buffer{};
  std::thread puller([&pty] { pty.unplug(); });
  EXPECT_EQ(port.stream->read(buffer, kLong).status, IoStatus::kDisconnected);
  puller.join();
  EXPECT_FALSE(port.stream->connected());
  EXPECT_EQ(port.stream->read(buffer, kLong).status, IoStatus::kDisconnected);
  EXPECT_EQ(port.stream->write(all_bytes(), kLong), IoStatus::kDisconnected);
}

TEST(SerialPort, APulledPlugIsSeenByTheWrite) {
  test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name()});
  ASSERT_NE(port.stream, nullptr) << port.error;
  pty.unplug();
  EXPECT_EQ(port.stream->write(all_bytes(), kLong), IoStatus::kDisconnected);
  EXPECT_FALSE(port.stream->connected());
}

TEST(SerialPort, OneProcessOnly) {
  const test::PtyPair pty;
  {
    const OpenResult first = open_serial_port({pty.name()});
    ASSERT_NE(first.stream, nullptr) << first.error;
    const OpenResult second = open_serial_port({pty.name()});
    EXPECT_EQ(second.stream, nullptr);
    EXPECT_NE(second.error.find("in use"), std::string::npos) << second.error;
  }
  EXPECT_NE(open_serial_port({pty.name()}).stream, nullptr);  // and free again
}

TEST(SerialPort, ChildProcessesDoNotInheritIt) {
  const test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name()});
  ASSERT_NE(port.stream, nullptr) << port.error;
  const std::string probe = "/proc/self/fd/" + std::to_string(port.stream->poll_handle());
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/usr/bin/test", "test", "!", "-e", probe.c_str(), nullptr);
    ::_exit(99);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(SerialPort, LinksAreFollowed) {
  const test::PtyPair pty;
  const test::TemporaryDir dir;
  const std::filesystem::path link = dir.path() / "scanner";
  std::filesystem::create_symlink(pty.name(), link);
  const OpenResult port = open_serial_port({link.string()});
  ASSERT_NE(port.stream, nullptr) << port.error;
  pty.send("x");
  EXPECT_EQ(read_exactly(*port.stream, 1).size(), 1U);
}

TEST(SerialPort, SetsTheRateOfTheLine) {
  const test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name(), 9600});
  ASSERT_NE(port.stream, nullptr) << port.error;
  EXPECT_EQ(pty.baud(), 9600);
  for (const int baud : {38400, 115200, 500000, 1000000}) {
    EXPECT_TRUE(port.stream->set_baud(baud));
    EXPECT_EQ(pty.baud(), baud);
  }
}

TEST(SerialPort, DiscardsInput) {
  const test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name()});
  ASSERT_NE(port.stream, nullptr) << port.error;
  pty.send("old");
  pollfd arrived{port.stream->poll_handle(), POLLIN, 0};
  ASSERT_EQ(::poll(&arrived, 1, 5000), 1);
  port.stream->discard_input();
  pty.send("new");
  EXPECT_EQ(read_exactly(*port.stream, 3), (std::vector<std::uint8_t>{'n', 'e', 'w'}));
}

TEST(SerialPort, AnythingButAPortIsRefusedWithAReason) {
  const OpenResult missing = open_serial_port({"/dev/serial/by-id/no-such-device"});
  EXPECT_EQ(missing.stream, nullptr);
  EXPECT_NE(missing.error.find("/dev/serial/by-id/no-such-device"), std::string::npos);
  const OpenResult file = open_serial_port({"/dev/null"});
  EXPECT_EQ(file.stream, nullptr);
  EXPECT_NE(file.error, "");
  EXPECT_EQ(open_serial_port({""}).stream, nullptr);
}

}  // namespace serial_port_test
}  // namespace nodmap::serial
