// SPDX-License-Identifier: BSD-3-Clause
// The traffic of a running robot, which every receive buffer must hold: with multicast, every
// socket receives every channel, subscribed or not.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace nodmap::doctor {

struct ChannelLoad {
  std::string_view channel;
  std::int64_t rate_hz = 0;     ///< 0: sent in bursts
  std::int64_t size_bytes = 0;  ///< size of a message, or of all chunks of one burst together
};

inline constexpr std::array<ChannelLoad, 8> kChannelLoads{{
    {"SCAN", 75, 3'100},  // 361 ranges and intensities; 1.6 kB with 181
    {"ODOMETRY", 100, 400},
    {"PITCH_STATE", 200, 100},
    {"OBSTACLE_MAP", 75, 7'500},
    {"STRUCTURE_MAP", 75, 7'500},
    {"POSE_2D", 75, 500},
    {"CLOUD", 0, 580'000},     // one sweep: 100 scans of 361 points, 16 bytes each
    {"MAP_2D", 0, 1'000'000},  // 50 m x 50 m in cells of 5 cm
}};

/// Bytes per second of the channels with a steady rate.
[[nodiscard]] constexpr std::int64_t steady_bytes_per_s() {
  std::int64_t sum = 0;
  for (const ChannelLoad& load : kChannelLoads) {
    sum += load.rate_hz * load.size_bytes;
  }
  return sum;
}

/// Bytes that may arrive at once.
[[nodiscard]] constexpr std::int64_t burst_bytes() {
  std::int64_t sum = 0;
  for (const ChannelLoad& load : kChannelLoads) {
    sum += load.rate_hz == 0 ? load.size_bytes : 0;
  }
  return sum;
}

/// How long a receiving thread may have to wait on a busy host.
inline constexpr std::int64_t kStallMs = 100;

/// Buffer size that a socket needs for the channels with a steady rate.
[[nodiscard]] constexpr std::int64_t steady_buffer_bytes() {
  return steady_bytes_per_s() * kStallMs / 1000;
}
/// Buffer size that it needs if all bursts arrive within one such wait.
[[nodiscard]] constexpr std::int64_t full_buffer_bytes() {
  return steady_buffer_bytes() + burst_bytes();
}

}  // namespace nodmap::doctor
