// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/map_revision.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace nodmap::node {
namespace map_revision_test {

using Tile = MapRevision::Tile;

std::vector<Tile> classify_all(const std::vector<std::int64_t>& revisions) {
  MapRevision newest;
  std::vector<Tile> tiles;
  for (const std::int64_t revision : revisions) {
    tiles.push_back(newest.classify(revision));
  }
  return tiles;
}

TEST(MapRevision, TheFirstTileMayHaveAnyRevision) {
  for (const std::int64_t revision : {std::int64_t{-3}, std::int64_t{0}, std::int64_t{1} << 62}) {
    EXPECT_EQ(classify_all({revision}), std::vector{Tile::kOfKnownMap});
  }
}

TEST(MapRevision, RevisionsThatGrowOrStayBelongToTheKnownMap) {
  EXPECT_EQ(classify_all({1, 1, 2, 5, 5}), std::vector<Tile>(5, Tile::kOfKnownMap));
}

TEST(MapRevision, LateTilesBetweenOthersAreNoNewMap) {
  EXPECT_EQ(classify_all({7, 6, 7, 6, 8}),
            (std::vector{Tile::kOfKnownMap, Tile::kLate, Tile::kOfKnownMap, Tile::kLate,
                         Tile::kOfKnownMap}));
}

// Both are lower than the map's, although the second one is higher than the first.
TEST(MapRevision, TheSecondLowerTileInSuccessionBeginsANewMap) {
  EXPECT_EQ(classify_all({7, 0, 1, 2}),
            (std::vector{Tile::kOfKnownMap, Tile::kLate, Tile::kOfNewMap, Tile::kOfKnownMap}));
}

}  // namespace map_revision_test
}  // namespace nodmap::node
