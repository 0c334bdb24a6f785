// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/geometry/time.hpp"

namespace nodmap::slam6d {

/// Cuts a map file into parts that are sent one by one: all at once they are more than a receiver's
/// socket holds (some 200 kB on a machine as it is installed), and without one of them it is no
/// map.
class OctomapParts {
 public:
  /// With its head a part stays below 64 KiB.
  static constexpr std::size_t kBytesPerPart = 60'000;

  struct Part {
    time::Timestamp stamp{};
    std::int64_t revision = 0;
    std::int32_t index = 0;
    std::int32_t count = 0;
    std::string_view bytes;  ///< of the file: valid until the next one begins
  };

  /// A map file with what was measured up to `stamp`. Gives up what is left of the last one.
  void begin(time::Timestamp stamp, std::string file);
  [[nodiscard]] bool is_empty() const { return index_ == count_; }
  /// There must be one.
  [[nodiscard]] Part next();

 private:
  std::string file_;
  time::Timestamp stamp_{};
  std::int64_t revision_ = -1;
  std::int32_t index_ = 0;
  std::int32_t count_ = 0;
};

}  // namespace nodmap::slam6d
