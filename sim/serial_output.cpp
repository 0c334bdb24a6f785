// SPDX-License-Identifier: BSD-3-Clause
#include "sim/serial_output.hpp"

#include <algorithm>
#include <utility>

#include "sim/uart.hpp"

namespace nodmap::sim {
namespace {

constexpr std::int64_t kPortionUs = 1000;

}  // namespace

std::int64_t SerialOutput::Telegram::left_us(std::size_t count) const {
  constexpr std::int64_t kBitsPerByteUs = 10'000'000;
  const auto bits = kBitsPerByteUs * static_cast<std::int64_t>(count);
  return start_us + (bits + baud - 1) / baud;
}

void SerialOutput::send(Bytes bytes, int baud, std::int64_t from_us) {
  if (bytes.empty()) {
    return;
  }
  const std::int64_t start_us = queue_.empty() ? from_us : std::max(from_us, free_us());
  queue_.push_back({std::move(bytes), baud, start_us, 0});
}

void SerialOutput::take(std::int64_t now_us, int host_baud, Bytes& line) {
  while (!queue_.empty()) {
    Telegram& telegram = queue_.front();
    std::size_t left = telegram.taken;
    while (left < telegram.bytes.size() && telegram.left_us(left + 1) <= now_us) {
      ++left;
    }
    const ByteView gone = ByteView(telegram.bytes).subspan(telegram.taken, left - telegram.taken);
    append(line, heard_at(host_baud, gone, telegram.baud));
    telegram.taken = left;
    if (left < telegram.bytes.size()) {
      return;
    }
    queue_.pop_front();
  }
}

std::int64_t SerialOutput::next_us() const {
  if (queue_.empty()) {
    return kNever;
  }
  const Telegram& telegram = queue_.front();
  return std::min(telegram.left_us(telegram.taken + 1) + kPortionUs,
                  telegram.left_us(telegram.bytes.size()));
}

std::int64_t SerialOutput::free_us() const {
  return queue_.empty() ? std::numeric_limits<std::int64_t>::min()
                        : queue_.back().left_us(queue_.back().bytes.size());
}

}  // namespace nodmap::sim
