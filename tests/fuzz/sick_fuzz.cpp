// SPDX-License-Identifier: BSD-3-Clause
// Any bytes, in any pieces and with any pauses, through the laser's parser and its decoders.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "drivers/laser3d/sick/session.hpp"

namespace {

using namespace nodmap;           // NOLINT(google-build-using-namespace): a program of one page
using namespace nodmap::laser3d;  // NOLINT(google-build-using-namespace)

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void check(const SickTelegram& telegram) {
  require(telegram.data.size() <= SickParser::kMaxTelegramBytes);
  for (const unsigned mode : {0x00U, 0x03U, 0x06U, 0x0FU, 0x3FU}) {
    if (const auto scan = read_scan(telegram, {static_cast<std::uint8_t>(mode)})) {
      require(scan->ranges_m.size() <= 401);
      for (const float range_m : scan->ranges_m) {
        require(!(range_m < 0.0F));
        require(!std::isfinite(range_m) || range_m <= 330.0F);
      }
      static_cast<void>(mirror_revolutions(*scan, SickVariant::k100x025, telegram.first_byte));
      static_cast<void>(interlaced_revolution(*scan, telegram.first_byte));
    }
  }
  if (const auto config = read_config(telegram)) {
    static_cast<void>(with_measuring(*config, SickUnit::kMillimetre, {0x06}));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  SickParser parser(500000);
  SickSession session({});
  time::SteadyTime now;
  static_cast<void>(session.open(now));
  std::size_t at = 0;
  while (at < size) {
    // One byte determines how many bytes come at once, and after how long.
    const std::size_t count = std::min<std::size_t>(size - at, 1U + (data[at] & 0x3FU) * 16U);
    now += (data[at] & 0x40U) != 0 ? 300ms : 1ms;
    parser.feed(ByteView(data + at, count), now);
    at += count;
    while (const auto event = parser.next()) {
      if (const auto* telegram = std::get_if<SickTelegram>(&*event)) {
        check(*telegram);
        const SickOutput output = session.take(*telegram, now);
        require(output.send.size() <= 64);
      } else if (std::holds_alternative<SickNak>(*event)) {
        session.take_nak(now);
      }
    }
    static_cast<void>(session.poll(now));
  }
  require(static_cast<std::size_t>(parser.errors().skipped_bytes) <= size);
  return 0;
}
