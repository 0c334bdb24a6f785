// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/codec.hpp"

namespace nodmap::test {

/// A bus in memory for one node: delivered messages reach the node's handlers immediately, and
/// published messages are kept.
class MemoryBus final : public bus::Bus {
 public:
  /// Throws std::out_of_range if the channel has no subscriber.
  template <class Message>
  void deliver(const std::string& channel, const Message& message) {
    std::vector<std::byte> bytes;
    bus::encode_into(bytes, message);
    deliver_bytes(channel, bytes);
  }
  /// The same for a message of another process.
  template <class Message>
  void deliver_from(const bus::Sender& sender, const std::string& channel, const Message& message) {
    const bus::Origin own = origin();
    set_origin({sender, own.received, own.arrived});
    deliver(channel, message);
    set_origin(own);
  }
  /// Where all further messages come from.
  using Bus::set_origin;
  void deliver_bytes(const std::string& channel, std::span<const std::byte> bytes) {
    handlers_.at(channel)(bytes);
  }

  /// The number of messages published on this channel.
  [[nodiscard]] std::size_t count(const std::string& channel) const {
    const auto sent = sent_.find(channel);
    return sent == sent_.end() ? 0 : sent->second.size();
  }
  /// The messages published on this channel, oldest first.
  template <class Message>
  [[nodiscard]] std::vector<Message> sent(const std::string& channel) const {
    std::vector<Message> messages;
    for (std::size_t i = 0; i < count(channel); ++i) {
      EXPECT_TRUE(bus::decode_into(messages.emplace_back(), sent_.at(channel)[i]));
    }
    return messages;
  }
  /// The newest of them; throws std::out_of_range if there is none.
  template <class Message>
  [[nodiscard]] Message last(const std::string& channel) const {
    Message message{};
    EXPECT_TRUE(bus::decode_into(message, sent_.at(channel).back()));
    return message;
  }

 private:
  bool send(const std::string& channel, std::span<const std::byte> bytes) override {
    sent_[channel].emplace_back(bytes.begin(), bytes.end());
    return true;
  }
  void listen(const std::string& channel, BytesHandler handler, int /*queue_capacity*/) override {
    handlers_[channel] = std::move(handler);
  }

  std::map<std::string, BytesHandler> handlers_;
  std::map<std::string, std::vector<std::vector<std::byte>>> sent_;
};

}  // namespace nodmap::test
