// SPDX-License-Identifier: BSD-3-Clause
// Feeds datagrams as bytes, without a network, including those that crash liblcm.
#include "common/bus/message_assembler.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::bus {
namespace message_assembler_test {

using Bytes = std::vector<std::byte>;

constexpr Sender kSender{0x7F000001, 40'000};

void append_number(Bytes& bytes, std::uint64_t value, int size) {
  for (int i = size - 1; i >= 0; --i) {
    bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 0xFFU));
  }
}

void append(Bytes& bytes, std::string_view text) {
  for (const char c : text) {
    bytes.push_back(static_cast<std::byte>(c));
  }
}

Bytes whole(std::string_view channel_and_data) {
  Bytes bytes;
  append_number(bytes, 0x4C433032, 4);
  append_number(bytes, 7, 4);
  append(bytes, channel_and_data);
  return bytes;
}

struct Header {
  std::uint64_t seq = 7;
  std::uint64_t message_bytes = 0;
  std::uint64_t offset = 0;
  std::uint64_t number = 0;
  std::uint64_t count = 0;
};

Bytes fragment(const Header& header, std::string_view payload) {
  Bytes bytes;
  append_number(bytes, 0x4C433033, 4);
  append_number(bytes, header.seq, 4);
  append_number(bytes, header.message_bytes, 4);
  append_number(bytes, header.offset, 4);
  append_number(bytes, header.number, 2);
  append_number(bytes, header.count, 2);
  append(bytes, payload);
  return bytes;
}

std::string text_of(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes) {
    text += static_cast<char>(b);
  }
  return text;
}

constexpr std::string_view kChannel{"SCAN\0", 5};

class Assembler : public ::testing::Test {
 protected:
  // "CHANNEL=data" of the message that is complete now; empty: none.
  std::string take(const Bytes& datagram, const Sender& sender = kSender) {
    const auto message = assembler_.take(sender, datagram);
    return message ? std::string(message->channel) + "=" + text_of(message->data) : "";
  }

  MessageAssembler assembler_{[](std::string_view channel) { return channel != "UNWANTED"; }};
};

TEST_F(Assembler, ADatagramIsAMessage) {
  EXPECT_EQ(take(whole(std::string_view("SCAN\0data", 9))), "SCAN=data");
  EXPECT_EQ(take(whole(kChannel)), "SCAN=");
  EXPECT_EQ(take(whole(std::string_view("UNWANTED\0data", 13))), "");
  EXPECT_EQ(assembler_.malformed(), 0);
}

TEST_F(Assembler, AChannelEndsWithinTheDatagram) {
  EXPECT_EQ(take(whole("SCAN")), "");  // liblcm: data of 2^32 - 1 bytes
  EXPECT_EQ(take(whole("")), "");
  EXPECT_EQ(take(whole(std::string(64, 'A') + '\0')), "");
  EXPECT_EQ(take(whole(std::string(100, 'A'))), "");
  EXPECT_EQ(take(whole(std::string_view("A\nB\0data", 8))), "");
  EXPECT_EQ(take(whole(std::string_view("\xFF\0data", 6))), "");
  EXPECT_EQ(assembler_.malformed(), 6);
  EXPECT_EQ(take(whole(std::string(63, 'A') + '\0')), std::string(63, 'A') + "=");
}

// A log with a message without a channel counts as damaged, also for lcm-logplayer.
TEST_F(Assembler, AChannelHasAName) {
  EXPECT_EQ(take(whole(std::string_view("\0data", 5))), "");
  EXPECT_EQ(take(fragment({.message_bytes = 4, .count = 1}, std::string_view("\0data", 5))), "");
  EXPECT_EQ(assembler_.malformed(), 2);
}

TEST_F(Assembler, ShortAndForeignDatagramsAreMalformed) {
  const Bytes message = fragment({.message_bytes = 4, .count = 1}, std::string(kChannel) + "data");
  for (std::size_t size = 0; size < message.size(); ++size) {
    EXPECT_EQ(take(Bytes(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(size))),
              "");
  }
  EXPECT_EQ(assembler_.malformed(), static_cast<std::int64_t>(message.size()));
  Bytes foreign = whole(kChannel);
  foreign[3] = std::byte{'4'};
  EXPECT_EQ(take(foreign), "");
}

TEST_F(Assembler, FragmentsBecomeTheirMessageInAnyOrderAfterTheFirst) {
  const std::string filler(1000, 'x');
  const auto part = [&](std::uint64_t number) {
    return fragment({.message_bytes = 3000, .offset = 1000 * number, .number = number, .count = 3},
                    (number == 0 ? std::string(kChannel) : "") + filler);
  };
  for (const auto& order : {std::array{1, 2}, std::array{2, 1}}) {
    EXPECT_EQ(take(part(0)), "");
    EXPECT_EQ(take(part(static_cast<std::uint64_t>(order[0]))), "");
    EXPECT_EQ(take(part(static_cast<std::uint64_t>(order[1]))), "SCAN=" + std::string(3000, 'x'));
  }
  EXPECT_EQ(assembler_.pending_bytes(), 0U);
}

// The two datagrams that crash liblcm 1.3.1 and 1.5.2: offset + size is 4 in 32 bits.
TEST_F(Assembler, OffsetAndSizeDoNotWrapAround) {
  EXPECT_EQ(take(fragment({.message_bytes = 1000, .count = 2}, kChannel)), "");
  EXPECT_EQ(take(fragment({.message_bytes = 1000, .offset = 0xFFFFFF00, .number = 1, .count = 2},
                          std::string(260, 'x'))),
            "");
  EXPECT_EQ(assembler_.malformed(), 1);
  EXPECT_EQ(assembler_.pending_bytes(), 0U);
}

TEST_F(Assembler, AFragmentLiesWithinItsMessage) {
  const std::string thousand(1000, 'x');
  const Header second{.message_bytes = 2000, .offset = 1000, .number = 1, .count = 2};
  for (Header header :
       {Header{second.seq, 2000, 1001, 1, 2}, Header{second.seq, 2000, 2001, 1, 2},
        Header{second.seq, 2000, 1000, 2, 2}, Header{second.seq, 2000, 0, 65535, 2}}) {
    EXPECT_EQ(take(fragment({.message_bytes = 2000, .count = 2}, std::string(kChannel) + thousand)),
              "");
    EXPECT_EQ(take(fragment(header, thousand)), "");
    EXPECT_EQ(take(fragment(second, thousand)), "");  // its message was dropped
  }
  EXPECT_EQ(assembler_.malformed(), 4);
  EXPECT_EQ(assembler_.pending_bytes(), 0U);
}

// Each fragment lies within the message and their lengths add up, but bytes 500 to 1000 were never
// received.
TEST_F(Assembler, AMessageWithAGapIsDropped) {
  EXPECT_EQ(take(fragment({.message_bytes = 1500, .count = 2},
                          std::string(kChannel) + std::string(1000, 'x'))),
            "");
  EXPECT_EQ(take(fragment({.message_bytes = 1500, .offset = 500, .number = 1, .count = 2},
                          std::string(500, 'y'))),
            "");
  EXPECT_EQ(assembler_.malformed(), 1);
}

TEST_F(Assembler, ADuplicateCountsOnce) {
  const std::string thousand(1000, 'x');
  const Bytes first =
      fragment({.message_bytes = 3000, .count = 3}, std::string(kChannel) + thousand);
  const Bytes second =
      fragment({.message_bytes = 3000, .offset = 1000, .number = 1, .count = 3}, thousand);
  const Bytes third =
      fragment({.message_bytes = 3000, .offset = 2000, .number = 2, .count = 3}, thousand);
  for (const Bytes& datagram : {first, first, second, second}) {
    EXPECT_EQ(take(datagram), "");
  }
  EXPECT_EQ(take(third), "SCAN=" + std::string(3000, 'x'));
}

TEST_F(Assembler, AnotherMessageOfTheSenderEndsAnIncompleteOne) {
  const std::string thousand(1000, 'x');
  const Header lost{.seq = 1, .message_bytes = 2000, .count = 2};
  EXPECT_EQ(take(fragment(lost, std::string(kChannel) + thousand)), "");
  EXPECT_EQ(
      take(fragment({.seq = 2, .message_bytes = 2000, .offset = 1000, .number = 1, .count = 2},
                    thousand)),
      "");
  EXPECT_EQ(
      take(fragment({.seq = 1, .message_bytes = 2000, .offset = 1000, .number = 1, .count = 2},
                    thousand)),
      "");
  EXPECT_EQ(assembler_.pending_bytes(), 0U);
}

TEST_F(Assembler, InvalidNumbersOfFragmentsAreMalformed) {
  EXPECT_EQ(take(fragment({.message_bytes = 1000, .count = 65535}, kChannel)), "");
  EXPECT_EQ(take(fragment({.message_bytes = 1000, .count = 0}, kChannel)), "");
  EXPECT_EQ(take(fragment({.message_bytes = 0xFFFFFFFF, .count = 65535}, kChannel)), "");
  EXPECT_EQ(assembler_.malformed(), 3);
  EXPECT_EQ(assembler_.pending_bytes(), 0U);
}

TEST_F(Assembler, IncompleteMessagesAreBoundedInNumberAndBytes) {
  for (std::uint16_t port = 0; port < 1000; ++port) {
    const std::size_t size = port % 2 == 0 ? MessageAssembler::kMaxMessageBytes : 3000;
    EXPECT_EQ(
        take(fragment({.message_bytes = size, .count = 3}, kChannel), {kSender.address, port}), "");
    EXPECT_LE(assembler_.pending_bytes(), MessageAssembler::kMaxPendingBytes);
  }
  for (std::uint16_t port = 0; port < 1000; ++port) {
    EXPECT_EQ(
        take(fragment({.message_bytes = 1000, .count = 3}, kChannel), {kSender.address, port}), "");
  }
  // Each holds its 1000 bytes and its list of three fragments.
  EXPECT_LE(assembler_.pending_bytes(), MessageAssembler::kMaxPending * 1100);
}

TEST_F(Assembler, SendersDoNotMix) {
  const std::string thousand(1000, 'x');
  const std::string others(1000, 'y');
  const Sender other{kSender.address, 40'001};
  const Header second{.message_bytes = 2000, .offset = 1000, .number = 1, .count = 2};
  EXPECT_EQ(take(fragment({.message_bytes = 2000, .count = 2}, std::string(kChannel) + thousand)),
            "");
  EXPECT_EQ(
      take(fragment({.message_bytes = 2000, .count = 2}, std::string(kChannel) + others), other),
      "");
  EXPECT_EQ(take(fragment(second, others), other), "SCAN=" + others + others);
  EXPECT_EQ(take(fragment(second, thousand)), "SCAN=" + thousand + thousand);
}

// Whatever is received, there is no crash (under sanitizers: no read of bytes that were not
// received) and no memory use beyond the limit.
TEST_F(Assembler, RandomlyDamagedFragmentsStayWithinTheMemoryLimit) {
  std::mt19937 random(5);
  const std::string thousand(1000, 'x');
  for (int i = 0; i < 100'000; ++i) {
    const std::uint64_t number = random() % 3;
    Bytes datagram =
        fragment({.message_bytes = 3000, .offset = 1000 * number, .number = number, .count = 3},
                 (number == 0 ? std::string(kChannel) : "") + thousand);
    for (auto flips = random() % 3; flips > 0; --flips) {
      datagram[random() % 30] = static_cast<std::byte>(random() & 0xFFU);
    }
    datagram.resize(random() % 4 == 0 ? random() % datagram.size() : datagram.size());
    const auto message =
        assembler_.take({kSender.address, static_cast<std::uint16_t>(random() % 4)}, datagram);
    if (message) {
      ASSERT_LE(message->data.size(), 66'000U);
    }
    ASSERT_LE(assembler_.pending_bytes(), MessageAssembler::kMaxPendingBytes);
  }
}

}  // namespace message_assembler_test
}  // namespace nodmap::bus
