// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/message_assembler.hpp"

#include <algorithm>
#include <utility>

#include "common/bus/wire_layout.hpp"

namespace nodmap::bus {
namespace {

constexpr std::uint32_t kWholeMagic = 0x4C433032;     // "LC02"
constexpr std::uint32_t kFragmentMagic = 0x4C433033;  // "LC03"
constexpr std::size_t kWholeHeaderBytes = 8;
constexpr std::size_t kFragmentHeaderBytes = 20;
// No sender makes smaller fragments, except for the first and the last of a message.
constexpr std::size_t kMinFragmentBytes = 512;

// Removes the channel and its NUL from the front of `bytes`. Nothing if there is no NUL, or if the
// name is invalid: empty, longer than LCM allows, or containing anything but printable ASCII
// characters.
std::optional<std::string_view> take_channel(std::span<const std::byte>& bytes) {
  const auto head = bytes.first(std::min(bytes.size(), MessageAssembler::kMaxChannelLength + 1));
  const auto end = std::ranges::find(head, std::byte{0});
  const bool is_printable = std::all_of(
      head.begin(), end, [](std::byte b) { return b >= std::byte{' '} && b <= std::byte{'~'}; });
  if (end == head.begin() || end == head.end() || !is_printable) {
    return std::nullopt;
  }
  const auto length = static_cast<std::size_t>(end - head.begin());
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes are characters
  const std::string_view channel(reinterpret_cast<const char*>(bytes.data()), length);
  bytes = bytes.subspan(length + 1);
  return channel;
}

}  // namespace

std::optional<MessageAssembler::Message> MessageAssembler::take(
    const Sender& sender, std::span<const std::byte> datagram) {
  if (datagram.size() < kWholeHeaderBytes) {
    return refuse();
  }
  const auto magic = read_big_endian<std::uint32_t>(datagram, 0);
  if (magic == kWholeMagic) {
    return take_whole(datagram.subspan(kWholeHeaderBytes));
  }
  if (magic != kFragmentMagic || datagram.size() < kFragmentHeaderBytes) {
    return refuse();
  }
  return take_fragment(sender, {.seq = read_big_endian<std::uint32_t>(datagram, 4),
                                .message_bytes = read_big_endian<std::uint32_t>(datagram, 8),
                                .offset = read_big_endian<std::uint32_t>(datagram, 12),
                                .number = read_big_endian<std::uint16_t>(datagram, 16),
                                .count = read_big_endian<std::uint16_t>(datagram, 18),
                                .payload = datagram.subspan(kFragmentHeaderBytes)});
}

std::optional<MessageAssembler::Message> MessageAssembler::take_whole(
    std::span<const std::byte> after_header) {
  const std::optional<std::string_view> channel = take_channel(after_header);
  if (!channel) {
    return refuse();
  }
  if (!is_wanted_(*channel)) {
    return std::nullopt;
  }
  return Message{*channel, after_header};
}

std::optional<MessageAssembler::Message> MessageAssembler::take_fragment(const Sender& sender,
                                                                         Fragment fragment) {
  auto pending = pending_.find(sender);
  if (pending != pending_.end() && !pending->second.is_message_of(fragment)) {
    drop(pending);  // its other fragments were lost: a sender completes one message before the next
    pending = pending_.end();
  }
  if (pending == pending_.end() && fragment.number == 0) {
    pending = begin_message(sender, fragment);
  } else if (pending != pending_.end() && fragment.number == 0) {
    return std::nullopt;  // a duplicate
  }
  if (pending == pending_.end()) {
    return std::nullopt;
  }
  Pending& message = pending->second;
  const std::size_t size = fragment.payload.size();
  // Subtracts instead of adding, because the sum could overflow.
  if (fragment.number >= fragment.count || fragment.offset > message.size ||
      size > message.size - fragment.offset) {
    drop(pending);
    return refuse();
  }
  Range& range = message.fragments[fragment.number];
  if (range.has_come) {
    return std::nullopt;
  }
  range = {fragment.offset, static_cast<std::uint32_t>(size), true};
  std::ranges::copy(fragment.payload, &message.data[fragment.offset]);
  ++message.num_come;
  return message.num_come == message.fragments.size() ? finish(pending) : std::nullopt;
}

MessageAssembler::PendingOfSender MessageAssembler::begin_message(const Sender& sender,
                                                                  Fragment& fragment) {
  const std::optional<std::string_view> channel = take_channel(fragment.payload);
  if (!channel || fragment.count == 0 || fragment.message_bytes > kMaxMessageBytes ||
      fragment.count > fragment.message_bytes / kMinFragmentBytes + 2) {
    refuse();
    return pending_.end();
  }
  if (!is_wanted_(*channel)) {
    return pending_.end();
  }
  Pending message{.channel = std::string(*channel),
                  .seq = fragment.seq,
                  .data = nullptr,
                  .size = fragment.message_bytes,
                  .fragments = {},
                  .num_come = 0,
                  .order = num_begun_++};
  make_room(fragment.message_bytes + fragment.count * sizeof(Range));
  message.data = std::make_unique_for_overwrite<std::byte[]>(message.size);  // NOLINT
  message.fragments.resize(fragment.count);
  pending_bytes_ += message.bytes();
  return pending_.emplace(sender, std::move(message)).first;
}

std::optional<MessageAssembler::Message> MessageAssembler::finish(PendingOfSender pending) {
  complete_ = std::move(pending->second);
  pending_bytes_ -= complete_.bytes();
  pending_.erase(pending);
  if (!complete_.is_without_gap()) {
    return refuse();
  }
  return Message{complete_.channel, {complete_.data.get(), complete_.size}};
}

void MessageAssembler::drop(PendingOfSender pending) {
  pending_bytes_ -= pending->second.bytes();
  pending_.erase(pending);
}

void MessageAssembler::make_room(std::size_t bytes) {
  while (!pending_.empty() &&
         (pending_.size() >= kMaxPending || pending_bytes_ + bytes > kMaxPendingBytes)) {
    drop(std::ranges::min_element(pending_, {}, [](const auto& sender_and_message) {
      return sender_and_message.second.order;
    }));
  }
}

std::optional<MessageAssembler::Message> MessageAssembler::refuse() {
  ++malformed_;
  return std::nullopt;
}

bool MessageAssembler::Pending::is_message_of(const Fragment& fragment) const {
  return seq == fragment.seq && size == fragment.message_bytes &&
         fragments.size() == fragment.count;
}

bool MessageAssembler::Pending::is_without_gap() const {
  std::size_t end = 0;
  for (const Range& range : fragments) {
    if (range.offset != end) {
      return false;
    }
    end += range.size;
  }
  return end == size;
}

std::size_t MessageAssembler::Pending::bytes() const {
  return size + fragments.size() * sizeof(Range);
}

}  // namespace nodmap::bus
