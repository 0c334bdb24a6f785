// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/serial_device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::sim {
namespace {

constexpr time::Duration kPortion = 1ms;
constexpr std::int64_t kBitsPerByte = 10;  // start, eight, stop

// The signal on the line; times in bits of the sender.
class Line {
 public:
  explicit Line(ByteView bytes) : bytes_(bytes) {}

  [[nodiscard]] std::int64_t end() const {
    return kBitsPerByte * static_cast<std::int64_t>(bytes_.size());
  }

  [[nodiscard]] bool high(std::int64_t bit) const {
    if (bit < 0 || bit >= end()) {
      return true;  // idle
    }
    const std::uint8_t byte = bytes_[static_cast<std::size_t>(bit / kBitsPerByte)];
    const std::int64_t within = bit % kBitsPerByte;
    return within == kBitsPerByte - 1 || (within > 0 && (byte >> (within - 1) & 1) != 0);
  }

  // The first falling edge at or after `time`; end() when there is none.
  [[nodiscard]] std::int64_t falling_edge(double time) const {
    auto bit = static_cast<std::int64_t>(std::ceil(time));
    while (bit < end() && (high(bit) || !high(bit - 1))) {
      ++bit;
    }
    return bit;
  }

 private:
  ByteView bytes_;
};

}  // namespace

void append(Bytes& bytes, ByteView more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

void append_little_endian(Bytes& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xFFU));
  }
}

std::uint32_t little_endian(ByteView bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) {
    value = value << 8U | bytes[i - 1];
  }
  return value;
}

time::SteadyTime SerialOutput::Telegram::sent(std::size_t count) const {
  const time::Duration at_one_baud = kBitsPerByte * static_cast<std::int64_t>(count) * 1s;
  return start + (at_one_baud + time::Duration(baud - 1)) / baud;  // rounded up
}

void SerialOutput::send(Bytes bytes, int baud, time::SteadyTime from) {
  if (bytes.empty()) {
    return;
  }
  const time::SteadyTime start = queue_.empty() ? from : std::max(from, idle_from());
  queue_.push_back({std::move(bytes), baud, start, 0});
}

void SerialOutput::take(time::SteadyTime now, int host_baud, Bytes& line) {
  while (!queue_.empty()) {
    Telegram& telegram = queue_.front();
    std::size_t num_sent = telegram.num_taken;
    while (num_sent < telegram.bytes.size() && telegram.sent(num_sent + 1) <= now) {
      ++num_sent;
    }
    const ByteView sent =
        ByteView(telegram.bytes).subspan(telegram.num_taken, num_sent - telegram.num_taken);
    append(line, received_bytes(host_baud, sent, telegram.baud));
    telegram.num_taken = num_sent;
    if (num_sent < telegram.bytes.size()) {
      return;
    }
    queue_.pop_front();
  }
}

time::SteadyTime SerialOutput::next_due() const {
  if (queue_.empty()) {
    return kNever;
  }
  const Telegram& telegram = queue_.front();
  return std::min(telegram.sent(telegram.num_taken + 1) + kPortion,
                  telegram.sent(telegram.bytes.size()));
}

time::SteadyTime SerialOutput::idle_from() const {
  return queue_.empty() ? time::SteadyTime::min() : queue_.back().sent(queue_.back().bytes.size());
}

Bytes received_bytes(int receiver_baud, ByteView bytes, int sender_baud) {
  if (receiver_baud == sender_baud) {
    return {bytes.begin(), bytes.end()};
  }
  if (receiver_baud <= 0 || sender_baud <= 0) {
    return {};
  }
  const Line line(bytes);
  const double step = static_cast<double>(sender_baud) / receiver_baud;
  const auto sample = [&](std::int64_t edge, double bits) {
    return line.high(
        static_cast<std::int64_t>(std::floor(static_cast<double>(edge) + bits * step)));
  };
  Bytes received;
  double time = 0.0;
  for (std::int64_t edge = line.falling_edge(time); edge < line.end();
       edge = line.falling_edge(time)) {
    unsigned byte = 0;
    for (unsigned bit = 0; bit < 8; ++bit) {
      byte |= sample(edge, 1.5 + bit) ? 1U << bit : 0U;
    }
    received.push_back(sample(edge, 9.5) ? static_cast<std::uint8_t>(byte) : std::uint8_t{0});
    time = static_cast<double>(edge) + 9.5 * step;
  }
  return received;
}

}  // namespace nodmap::sim
