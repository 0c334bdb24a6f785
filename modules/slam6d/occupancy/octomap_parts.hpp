// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/geometry/time.hpp"

namespace nodmap::slam6d {

/// Divides a map file into parts that are sent one by one. All at once they would overflow a
/// receiver's socket buffer (some 200 kB by default), and a map with one part missing is useless.
class OctomapParts {
 public:
  /// With its header a part stays below 64 KiB.
  static constexpr std::size_t kBytesPerPart = 60'000;

  struct Part {
    time::Timestamp stamp{};
    std::int64_t revision = 0;
    std::int32_t index = 0;
    std::int32_t count = 0;
    std::string_view bytes;  ///< of the file; valid until the next begin()
  };

  /// Begins with a map file that contains what was measured up to `stamp`. The rest of the last
  /// file is dropped.
  void begin(time::Timestamp stamp, std::string file);
  [[nodiscard]] bool is_empty() const { return index_ == count_; }
  /// The next part. Must not be called when is_empty().
  [[nodiscard]] Part next();

 private:
  std::string file_;
  time::Timestamp stamp_{};
  std::int64_t revision_ = -1;
  std::int32_t index_ = 0;
  std::int32_t count_ = 0;
};

}  // namespace nodmap::slam6d
