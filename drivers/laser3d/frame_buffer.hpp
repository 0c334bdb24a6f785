// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>

#include "drivers/laser3d/bytes.hpp"

namespace nodmap::laser3d {

/// Bytes from a line that wait to become a frame, and when each of them arrived.
class FrameBuffer {
 public:
  /// A pause within a frame is at most 14 ms (SICK); after this long the rest will not come.
  static constexpr std::int64_t kExpiryUs = 250'000;

  /// Forgets everything; from now on the line has this rate.
  void reset(int baud);

  /// Takes bytes of which the last was read at `now_us`.
  void feed(ByteView bytes, std::int64_t now_us);

  /// When nothing has come for kExpiryUs, what is there can no longer be finished.
  void expire(std::int64_t now_us);

  [[nodiscard]] ByteView unread() const { return ByteView(buffer_).subspan(head_); }
  void skip(std::size_t count) { head_ += count; }

  /// Whether a frame of this size at the front may still become whole, or is: bytes from before a
  /// long silence never belong to one frame with bytes from after it.
  [[nodiscard]] bool may_reach(std::size_t size) const;

  /// When the first unread byte arrived: dated back from the end of its reading by the time the
  /// line needs for the bytes between, so it is never earlier than the truth.
  [[nodiscard]] std::int64_t front_arrival_us() const;

 private:
  struct Mark {
    std::int64_t end = 0;  // position behind the last byte of one feed
    std::int64_t time_us = 0;
  };

  [[nodiscard]] std::int64_t front() const { return start_ + static_cast<std::int64_t>(head_); }
  [[nodiscard]] std::int64_t end() const {
    return start_ + static_cast<std::int64_t>(buffer_.size());
  }
  void drop_read();

  double byte_us_ = 0.0;
  Bytes buffer_;
  std::size_t head_ = 0;        // of the unread bytes in the buffer
  std::int64_t start_ = 0;      // position of buffer_[0] in the stream
  std::int64_t stale_end_ = 0;  // a frame begun before this must end before it
  std::deque<Mark> marks_;
};

}  // namespace nodmap::laser3d
