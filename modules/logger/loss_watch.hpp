// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "common/node/message_counts.hpp"

namespace nodmap::logger {

/// Detects lost messages by gaps in the sequence numbers of scans and odometry. These are the most
/// frequent messages, so losses show in them first. Other messages are not decoded.
class LossWatch {
 public:
  /// Number of messages of this channel that were lost immediately before this one.
  [[nodiscard]] std::int64_t lost_before(const std::string& channel,
                                         std::span<const std::byte> data);

 private:
  std::map<std::string, node::SequenceCounter> watches_;
};

}  // namespace nodmap::logger
