// SPDX-License-Identifier: BSD-3-Clause
// Any bytes, in any pieces, with any pauses, through the servo's parser and its conversation.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "drivers/laser3d/dynamixel_session.hpp"

namespace {

using namespace nodmap::laser3d;  // NOLINT(google-build-using-namespace): a program of one page

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  DynamixelParser parser(1'000'000);
  DynamixelSession session({});
  std::int64_t now_us = 0;
  static_cast<void>(session.open(now_us));
  std::size_t at = 0;
  while (at < size) {
    const std::size_t count = std::min<std::size_t>(size - at, 1U + (data[at] & 0x3FU));
    now_us += (data[at] & 0x40U) != 0 ? 300'000 : 1'000;
    const ByteView bytes(data + at, count);
    at += count;
    parser.feed(bytes, now_us);
    while (const auto answer = parser.next()) {
      require(answer->parameters.size() <= 128);
      static_cast<void>(dynamixel_x::state_in(*answer));
    }
    const ServoOutput output = session.receive(bytes, now_us);
    require(!output.sample || std::isfinite(output.sample->pitch_rad));
    require(!output.sample || output.sample->time_us <= now_us);
    session.aim(0.1 * static_cast<double>(size % 7), 1.0);
    require(session.poll(now_us).send.size() <= 64);
  }
  return 0;
}
