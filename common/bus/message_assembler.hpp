// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

#include "common/bus/sender.hpp"

namespace nodmap::bus {

/// Assembles LCM's UDP datagrams into messages. A datagram contains a whole message or a fragment
/// of one, all numbers big-endian:
///
///     whole message:  magic "LC02", sequence number (32 bits each);
///                     channel with terminating NUL; data
///     fragment:       magic "LC03", sequence number, size of the message's data,
///                     offset of this fragment's data (32 bits each);
///                     number of this fragment, number of fragments (16 bits each);
///                     in the first fragment only: channel with terminating NUL;
///                     data of this fragment
///
/// Every value in a datagram is checked: the channel must end within the datagram and the fragment
/// within its message. A message is returned when each fragment has been received once, without
/// gaps or overlaps. Incomplete messages are limited in number and bytes; beyond that the oldest is
/// dropped.
///
/// Fragments received before the first one of their message are dropped, because only the first one
/// names the channel.
class MessageAssembler {
 public:
  /// Both parts are valid until the next call of take().
  struct Message {
    std::string_view channel;
    std::span<const std::byte> data;
  };

  static constexpr std::size_t kMaxChannelLength = 63;  // LCM's own limit
  static constexpr std::size_t kMaxMessageBytes = std::size_t{16} << 20U;
  static constexpr std::size_t kMaxPendingBytes = std::size_t{32} << 20U;
  static constexpr std::size_t kMaxPending = 64;

  /// Messages on channels for which `is_wanted` returns false are dropped at once.
  explicit MessageAssembler(std::function<bool(std::string_view)> is_wanted)
      : is_wanted_(std::move(is_wanted)) {}

  /// Adds a datagram; returns the message that it completes, if any.
  [[nodiscard]] std::optional<Message> take(const Sender& sender,
                                            std::span<const std::byte> datagram);

  /// Number of datagrams that are not LCM's, or that do not fit their message.
  [[nodiscard]] std::int64_t malformed() const { return malformed_; }

  /// Number of bytes held for incomplete messages.
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
    std::int64_t order = 0;  ///< position of its first fragment among those of all messages

    [[nodiscard]] bool is_message_of(const Fragment& fragment) const;
    [[nodiscard]] bool is_without_gap() const;
    [[nodiscard]] std::size_t bytes() const;
  };
  using PendingOfSender = std::map<Sender, Pending>::iterator;

  std::optional<Message> take_whole(std::span<const std::byte> after_header);
  std::optional<Message> take_fragment(const Sender& sender, Fragment fragment);
  /// Makes an entry for a message from its first fragment, if the message is wanted and valid.
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
  Pending complete_;  // the message that the last call returned
};

}  // namespace nodmap::bus
