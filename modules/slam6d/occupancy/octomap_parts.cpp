// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/octomap_parts.hpp"

#include <utility>

namespace nodmap::slam6d {

void OctomapParts::begin(time::Timestamp stamp, std::string file) {
  file_ = std::move(file);
  stamp_ = stamp;
  ++revision_;
  index_ = 0;
  count_ = static_cast<std::int32_t>((file_.size() + kBytesPerPart - 1) / kBytesPerPart);
}

OctomapParts::Part OctomapParts::next() {
  const std::size_t first = static_cast<std::size_t>(index_) * kBytesPerPart;
  return {.stamp = stamp_,
          .revision = revision_,
          .index = index_++,
          .count = count_,
          .bytes = std::string_view(file_).substr(first, kBytesPerPart)};
}

}  // namespace nodmap::slam6d
