// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/octomap_parts.hpp"

#include <gtest/gtest.h>

namespace nodmap::slam6d {
namespace octomap_parts_test {

constexpr std::size_t kPart = OctomapParts::kBytesPerPart;

TEST(OctomapParts, AllPartsTogetherAreTheFile) {
  for (const std::size_t size : {std::size_t{1}, kPart - 1, kPart, kPart + 1, 3 * kPart}) {
    std::string file(size, '\0');
    for (std::size_t i = 0; i < size; ++i) {
      file[i] = static_cast<char>(i % 251);
    }
    OctomapParts parts;
    parts.begin(time::from_utime(7), file);
    std::string joined;
    for (std::int32_t index = 0; !parts.is_empty(); ++index) {
      const OctomapParts::Part part = parts.next();
      EXPECT_EQ(part.index, index);
      EXPECT_EQ(part.count, static_cast<std::int32_t>((size + kPart - 1) / kPart));
      EXPECT_EQ(part.stamp, time::from_utime(7));
      EXPECT_EQ(part.revision, 0);
      EXPECT_LE(part.bytes.size(), kPart);
      joined += part.bytes;
    }
    EXPECT_TRUE(joined == file) << size;
  }
}

TEST(OctomapParts, ANewFileStartsANewRevision) {
  OctomapParts parts;
  EXPECT_TRUE(parts.is_empty());
  parts.begin(time::from_utime(1), std::string(2 * kPart, 'a'));
  (void)parts.next();
  parts.begin(time::from_utime(2), "b");  // before all parts of the first one were taken
  EXPECT_EQ(parts.next().revision, 1);
  EXPECT_TRUE(parts.is_empty());
  parts.begin(time::from_utime(3), "");
  EXPECT_TRUE(parts.is_empty());
}

}  // namespace octomap_parts_test
}  // namespace nodmap::slam6d
