// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/frame_buffer.hpp"

namespace nodmap::laser3d {

void FrameBuffer::reset(int baud) {
  constexpr double kBitsPerByte = 10.0;  // start, eight, stop
  *this = FrameBuffer();
  byte_us_ = 1e6 * kBitsPerByte / baud;
}

void FrameBuffer::feed(ByteView bytes, std::int64_t now_us) {
  if (bytes.empty()) {
    return;
  }
  expire(now_us);
  drop_read();
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  marks_.push_back({end(), now_us});
}

void FrameBuffer::expire(std::int64_t now_us) {
  if (!marks_.empty() && now_us - marks_.back().time_us > kExpiryUs) {
    stale_end_ = end();
  }
}

bool FrameBuffer::may_reach(std::size_t size) const {
  return front() >= stale_end_ || front() + static_cast<std::int64_t>(size) <= stale_end_;
}

std::int64_t FrameBuffer::front_arrival_us() const {
  for (const Mark& mark : marks_) {
    if (front() < mark.end) {
      const auto bytes_after = static_cast<double>(mark.end - 1 - front());
      return mark.time_us - static_cast<std::int64_t>(bytes_after * byte_us_);
    }
  }
  return 0;
}

void FrameBuffer::drop_read() {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(head_));
  start_ += static_cast<std::int64_t>(head_);
  head_ = 0;
  while (!marks_.empty() && marks_.front().end <= start_) {
    marks_.pop_front();
  }
}

}  // namespace nodmap::laser3d
