// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/octomap_parts.hpp"

#include <utility>

namespace nodmap::slam6d {

void OctomapParts::begin(std::int64_t utime_us, std::string file) {
  file_ = std::move(file);
  utime_us_ = utime_us;
  ++revision_;
  index_ = 0;
  count_ = static_cast<std::int32_t>((file_.size() + kBytesPerPart - 1) / kBytesPerPart);
}

OctomapParts::Part OctomapParts::next() {
  const std::size_t first = static_cast<std::size_t>(index_) * kBytesPerPart;
  return {.utime_us = utime_us_,
          .revision = revision_,
          .index = index_++,
          .count = count_,
          .bytes = std::string_view(file_).substr(first, kBytesPerPart)};
}

}  // namespace nodmap::slam6d
