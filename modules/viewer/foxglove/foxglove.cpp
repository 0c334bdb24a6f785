// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/foxglove.hpp"

#include <algorithm>
#include <bit>

namespace nodmap::foxglove {

static_assert(std::endian::native == std::endian::little, "packed data are little-endian");

Json time_json(time::Timestamp stamp) {
  const std::int64_t us = std::max<std::int64_t>(time::to_utime(stamp), 0);
  return {{"sec", us / 1'000'000}, {"nsec", us % 1'000'000 * 1000}};
}

Json vector_json(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

Json quaternion_json(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

Json pose_json(const geometry::SE3& T_frame_thing) {
  return {{"position", vector_json(T_frame_thing.translation())},
          {"orientation", quaternion_json(Eigen::Quaterniond(T_frame_thing.linear()))}};
}

Json color_json(const Color& color) {
  return {{"r", color.r}, {"g", color.g}, {"b", color.b}, {"a", color.a}};
}

Json packed_fields_json(std::initializer_list<PackedField> fields) {
  Json list = Json::array();
  for (const PackedField& field : fields) {
    list.push_back({{"name", field.name},
                    {"offset", field.offset_bytes},
                    {"type", static_cast<int>(field.type)}});
  }
  return list;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = (bits << 8U) | (k < count ? static_cast<std::uint32_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(k <= count ? kDigits[(bits >> (18U - 6U * k)) & 63U] : '=');
    }
  }
  return text;
}

std::string packed_floats(std::span<const float> values) {
  return base64(std::as_bytes(values));
}

std::string to_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace nodmap::foxglove
