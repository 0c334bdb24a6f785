// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick_config.hpp"

namespace nodmap::laser3d {
namespace {

constexpr std::size_t kAvailability = 4;
constexpr std::size_t kMeasuringMode = 5;
constexpr std::size_t kUnit = 6;
constexpr std::size_t kConfigBytes = 34;
constexpr std::size_t kOldConfigBytes = 32;

}  // namespace

std::optional<SickConfig> read_config(const SickTelegram& telegram) {
  ByteView data = telegram.data;
  if (telegram.reply == SickReply::kConfigWritten && !data.empty() && data.front() == 1) {
    data = data.subspan(1);
  } else if (telegram.reply != SickReply::kConfig) {
    return std::nullopt;
  }
  if (data.size() != kConfigBytes && data.size() != kOldConfigBytes) {
    return std::nullopt;
  }
  return SickConfig{Bytes(data.begin(), data.end())};
}

SickConfig with_measuring(SickConfig config, SickUnit unit, SickMeasuringMode mode) {
  constexpr std::uint8_t kSendIndices = 0x02;
  config.bytes[kAvailability] |= kSendIndices;
  config.bytes[kMeasuringMode] = mode.value;
  config.bytes[kUnit] = static_cast<std::uint8_t>(unit);
  return config;
}

}  // namespace nodmap::laser3d
