// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/loss_watch.hpp"

#include <optional>

#include "common/bus/codec.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::logger {
namespace {

// Limits the memory used by meaningless channels with messages that happen to be valid.
constexpr std::size_t kMaxChannels = 100;

std::optional<std::int64_t> sequence_number(std::span<const std::byte> data) {
  const std::int64_t fingerprint = bus::fingerprint_of(data);
  if (fingerprint == nodmap::scan_t::getHash()) {
    nodmap::scan_t scan{};
    return bus::decode_into(scan, data) ? std::optional(scan.scan_seq) : std::nullopt;
  }
  if (fingerprint == nodmap::odometry_t::getHash()) {
    nodmap::odometry_t odometry{};
    return bus::decode_into(odometry, data) ? std::optional(odometry.odometry_seq) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::int64_t LossWatch::lost_before(const std::string& channel, std::span<const std::byte> data) {
  const std::optional<std::int64_t> seq = sequence_number(data);
  if (!seq || (watches_.size() >= kMaxChannels && !watches_.contains(channel))) {
    return 0;
  }
  return watches_[channel].lost_before(*seq);
}

}  // namespace nodmap::logger
