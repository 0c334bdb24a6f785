// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/voxel_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace nodmap::slam6d {
namespace voxel_index_test {

// Places close together, in all positions within their blocks, in several clusters.
std::vector<VoxelPlace> random_places(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> step(0, 11);
  const std::vector<VoxelPlace> corners{{1, 1, 1}, {1 << 20, 1 << 20, 1 << 20}, {2'097'000, 5, 9}};
  std::vector<VoxelPlace> places;
  for (std::size_t i = 0; i < n; ++i) {
    const VoxelPlace& corner = corners[i % corners.size()];
    places.push_back(
        {corner[0] + step(random), corner[1] + step(random), corner[2] + step(random)});
  }
  return places;
}

// The oracle of all tests: an ordered map from places to numbers.
std::map<VoxelPlace, std::uint32_t> numbered(const std::vector<VoxelPlace>& places) {
  std::map<VoxelPlace, std::uint32_t> numbers;
  for (const VoxelPlace& place : places) {
    numbers.try_emplace(place, static_cast<std::uint32_t>(numbers.size()));
  }
  return numbers;
}

VoxelIndex index_of(const std::vector<VoxelPlace>& places) {
  VoxelIndex index;
  for (const VoxelPlace& place : places) {
    index.find_or_add(place);
  }
  return index;
}

TEST(VoxelIndex, NumbersPlacesInTheOrderInWhichTheyCame) {
  const auto places = random_places(3'000, 1);
  const auto numbers = numbered(places);
  VoxelIndex index;
  EXPECT_EQ(index.size(), 0U);
  for (const VoxelPlace& place : places) {
    EXPECT_EQ(index.find_or_add(place), numbers.at(place));
  }
  EXPECT_EQ(index.size(), numbers.size());
}

TEST(VoxelIndex, CornersAreTheVoxelsOneStepAway) {
  const auto places = random_places(900, 2);
  const auto numbers = numbered(places);
  const VoxelIndex index = index_of(places);
  std::mt19937 random(3);
  std::bernoulli_distribution is_forward(0.5);
  for (const VoxelPlace& place : random_places(3'000, 4)) {
    VoxelPlace steps{};
    std::ranges::generate(steps, [&] { return is_forward(random) ? 1 : -1; });
    std::vector<std::uint32_t> expected;
    for (int corner = 0; corner < 8; ++corner) {
      const auto found =
          numbers.find({place[0] + (corner & 1) * steps[0], place[1] + (corner >> 1 & 1) * steps[1],
                        place[2] + (corner >> 2) * steps[2]});
      if (found != numbers.end()) {
        expected.push_back(found->second);
      }
    }
    const VoxelIndex::Corners corners = index.corners(place, steps);
    EXPECT_TRUE(std::ranges::equal(corners.numbers(), expected));
  }
}

TEST(VoxelIndex, EachPairOfTouchingVoxelsIsMetOnce) {
  const auto places = random_places(900, 5);
  const auto numbers = numbered(places);
  std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (const auto& [a, i] : numbers) {
    for (const auto& [b, j] : numbers) {
      if (i < j && std::abs(a[0] - b[0]) <= 1 && std::abs(a[1] - b[1]) <= 1 &&
          std::abs(a[2] - b[2]) <= 1) {
        expected.emplace(i, j);
      }
    }
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> met;
  std::uint32_t last = 0;
  index_of(places).for_each_with_others([&](std::uint32_t i, auto others) {
    EXPECT_GE(i, last);
    last = i;
    for (const std::uint32_t j : others) {
      EXPECT_TRUE(met.emplace(std::min(i, j), std::max(i, j)).second);
    }
  });
  EXPECT_EQ(met, expected);
}

TEST(VoxelIndex, AnEmptyOneHasNoVoxels) {
  const VoxelIndex index;
  EXPECT_EQ(index.corners({5, 5, 5}, {1, -1, 1}).numbers().size(), 0U);
  index.for_each_with_others([](std::uint32_t, auto) { FAIL(); });
}

}  // namespace voxel_index_test
}  // namespace nodmap::slam6d
