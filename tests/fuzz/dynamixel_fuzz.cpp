// SPDX-License-Identifier: BSD-3-Clause
// Any bytes, in any pieces and with any pauses, through the servo's parser and its session. Then
// the session again, with answers of any content whose checksums are correct, because random bytes
// hardly ever have a correct checksum.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "drivers/laser3d/servo/dynamixel.hpp"
#include "drivers/laser3d/servo/dynamixel_session.hpp"

namespace {

using namespace nodmap;           // NOLINT(google-build-using-namespace): a program of one page
using namespace nodmap::laser3d;  // NOLINT(google-build-using-namespace)

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void check(const ServoOutput& output, time::SteadyTime now) {
  require(!output.sample || std::isfinite(output.sample->pitch_rad));
  require(!output.sample || output.sample->stamp <= now);
}

// An answer of the servo, error and parameters, in a complete frame.
std::vector<std::uint8_t> answer_of(ByteView content) {
  const std::size_t length = content.size() + 3;  // instruction and checksum
  std::vector<std::uint8_t> frame{0xFF,
                                  0xFF,
                                  0xFD,
                                  0x00,
                                  static_cast<std::uint8_t>(ServoParams{}.id),
                                  static_cast<std::uint8_t>(length & 0xFFU),
                                  static_cast<std::uint8_t>(length >> 8U),
                                  0x55};
  frame.insert(frame.end(), content.begin(), content.end());
  const std::uint16_t crc = dynamixel_crc(frame);
  nodmap::serial::append_little(frame, crc);
  return frame;
}

// The first byte of each answer determines its length and its delay.
void answer(const std::uint8_t* data, std::size_t size) {
  DynamixelSession session({}, 40.0);
  time::SteadyTime now;
  static_cast<void>(session.open(now));
  static_cast<void>(session.poll(now));
  std::size_t at = 0;
  while (at < size) {
    const std::uint8_t head = data[at++];
    const std::size_t count = std::min<std::size_t>(size - at, head & 0x3FU);
    now += (head & 0x40U) != 0 ? 300ms : 1ms;
    check(session.receive(answer_of({data + at, count}), now), now);
    at += count;
    session.aim(0.1 * static_cast<double>(size % 7), 1.0);
    require(session.poll(now).send.size() <= 64);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  answer(data, size);
  DynamixelParser parser(1'000'000);
  DynamixelSession session({}, 40.0);
  time::SteadyTime now;
  static_cast<void>(session.open(now));
  std::size_t at = 0;
  while (at < size) {
    const std::size_t count = std::min<std::size_t>(size - at, 1U + (data[at] & 0x3FU));
    now += (data[at] & 0x40U) != 0 ? 300ms : 1ms;
    const ByteView bytes(data + at, count);
    at += count;
    parser.feed(bytes, now);
    while (const auto answer = parser.next()) {
      require(answer->parameters.size() <= 128);
      static_cast<void>(dynamixel_x::state_in(*answer));
    }
    check(session.receive(bytes, now), now);
    session.aim(0.1 * static_cast<double>(size % 7), 1.0);
    require(session.poll(now).send.size() <= 64);
  }
  return 0;
}
