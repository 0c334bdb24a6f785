// SPDX-License-Identifier: BSD-3-Clause
// Building blocks of Foxglove's schemas as JSON, and the schemas themselves. Source:
// https://docs.foxglove.dev/docs/sdk/schemas
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::foxglove {

using Json = nlohmann::json;

/// Names of the frames. `map` is the map of 2D SLAM, `map_6d` that of 6D SLAM. Both have their
/// origin where the run started, and each is corrected separately.
namespace frames {
inline constexpr const char* kMap = "map";
inline constexpr const char* kMap6d = "map_6d";
inline constexpr const char* kOdom = "odom";
inline constexpr const char* kBase = "base";
inline constexpr const char* kWorld = "world";
}  // namespace frames

/// A stamp as {sec, nsec} since the epoch; times before the epoch become the epoch.
[[nodiscard]] Json time_json(time::Timestamp stamp);

[[nodiscard]] Json vector_json(const Eigen::Vector3d& v);
[[nodiscard]] Json quaternion_json(const Eigen::Quaterniond& q);
[[nodiscard]] Json pose_json(const geometry::SE3& T_frame_thing);

/// Components from 0 to 1.
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

/// Encodes bytes for JSON (RFC 4648, with padding).
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

/// Encodes 32-bit floats, little-endian, in base64.
[[nodiscard]] std::string packed_floats(std::span<const float> values);

/// A message as text. Invalid UTF-8 (strings may come from any sender) becomes U+FFFD.
[[nodiscard]] std::string to_text(const Json& json);

/// The text of the JSON Schema with this name: "foxglove.LaserScan", "nodmap.drive_t", ... Throws
/// std::out_of_range for an unknown name.
[[nodiscard]] const std::string& schema_text(const std::string& schema_name);

}  // namespace nodmap::foxglove
