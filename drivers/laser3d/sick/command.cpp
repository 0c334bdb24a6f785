// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/command.hpp"

#include <array>
#include <string_view>

namespace nodmap::laser3d {
namespace {

// Byte positions in the configuration.
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

namespace sick_command {
namespace {

constexpr std::uint8_t kSetMode = 0x20;

Bytes frame_one(std::uint8_t command) {
  return frame(std::array{command});
}

Bytes frame_two(std::uint8_t command, std::uint8_t parameter) {
  return frame(std::array{command, parameter});
}

}  // namespace

Bytes frame(ByteView command_and_parameters) {
  constexpr std::uint8_t kStx = 0x02;
  constexpr std::uint8_t kBroadcast = 0x00;
  Bytes bytes = {kStx, kBroadcast};
  serial::append_little(bytes, static_cast<std::uint16_t>(command_and_parameters.size()));
  serial::append(bytes, command_and_parameters);
  serial::append_little(bytes, sick_crc(bytes));
  return bytes;
}

Bytes set_mode(SickMode mode) {
  constexpr std::string_view kPassword = "SICK_LMS";
  Bytes command = {kSetMode, static_cast<std::uint8_t>(mode)};
  if (mode == SickMode::kInstallation) {
    command.insert(command.end(), kPassword.begin(), kPassword.end());
  }
  return frame(command);
}

Bytes set_baud(int baud) {
  switch (baud) {
    case 500000:
      return frame_two(kSetMode, 0x48);
    case 38400:
      return frame_two(kSetMode, 0x40);
    case 19200:
      return frame_two(kSetMode, 0x41);
    default:
      return frame_two(kSetMode, 0x42);
  }
}

Bytes set_variant(SickVariant variant) {
  const SickGeometry geometry = geometry_of(variant);
  Bytes command = {0x3B};
  serial::append_little(command, static_cast<std::uint16_t>(geometry.field_deg));
  serial::append_little(command, static_cast<std::uint16_t>(geometry.resolution_cdeg));
  return frame(command);
}

Bytes request_config() {
  return frame_one(0x74);
}

Bytes write_config(const SickConfig& config) {
  Bytes command = {0x77};
  serial::append(command, config.bytes);
  return frame(command);
}

}  // namespace sick_command
}  // namespace nodmap::laser3d
