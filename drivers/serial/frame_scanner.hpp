// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/endian/conversion.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::serial {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

inline void append(Bytes& bytes, ByteView more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// Appends a number, least significant byte first.
template <class Integer>
void append_little(Bytes& bytes, Integer value) {
  bytes.resize(bytes.size() + sizeof value);
  boost::endian::endian_store<Integer, sizeof value, boost::endian::order::little>(
      bytes.data() + bytes.size() - sizeof value, value);
}

/// A frame format's classification of the bytes at the front.
struct FrameStart {
  enum class Kind : std::uint8_t {
    kNone,         ///< no frame begins with this byte
    kImplausible,  ///< like the start of a frame, but with an impossible length or structure
    kPlausible,
  };
  Kind kind = Kind::kNone;
  std::size_t size = 0;  ///< of the whole frame; of its header while that is incomplete
};

/// A device's frame format: a recognizable start, a length and a checksum.
struct FrameFormat {
  /// `in_step`: no byte was skipped since the last whole frame.
  FrameStart (*start)(ByteView bytes, bool in_step);
  /// `frame` has the size that start() gave for it.
  bool (*checksum_holds)(ByteView frame);
};

/// A complete frame with a correct checksum. Its bytes are valid until the scanner is fed again.
struct Frame {
  time::SteadyTime first_byte;  ///< when its first byte arrived
  ByteView bytes;
};

/// Finds frames in a stream of bytes that may be truncated, mixed with noise or damaged.
///
/// A frame with an impossible length, structure or checksum is a false start: the search continues
/// one byte after its first one, so that a complete frame inside it is never lost. Stores less than
/// one frame and the bytes of one feed().
class FrameScanner {
 public:
  /// Counts of what was dropped, by cause.
  struct Errors {
    std::int64_t checksum = 0;
    std::int64_t implausible = 0;    ///< false starts, recognised by length or structure
    std::int64_t expired = 0;        ///< frames that were never completed
    std::int64_t skipped_bytes = 0;  ///< bytes that belong to no frame
  };

  /// After this long without a byte a frame is given up. A pause within a frame is at most 14 ms
  /// (SICK).
  static constexpr time::Duration kExpiry = 250ms;

  FrameScanner(const FrameFormat& format, int baud) : format_(format) { reset(baud); }

  /// Forgets all bytes; from now on the line has the rate `baud`, bit/s.
  void reset(int baud);

  /// Adds bytes, the last of which was read at `now`.
  void feed(ByteView bytes, time::SteadyTime now);

  /// Gives up an incomplete frame when nothing has been received for kExpiry.
  void expire(time::SteadyTime now);

  /// The next complete frame in the bytes fed so far, if any.
  [[nodiscard]] std::optional<Frame> next();

  [[nodiscard]] const Errors& errors() const { return errors_; }

 private:
  struct Mark {
    std::int64_t end = 0;  // position in the stream after the last byte of one feed
    time::SteadyTime stamp;
  };

  [[nodiscard]] ByteView unread() const { return ByteView(buffer_).subspan(head_); }
  [[nodiscard]] std::int64_t front() const { return start_ + static_cast<std::int64_t>(head_); }
  [[nodiscard]] std::int64_t end() const {
    return start_ + static_cast<std::int64_t>(buffer_.size());
  }
  [[nodiscard]] bool may_reach(std::size_t size) const;
  [[nodiscard]] time::SteadyTime front_arrival() const;
  [[nodiscard]] Frame take_frame(std::size_t size);
  void skip_byte();
  void drop_read();

  FrameFormat format_;
  time::FineDuration byte_time_{};  // on the line
  Bytes buffer_;
  std::size_t head_ = 0;        // of the unread bytes in the buffer
  std::int64_t start_ = 0;      // position of buffer_[0] in the stream
  std::int64_t stale_end_ = 0;  // a frame begun before this position must end before it
  std::deque<Mark> marks_;
  bool in_step_ = true;
  Errors errors_;
};

}  // namespace nodmap::serial
