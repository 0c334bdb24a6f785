// SPDX-License-Identifier: BSD-3-Clause
// What Foxglove's schemas are made of, as JSON, and the schemas themselves.
// Source: https://docs.foxglove.dev/docs/sdk/schemas
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::foxglove {

using Json = nlohmann::json;

/// Frames of what is sent. `map` is the map of 2D SLAM, `map_6d` that of 6D SLAM: both begin where
/// the run began, and are corrected each on its own.
namespace frames {
inline constexpr const char* kMap = "map";
inline constexpr const char* kMap6d = "map_6d";
inline constexpr const char* kOdom = "odom";
inline constexpr const char* kBase = "base";
inline constexpr const char* kWorld = "world";
}  // namespace frames

/// {sec, nsec} of microseconds since the epoch; times before it are taken as the epoch.
[[nodiscard]] Json time_json(time::Timestamp stamp);

[[nodiscard]] Json vector_json(const Eigen::Vector3d& v);
[[nodiscard]] Json quaternion_json(const Eigen::Quaterniond& q);
[[nodiscard]] Json pose_json(const geometry::SE3& T_frame_thing);

/// Each 0..1.
struct Color {
  double r = 0.0;
  double g = 0.0;
  double b = 0.0;
  double a = 1.0;
};
[[nodiscard]] Json color_json(const Color& color);

/// NumericType of Foxglove's PackedElementField.
enum class NumericType : std::uint8_t { kUint8 = 1, kInt8 = 2, kFloat32 = 7 };

struct PackedField {
  const char* name;
  std::uint32_t offset_bytes;
  NumericType type;
};
[[nodiscard]] Json packed_fields_json(std::initializer_list<PackedField> fields);

/// RFC 4648, with padding: how bytes are written in JSON.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

/// Little-endian 32 bit floats, base64.
[[nodiscard]] std::string packed_floats(std::span<const float> values);

/// A message as text. Bytes that are not UTF-8 (a string can come from anyone) become U+FFFD.
[[nodiscard]] std::string to_text(const Json& json);

/// The JSON Schema, as text, of a schema by its name: "foxglove.LaserScan", "nodmap.drive_t", ...
/// Throws std::out_of_range for an unknown name.
[[nodiscard]] const std::string& schema_text(const std::string& schema_name);

}  // namespace nodmap::foxglove
