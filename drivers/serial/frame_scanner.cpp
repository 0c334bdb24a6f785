// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/frame_scanner.hpp"

namespace nodmap::serial {

void FrameScanner::reset(int baud) {
  constexpr double kBitsPerByte = 10.0;  // start, eight, stop
  byte_time_ = time::FineDuration(1s) * kBitsPerByte / baud;
  buffer_.clear();
  head_ = 0;
  start_ = 0;
  stale_end_ = 0;
  marks_.clear();
  in_step_ = true;
}

void FrameScanner::feed(ByteView bytes, time::SteadyTime now) {
  if (bytes.empty()) {
    return;
  }
  expire(now);
  drop_read();
  append(buffer_, bytes);
  marks_.push_back({end(), now});
}

void FrameScanner::expire(time::SteadyTime now) {
  if (!marks_.empty() && now - marks_.back().stamp > kExpiry) {
    stale_end_ = end();
  }
}

std::optional<Frame> FrameScanner::next() {
  while (!unread().empty()) {
    const FrameStart start = format_.start(unread(), in_step_);
    if (start.kind == FrameStart::Kind::kImplausible) {
      ++errors_.implausible;
    } else if (start.kind == FrameStart::Kind::kPlausible) {
      if (!may_reach(start.size)) {
        ++errors_.expired;
      } else if (unread().size() < start.size) {
        return std::nullopt;
      } else if (!format_.checksum_holds(unread().first(start.size))) {
        ++errors_.checksum;
      } else {
        return take_frame(start.size);
      }
    }
    skip_byte();
  }
  return std::nullopt;
}

// Whether a frame of this size at the front is complete or can still become complete. Bytes from
// before and after a long silence never belong to the same frame.
bool FrameScanner::may_reach(std::size_t size) const {
  return front() >= stale_end_ || front() + static_cast<std::int64_t>(size) <= stale_end_;
}

// When the first unread byte arrived: the time of the read minus the transmission time of the
// bytes after it. Never earlier than the true time.
time::SteadyTime FrameScanner::front_arrival() const {
  for (const Mark& mark : marks_) {
    if (front() < mark.end) {
      const auto bytes_after = static_cast<double>(mark.end - 1 - front());
      return mark.stamp - std::chrono::duration_cast<time::Duration>(bytes_after * byte_time_);
    }
  }
  return {};
}

Frame FrameScanner::take_frame(std::size_t size) {
  const Frame frame{front_arrival(), unread().first(size)};
  head_ += size;
  in_step_ = true;
  return frame;
}

void FrameScanner::skip_byte() {
  ++head_;
  ++errors_.skipped_bytes;
  in_step_ = false;
}

void FrameScanner::drop_read() {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(head_));
  start_ += static_cast<std::int64_t>(head_);
  head_ = 0;
  while (!marks_.empty() && marks_.front().end <= start_) {
    marks_.pop_front();
  }
}

}  // namespace nodmap::serial
