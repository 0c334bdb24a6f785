// SPDX-License-Identifier: BSD-3-Clause
// SLCAN: CAN frames as lines of text, the protocol of the Lawicel CANUSB and its clones on a serial
// line. A command ends with CR; the adapter answers CR (done) or BEL (refused).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace nodmap::kurt {

struct CanFrame {
  std::uint32_t id = 0;
  bool extended = false;  ///< 29-bit id instead of 11-bit
  bool remote = false;    ///< a request for data: has a length, but no data
  std::uint8_t length = 0;
  std::array<std::uint8_t, 8> data{};
  std::optional<std::uint16_t> stamp_ms;  ///< the adapter's clock, 0 to 59999, if it sends it

  [[nodiscard]] bool operator==(const CanFrame&) const = default;
};

/// The command line that sends this frame, with its CR.
[[nodiscard]] std::string to_line(const CanFrame& frame);

/// Parses the frame in a line (without its end); empty if it is not a complete, valid frame.
[[nodiscard]] std::optional<CanFrame> parse_frame(std::string_view line);

/// One line from the adapter.
struct SlcanLine {
  enum class Kind : std::uint8_t {
    kFrame,    ///< a frame from the bus
    kDone,     ///< a command was executed
    kRefused,  ///< a command was refused
    kFlags,    ///< the answer to `F`
    kVersion,  ///< the answer to `V`
  };
  Kind kind = Kind::kDone;
  CanFrame frame;          ///< of kFrame
  std::uint8_t flags = 0;  ///< of kFlags, see SlcanFlag
};

/// Bits of the adapter's error flags.
enum SlcanFlag : std::uint8_t {
  kReceiveQueueFull = 1U << 0U,
  kTransmitQueueFull = 1U << 1U,
  kErrorWarning = 1U << 2U,
  kOverrun = 1U << 3U,
  kErrorPassive = 1U << 5U,
  kArbitrationLost = 1U << 6U,
  kBusError = 1U << 7U,
};

struct SlcanCounts {
  std::int64_t frames = 0;
  std::int64_t done = 0;
  std::int64_t refused = 0;
  std::int64_t malformed = 0;  ///< like a frame, but too short, dlc > 8, or not hexadecimal
  std::int64_t too_long = 0;   ///< longer than any line can be: a line end was lost
  std::int64_t unknown = 0;  ///< other letters: states, errors and serial numbers of some adapters
};

/// Splits received bytes into lines. Accepts any bytes in pieces of any size; invalid ones are
/// counted and dropped up to the next line end.
class SlcanParser {
 public:
  /// Calls `sink(const SlcanLine&)` for each line that these bytes complete.
  template <class Sink>
  void push(std::span<const std::uint8_t> bytes, Sink&& sink) {
    for (const std::uint8_t byte : bytes) {
      if (const std::optional<SlcanLine> line = take(byte)) {
        sink(*line);
      }
    }
  }

  /// Adds a byte; returns the line or acknowledgement that it completes, if that is a valid one.
  std::optional<SlcanLine> take(std::uint8_t byte);

  /// Drops an incomplete line, because a new connection starts.
  void restart();

  [[nodiscard]] const SlcanCounts& counts() const { return counts_; }

 private:
  // T, 8 digits of id, length, 16 of data, 4 of stamp.
  static constexpr std::size_t kLongestLine = 30;

  [[nodiscard]] std::optional<SlcanLine> take_end(std::uint8_t end);
  [[nodiscard]] std::optional<SlcanLine> classify(std::string_view text, std::uint8_t end);

  std::array<char, kLongestLine> line_{};
  std::size_t size_ = 0;
  bool overflow_ = false;
  bool is_acknowledged_ = false;  // by z or Z, which a CR may follow
  SlcanCounts counts_;
};

}  // namespace nodmap::kurt
