// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nodmap::bus {

/// LCM's UDP datagrams as messages: a datagram holds a whole message (magic LC02) or a fragment of
/// one (LC03).
///
///     LC02: magic, sequence number                            then the channel with its NUL, the
///     data LC03: magic, sequence number, size of the message's data, offset of this fragment's
///     data in it
///           (32 bits each), number of this fragment, number of fragments (16 bits each); the first
///           fragment has the channel with its NUL before its data
///
/// All big-endian. Nothing that a datagram says of itself is believed: a channel ends within it, a
/// fragment lies within its message, and a message is handed out when each of its fragments has
/// come once and they follow each other without gap and overlap. What waits for its other fragments
/// is bounded in number and in bytes; beyond that the oldest is dropped.
///
/// No fragment is taken before the first of its message, which alone names the channel.
class MessageAssembler {
 public:
  struct Sender {
    std::uint32_t address = 0;
    std::uint16_t port = 0;

    auto operator<=>(const Sender&) const = default;
  };

  /// Both parts are valid until the next call of take().
  struct Message {
    std::string_view channel;
    std::span<const std::byte> data;
  };

  static constexpr std::size_t kMaxChannelLength = 63;  // LCM's own limit
  static constexpr std::size_t kMaxMessageBytes = std::size_t{16} << 20U;
  static constexpr std::size_t kMaxPendingBytes = std::size_t{32} << 20U;
  static constexpr std::size_t kMaxPending = 64;

  /// Messages of channels that are not wanted are dropped at once.
  explicit MessageAssembler(std::function<bool(std::string_view)> is_wanted)
      : is_wanted_(std::move(is_wanted)) {}

  /// A datagram has come. The message that it completes, if any.
  [[nodiscard]] std::optional<Message> take(const Sender& sender,
                                            std::span<const std::byte> datagram);

  /// Datagrams that were nothing of LCM's, or fragments that cannot belong to their message.
  [[nodiscard]] std::int64_t malformed() const { return malformed_; }

  /// What the messages that wait for fragments hold.
  [[nodiscard]] std::size_t pending_bytes() const { return pending_bytes_; }

 private:
  struct Fragment {
    std::uint32_t seq = 0;
    std::uint32_t message_bytes = 0;
    std::uint32_t offset = 0;
    std::uint16_t number = 0;
    std::uint16_t count = 0;
    std::span<const std::byte> payload;
  };
  struct Range {
    std::uint32_t offset = 0;
    std::uint32_t size = 0;
    bool has_come = false;
  };
  /// A message of which fragments are missing.
  struct Pending {
    std::string channel;
    std::uint32_t seq = 0;
    std::unique_ptr<std::byte[]>
        data;  // NOLINT(modernize-avoid-c-arrays): memory only when written
    std::size_t size = 0;
    std::vector<Range> fragments;
    std::size_t num_come = 0;
    std::int64_t order = 0;  ///< of its first fragment, among all

    [[nodiscard]] bool is_message_of(const Fragment& fragment) const;
    [[nodiscard]] bool is_without_gap() const;
    [[nodiscard]] std::size_t bytes() const;
  };
  using PendingOfSender = std::map<Sender, Pending>::iterator;

  std::optional<Message> take_whole(std::span<const std::byte> after_header);
  std::optional<Message> take_fragment(const Sender& sender, Fragment fragment);
  /// The first fragment of a message: a place for it, when it is wanted and can be one.
  PendingOfSender begin_message(const Sender& sender, Fragment& fragment);
  std::optional<Message> finish(PendingOfSender pending);
  void drop(PendingOfSender pending);
  void make_room(std::size_t bytes);
  std::optional<Message> refuse();

  std::function<bool(std::string_view)> is_wanted_;
  std::map<Sender, Pending> pending_;
  std::size_t pending_bytes_ = 0;
  std::int64_t num_begun_ = 0;
  std::int64_t malformed_ = 0;
  Pending complete_;  // what the last call handed out
};

}  // namespace nodmap::bus
