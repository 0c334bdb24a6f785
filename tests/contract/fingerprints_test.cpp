// SPDX-License-Identifier: BSD-3-Clause
// A type that has left the house is never edited: a changed field makes every old log unreadable.
// Whoever changes one adds a new type instead and a line here.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "common/bus/codec.hpp"

namespace nodmap {
namespace {

std::map<std::string, std::int64_t> fingerprints() {
  return {{cloud_chunk_t::getTypeName(), cloud_chunk_t::getHash()},
          {egomap_t::getTypeName(), egomap_t::getHash()},
          {grid_chunk_t::getTypeName(), grid_chunk_t::getHash()},
          {odometry_t::getTypeName(), odometry_t::getHash()},
          {pose_t::getTypeName(), pose_t::getHash()},
          {save_request_t::getTypeName(), save_request_t::getHash()},
          {scan_t::getTypeName(), scan_t::getHash()},
          {status_t::getTypeName(), status_t::getHash()}};
}

TEST(Fingerprints, AreThoseThatWereReleased) {
  const std::map<std::string, std::int64_t> released{
#include "tests/contract/released_fingerprints.inc"
  };
  EXPECT_EQ(fingerprints(), released);
}

// lcm-spy tells types by their fingerprints alone.
TEST(Fingerprints, AreDistinct) {
  std::set<std::int64_t> distinct;
  for (const auto& [name, fingerprint] : fingerprints()) {
    EXPECT_TRUE(distinct.insert(fingerprint).second) << name;
  }
}

}  // namespace
}  // namespace nodmap
