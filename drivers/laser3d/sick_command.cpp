// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick_command.hpp"

#include <array>
#include <string_view>

#include "drivers/laser3d/sick_crc.hpp"

namespace nodmap::laser3d {

SickGeometry geometry_of(SickVariant variant) {
  switch (variant) {
    case SickVariant::k180x050:
      return {180, 50, 2};
    case SickVariant::k100x100:
      return {100, 100, 1};
    case SickVariant::k100x050:
      return {100, 50, 2};
    case SickVariant::k100x025:
      return {100, 25, 4};
    case SickVariant::k180x100:
      break;
  }
  return {180, 100, 1};
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
  append_u16(bytes, static_cast<std::uint16_t>(command_and_parameters.size()));
  append(bytes, command_and_parameters);
  append_u16(bytes, sick_crc(bytes));
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

Bytes set_sub_range(int first_value, int last_value) {
  constexpr std::uint8_t kSubRange = 0x27;
  Bytes command = {kSetMode, kSubRange};
  append_u16(command, static_cast<std::uint16_t>(first_value));
  append_u16(command, static_cast<std::uint16_t>(last_value));
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

Bytes keep_baud(bool permanent) {
  return frame_two(0x66, permanent ? 1 : 0);
}

Bytes set_variant(SickVariant variant) {
  const SickGeometry geometry = geometry_of(variant);
  Bytes command = {0x3B};
  append_u16(command, static_cast<std::uint16_t>(geometry.field_deg));
  append_u16(command, static_cast<std::uint16_t>(geometry.resolution_cdeg));
  return frame(command);
}

Bytes request_scan() {
  return frame_two(0x30, 0x01);
}
Bytes request_partial_scan() {
  return frame_two(0x30, 0x08);
}
Bytes request_status() {
  return frame_one(0x31);
}
Bytes request_errors() {
  return frame_one(0x32);
}
Bytes request_type() {
  return frame_one(0x3A);
}
Bytes request_config() {
  return frame_one(0x74);
}
Bytes reset() {
  return frame_one(0x10);
}

Bytes write_config(const SickConfig& config) {
  Bytes command = {0x77};
  append(command, config.bytes);
  return frame(command);
}

}  // namespace sick_command
}  // namespace nodmap::laser3d
