// SPDX-License-Identifier: BSD-3-Clause
// A message type that has been released is never edited: a changed field makes every old log
// unreadable. To change one, add a new type, and a line here.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "common/bus/codec.hpp"

namespace nodmap {
namespace fingerprints_test {

std::map<std::string, std::int64_t> fingerprints() {
  std::map<std::string, std::int64_t> all;
  for (const bus::MessageType& type : bus::message_types()) {
    all.emplace(type.name, type.fingerprint);
  }
  return all;
}

TEST(Fingerprints, ReleasedTypesHaveTheirReleasedFingerprints) {
  const std::map<std::string, std::int64_t> released{
#include "tests/contract/released_fingerprints.inc"
  };
  EXPECT_EQ(fingerprints(), released);
}

// lcm-spy distinguishes types by their fingerprints alone.
TEST(Fingerprints, NoTwoTypesHaveTheSameFingerprint) {
  std::set<std::int64_t> distinct;
  for (const auto& [name, fingerprint] : fingerprints()) {
    EXPECT_TRUE(distinct.insert(fingerprint).second) << name;
  }
}

}  // namespace fingerprints_test
}  // namespace nodmap
