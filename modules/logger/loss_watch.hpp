// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "common/node/message_counts.hpp"

namespace nodmap::logger {

/// Notices messages that never arrived, by the sequence numbers of scans and odometry: they come
/// most often, so that a loss on the way shows in them first. Other messages are not looked into.
class LossWatch {
 public:
  /// How many messages of this channel were lost just before this one.
  [[nodiscard]] std::int64_t lost_before(const std::string& channel,
                                         std::span<const std::byte> data);

 private:
  std::map<std::string, node::SequenceCounter> watches_;
};

}  // namespace nodmap::logger
